"""Coexisting motions, told apart and named; motions in closed form beside flown ones; exponents."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from stand_in import SI

import vibeam
from vibeam.maps.closed_form import ClosedForm, closed_form_strobes
from vibeam.maps.evaluate import GridResponse
from vibeam.maps.motions import READ, counted, label
from vibeam.system.quantities import Ended


def response(axes: dict[str, Any], **values: Any) -> GridResponse:
    shape = np.shape(values["period"])
    usual = {
        "impacts_per_period": np.ones(shape), "maximum": np.zeros(shape), "minimum": np.full(shape, -1.0),
        "impact_velocity": np.ones(shape), "ended": np.full(shape, Ended.COMPLETE.code),
    } | values  # fmt: skip
    return GridResponse("m", axes, ("apart",), {name: np.asarray(each)[None] for name, each in usual.items()})


def test_motions_of_a_plane_of_starts_are_told_apart_by_what_was_read_of_them() -> None:
    period = np.array([[1, 1, 2], [1, 0, -1]])
    minimum = np.array([[-1.0, -1.0 - 1e-6, -1.0], [-2.0, -1.3, -1.0]])
    ended = np.full((2, 3), Ended.COMPLETE.code)
    found = label(
        response({"start.velocity": np.arange(2.0), "start.displacement": np.arange(3.0)}, period=period,
                 minimum=minimum, impacts_per_period=np.array([[1, 1, 0.5], [1, 1.3, 0]]), ended=ended), 0
    )  # fmt: skip
    names = np.array([*(motion.name for motion in found.motions), "failed"])[found.which]
    assert names.tolist() == [
        ["1 impact in 1 period, b", "1 impact in 1 period, b", "1 impact in 2 periods"],
        ["1 impact in 1 period, a", "not periodic", "no contact"],
    ]
    assert [motion.starts for motion in found.motions] == [2, 1, 1, 1, 1]
    assert sum(motion.share for motion in found.motions) == pytest.approx(1.0)


def test_round_off_of_an_extreme_that_is_zero_tells_nothing_apart() -> None:
    found = label(
        response({"start.velocity": np.arange(3.0)}, period=np.ones(3, int), maximum=np.array([1e-18, -3e-19, 0.0])), 0
    )
    assert [motion.starts for motion in found.motions] == [3]


def test_a_failed_start_leads_to_no_motion() -> None:
    ended = np.array([Ended.COMPLETE.code, Ended.PENETRATED.code])
    found = label(response({"start.velocity": np.arange(2.0)}, period=np.array([1, 0]), ended=ended), 0)
    assert found.which.tolist() == [0, -1]
    assert found.motions[0].share == 1.0


def test_motions_at_different_places_are_known_by_their_names() -> None:
    """One motion whose amplitude changes along an axis is one; two at a place are two."""
    minimum = np.array([[-1.0, -1.0], [-1.5, -1.5], [-2.0, -3.0]])
    found = label(response({"sweep.frequency": np.arange(3.0)}, period=np.ones((3, 2), int), minimum=minimum), 0)
    assert counted(found).tolist() == [1, 1, 2]
    assert {motion.name for motion in found.motions} == {
        "1 impact in 1 period", "1 impact in 1 period, a", "1 impact in 1 period, b",
    }  # fmt: skip


def test_a_shift_of_the_drive_by_a_period_makes_no_other_motion() -> None:
    """The loose rig after its doubling: two impacts in two periods, whichever comes first."""
    case = vibeam.load("cases/dtu_loose.toml")
    found = vibeam.evaluate(
        case, "sdof", {"start.velocity": np.linspace(-0.05, 0.05, 6)}, direction="apart", frequency=16.2, settle=600,
        hold=16, strobes=2, quantities=(*READ, "period", "impacts_per_period", "strobes"),
    )  # fmt: skip
    assert set(found["period"]) == {2}
    assert len({round(float(value), 7) for value in found["strobes"][:, -1]}) <= 2
    assert [motion.name for motion in label(found, 0).motions] == ["2 impacts in 2 periods"]


def test_motions_in_closed_form_are_those_that_are_flown() -> None:
    """Along the gap and the frequency; and where the flight leaves it for a doubled one, it is unstable."""
    text: dict[str, Any] = {"picture": "bifurcation", "fidelities": ["two_modes"], "settle": 600, "hold": 16}
    axis = {"key": "sweep.frequency", "from": 15.6, "to": 16.2, "points": 4}
    case = vibeam.load("cases/dtu_loose.toml", set=SI | {"map": {"m": text | {"axes": [axis], "direction": "up"}}})
    known, why = closed_form_strobes(case, case.maps["m"], "two_modes", points=5)
    assert why == ""
    single = [each for each in known if each.periods == 1]
    assert single
    for frequency in (15.6, 15.75):
        flown = vibeam.evaluate(
            case, "two_modes", {"sweep.frequency": [frequency]}, settle=600, hold=8, strobes=1, quantities=("strobes",)
        )
        distance = [
            np.abs(np.interp(frequency, each.values, each.strobes[:, 0]) - flown["strobes"][0, 0])
            for each in single if each.stable[np.argmin(np.abs(each.values - frequency))]
        ]  # fmt: skip
        assert min(distance) < 1e-9
    assert not any(each.stable[-1] for each in single)


def known_of(name: str, points: int, **more: Any) -> tuple[vibeam.Case, list[ClosedForm]]:
    case = vibeam.load("cases/maps/doubling.toml", set=SI | {f"map.{name}.{key}": value for key, value in more.items()})
    found, why = closed_form_strobes(case, case.maps[name], "sdof", points=points)
    assert why == ""
    return case, found


def test_the_diagram_of_the_doubling_has_stable_and_unstable_branches_of_doubled_motions() -> None:
    """Where they are stable, the sweep finds them."""
    axis = {"key": "sweep.frequency", "from": 16.15, "to": 16.27, "points": 5}
    case, found = known_of("bifurcation", 13, axes=[axis])
    assert [(each.impacts, each.periods) for each in found] == [(1, 1), (2, 2), (4, 4)]
    for each in found[1:]:
        assert 0 < each.stable.sum() < len(each.stable)
        assert each.strobes.shape == (len(each.values), each.periods)
        stable = np.flatnonzero(each.stable)
        for at in (stable[len(stable) // 2], stable[3 * len(stable) // 4]):
            flown = vibeam.evaluate(
                case, "sdof", {"sweep.frequency": [each.values[at]]}, settle=4000, hold=16, strobes=each.periods,
                quantities=("strobes", "period"),
            )  # fmt: skip
            assert flown["period"][0] == each.periods
            size = np.abs(each.strobes[at]).max()
            np.testing.assert_allclose(np.sort(flown["strobes"][0]), each.strobes[at], rtol=0, atol=1e-9 * size)


@pytest.mark.parametrize(
    ("key", "ends", "frequency"),
    [
        ("drive.voltage", ("0.5985 V", "0.604 V"), 16.2),
        ("stop.gap", ("0.0995 mm", "0.1002 mm"), 16.2),
        ("stop.restitution", (0.5, 0.7), 16.182),
    ],
)
def test_doubled_motions_are_followed_over_other_keys_too(key: str, ends: tuple[Any, Any], frequency: float) -> None:
    axis = {"key": key, "from": ends[0], "to": ends[1], "points": 11}
    case, found = known_of("bifurcation", 11, axes=[axis], frequency=frequency)
    doubled = next(each for each in found if each.impacts == 2)
    at = int(np.flatnonzero(doubled.stable)[len(np.flatnonzero(doubled.stable)) // 2])
    flown = vibeam.evaluate(
        case, "sdof", {key: [doubled.values[at]]}, frequency=frequency, settle=4000, hold=16, strobes=2,
        quantities=("strobes", "period"), direction="apart",
    )  # fmt: skip
    assert flown["period"][0] == 2
    size = np.abs(doubled.strobes[at]).max()
    np.testing.assert_allclose(np.sort(flown["strobes"][0]), doubled.strobes[at], rtol=0, atol=1e-9 * size)


def test_a_key_that_changes_the_modes_has_motions_with_one_impact_alone() -> None:
    axis = {"key": "mass.mass", "from": "0.2 kg", "to": "0.202 kg", "points": 5}
    _, found = known_of("bifurcation", 5, axes=[axis], frequency=16.2, direction="apart")
    assert {each.impacts for each in found} == {1}


def test_a_system_without_closed_form_says_so() -> None:
    axis = {"key": "sweep.frequency", "from": 15.6, "to": 16.2, "points": 4}
    case = vibeam.load(
        "cases/dtu_loose.toml",
        set=SI | {"map": {"m": {"picture": "bifurcation", "axes": [axis]}}, "stop.second_gap": "1 mm"},
    )
    assert closed_form_strobes(case, case.maps["m"], "sdof") == (
        [], "no motions in closed form for sdof: there are none with a second stop",
    )  # fmt: skip


def test_the_exponent_of_a_motion_without_impacts_is_that_of_its_damping() -> None:
    case = vibeam.load("cases/dtu_loose.toml", set={"stop.gap": "100 mm"})
    found = vibeam.evaluate(
        case, "sdof", {"drive.voltage": [0.1, 0.2], "sweep.frequency": [14.0, 15.0]}, settle=1000, hold=20,
        quantities=("lyapunov", "state"),
    )  # fmt: skip
    system = case.system("sdof")
    np.testing.assert_allclose(found["lyapunov"], -system.zeta[0] * system.omega[0], rtol=1e-9)
    assert found["state"].shape == (2, 2, 2)
