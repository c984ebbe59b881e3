"""Direct integration and Moreau–Jean stepping under a record: closed forms, flight under the same sine, rests."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import vibeam
from vibeam import Record, TimeDerivative
from vibeam.solvers import SOLVERS, solver

FINE: dict[str, dict[str, Any]] = {
    "direct": {"method": "DOP853", "rtol": 1e-11, "atol": 1e-15},
    "moreau": {"steps": 40_000},
}
CLOSE = {"direct": 1e-9, "moreau": 3e-4}  # shares of what is compared: tolerance of a step, length of a step
READ = {"direct": 1e-7, "moreau": 1e-2}  # the same between samples, by cubics; of a pulse of 76 steps
OMEGA, B = 95.0, 1e-4


def one_mode(**more: Any) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(60.0, 0.0, 1.0, 1.0, **({"gap": 1e-3, "restitution": 0.7} | more))


def two_modes(gap: float = 2e-4) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes([60.0, 330.0], 0.02, [2.0, 0.8], [0.5, 0.2], gap=gap, restitution=0.7)


def moved(name: str, system: vibeam.ImpactSystem, record: Record, t_end: float, **options: Any) -> Any:
    return solver(name, system, 60.0, **(FINE[name] | options)).record_motion(record, None, 0.0, t_end)


@pytest.mark.parametrize("name", FINE)
def test_the_first_impact_under_a_half_sine_is_the_closed_one(name: str) -> None:
    peak, duration = 30.0, 0.02
    p = np.pi / duration
    x = lambda t: peak / (60.0**2 - p**2) * (np.sin(p * t) - p / 60 * np.sin(60 * t))  # noqa: E731
    at = brentq(lambda t: x(t) - 1e-3, 1e-3, duration)
    speed = peak * p / (60.0**2 - p**2) * (np.cos(p * at) - np.cos(60 * at))
    path = moved(name, one_mode(), Record.half_sine(-peak, duration), 0.1)
    assert path.impact_times[0] == pytest.approx(at, rel=CLOSE[name])
    assert path.impact_velocities[0] == pytest.approx(speed, rel=CLOSE[name])


@pytest.mark.parametrize("name", FINE)
def test_the_first_impact_under_a_saw_tooth_is_the_closed_one(name: str) -> None:
    slope = 20.0 / 0.02
    at = brentq(lambda t: slope / 60**2 * (t - np.sin(60 * t) / 60) - 1e-3, 1e-3, 0.03)
    path = moved(name, one_mode(), Record.saw_tooth(20.0, 0.03 * 20 / 30, quantity="force"), 0.1)
    assert path.impact_times[0] == pytest.approx(at, rel=CLOSE[name])


@pytest.mark.parametrize(("name", "within"), [("direct", 1e-7), ("moreau", 1e-2)])
def test_a_sine_as_a_record_is_the_drive(name: str, within: float) -> None:
    """Nine impacts on: errors grow from impact to impact, the same in both."""
    exact = vibeam.simulate(two_modes(), vibeam.Drive(OMEGA, B), t_end=1.0)
    path = moved(name, two_modes(), Record.sine(-(OMEGA**2) * B, OMEGA / (2 * np.pi), 1.0), 1.0)
    assert path.ended is vibeam.Ended.COMPLETE
    assert len(exact.impact_times) > 9
    assert path.impact_times[:9] == pytest.approx(exact.impact_times[:9], rel=within)
    assert path.impact_velocities[:9] == pytest.approx(exact.impact_velocities[:9], rel=10 * within)


@pytest.mark.parametrize(("interpolation", "order"), [("linear", 2.0), ("cubic", 4.0)])
def test_a_sampled_sine_converges_at_the_order_of_its_interpolation(interpolation: str, order: float) -> None:
    free = two_modes(gap=1.0)
    exact = vibeam.simulate(free, vibeam.Drive(OMEGA, B), t_end=0.5)
    t = np.linspace(0.1, 0.5, 50)
    off = []
    for samples in (400, 800):
        values = -(OMEGA**2) * B * np.sin(OMEGA * np.arange(samples // 2 + 1) / samples)
        record = Record.sampled(values, rate=samples, interpolation=interpolation)
        off.append(np.abs(moved("direct", free, record, 0.5).at(t) - exact.at(t)).max())
    assert np.log2(off[0] / off[1]) == pytest.approx(order, abs=0.25)


@pytest.mark.parametrize("name", FINE)
def test_a_contact_rests_until_the_force_is_gone(name: str) -> None:
    force, gap, until = 10.0, 1e-3, 0.3
    at = np.arccos(1 - gap * 60**2 / force) / 60
    acceleration = {"acc": TimeDerivative([1.0], order=2)}
    system = one_mode(restitution=0.0, gap=gap, derivatives=acceleration)
    path = moved(name, system, Record.step(force, until, quantity="force"), 0.4)
    assert path.rests[:1] == pytest.approx(np.array([[at, until]]), rel=CLOSE[name])
    assert path.impact_velocities[0] == pytest.approx(force / 60 * np.sin(60 * at), rel=CLOSE[name])
    assert path.at(0.2, "acc") == 0.0
    assert path.at([0.01, 0.35], "acc") == pytest.approx(
        [force * np.cos(0.6), -(60**2) * gap * np.cos(60 * 0.05)], rel=READ[name]
    )


@pytest.mark.parametrize("name", FINE)
def test_a_short_pulse_between_long_quiet_times_is_not_passed_over(name: str) -> None:
    """A pulse of 0.2 ms a second after the start, where steps are an eighth of the slowest period."""
    peak, duration = 5e4, 2e-4
    record = Record.step(0.0, 1.0).then(Record.trapezoid(-peak, duration, rise=0.0))
    path = moved(name, one_mode(gap=1.0), record, 1.2)
    t = np.linspace(1.05, 1.2, 9)
    middle = 1.0 + duration / 2
    free = peak * 2 * np.sin(60 * duration / 2) / 60**2 * np.sin(60 * (t - middle))
    assert path.at(t) == pytest.approx(free, abs=READ[name] * np.abs(free).max())


def test_solvers_of_one_frequency_say_so_in_one_sentence() -> None:
    assert {name for name, declared in SOLVERS.items() if declared.records} == {"flight", "direct", "moreau"}
    for name in ("zhuravlev", "ivanov"):
        with pytest.raises(ValueError, match="cannot move under a record: flight, direct and moreau can"):
            solver(name, one_mode(), 60.0).record_motion(Record.half_sine(1.0, 0.1), None, 0.0, 1.0)
