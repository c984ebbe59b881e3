"""Animations: numbers of a loop against the motion itself, frames of the files, branches, faults."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from PIL import Image
from stand_in import SDOF
from typer.testing import CliRunner

import vibeam
from vibeam.case.beam_field import field_system, fields
from vibeam.casefile.read import parse
from vibeam.cli.main import app
from vibeam.exchange.faults import CaseError
from vibeam.figures.moving import pictures
from vibeam.figures.sheet import Sheet
from vibeam.report.figures import _composed, write_shown
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
kind = "animation"
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
    scale = float(np.abs(sheet["contact"]).max())
    assert sheet["beam_position"][at] == pytest.approx(0.24)
    assert np.allclose(sheet["beam_deflection"][:, at], path.at(times - 1e-12), atol=1e-5 * scale)
    assert (sheet["periods"], sheet["seamless"]) == (1.0, 1.0)
    assert sheet["amplitude"][0] == pytest.approx(result[fidelity].up.amplitude[0], rel=1e-7)
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
    _, sheet = sheet_of(text=text)
    assert not sheet.fault
    ours = int(np.argmin(np.abs(sheet["beam_position"] - 0.24)))
    theirs = int(np.argmin(np.abs(sheet["opposite_position"] - 0.2)))
    met = sheet["opposite_deflection"][:, theirs] + 0.01 * sheet["opposite_slope"][:, theirs]
    size = np.abs(sheet["contact"]).max()
    assert np.allclose(sheet["met"], met, atol=1e-12)
    contact = np.interp(sheet["time"], sheet["history_time"], sheet["contact"])
    assert np.allclose(sheet["beam_deflection"][:, ours] - met, contact, atol=1e-4 * size)
    assert np.abs(met).max() > 1e-3 * size


def test_a_branch_is_that_of_the_sweep() -> None:
    """Above resonance a motion with impacts, reached upward, stands beside one without, reached downward."""
    own = {"sweep.frequency": {"from": 8.0, "to": 14.0, "points": 25}, "show.it.fidelities": ["sdof"]}
    found = {}
    for way in ("up", "down"):
        result = vibeam.run(parse(CASE, set={**own, "show.it.frequency": FOLD, "show.it.direction": way}))
        response = getattr(result["sdof"], way)
        at = int(np.argmin(np.abs(response.frequency - FOLD)))
        found[way] = result.shown["it"][0]["amplitude"][0]
        assert found[way] == pytest.approx(response.amplitude[at], rel=1e-3)
    assert found["up"] > 1.2 * found["down"]


FOLD = 11.5


def test_files_hold_every_frame_and_loop_without_a_seam(tmp_path: Path) -> None:
    result, _ = sheet_of()
    (file,) = write_shown(result, tmp_path / "a.h5", "the stamp")
    assert file.name == "a_it.gif"
    assert file.stat().st_size < 1_000_000
    with Image.open(file) as image:
        assert (image.info["loop"], image.info["comment"]) == (0, b"the stamp")
        shown = []
        for index in range(image.n_frames):
            image.seek(index)
            shown.append(image.info["duration"])
        assert sum(shown) == 36 * 50  # equal neighbours are one frame that lasts
    frames = pictures(lambda: _composed(result, result.case.shows["it"]))
    assert len(frames) == 36
    steps = [np.abs(frames[k].astype(int) - frames[k - 1].astype(int)).mean() for k in range(36)]
    assert 0 < steps[0] <= 1.5 * max(steps[1:])  # from the last to the first as between any two


def test_stop_and_beam_are_drawn_to_the_scale_that_is_said() -> None:
    result, _ = sheet_of()
    figure, moving = _composed(result, result.case.shows["it"])
    figure.draw_without_rendering()
    axes = next(each for each in figure.axes if each.get_title() == "beam")
    beam = next(artist for artist in moving.artists if artist.axes is axes)
    said = next(text.get_text() for text in axes.texts)
    across, upward = axes.transData.transform([[0, 0], [1, 0]]), axes.transData.transform([[0, 0], [0, 1]])
    assert axes.get_ylabel() == "deflection (mm)"
    scale = (upward[1, 1] - upward[0, 1]) / (across[1, 0] - across[0, 0])
    assert float(said.removeprefix("deflection × ")) == pytest.approx(scale, rel=0.005)  # matplotlib goes no nearer
    stop = next(artist for artist in moving.artists if artist.axes is axes and artist.get_marker() == 7)
    assert (stop.get_xdata()[0], stop.get_ydata()[0]) == (pytest.approx(240), pytest.approx(0.5))
    highest = []
    for frame in range(moving.count):
        moving.turn(frame)
        highest.append(np.interp(240, beam.get_xdata(), beam.get_ydata()))
    assert 0.4 < max(highest) <= 0.5
    shown = [line for line in figure.axes if line.get_xlabel().startswith("time")]
    assert shown[0].get_xlim() == (0, 1)


def test_impacts_are_marked_when_they_happen() -> None:
    result, sheet = sheet_of()
    _, moving = _composed(result, result.case.shows["it"])
    flash = next(artist for artist in reversed(moving.artists) if artist.get_marker() == "*")
    lit = set()
    for frame in range(moving.count):
        moving.turn(frame)
        lit |= {frame} if len(flash.get_xdata()) else set()
    hits = sheet["impact_time"] * 10 * 36
    assert lit == {int(each) % 36 for hit in hits for each in np.arange(np.ceil(hit), hit + 0.06 * 36)}


def test_a_motion_of_samples_is_shown_too() -> None:
    _, exact = sheet_of()
    _, found = sheet_of(
        "it", CASE.replace("[fidelity.beam]", '[fidelity.it]\nsolver = "direct"'), sweep__settle=30, sweep__hold=3
    )
    assert not found.fault
    size = np.abs(exact["contact"]).max()
    assert np.allclose(found["beam_deflection"], exact["beam_deflection"], atol=0.02 * size)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"show.it.frequency": [10.0, 11.0]}, "2 frequencies, and an animation shows one"),
        ({"show.it.direction": "both"}, 'write "up" or "down"'),
        ({"show.it.format": "png"}, "show.it.format"),
        ({"show.it.frames": 1}, "show.it.frames"),
        ({"show.it.rate": "1 Hz/s"}, 'kind = "animation" has no use for it'),
        ({"show.it": {"kind": "portrait", "frequency": 10.0, "format": "gif"}}, 'kind = "portrait" has no use for it'),
    ],
)
def test_what_makes_no_sense_is_refused(changed: Any, said: str) -> None:
    with pytest.raises(CaseError, match=said):
        parse(CASE, set=changed)


def test_a_case_without_a_beam_is_refused() -> None:
    with pytest.raises(CaseError, match='"animation" draws a beam, and this case has none'):
        parse(SDOF, set={"show.it": {"kind": "animation", "frequency": 0.3}})


def test_without_ffmpeg_there_is_one_message_before_anything_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = tmp_path / "a.toml"
    case.write_text(CASE + 'format = "mp4"\n')
    monkeypatch.setitem(mpl.rcParams, "animation.ffmpeg_path", str(tmp_path / "none"))
    done = CliRunner().invoke(app, ["run", str(case)])
    assert done.exit_code == 2
    assert "show.it.format: mp4 needs ffmpeg" in done.stderr
    assert 'apt install ffmpeg), or write format = "gif"' in done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.toml"]


def test_mp4_gets_all_frames_in_even_sizes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A program in place of ffmpeg notes what it is given."""
    program = tmp_path / "ffmpeg"
    program.write_text(
        f"#!{sys.executable}\nimport sys\n"
        "open(sys.argv[-1], 'w').write('\\n'.join([str(len(sys.stdin.buffer.read())), *sys.argv]))\n"
    )
    program.chmod(0o755)
    monkeypatch.setitem(mpl.rcParams, "animation.ffmpeg_path", str(program))
    result, _ = sheet_of(show__it__format=["mp4"], show__it__frames=5)
    (file,) = write_shown(result, tmp_path / "a.h5", "the stamp")
    count, *asked = file.read_text().splitlines()
    wide, high = map(int, asked[asked.index("-video_size") + 1].split("x"))
    assert (wide % 2, high % 2) == (0, 0)
    assert int(count) == 5 * 3 * wide * high
    assert "comment=the stamp" in asked
