"""Branches that doublings begin: the doubling by tangent maps of flights, their motions by flights."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from vibeam.flight.trajectory import simulate
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import boundaries
from vibeam.periodic.doubled_branches import DoubledBranch, doubled_branches
from vibeam.periodic.orbit_search import orbits
from vibeam.periodic.shooting import cycle
from vibeam.periodic.stroboscopic import StroboscopicMap
from vibeam.periodic.train_branch import TrainBranch
from vibeam.periodic.train_orbits import train_orbit
from vibeam.periodic.trains import states_before
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State

NOMINAL = ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, gap=0.1, restitution=0.8)

AMPLITUDE, LOW, HIGH = 0.2, 2.4, 2.6


def setting(value: float) -> tuple[ImpactSystem, Drive]:
    return NOMINAL, Drive(value, AMPLITUDE)


@cache
def branches() -> list[DoubledBranch]:
    harder = [(value, orbits(*setting(value))[0]) for value in np.linspace(LOW, HIGH, 9)]
    points = [np.array([orbit.phase, orbit.impulse, value / (HIGH - LOW)]) for value, orbit in harder]
    return doubled_branches(TrainBranch(1, 1, setting, 1.0, HIGH - LOW), points, LOW, HIGH)


def test_a_doubling_begins_each() -> None:
    """A multiplier of the shorter motion, by the tangent maps of its flights, is −1 there."""
    assert [(each.impacts, each.periods) for each in branches()] == [(2, 2), (4, 4)]
    exact = boundaries(NOMINAL, AMPLITUDE, (LOW, HIGH), points=51, kinds=(Kind.DOUBLING,))
    assert branches()[0].values[0] == pytest.approx(exact[0].omega, rel=1e-12)
    for each in branches():
        system, drive = setting(float(each.values[0]))
        train = each.trains[0]
        half, span = each.impacts // 2, 2 * np.pi * each.periods / drive.omega
        np.testing.assert_allclose(train.times[half:] - train.times[:half], span / 2, rtol=1e-12)
        displacement, before = (each[0] for each in states_before(system, train.under(drive, span)))
        after = State(displacement[0], before[0] + train.impulses[0] * system.contact)
        beside, start = StroboscopicMap(system, drive, float(train.times[0])).in_flight(after)
        found = cycle(beside, start)
        assert found is not None
        assert found.periods == each.periods // 2
        assert found.multipliers[0] == pytest.approx(-1, abs=1e-7)


@pytest.mark.parametrize("number", [0, 1])
def test_flights_from_stable_and_unstable_points_come_back(number: int) -> None:
    each = branches()[number]
    stable = each.stable
    assert stable[1]
    assert not stable[-2]
    for at in (3, len(stable) // 3, len(stable) - 3):
        system, drive = setting(float(each.values[at]))
        train, span = each.trains[at], 2 * np.pi * each.periods / drive.omega
        displacement, before = (each[0] for each in states_before(system, train.under(drive, span)))
        state = State(displacement[0], before[0] + train.impulses[0] * system.contact)
        first = float(train.times[0])
        flown = simulate(system, drive, first + 0.999 * span, state, t_start=first)
        assert len(flown.impact_times) == each.impacts - 1
        order = np.argsort(train.times)
        np.testing.assert_allclose(
            np.sort(np.mod(flown.impact_times, span)), np.delete(np.mod(train.times[order], span), 0), atol=1e-9
        )
        velocities = -train.impulses * float(system.contact @ system.contact) / (1 + system.restitution)
        refined = train_orbit(system, drive, each.periods, train.times, velocities)
        assert refined is not None
        assert refined.admissible
        assert refined.stable == stable[at]
        np.testing.assert_allclose(refined.multipliers[0], each.multipliers[at, 0], rtol=1e-6)


def test_a_branch_ends_where_an_impact_grazes_or_the_range_does() -> None:
    for each in branches():
        last = each.trains[-1].impulses
        at_end = min(abs(each.values[-1] - LOW), abs(each.values[-1] - HIGH)) < 1e-9
        assert at_end or last.max() > -1e-6 * np.abs(last).max()


def test_longer_motions_than_asked_for_are_left_out() -> None:
    value = LOW
    orbit = orbits(*setting(value))[0]
    point = np.array([orbit.phase, orbit.impulse, value / (HIGH - LOW)])
    assert doubled_branches(TrainBranch(1, 4, setting, 1.0, HIGH - LOW), [point], LOW, HIGH) == []
