"""Motions of measured points over the keys: found by flights that settle, then followed, each known by its number."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from vibeam.periodic.shooting import NoOrbit, Reason
from vibeam.studies.fit.flights import FlyingModel, OrbitModel
from vibeam.studies.fit.orbits import FollowedOrbit, Shooting, differentiate
from vibeam.studies.fit.points import Points
from vibeam.studies.fit.surface import Forward
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Array, Index

HALVINGS = 3  # of the way to other keys
ALIKE = 1e-4  # share of the motion's size within which two motions at the same keys are one
NEARBY = 0.1  # distance of keys up to which a known motion is followed there, share of the bounds
SLOWER = 0.9  # of the lowest frequency: models are ready for drives beside the points too
SOON, SHORT, LONG, HOLD = 25, 40, 300, 32  # drive periods settled, and held


class SettledPoint(NamedTuple):
    """Point ``place`` as the model settles on it: entry ``k`` of all that is read off, and the state after it."""

    place: int
    read: FrequencyResponse
    k: int
    state: State


def settled_points(
    points: Points, made: FlyingModel, places: Index, settle: int, hold: int = HOLD
) -> Iterator[SettledPoint]:
    """Motions that a model settles on, swept up and down over the points ``places``."""
    order = places[np.argsort(points.omega[places], kind="stable")]
    for leg in (order, order[::-1]):
        found, states = made.swept(points.omega[leg], None, settle, hold, points.quantity)
        for k, place in enumerate(leg.tolist()):
            yield SettledPoint(place, found, k, states[k])


@dataclass
class Trail:
    """One motion of one measured point over the keys: what was found of it so far. It grows as it is followed."""

    found: list[FollowedOrbit]

    @property
    def shooting(self) -> Shooting:
        """Shooting at the measured point."""
        return self.found[0].shooting

    @property
    def called(self) -> str:
        """The motion in words, as it was found last."""
        return self.found[-1].called

    def nearest(self, x: Array) -> FollowedOrbit:
        """That of the nearest keys; where derivatives are known of one nearby that one, if it is not at ``x``."""
        near = min(reversed(self.found), key=lambda each: float(np.abs(each.x - x).max()))
        if near.by is not None or np.array_equal(near.x, x):
            return near
        known = [each for each in self.found if each.by is not None and float(np.abs(each.x - x).max()) < NEARBY]
        return min(known, key=lambda each: float(np.abs(each.x - x).max()), default=near)

    def at(self, x: Array) -> FollowedOrbit:
        """The motion at shares ``x``; NoOrbit where it is lost."""
        return self._reached(x, HALVINGS)

    def beside(self, x: Array, omega: float) -> FollowedOrbit:
        """The motion at shares ``x`` and a drive at or beside the point's own."""
        found = self.at(x)
        if omega == self.shooting.omega:
            return found
        return replace(self.shooting, omega=omega).orbit(x, found.state, found)

    def _reached(self, x: Array, halvings: int) -> FollowedOrbit:
        near = self.nearest(x)
        if np.array_equal(near.x, x):
            return near
        try:
            differentiate([near])
            self.found.append(self.shooting.further(near, x))
        except ValueError:
            if not halvings:
                raise NoOrbit(Reason.LEFT, "it is lost") from None
            self._reached((near.x + x) / 2, halvings - 1)
            return self._reached(x, halvings - 1)
        return self.found[-1]


