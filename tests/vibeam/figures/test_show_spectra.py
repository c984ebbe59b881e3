"""Figures of shock and response spectra: their numbers are those of the functions, their pictures are drawn."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.figures.sheet import sheets
from vibeam.report.figures import write_shown

RIG: dict[str, Any] = {
    "beam": {
        "length": "180 mm",
        "width": "15 mm",
        "thickness": "0.5 mm",
        "youngs_modulus": "210 GPa",
        "density": "7850 kg/m^3",
        "damping_ratio": 0.017,
    },
    "mass": {"mass": "20 g", "position": "132 mm"},
    "stop": {"gap": "0.2 mm", "restitution": 0.7},
    "sensor": {"position": "100 mm"},
    "fidelity": {"one": {"reduction": "static_mode"}, "three": {"reduction": "modal", "modes": 3}},
}
PULSE = {"shape": "half_sine", "acceleration": "2 g", "duration": "11 ms"}
WHITE = {"density": "0.001 g^2/Hz", "band": ["5 Hz", "400 Hz"], "seed": 3}
NATURAL = ["20 Hz", "90 Hz", "400 Hz"]


def case(drive: dict[str, Any], record: dict[str, Any], **shows: dict[str, Any]) -> vibeam.Case:
    return vibeam.Case.of(RIG | {"drive": drive, "record": record, "show": shows})


def numbers(made: vibeam.Case, name: str) -> dict[str, Any]:
    found = {each.fidelity: each for each in sheets(made, made.shows[name])}
    assert {each.fault for each in found.values()} == {""}
    return found


def test_equipment_at_the_sensor_is_that_of_the_function() -> None:
    asked = {"kind": "shock_spectrum", "natural": NATURAL, "equipment_damping": 0.02}
    made = case(PULSE, {"duration": "0.2 s"}, equipment=asked)
    found, rates = numbers(made, "equipment"), [20.0, 90.0, 400.0]
    for name in ("one", "three"):
        path = vibeam.simulate(made.system(name), made.input(name), 0.2, made.start(name))
        assert len(path.impact_times) > 1
        own = vibeam.shock_spectrum(path, rates, 0.02)
        np.testing.assert_array_equal(found[name]["shock_acceleration"], own.of())
        on_base = vibeam.shock_spectrum(made.input(name), rates, 0.02)
        np.testing.assert_array_equal(found[name]["base_pseudo_velocity"], on_base.of("pseudo_velocity"))
    assert found["three"]["shock_acceleration"][1] > 2 * found["one"]["shock_acceleration"][1]  # mode 2 rings


def test_device_with_and_without_its_stop() -> None:
    asked = {"kind": "shock_spectrum", "response_of": "device", "output": "contact", "natural": NATURAL}
    found = numbers(case(PULSE, {"duration": "0.2 s"}, device=asked), "device")
    for each in found.values():
        struck = each["shock_impacts"] > 0
        assert struck.tolist() == [True, False, False]
        assert each["shock_impact_velocity"][0] > 0
        np.testing.assert_allclose(each["shock_displacement"][1:], each["free_displacement"][1:], rtol=1e-9)


def test_densities_ratios_and_coherence_are_those_of_the_functions() -> None:
    asked = {"kind": "response_spectrum", "up_to": "200 Hz", "resolution": "5 Hz"}
    made = case(WHITE, {"duration": "2 s", "realisations": 3}, density=asked)
    found = numbers(made, "density")
    one, three = found["one"], found["three"]
    assert np.all((one["density_low"] < one["density"]) & (one["density"] < one["density_high"]))
    np.testing.assert_allclose(three["density_ratio"], 1.0, rtol=1e-12)
    np.testing.assert_allclose(one["density_ratio"], one["density"] / three["density"], rtol=1e-12)
    assert (one["frequency"][0], one["frequency"][-1]) == (pytest.approx(5.0, rel=1e-3), pytest.approx(200.0, rel=0.03))
    assert np.all(one["coherence"] <= 1.0)


def test_lines_beyond_what_is_asked_are_said() -> None:
    asked = {"kind": "response_spectrum", "up_to": "1 Hz", "resolution": "5 Hz"}
    made = case(WHITE, {"duration": "1 s"}, density=asked)
    faults = {each.fault for each in sheets(made, made.shows["density"])}
    assert faults == {"up_to: 1 Hz is below the first line, 5 Hz: longer segments"}


def test_linear_structure_in_noise_has_its_theoretical_density() -> None:
    """By hand, one mode and a stop out of reach: |row·load/(ω² − Ω² + 2iζωΩ)|² S, within the intervals at 94 of 100."""
    asked = {"kind": "response_spectrum", "up_to": "150 Hz", "resolution": "1 Hz"}
    far = {"stop": {"gap": "1 m", "restitution": 0.7}}
    record = {"duration": "20 s", "realisations": 8}
    made = vibeam.Case.of(RIG | far | {"drive": WHITE, "record": record, "show": {"density": asked}})
    found, system = numbers(made, "density")["one"], made.system("one")
    turn = 2 * np.pi * found["frequency"]
    gain = system.outputs["sensor"] * system.load / (system.omega**2 - turn**2 + 2j * system.zeta * system.omega * turn)
    exact = np.abs(gain) ** 2 * 0.001 * 9.80665**2
    seen = found["frequency"] > 3 * float(system.omega[0]) / (2 * np.pi)  # nearer, the resonance leaks into the lines
    held = (found["density_low"] <= exact) & (exact <= found["density_high"])
    assert np.mean(held[seen]) == pytest.approx(0.95, abs=0.05)
    np.testing.assert_allclose(found["gain"][seen], np.abs(gain)[seen], rtol=0.01)  # what both share cancels
    assert np.min(found["coherence"][seen]) > 0.99


def test_pictures_are_drawn_and_kept_in_the_results(tmp_path: Path) -> None:
    shown = {
        "equipment": {"kind": "shock_spectrum", "natural": NATURAL},
        "device": {"kind": "shock_spectrum", "response_of": "device", "natural": NATURAL},
    }
    result = vibeam.run(case(PULSE, {"duration": "0.1 s"}, **shown), tmp_path / "shock.h5")
    assert {len(each) for each in result.shown.values()} == {2}
    for each in write_shown(result, tmp_path / "shock.h5"):
        assert each.stat().st_size > 10_000
