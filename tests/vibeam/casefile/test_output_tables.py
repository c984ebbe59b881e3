"""[output.NAME] in a case: read by their names everywhere, with their units; what is wrong with one."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import vibeam
from vibeam.figures.units import amplitude_of, motion_of, units_for
from vibeam.studies.recorded_numbers import AskedNumber

CASES = Path(__file__).parents[3] / "cases"

RIG = CASES / "dtu_neutral.toml"

OUTPUTS = {
    "output.gauge.position": "5 mm",
    "output.gauge.quantity": "strain",
    "output.speed.position": "100 mm",
    "output.speed.quantity": "velocity",
    "output.accelerometer.position": "132 mm",
    "output.accelerometer.quantity": "acceleration",
    "output.turn.position": "180 mm",
    "output.turn.quantity": "slope",
}

SHORT = {"sweep.frequency": ["15 Hz"], "sweep.settle": 60, "sweep.hold": 4, "sweep.direction": "up", "reference": None}


def loaded(**changes: Any) -> vibeam.Case:
    return vibeam.load(RIG, set=OUTPUTS | SHORT | {key.replace("__", "."): value for key, value in changes.items()})


def faults(changes: Mapping[str, Any]) -> str:
    with pytest.raises(vibeam.CaseError) as caught:
        vibeam.load(RIG, set=SHORT | dict(changes))
    return str(caught.value)


def test_a_case_without_them_has_nothing_of_them():
    case = vibeam.load(RIG)
    assert "output" not in tomllib.loads(case.text)
    assert case.scene.outputs == ()
    assert case.system("beam").derivatives == {}


def test_a_case_with_them_moves_to_the_same_bits():
    plain, read = vibeam.load(RIG, set=SHORT), loaded()
    assert all(plain.system(name).moves_as(read.system(name)) for name in plain.fidelities)
    one, other = (vibeam.run(case)["beam"].up for case in (plain, read))
    assert one.amplitude.tobytes() == other.amplitude.tobytes()


def test_every_output_is_a_system_s_by_its_name():
    system = loaded().system("beam")
    assert set(system.outputs) == {"sensor", "tip", "gauge", "turn"}
    assert {name: each.order for name, each in system.derivatives.items()} == {"speed": 1, "accelerometer": 2}
    assert np.array_equal(system.derivatives["speed"].row, system.outputs["sensor"])
    path = vibeam.simulate(system, vibeam.Drive(95.0, 1e-4), 0.2)
    assert float(path.at(0.15, "speed")) == float(path.velocity_at(0.15, "sensor"))


def test_an_acceleration_is_absolute_unless_it_says_otherwise():
    assert loaded().system("sdof").derivatives["accelerometer"].base == 1
    assert loaded(output__accelerometer__absolute=False).system("sdof").derivatives["accelerometer"].base == 0
    driven = {"drive.voltage": None, "drive.gain": None, "drive.force": "1 N", "drive.at": "132 mm"}
    case = vibeam.load(RIG, set=OUTPUTS | SHORT | driven)  # a force drives the beam, the base is at rest
    assert case.system("sdof").derivatives["accelerometer"].base == 0


def test_a_platform_that_moves_by_itself_is_what_an_acceleration_is_absolute_by():
    platform = {"platform.mass": "5 kg", "platform.frequency": "3 Hz", "platform.damping_ratio": 0.05,
                "platform.coupling": "two-way", "platform.calibrated_at": "15.5 Hz"}  # fmt: skip
    plain = vibeam.load(RIG, set=OUTPUTS | SHORT | platform).system("beam")
    relative = vibeam.load(RIG, set=OUTPUTS | SHORT | platform | {"output.accelerometer.absolute": False}).system(
        "beam"
    )
    absolute, own = (each.derivatives["accelerometer"] for each in (plain, relative))
    assert absolute.base == own.base == 0
    assert np.array_equal(absolute.row, own.row + plain.outputs["platform"])


UNITS = {"gauge": "1", "speed": "m s-1", "accelerometer": "m s-2", "turn": "rad", "sensor": "m"}


@pytest.mark.parametrize("output", UNITS)
def test_units_in_the_results_file_and_of_xarray(tmp_path, output):
    case = loaded(sweep__output=output)
    result = vibeam.run(case, out=tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5") as file:
        stored = file["beam/up"]
        assert stored["amplitude"].attrs["units"] == UNITS[output]
        assert stored["reach"].attrs["units"] == "m"
        assert stored["impact_velocity"].attrs["units"] == "m s-1"
    assert result.to_dataframe().attrs["units"]["maximum"] == UNITS[output]
    again = vibeam.run(case, out=tmp_path / "a.h5")
    assert again.found == len(again.case.fidelities)
    assert again["beam"].up.amplitude == result["beam"].up.amplitude


LABELS = {
    "gauge": ("strain amplitude, gauge, ½(max − min) (µε)", "gauge:\nrate (µε/s)"),
    "speed": ("velocity amplitude, speed, ½(max − min) (mm/s)", "speed:\nacceleration (m/s²)"),
    "accelerometer": ("acceleration amplitude, accelerometer, ½(max − min) (m/s²)", "accelerometer:\njerk (m/s³)"),
    "turn": ("slope amplitude, turn, ½(max − min) (mrad)", "turn:\nrate (mrad/s)"),
    "sensor": ("amplitude at the sensor, ½(max − min) (mm)", "sensor velocity (mm/s)"),
}


@pytest.mark.parametrize("output", LABELS)
def test_labels_of_axes(output):
    units = units_for(vibeam.run(loaded(sweep__output=output)))
    assert (amplitude_of(output, units), motion_of(output, "velocity", units)) == LABELS[output]


@pytest.mark.parametrize(("kind", "output"), [("history", "gauge"), ("history", "accelerometer"), ("portrait", "speed"),
                                              ("harmonics", "speed"), ("spectrum", "gauge")])  # fmt: skip
def test_figures_show_them(tmp_path, kind, output):
    shown = {"show.a.kind": kind, "show.a.frequency": "15 Hz", "show.a.output": output, "show.a.fidelities": ["sdof"]}
    case = vibeam.load(RIG, set=OUTPUTS | SHORT | shown)
    sheet = vibeam.run(case, out=tmp_path / "a.h5").shown["a"][0]
    assert not sheet.fault
    column = {"harmonics": "harmonic", "spectrum": "displacement_line"}.get(kind, "displacement")
    with h5py.File(tmp_path / "a.h5") as file:
        stored = file[f"show/a/sdof/0/{column}"].attrs
        assert stored["units"] == UNITS[output]
        assert kind != "history" or stored["long_name"] == f"{OUTPUTS[f'output.{output}.quantity']} of the output"


def test_a_velocity_is_a_fidelity_s_reference_and_measured(tmp_path):
    """Far from the stop one mode answers with X = load Ω²B/|ω² − Ω² + 2iζωΩ|, its velocity with ΩX."""
    own_file = _without_references(tmp_path / "own.toml")
    far = {"stop.gap": "20 mm", "stop.gap_at": "contact", "sweep.output": "speed", "sweep.settle": 2000}
    case = vibeam.load(RIG, set=OUTPUTS | SHORT | far)
    system, omega = case.system("sdof"), 2 * np.pi * 15.0
    base = float(np.ravel(case.amplitude(np.array([omega])))[0])
    answer = system.load * omega**2 * base / (system.omega**2 - omega**2 + 2j * system.zeta * system.omega * omega)
    speed = float(omega * abs(system.derivatives["speed"].row[0] * answer[0]))
    for factor, holds in ((1.0, True), (1.01, False)):
        (tmp_path / "speed.csv").write_text(f"frequency_hz,direction,amplitude\n15,up,{speed * factor!r}\n")
        asked = {
            "reference.speed.file": "speed.csv", "reference.speed.fidelity": "sdof",
            "reference.speed.quantity": "amplitude", "reference.speed.tolerance": "0.01 %",
            "measured.speed.fidelity": "sdof", "measured.speed.quantity": "amplitude",
            "measured.speed.frequency": "15 Hz", "measured.speed.value": f"{1e3 * speed!r} mm/s",
            "measured.speed.source": "closed form",
        }  # fmt: skip
        changes = OUTPUTS | SHORT | far | asked
        del changes["reference"]
        own = vibeam.load(own_file, set=changes)
        result = vibeam.run(own)
        assert all(row.passed for row in vibeam.check(own)) == holds
        assert abs(vibeam.compare_measured(own, result)[0].difference) < 1e-4 * speed


def _without_references(path: Path) -> Path:
    """The rig's file less its references, whose files are not beside it."""
    lines, keep = [], True
    for line in RIG.read_text().splitlines():
        keep = not line.startswith("[reference") if line.startswith("[") else keep
        lines += [line] if keep else []
    path.write_text("\n".join(lines))
    return path


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"sweep.output": "gage"}, '"sensor" | "contact" | "tip" | "platform" | "gauge" |'),
        ({"sweep.output": "gage"}, "did you mean 'gauge'?"),
        ({"sweep.output": 1}, "sweep.output: must be text in quotes, not 1"),
        ({"output.gauge.position": "200 mm"}, "output.gauge.position: 0.2 m is beyond the tip: beam.length is 0.18 m"),
        ({"output.gauge.position": None}, "output.gauge.position: missing (from x = 0, in [0, length])"),
        ({"output.tip.position": "1 mm"}, 'output.tip: the name "tip" is that of an output'),
        ({"output.gauge.quantity": "stress"}, "output.gauge.quantity: 'stress' is not one of"),
        ({"output.gauge.distance": 0}, "output.gauge.distance: is 0: the neutral axis is not strained"),
        ({"output.gauge.quantity": "slope", "output.gauge.distance": "1 mm"}, "is of a strain gauge: write quantity"),
        ({"output.gauge.absolute": True}, 'output.gauge.absolute: goes with quantity = "acceleration" alone'),
        (
            {"plate": [{"start": 0, "end": "20 mm", "width": "20 mm", "thickness": "1 mm", "mass": "3 g"}]},
            'output.gauge.distance: missing (a plate is bonded there): write distance = "0.5 mm"'
        ),
        (
            {"section": [{"start": 0, "end": "20 mm", "shape": "general", "area": 2e-5, "second_moment": 2e-12}]},
            'output.gauge.distance: missing (shape = "general" has no height): write distance'
        ),
        (
            {"sweep.output": "speed", "fidelity.sdof.solver": "averaging"},
            'fidelity.sdof.solver: "averaging" reads no velocity, which sweep.output "speed" is: write "flight" or'
        ),
        (
            {"sweep.output": "speed", "stop.law": "hertz", "stop.stiffness": "1e7 N/m^1.5", "stop.restitution": None,
             "stop.restitution_of": None},
            'sweep.output: the velocity in the contacts of stop.law = "hertz" is not read'
        ),
        (
            {"show.a.kind": "section", "show.a.frequency": "15 Hz", "show.a.output": "speed"},
            'show.a.output: kind = "section" shows no velocity, which "speed" is: write output = "sensor"'
        ),
        (
            {"sweep.output": "speed", "show.a.kind": "curve", "show.a.quantity": "output_reach"},
            'show.a.quantity: "output_reach" is of a displacement, sweep.output "speed" is of the quantity velocity'
        ),
        (
            {"sweep.output": "speed", "measured.a.fidelity": "sdof", "measured.a.quantity": "amplitude",
             "measured.a.frequency": "15 Hz", "measured.a.value": "1 mm", "measured.a.source": "x"},
            'measured.a.value: a length, but "amplitude" is a speed'
        ),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_with_its_cure(changes, message):
    assert message in faults(OUTPUTS | changes)