class Trails:
    """Motions of measured points that are followed, each with a number, and the models that fly, by fidelity."""

    def __init__(self) -> None:
        self.every: list[Trail] = []
        self.models: dict[str, OrbitModel] = {}

    def apart(self) -> Trails:
        """The same motions, which grow by themselves from now on."""
        made = Trails()
        made.every, made.models = [Trail(list(map(copy, each.found))) for each in self.every], self.models
        return made

    def model(self, forward: Forward, omega: Array) -> OrbitModel:
        """A fidelity's model as it flies at drives ``omega`` (points,) rad/s."""
        name = forward.model.fidelity.name
        if name not in self.models:
            self.models[name] = OrbitModel(forward, SLOWER * float(omega.min()))
        return self.models[name]

    def alike(self, point: int, x: Array, state: Array, period: int, within: float) -> int | None:
        """Number of the motion that is known at a point and shares ``x`` and has that state; None without."""
        for number, trail in enumerate(self.every):
            near = trail.nearest(x) if trail.shooting.point == point else None
            if near is None or near.period != period or not np.array_equal(near.x, x):
                continue
            if near.apart(state) < within:
                return number
        return None

    def number(self, found: FollowedOrbit) -> int:
        """Number of the motion that was found at a point: that of one that is known, or a new one's."""
        number = self.alike(found.shooting.point, found.x, found.state, found.period, ALIKE)
        if number is None:
            self.every.append(Trail([found]))
        return len(self.every) - 1 if number is None else number

    def known(self, point: int, x: Array) -> Iterator[tuple[int, FollowedOrbit]]:
        """Motions of a point that are known nearby and can be followed to shares ``x``, with their numbers."""
        for number, trail in enumerate(self.every):
            if trail.shooting.point == point and float(np.abs(trail.nearest(x).x - x).max()) < NEARBY:
                with suppress(NoOrbit):
                    yield number, trail.at(x)

    def exists(self, number: int, x: Array, unstable: bool) -> bool:
        """Test whether the model has a motion at shares ``x``, with derivatives, stable; ``unstable``: or not."""
        with suppress(NoOrbit):
            found = self.every[number].at(x)
            return (found.stable or unstable) and found.differentiable
        return False

    def values(self, numbers: list[int], x: Array, omega: Array, slopes: bool = True) -> tuple[Array, Array]:
        """Values (m,) of motions at shares ``x`` and drives (m,), derivatives (P, m); as tangents go on where lost.

        Another drive than the point's own is one beside it. Derivatives are 0 without ``slopes``, and where they are
        not known: ``exists`` then says no.
        """
        trails = [self.every[each] for each in numbers]
        nearest = [trail.nearest(x) for trail in trails]
        differentiate([each for each in nearest if not np.array_equal(each.x, x)])
        found: list[FollowedOrbit] = []
        for trail, near, rate in zip(trails, nearest, omega.tolist(), strict=True):
            try:
                found.append(trail.beside(x, rate))
            except NoOrbit:
                found.append(near)
        if slopes:
            differentiate([each for each in found if np.array_equal(each.x, x)])
        by = np.array([np.zeros(len(x)) if each.by is None else np.nan_to_num(each.by) for each in found])
        return np.array([each.value + own @ (x - each.x) for each, own in zip(found, by, strict=True)]), by.T

    def branch(self, numbers: set[int], reference: str, kind: str, x: Array, frequency: Array) -> tuple[Array, Array]:
        """Value (points,) of a kind of motion at other frequencies, Hz, and derivatives (P, points); NaN without.

        Each is followed from its nearest neighbour that is known, the measured points of that kind first.
        """
        known: list[FollowedOrbit] = []
        for trail in (self.every[each] for each in sorted(numbers)):
            if trail.called == kind and trail.shooting.points.reference == reference:
                with suppress(NoOrbit):
                    known.append(trail.at(x))
        value, by = np.full(len(frequency), np.nan), np.zeros((len(x), len(frequency)))
        omega, own = 2 * np.pi * frequency, dict[int, FollowedOrbit]()
        first = [min((abs(rate - each.shooting.omega) for each in known), default=0.0) for rate in omega]
        for k in np.argsort(first, kind="stable").tolist() if known else []:
            near = min(known, key=lambda each: abs(each.shooting.omega - omega[k]))
            with suppress(NoOrbit):
                found = replace(near.shooting, omega=float(omega[k])).orbit(x, near.state, near)
                if found.called == kind:
                    known.append(found)
                    own[k] = found
        differentiate(list(own.values()))
        for k, found in own.items():
            value[k], by[:, k] = found.value, found.by
        return value, by

    def soon(self, points: Points, forward: Forward, x: Array, settle: int = SOON) -> Array:
        """Values (2, points) soon after a start upward and downward at shares ``x``."""
        found, model = np.full((2, len(points)), np.nan), self.model(forward, points.omega)
        for each in settled_points(points, model.at(x), np.arange(len(points)), settle, 1):
            leg = int(np.isfinite(found[0, each.place]))
            found[leg, each.place] = getattr(each.read, points.quantity)[each.k]
        return found
