"""Orbits near those of another model: against the quadratic of ``orbits``, and flights."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from vibeam.flight.solver import FlightSolver
from vibeam.periodic.bifurcation_functions import motions
from vibeam.periodic.motions import OrbitKind, predicted
from vibeam.periodic.nearby_orbits import nearby_orbits
from vibeam.periodic.orbit_search import orbits
from vibeam.periodic.trains import Trains
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.rows import TimeDerivative

THREE = ImpactSystem.from_modes(
    [1.0, 5.3, 13.0], 0.02, [1.0, 1.5 / 5.3, -1.1 / 13], [1.0, 1 / 5.3, 1 / 13], gap=0.1, restitution=0.7,
    outputs={"sensor": [0.8, 0.3, 0.2]},
)  # fmt: skip


def cut(full: ImpactSystem, n: int) -> ImpactSystem:
    """Its first n modes."""
    rows = {name: getattr(full, name)[:n] for name in ("omega", "zeta", "contact", "load", "static")}
    return replace(full, outputs={"sensor": full.outputs["sensor"][:n]}, **rows)


def closed(system: ImpactSystem, omega: np.ndarray[Any, Any], amplitude: float, branch: int) -> Trains:
    base = np.full(len(omega), amplitude)
    roots = motions(system, 1, omega, base, np.full(len(omega), system.gap)).roots
    return Trains(roots.phase[:, branch, None], roots.impulse[:, branch, None], omega, base, 1)


def test_the_corrected_orbit_is_the_other_models_own() -> None:
    """Against the quadratic of ``orbits``, which knows nothing of the first model."""
    omega = np.array([1.4, 1.8, 2.2])
    near = nearby_orbits(THREE, closed(cut(THREE, 1), omega, 0.2, 0))
    own = [orbits(THREE, Drive(each, 0.2))[0] for each in omega]
    assert near.found.all()
    assert near.trains.phases[:, 0] == pytest.approx([each.phase for each in own], rel=1e-12)
    assert near.trains.impulses[:, 0] == pytest.approx([each.impulse for each in own], rel=1e-12)
    assert np.all(near.first > 1e-3)


def test_extremes_are_those_of_the_flight_and_the_bound_holds_for_damping_of_every_kind() -> None:
    for zeta, unsure in (([0.02, 0.02, 0.02], 1e-5), ([0.3, 0.9, 3.0], 1e-4), ([0.02, 1.0, 1.00001], 1e-2)):
        full = replace(THREE, zeta=np.array(zeta))
        drive = Drive(1.8, 0.2)
        own = next(each for each in orbits(full, drive) if each.admissible)
        train = Trains(*(np.array([[each]]) for each in (own.phase, own.impulse)), np.array([1.8]), np.array([0.2]), 1)
        there, watched = predicted(full, train, "sensor"), own.watched("sensor")
        bounds = {"maximum": there.uncertainty, "minimum": there.uncertainty, "reach": there.reach_uncertainty}
        for name, bound in bounds.items():
            assert abs(getattr(there, name)[0] - getattr(watched, name)[0]) <= bound[0] + 1e-9
        assert there.uncertainty[0] < unsure * there.amplitude[0]
        assert there.impact_velocity[0] == pytest.approx(own.velocity, rel=1e-12)


def test_velocities_and_accelerations_are_read_off_too() -> None:
    """Against the flight settled on the same orbit: a velocity jumps at the impact, an acceleration has the base's."""
    row = np.array([0.8, 0.3, 0.2])
    for order, base in ((1, 0.0), (2, 1.0)):
        full = replace(THREE, outputs={}, derivatives={"probe": TimeDerivative(row, order, base)})
        own = next(each for each in orbits(full, Drive(1.8, 0.2)) if each.admissible)
        train = Trains(*(np.array([[each]]) for each in (own.phase, own.impulse)), np.array([1.8]), np.array([0.2]), 1)
        there = predicted(full, train, "probe")
        watched, _ = FlightSolver(full, 1.8).steady([1.8], 0.2, None, 1500, 8, "probe")
        assert watched.impact_velocity[0] == pytest.approx(own.velocity, rel=1e-6)
        assert there.maximum[0] == pytest.approx(watched.maximum[0], rel=1e-4)
        assert there.minimum[0] == pytest.approx(watched.minimum[0], rel=1e-4)


def test_an_orbit_of_another_kind_is_refused() -> None:
    """A second touch and a multiplier beyond the circle, as ``orbits`` proves them."""
    reduced, seen = cut(THREE, 1), set()
    for omega in np.linspace(0.7, 3.2, 101):
        train = closed(reduced, np.array([omega]), 0.2, 0)
        if not train.impulses[0, 0] < 0:
            continue
        there = predicted(THREE, train, "sensor")
        own = orbits(THREE, Drive(omega, 0.2))[:1]
        kind = list(OrbitKind)[there.found[0]]
        if own and kind is not OrbitKind.NO_ORBIT:
            truth = (
                OrbitKind.STRIKES if not own[0].admissible else OrbitKind.ORBIT if own[0].stable else OrbitKind.UNSTABLE
            )
            assert kind is truth, omega
            seen.add(kind)
    assert seen == {OrbitKind.ORBIT, OrbitKind.STRIKES, OrbitKind.UNSTABLE}


def test_the_correction_grows_toward_a_fold_and_is_refused_beyond_it() -> None:
    """The fold is where the discriminant of the quadratic vanishes; the correction goes like one over its root."""
    full = replace(THREE, gap=0.4)
    omega = np.linspace(1.6, 1.8, 2001)
    real = motions(full, 1, omega, np.full(2001, 0.2), np.full(2001, 0.4)).roots.discriminant > 0
    fold = int(np.flatnonzero(~real)[0])
    assert 0 < fold < 2000
    off = replace(full, contact=full.contact * np.array([1.0, 1.0, 0.999]))  # a model beside it
    near = nearby_orbits(full, closed(off, omega[fold - np.array([64, 16, 4])], 0.2, 0))
    assert near.found.all()
    assert near.first[1:] / near.first[:-1] == pytest.approx([2, 2], rel=0.25)
    beyond = nearby_orbits(replace(full, gap=0.41), closed(full, omega[[fold - 2]], 0.2, 0))
    assert not beyond.found.any()
