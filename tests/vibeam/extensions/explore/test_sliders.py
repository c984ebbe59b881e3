"""Sliders of a page: each moves what ``--set`` moves, by as much, within what the case accepts."""

import numpy as np
import pytest

import vibeam
from vibeam.extensions.explore.drive import drive_amplitude, slider_frequencies
from vibeam.extensions.explore.own_numbers import restitution
from vibeam.extensions.explore.sliders import case_sliders

CASES = (
    "dtu_neutral", "dtu_drives", "sdof_nominal", "rigs/harvester", "rigs/tube", "rigs/absorber", "matrices/frame",
    "experiment/fig19", "experiment/table1", "experiment/fig27_damping",
)  # fmt: skip
#: of both, to round-off of the few sums that make a number
SAME = {"rtol": 1e-12, "atol": 0.0}
FIRST = {"amplitude": 0, "velocity": 1, "acceleration": 2, "force": 2, "moment": 2}


def load(name):
    return vibeam.load(f"cases/{name}.toml")


def places(slider, count=3):
    """Places of a slider, its ends among them, that no code has chosen."""
    inner = np.random.default_rng(30).uniform(slider.low, slider.high, count)
    return [slider.low, *map(float, inner), slider.high]


def number(slider, fidelity, value):
    start, slope = slider.of[fidelity]
    return start + slope * value


def damping(system):
    """Modal damping matrix."""
    return np.diag(2 * system.zeta * system.omega) if system.coupling is None else system.coupling


@pytest.mark.parametrize("name", CASES)
def test_every_number_is_that_of_the_case_with_the_key_at_that_value(name):
    case, found = load(name), case_sliders(load(name))
    assert {"frequency", "drive", "gap"} <= found.sliders.keys() | found.fixed.keys()
    for slider in found.sliders.values():
        for value in places(slider) if slider.name != "frequency" else ():
            moved = case.with_keys(slider.settings(value))  # refused: the slider goes too far
            for fidelity in slider.of.keys() - found.refused.keys():
                before, after, own = case.system(fidelity), moved.system(fidelity), number(slider, fidelity, value)
                if slider.name == "gap":
                    assert np.isclose(own, after.gap, rtol=1e-12, atol=1e-12 * slider.high)
                elif slider.name == "restitution":
                    assert np.isclose(own, restitution(after), rtol=0, atol=1e-12)
                elif slider.name == "damping":
                    one, two = damping(before), damping(after)
                    np.testing.assert_allclose(own * one, two, rtol=0, atol=1e-12 * np.abs(one).max())
                np.testing.assert_allclose(before.omega, after.omega, **SAME)


@pytest.mark.parametrize("name", CASES)
def test_the_base_motion_is_that_of_the_case_at_every_frequency_of_the_slider(name):
    case, grid = load(name), slider_frequencies(load(name))
    slider = case_sliders(case).sliders["drive"]
    moved = case.with_keys(slider.settings(0.37 * slider.high))
    for fidelity in case.fidelities:
        said = drive_amplitude(case, fidelity, grid)
        unit = said["factor"] / (2 * np.pi * grid) ** said["power"] if "power" in said else said["amplitude"]
        wanted = np.broadcast_to(moved.amplitude_of(fidelity, 2 * np.pi * grid), grid.shape)
        np.testing.assert_allclose(number(slider, fidelity, 0.37 * slider.high) * unit, wanted, **SAME)
        assert case.amplitude_of(fidelity, 2 * np.pi * grid) == pytest.approx(said["level"] * unit, rel=1e-12)


def test_a_drive_is_a_power_where_it_is_exact():
    case = load("dtu_drives")
    for fidelity, key in {"acceleration": "acceleration", "displacement": "amplitude", "force": "force"}.items():
        said = drive_amplitude(case, fidelity, slider_frequencies(case))
        assert (said["power"], said["factor"]) == (FIRST[key], 1.0)


def test_a_drive_over_frequency_is_a_table_and_its_slider_a_factor():
    table = {"drive.frequency": ["14 Hz", "17 Hz"], "drive.acceleration": ["0.8 m/s^2", "1 m/s^2"]}
    case = vibeam.load("cases/dtu_neutral.toml", table | {"drive.voltage": None, "drive.gain": None})
    sliders = case_sliders(case).sliders
    drive, grid = sliders["drive"], slider_frequencies(case)
    assert (drive.value, drive.high, drive.unit) == (1.0, 3.0, "")
    assert drive.settings(2.0) == {"drive.acceleration.0": 1.6, "drive.acceleration.1": 2.0}
    assert sliders["frequency"].places.tolist() == grid.tolist()
    twice = case.with_keys({"drive.acceleration": [1.6, 2.0]}).amplitude_of("beam", 2 * np.pi * grid)
    np.testing.assert_allclose(2 * drive_amplitude(case, "beam", grid)["amplitude"], twice, **SAME)


def test_restitution_goes_as_far_as_every_contact_allows():
    slider = case_sliders(load("dtu_neutral")).sliders["restitution"]
    ends = [number(slider, name, slider.high) for name in slider.of]
    assert slider.label == "R₁ of mode 1"
    assert 0.9998 < max(ends) <= 1
    with pytest.raises(ValueError, match="restitution"):
        load("dtu_neutral").with_keys({"stop.restitution": slider.high + 1e-4}).system("beam")


def test_a_gap_stays_between_the_stops():
    slider = case_sliders(load("rigs/tube")).sliders["gap"]
    assert -0.2e-3 < slider.low < -0.19e-3
    with pytest.raises(vibeam.CaseError, match="nothing fits between the stops"):
        load("rigs/tube").with_keys({"stop.gap": -0.2e-3})


def test_what_has_no_slider_says_why():
    assert 'has the law "hertz"' in case_sliders(load("rigs/afm_tip")).fixed["restitution"]
    assert '"linear" has no coefficient' in case_sliders(load("rigs/elastic_stop")).fixed["restitution"]
    assert "no damping ratio" in case_sliders(load("rigs/absorber")).fixed["damping"]
    assert "value of its own" in case_sliders(load("experiment/fig27_damping")).fixed["damping"]


def test_a_model_made_of_a_flight_is_not_flown():
    added = {"fidelity.pod": {"reduction": "pod", "modes": 2, "frequency": "15 Hz", "periods": 3}}
    found = case_sliders(vibeam.load("cases/dtu_neutral.toml", added))
    assert "those of a flight" in found.refused["pod"]
    assert found.refused.keys() == {"pod"}
    assert found.sliders.keys() >= {"gap", "restitution", "damping"}


def test_a_sweep_of_one_frequency_is_widened_as_far_as_the_table_of_its_drive_goes():
    alone = vibeam.load("cases/dtu_neutral.toml", {"sweep.frequency": ["15 Hz"]})
    frequency = case_sliders(alone).sliders["frequency"]
    assert (frequency.low, frequency.value, frequency.high) == (14.25, 15.0, 15.75)
    table = {"drive.frequency": ["14.9 Hz", "17 Hz"], "drive.acceleration": ["0.8 m/s^2", "1 m/s^2"]}
    told = alone.with_keys({"drive.voltage": None, "drive.gain": None} | table)
    frequency = case_sliders(told).sliders["frequency"]
    assert (frequency.low, frequency.high) == (14.9, 15.75)
    assert frequency.places.min() == 14.9
    assert 15.0 in frequency.places
    assert frequency.places.max() == 15.75
