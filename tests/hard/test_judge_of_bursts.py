"""What the judge of random bursts lets pass and what it finds: the impacts of a falling ball, and those misreported."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import agreement
import numpy as np
import pytest
from agreement import BAR, SAFE, Tally, burst, follow, true_motion
from motions import state
from random_systems import Case
from sensitivity import Knot, blur

import vibeam

RESTITUTION, PULL = 0.9, 32.0

Impacts = tuple[np.ndarray, np.ndarray]


def ball(speed: float) -> Case:
    """A ball that left the stop at ``speed`` 2⁻³⁰ of v/a ago: flights of 2v/a, 2Rv/a, ..., impacts at v, Rv, ..."""
    system = vibeam.ImpactSystem.from_modes([0.0], [0.0], [1.0], [1.0], gap=0.0, restitution=RESTITUTION, static=[PULL])
    since = 2.0**-30 * speed / PULL
    start = state([-speed * since + PULL * since**2 / 2], [-speed + PULL * since])
    return Case(system, vibeam.Drive(1.0, 0.0), start)


def misreported(
    monkeypatch: pytest.MonkeyPatch, case: Case, change: Callable[[np.ndarray, np.ndarray], Impacts]
) -> Tally:
    """The first burst judged of a solver whose impacts are ``change``d."""
    true = vibeam.simulate

    class Misreported:
        def __init__(self, path: vibeam.Trajectory) -> None:
            self.path = path
            self.impact_times, self.impact_velocities = change(path.impact_times, path.impact_velocities)

        def __getattr__(self, name: str) -> Any:
            return getattr(self.path, name)

    monkeypatch.setattr(agreement.vibeam, "simulate", lambda *given, **more: Misreported(true(*given, **more)))
    return burst(case, 0.0, 8)[0]


def test_every_impact_of_a_long_accumulation_is_judged() -> None:
    """Bursts that end within it: the truth goes to its limit beyond the burst's end, but passes over no impact."""
    readout = follow(ball(1.0), 400)
    assert not readout.faults
    assert readout.impacts > 200  # 0.9²⁰⁰ = 7e-10: flights of 4e-11 s
    assert readout.worst_blur < 1


both_sizes = pytest.mark.parametrize("speed", [1.0, 1e-12], ids=["flights of 60 ms", "flights of 6e-14 s"])


@both_sizes
@pytest.mark.parametrize("share", [1e-5, 0.5])
def test_an_invented_impact_is_found(monkeypatch: pytest.MonkeyPatch, speed: float, share: float) -> None:
    when = 2.5 * speed / PULL  # within the second flight

    def add(times: np.ndarray, speeds: np.ndarray) -> Impacts:
        k = int(np.searchsorted(times, when))
        return np.insert(times, k, when), np.insert(speeds, k, share * speed)

    assert misreported(monkeypatch, ball(speed), add).invented == 1


@both_sizes
def test_an_impact_invented_after_the_last_true_one_is_found(monkeypatch: pytest.MonkeyPatch, speed: float) -> None:
    """A twentieth of a flight after the fifth impact; the burst ends before the sixth."""
    fifth = 2 * speed / PULL * (1 - RESTITUTION**5) / (1 - RESTITUTION)
    when = fifth + 0.05 * RESTITUTION**5 * 2 * speed / PULL

    def add(times: np.ndarray, speeds: np.ndarray) -> Impacts:
        k = int(np.searchsorted(times, when))
        return np.insert(times, k, when), np.insert(speeds, k, 0.5 * speed)

    readout = misreported(monkeypatch, ball(speed), add)
    assert (readout.impacts, readout.invented) == (5, 1)


@both_sizes
def test_a_lost_impact_is_found(monkeypatch: pytest.MonkeyPatch, speed: float) -> None:
    readout = misreported(monkeypatch, ball(speed), lambda times, speeds: (np.delete(times, 2), np.delete(speeds, 2)))
    assert readout.missed == 1


@both_sizes
@pytest.mark.parametrize("bounds", [0.25, -0.25, 2.0, -2.0])
def test_an_impact_moved_beyond_its_bound_is_found(
    monkeypatch: pytest.MonkeyPatch, speed: float, bounds: float
) -> None:
    moved = bounds * bound_of_the_second(ball(speed))

    def move(times: np.ndarray, speeds: np.ndarray) -> Impacts:
        return times + moved * (np.arange(len(times)) == 1), speeds

    readout = misreported(monkeypatch, ball(speed), move)
    assert readout.wrong == len(readout.faults) == (abs(bounds) > 1)


def bound_of_the_second(case: Case) -> float:
    """Error of the second impact's time that the judge allows."""
    motion = true_motion(case, 0.0, 45, 1e-25)
    motion.run(count=2)
    knots = [
        Knot(float(e.time), float(e.speed), np.array(e.displacement, float), np.array(e.velocity, float))
        for e in motion.events
        if e.kind == "impact"
    ]
    spread = blur(*case[:2], 0.0, case.start.displacement, case.start.velocity, knots)
    return float(BAR * knots[1].time + SAFE * spread.time[1])
