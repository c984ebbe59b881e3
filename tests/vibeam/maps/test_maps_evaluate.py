"""A grid of case keys against sweeps of cases that are written with each value."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from stand_in import SI

import vibeam
from vibeam.maps.block import Block, evaluate_block
from vibeam.maps.evaluate import grid_of
from vibeam.maps.points import Starts

RIG = "cases/dtu_neutral.toml"
FREQUENCIES = np.linspace(14.0, 17.0, 7)
SHORT: dict[str, Any] = {"settle": 40, "hold": 16}


def rig(**changes: Any) -> vibeam.Case:
    return vibeam.load(RIG, set=SI | {key.replace("__", "."): value for key, value in changes.items()})


def swept(case: vibeam.Case, fidelity: str, direction: str = "up") -> Any:
    omega = 2 * np.pi * FREQUENCIES
    return vibeam.sweep(
        case.system(fidelity),
        omega=omega,
        amplitude=case.amplitude_of(fidelity, omega),
        output=case.sweep.output,
        direction=direction,  # type: ignore[arg-type]
        **SHORT,
    )


@pytest.mark.parametrize(
    ("key", "values"),
    [
        ("stop.gap", (-5e-5, 0.0, 1e-4)),
        ("stop.restitution", (0.5, 0.72)),
        ("drive.voltage", (0.3, 0.6)),
        ("drive.gain", (4e-4, 7e-4)),
        ("mass.mass", (0.18, 0.21)),
        ("beam.thickness", (1e-3, 1.05e-3)),
        ("beam.elements", (20, 30)),
    ],
)
def test_a_line_is_the_sweep_of_the_case_with_that_value_to_the_bit(key: str, values: tuple[float, ...]) -> None:
    found = vibeam.evaluate(
        rig(), "two_modes", {key: values, "sweep.frequency": FREQUENCIES}, direction="both",
        quantities=("amplitude", "period", "impact_velocity"), lanes=False, **SHORT,
    )  # fmt: skip
    assert found["amplitude"].shape == (2, len(values), 7)
    for line, value in enumerate(values):
        both = swept(rig(**{key.replace(".", "__"): value}), "two_modes", "both")
        for way, expected, order in (("up", both.up, slice(None)), ("down", both.down, slice(None, None, -1))):
            for name, got in found.way(way).items():
                np.testing.assert_array_equal(got[line], getattr(expected, name)[order], err_msg=f"{name} {way}")


@pytest.mark.parametrize("direction", ["both", "apart"])
def test_lines_side_by_side_are_those_alone_to_round_off(direction: Any) -> None:
    grid = {"stop.restitution": [0.6, 0.7], "drive.voltage": np.linspace(0.3, 0.7, 5), "sweep.frequency": FREQUENCIES}
    found, alone = (
        vibeam.evaluate(
            rig(), "two_modes", grid, direction=direction, settle=300, hold=16, lanes=lanes,
            quantities=("amplitude", "period", "impact_velocity", "strobes", "energy"), strobes=2,
        )
        for lanes in (True, False)
    )  # fmt: skip
    settled = alone["period"] > 0
    assert np.mean(settled) > 0.9
    np.testing.assert_array_equal(found["period"], alone["period"])
    for name in ("amplitude", "impact_velocity", "energy"):
        np.testing.assert_allclose(found[name][settled], alone[name][settled], rtol=1e-7, err_msg=name)


def test_keys_that_decide_different_things_go_together() -> None:
    grid = {"drive.voltage": [0.4, 0.6], "stop.gap": [0.0, 1e-4], "stop.restitution": [0.6, 0.8]}
    found = vibeam.evaluate(rig(), "beam", grid | {"sweep.frequency": FREQUENCIES}, lanes=False, **SHORT)
    expected = swept(rig(drive__voltage=0.4, stop__gap=1e-4, stop__restitution=0.8), "beam")
    np.testing.assert_array_equal(found["amplitude"][0, 1, 1], expected.amplitude)
    expected = swept(rig(drive__voltage=0.6, stop__gap=0.0, stop__restitution=0.6), "beam")
    np.testing.assert_array_equal(found["amplitude"][1, 0, 0], expected.amplitude)


def test_a_key_that_the_fidelity_sets_itself_is_changed_there() -> None:
    case = vibeam.load(RIG, set=SI | {"fidelity.sdof.set": {"stop.gap": 2e-4}})
    found = vibeam.evaluate(case, "sdof", {"stop.gap": [0.0], "sweep.frequency": FREQUENCIES}, lanes=False, **SHORT)
    np.testing.assert_array_equal(found["amplitude"][0], swept(rig(stop__gap=0.0), "sdof").amplitude)


def test_a_gap_that_changes_along_the_sweep_is_that_of_a_sweep_whose_gap_drifts() -> None:
    gaps = np.linspace(1.5e-4, -2e-5, 9)
    found = vibeam.evaluate(rig(), "two_modes", {"stop.gap": gaps}, frequency=15.3, settle=200, hold=16)
    first = rig(stop__gap=float(gaps[0]))
    system = first.system("two_modes")
    contact = [rig(stop__gap=float(gap)).system("two_modes").gap for gap in gaps]
    drive: Any = {"omega": np.full(9, 2 * np.pi * 15.3), "amplitude": first.amplitude_of("two_modes")}
    drifting = vibeam.sweep(
        system, **drive, settle=200, hold=16, output="sensor", drift=lambda omega: np.array(contact) - system.gap
    )
    assert isinstance(drifting, vibeam.FrequencyResponse)
    np.testing.assert_allclose(found["amplitude"], drifting.amplitude, rtol=1e-9)
    np.testing.assert_array_equal(found["period"], drifting.period)


def test_points_apart_start_from_equilibrium_each() -> None:
    found = vibeam.evaluate(rig(), "sdof", {"sweep.frequency": FREQUENCIES}, direction="apart", lanes=False, **SHORT)
    case, omega = rig(), 2 * np.pi * FREQUENCIES[3]
    alone = vibeam.sweep(
        case.system("sdof"), omega=[omega], amplitude=case.amplitude_of("sdof"), output="sensor", **SHORT
    )
    assert isinstance(alone, vibeam.FrequencyResponse)
    assert found["amplitude"][3] == alone.amplitude[0]


def test_models_of_any_number_of_modes_stand_side_by_side() -> None:
    grid = {"fidelity.beam.modes": [1, 8, 2], "sweep.frequency": FREQUENCIES}
    found = vibeam.evaluate(rig(), "beam", grid, direction="apart", **SHORT)
    alone = vibeam.evaluate(
        rig(fidelity__beam__modes=8), "beam", {"sweep.frequency": FREQUENCIES}, direction="apart", **SHORT
    )
    np.testing.assert_array_equal(found["amplitude"][1], alone["amplitude"])


def test_a_start_is_where_the_contact_begins() -> None:
    """Without drive and out of reach of the stop: the free decay of mode 1, in closed form."""
    case = rig(drive__voltage=1e-12, stop__gap=1.0)
    found = vibeam.evaluate(
        case, "two_modes", {"start.displacement": [1e-4, -3e-4], "start.velocity": [0.0, 0.02]}, direction="apart",
        frequency=10.0, settle=3, hold=1, output="contact", strobes=1, quantities=("strobes",),
    )  # fmt: skip
    system = case.system("two_modes")
    omega, zeta, time = system.omega[0], system.zeta[0], 4 / 10.0
    damped = omega * np.sqrt(1 - zeta**2)
    for row, x in enumerate((1e-4, -3e-4)):
        for column, v in enumerate((0.0, 0.02)):
            turning = x * np.cos(damped * time) + (v + zeta * omega * x) / damped * np.sin(damped * time)
            expected = np.exp(-zeta * omega * time) * turning
            assert found["strobes"][row, column, 0] == pytest.approx(expected, rel=1e-6)


def test_random_starts_do_not_hang_on_blocks_and_lie_within_their_spread() -> None:
    case, starts = rig(), Starts(3, 7, 5e-4)
    grid = grid_of(
        case, "two_modes", {"drive.voltage": [0.4, 0.6, 0.7], "sweep.frequency": [14.5, 15.3]},
        quantities=("maximum",), direction="apart", frequency=None, settle=0, hold=1, output="contact", strobes=0,
        starts=starts,
    )  # fmt: skip
    whole, last = evaluate_block(Block(grid, 0, 3)), evaluate_block(Block(grid, 2, 3))
    np.testing.assert_array_equal(whole["maximum"][2:], last["maximum"])
    assert len(np.unique(whole["maximum"])) > 9
    assert whole["maximum"].shape == (3, 1, 2, 3)


def test_a_block_is_plain_data_that_gives_the_same_bits_after_a_journey_and_in_any_number_of_threads() -> None:
    grid = grid_of(
        rig(), "two_modes", {"drive.voltage": [0.4, 0.6, 0.7], "sweep.frequency": FREQUENCIES},
        quantities=("amplitude", "strobes"), direction="both", frequency=None, settle=40, hold=8, output=None,
        strobes=4, starts=None,
    )  # fmt: skip
    block = Block(grid, 1, 3)
    sent = pickle.loads(pickle.dumps(block))
    assert sent == block
    here, there = evaluate_block(block, threads=1), evaluate_block(sent, threads=2)
    assert here["strobes"].shape == (2, 2, 7, 4)
    for name in here:
        np.testing.assert_array_equal(here[name], there[name])


@pytest.mark.parametrize(
    ("axes", "more", "said"),
    [
        ({"beam.densty": [1.0]}, {"frequency": 15.0}, "beam.densty: unknown key; did you mean 'density'?"),
        ({"stop.restitution": [0.5, 1.5]}, {"frequency": 15.0}, "1.5 is outside \\[0, 1\\]"),
        ({"stop.gap": [0.0]}, {}, "frequency: missing where sweep.frequency is no axis"),
        ({"sweep.frequency": [15.0]}, {"frequency": 15.0}, "is an axis already"),
        ({"mass.mass": [0.1, 0.2]}, {"frequency": 15.0}, "mass.mass: changes the modes"),
        ({"start.velocity": [0.1, 0.2]}, {"frequency": 15.0}, 'direction = "apart"'),
        ({"stop.gap": []}, {"frequency": 15.0}, "has no value"),
        ({"stop.gap": [0.0]}, {"frequency": 15.0, "strobes": 60}, "60 values need as many periods held: hold is 50"),
    ],
)
def test_what_makes_no_grid_is_refused_with_its_cure(axes: Any, more: Any, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        vibeam.evaluate(rig(), "two_modes", axes, **more)


def test_all_values_that_the_case_may_not_have_are_reported_at_once() -> None:
    with pytest.raises(vibeam.CaseError) as error:
        vibeam.evaluate(rig(), "sdof", {"stop.restitution": [-1.0, 2.0], "sweep.frequncy": [1.0]})
    assert len(error.value.faults) == 3


@pytest.mark.parametrize("changes", [{"stop.wear": 1e-9}, {"fidelity.sdof.solver": "orbit"}])
def test_what_a_grid_cannot_take_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="a map cannot take"):
        vibeam.evaluate(vibeam.load(RIG, set=SI | changes), "sdof", {"sweep.frequency": [15.0]})


def test_an_unknown_fidelity_or_quantity_names_the_known_ones() -> None:
    with pytest.raises(KeyError, match="two_modes"):
        vibeam.evaluate(rig(), "beem", {"sweep.frequency": [15.0]})
    with pytest.raises(KeyError, match="impact_velocity"):
        vibeam.evaluate(rig(), "beam", {"sweep.frequency": [15.0]}, quantities=("speed",))
