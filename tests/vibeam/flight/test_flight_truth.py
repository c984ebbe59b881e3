"""The flight solver against stored arbitrary-precision truth (``tests/independent/make_truth.py`` remakes it)."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam

TRUTH = json.loads((Path(__file__).parents[2] / "independent" / "truth.json").read_text())
NAMES = {kind: [entry["name"] for entry in TRUTH[kind]] for kind in ("systems", "grazing", "chatter")}
TOUCHES = [entry["name"] for entry in TRUTH["grazing"] if entry["kind"] == "touch"]
MISSES = [entry["name"] for entry in TRUTH["grazing"] if entry["kind"] == "miss"]
BAR = 1e-10
EPSILON = np.finfo(float).eps


def entry(kind: str, name: str) -> dict[str, Any]:
    return next(e for e in TRUTH[kind] if e["name"] == name)


def system_of(e: dict[str, Any]) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(
        e["omega"], e["zeta"], e["contact"], e["load"], gap=e["gap"], restitution=e["restitution"], static=e["static"]
    )


def start_of(e: dict[str, Any]) -> vibeam.State:
    return vibeam.State(np.array(e["start"]["displacement"]), np.array(e["start"]["velocity"]))


def drive_of(e: dict[str, Any]) -> vibeam.Drive:
    return vibeam.Drive(e["drive"]["omega"], e["drive"]["amplitude"])


def run(e: dict[str, Any], t_end: float, system: vibeam.ImpactSystem | None = None) -> Any:
    return vibeam.simulate(system or system_of(e), drive_of(e), t_end, start_of(e))


def hits_of(e: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    return np.array(e["times"], dtype=float), np.array(e["velocities"], dtype=float)


# ------------------------------------------------------------------------------------------------ random systems


def assert_the_same_impacts(path: Any, e: dict[str, Any]) -> None:
    times, speeds = hits_of(e)
    assert len(path.impact_times) == len(times)
    bar = BAR * max(1.0, e["amplification"] / 100)
    np.testing.assert_allclose(path.impact_times, times, rtol=bar)
    np.testing.assert_allclose(path.impact_velocities, speeds, rtol=bar, atol=bar * speeds.max())


def fifty(e: dict[str, Any], system: vibeam.ImpactSystem | None = None) -> Any:
    return run(e, float(e["times"][-1]) * (1 + 1e-9), system)


@pytest.mark.parametrize("name", NAMES["systems"])
def test_fifty_impacts_of_random_systems(name: str) -> None:
    e = entry("systems", name)
    path = fifty(e)
    assert_the_same_impacts(path, e)
    assert path.ended is vibeam.Ended.COMPLETE
    assert path.stats["impacts"] == len(e["times"])


@pytest.mark.parametrize("name", NAMES["systems"])
def test_the_comparison_sees_a_millionth_of_the_restitution(name: str) -> None:
    e = entry("systems", name)
    with pytest.raises(AssertionError):
        assert_the_same_impacts(fifty(e, replace(system_of(e), restitution=e["restitution"] * (1 - 1e-6))), e)


def test_the_comparison_sees_a_millionth_of_the_gap_and_of_a_frequency() -> None:
    e = entry("systems", NAMES["systems"][0])
    system = system_of(e)
    for wrong in (replace(system, gap=system.gap * (1 + 1e-6)), replace(system, omega=system.omega * (1 + 1e-6))):
        with pytest.raises(AssertionError):
            assert_the_same_impacts(fifty(e, wrong), e)


# ------------------------------------------------------------------------------------------------ grazing


def round_off(e: dict[str, Any]) -> float:
    """Relative error of a grazing velocity that round-off of the velocities it is the sum of allows."""
    return 32 * EPSILON / e["speed_over_scale"]


def assert_it_touches(path: Any, e: dict[str, Any]) -> None:
    times, speeds = hits_of(e)
    allowed = round_off(e)
    assert len(path.impact_times) >= len(times)
    ahead = float(e["crest_time"]) - times[0]  # from the impact to the crest that is cut off
    assert abs(path.impact_times[0] - times[0]) <= allowed * ahead + BAR * times[0]
    assert abs(path.impact_velocities[0] / speeds[0] - 1) <= allowed + BAR
    bar = BAR + 100 * allowed * e["speed_over_scale"]
    np.testing.assert_allclose(path.impact_times[1 : len(times)], times[1:], rtol=bar)
    np.testing.assert_allclose(path.impact_velocities[1 : len(times)], speeds[1:], rtol=bar)


@pytest.mark.parametrize("name", TOUCHES)
def test_a_touch_is_there(name: str) -> None:
    e = entry("grazing", name)
    assert round_off(e) < 1
    assert_it_touches(run(e, e["t_end"]), e)


@pytest.mark.parametrize("name", MISSES)
def test_a_miss_is_not_there(name: str) -> None:
    e = entry("grazing", name)
    path = run(e, e["t_end"])
    times, speeds = hits_of(e)
    assert path.impact_times[0] > float(e["crest_time"]) * (1 + 1e-3)
    np.testing.assert_allclose(path.impact_times[: len(times)], times, rtol=BAR)
    np.testing.assert_allclose(path.impact_velocities[: len(times)], speeds, rtol=BAR)


@pytest.mark.parametrize("name", TOUCHES)
def test_a_miss_would_be_told_from_a_touch(name: str) -> None:
    touch, miss = entry("grazing", name), entry("grazing", name.replace("touch", "miss"))
    with pytest.raises(AssertionError):
        assert_it_touches(run(miss, miss["t_end"]), touch)


# ------------------------------------------------------------------------------------------------ chatter


def chatter(e: dict[str, Any], system: vibeam.ImpactSystem | None = None) -> Any:
    return run(e, float(e["next_time"]) * (1 + 1e-6), system)


def assert_the_same_chatter(path: Any, e: dict[str, Any]) -> None:
    times, speeds = hits_of(e)
    listed = int(np.sum(path.impact_times <= float(e["rest_time"])))
    assert len(path.chatters) == len(path.rests) == 1
    assert 5 <= listed <= len(times)
    np.testing.assert_allclose(path.impact_times[:listed], times[:listed], rtol=BAR)
    np.testing.assert_allclose(path.impact_velocities[:listed], speeds[:listed], rtol=BAR, atol=1e-14 * speeds.max())
    assert path.chatters[0, 0] == pytest.approx(float(e["rest_time"]), rel=BAR)
    np.testing.assert_allclose(path.rests[0], [float(e["rest_time"]), float(e["release_time"])], rtol=BAR)
    assert len(path.impact_times) == listed + 1
    assert path.impact_times[-1] == pytest.approx(float(e["next_time"]), rel=BAR)
    assert path.impact_velocities[-1] == pytest.approx(float(e["next_velocity"]), rel=BAR)


@pytest.mark.parametrize("name", NAMES["chatter"])
def test_chatter_rest_release_and_the_next_impact(name: str) -> None:
    e = entry("chatter", name)
    assert_the_same_chatter(chatter(e), e)


@pytest.mark.parametrize("name", NAMES["chatter"])
def test_the_impacts_left_out_are_the_feeble_end_of_the_series(name: str) -> None:
    """What is completed by its limit is over within 1e-5 of the accumulation's own time."""
    e = entry("chatter", name)
    path = chatter(e)
    before = path.impact_times[path.impact_times <= float(e["rest_time"])]
    assert float(e["rest_time"]) - before[-1] < 1e-5 * float(e["rest_time"])


@pytest.mark.parametrize("name", NAMES["chatter"])
def test_the_reported_remainder_bounds_the_error_and_is_small(name: str) -> None:
    e = entry("chatter", name)
    over, remainder = chatter(e).chatters[0]
    assert abs(over - float(e["rest_time"])) <= remainder + 1e-13
    assert 0 < remainder < 1e-9


@pytest.mark.parametrize("name", NAMES["chatter"])
def test_the_state_where_the_rest_begins(name: str) -> None:
    e = entry("chatter", name)
    found = chatter(e).modes_at(float(e["rest_time"]) * (1 + 1e-14))
    expected = np.array([e["rest_displacement"], e["rest_velocity"]], dtype=float)
    np.testing.assert_allclose(found, expected, rtol=BAR, atol=BAR * np.abs(expected).max())


def test_the_comparison_of_chatter_sees_a_millionth_of_the_restitution() -> None:
    e = entry("chatter", "3 modes, R 0.6")
    with pytest.raises(AssertionError):
        assert_the_same_chatter(chatter(e, replace(system_of(e), restitution=0.6 + 1e-6)), e)