def test_effects_are_judged_by_any_output():
    """Relative changes know no unit: those of a strain are those of a run's strains."""
    case = loaded(sweep__output="gauge", sweep__frequency=["15 Hz"], mass__rotary_inertia="3e-5 kg m^2")
    [row] = [each for each in vibeam.influence(case).rows if each.effect == "mass.rotary_inertia"]
    name = vibeam.influence(case).fidelity
    ours, whole = (
        vibeam.run(each, show=False)[name].peak.amplitude
        for each in (case.with_keys({"mass.rotary_inertia": None}), case)
    )
    assert row.without.change(AskedNumber("peak")) == pytest.approx(ours / whole - 1, rel=1e-6)


def test_a_fidelity_has_its_gauge_elsewhere():
    case = loaded(fidelity__sdof__set={"output.gauge.position": "20 mm"})
    assert [each.position for each in case.scene_of("sdof").outputs if each.name == "gauge"] == [0.02]
    assert [each.position for each in case.scene_of("beam").outputs if each.name == "gauge"] == [0.005]
    with pytest.raises(vibeam.CaseError, match=r"unknown key 'output.gauge.place'; .*known here: position"):
        loaded(fidelity__sdof__set={"output.gauge.place": "20 mm"})


def test_matrices_are_written_with_the_rows_of_displacements_alone(tmp_path):
    vibeam.export_matrices(loaded(), tmp_path / "rig.npz")
    with np.load(tmp_path / "rig.npz") as file:
        assert {"contact", "sensor", "tip"} <= set(file)
        assert not set(file) & {"gauge", "speed", "accelerometer", "turn"}
