"""VTU series of a motion: numbers of a loop against the motion itself, branches, faults."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from stand_in import SDOF

import vibeam
from vibeam.case.beam_field import field_system, fields
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam.figures.sheet import Sheet
from vibeam_models.beam import structure_of

CASE = """units = "SI"
[beam]
length = 0.3
width = 0.02
thickness = 0.002
youngs_modulus = 70e9
density = 2700
damping_ratio = 0.02
elements = 10
[mass]
mass = 0.05
position = 0.24
[stop]
gap = 0.5e-3
restitution = 0.6
[sensor]
position = 0.3
[drive]
amplitude = 1e-4
[sweep]
frequency = { from = 8.0, to = 14.0, points = 25 }
direction = "both"
settle = 200
hold = 20
output = "contact"
[fidelity.sdof]
reduction = "static_mode"
[fidelity.beam]
reduction = "modal"
modes = 4
[show.it]
kind = "vtu"
frequency = 10.0
"""

OPPOSITE = """[opposite]
position = 0.2
arm = 0.01
length = 0.25
"""


def sheet_of(fidelity: str = "beam", text: str = CASE, **changed: Any) -> tuple[Any, Sheet]:
    """A result and the sheet of one fidelity."""
    keys = {name.replace("__", "."): value for name, value in changed.items()}
    result = vibeam.run(parse(text, set={"sweep.frequency": [10.0], **keys}))
    return result, next(sheet for sheet in result.shown["it"] if sheet.fidelity == fidelity)


@pytest.mark.parametrize("fidelity", ["sdof", "beam"])
def test_a_loop_is_the_settled_motion_of_the_same_model(fidelity: str) -> None:
    """The beam where the stop is moves as the contact of the model without further points, from any begin."""
    result, sheet = sheet_of(fidelity)
    case = result.case
    drive = vibeam.Drive(2 * np.pi * 10, float(case.amplitude_of(fidelity)))
    path = vibeam.simulate(case.system(fidelity), drive, 200 / 10)
    times = 20 - 1 / 10 + sheet["time"]
    at = int(np.argmin(np.abs(sheet["beam_position"] - 0.24)))
    scale = float(np.abs(sheet["beam_deflection"][:, at]).max())
    assert sheet["beam_position"][at] == pytest.approx(0.24)
    assert np.allclose(sheet["beam_deflection"][:, at], path.at(times - 1e-12), atol=1e-5 * scale)
    assert (sheet["periods"], sheet["seamless"]) == (1.0, 1.0)
    assert len(sheet["time"]) == 36
    hits = path.impact_times[path.impact_times > 19.9] - 19.9
    assert np.allclose(sheet["impact_time"], hits, atol=1e-6)
    assert np.all(sheet["beam_deflection"][:, at] <= 0.5e-3)


def test_rows_of_all_points_are_the_reduction_expanded() -> None:
    """x = Φ q of the reduction itself, at the nodes, up to the signs of the modes."""
    case = parse(CASE)
    system, pointed = field_system(case.scene, case.fidelities["beam"])
    shape = fields(pointed, system)["beam"]
    whole = structure_of(case.scene)
    basis = vibeam.modal(whole, 4).basis
    nodes = shape.deflection[4::4]  # deflections of the nodes come first, then slopes, in turn; node 0 is held
    slopes = shape.slope[4::4]
    signs = np.sign(np.sum(basis[::2] * nodes, axis=0))
    assert np.allclose(nodes * signs, basis[::2], atol=1e-9 * np.abs(basis).max())
    assert np.allclose(slopes * signs, basis[1::2], atol=1e-9 * np.abs(basis).max())
    assert system.moves_as(case.system("beam"))


def test_two_beams_meet_where_the_contact_says() -> None:
    """u₁(x₁) − u₂(x₂) − a θ₂(x₂) is the contact's displacement."""
    text = CASE.replace("[sweep]", OPPOSITE + "[sweep]").replace('"static_mode"', '"modal"\nmodes = 1')
    result, sheet = sheet_of(text=text)
    assert not sheet.fault
    drive = vibeam.Drive(2 * np.pi * 10, float(result.case.amplitude_of("beam")))
    path = vibeam.simulate(result.case.system("beam"), drive, 200 / 10)
    contact = path.at(20 - 1 / 10 + sheet["time"] - 1e-12)
    ours = int(np.argmin(np.abs(sheet["beam_position"] - 0.24)))
    theirs = int(np.argmin(np.abs(sheet["opposite_position"] - 0.2)))
    met = sheet["opposite_deflection"][:, theirs] + 0.01 * sheet["opposite_slope"][:, theirs]
    size = np.abs(contact).max()
    assert np.allclose(sheet["met"], met, atol=1e-12)
    assert np.allclose(sheet["beam_deflection"][:, ours] - met, contact, atol=1e-4 * size)
    assert np.abs(met).max() > 1e-3 * size


def test_a_branch_is_that_of_the_sweep() -> None:
    """Above resonance a motion with impacts, reached upward, stands beside one without, reached downward."""
    own = {"show.it.fidelities": ["sdof"], "show.it.frames": 1000}
    found = {}
    for way in ("up", "down"):
        result = vibeam.run(parse(CASE, set={**own, "show.it.frequency": FOLD, "show.it.direction": way}))
        response = getattr(result["sdof"], way)
        at = int(np.argmin(np.abs(response.frequency - FOLD)))
        sheet = result.shown["it"][0]
        contact = sheet["beam_deflection"][:, int(np.argmin(np.abs(sheet["beam_position"] - 0.24)))]
        found[way] = np.ptp(contact) / 2
        assert found[way] == pytest.approx(response.amplitude[at], rel=3e-3)  # half of what it goes in a frame
    assert found["up"] > 1.2 * found["down"]


FOLD = 11.5


def test_a_motion_of_samples_is_shown_too() -> None:
    _, exact = sheet_of()
    _, found = sheet_of(
        "it", CASE.replace("[fidelity.beam]", '[fidelity.it]\nsolver = "direct"'), sweep__settle=30, sweep__hold=3
    )
    assert not found.fault
    size = np.abs(exact["beam_deflection"]).max()
    assert np.allclose(found["beam_deflection"], exact["beam_deflection"], atol=0.02 * size)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"show.it.frequency": [10.0, 11.0]}, '2 frequencies, and "vtu" shows one'),
        ({"show.it.direction": "both"}, 'write "up" or "down"'),
        ({"show.it.format": "png"}, "show.it.format: unknown key"),
        ({"show.it.frames": 1}, "show.it.frames"),
        ({"show.it.rate": "1 Hz/s"}, 'kind = "vtu" has no use for it'),
        ({"show.it": {"kind": "portrait", "frequency": 10.0, "frames": 9}}, 'kind = "portrait" has no use for it'),
    ],
)
def test_what_makes_no_sense_is_refused(changed: Any, said: str) -> None:
    with pytest.raises(CaseError, match=said):
        parse(CASE, set=changed)


def test_a_case_without_a_beam_is_refused() -> None:
    with pytest.raises(CaseError, match='"vtu" shows a beam, and this case has none'):
        parse(SDOF, set={"show.it": {"kind": "vtu", "frequency": 0.3}})
