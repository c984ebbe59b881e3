"""Weighted residuals of measured points on the motions that they lie on, and their exact Jacobian.

A point is compared with one motion of its frequency: one of the two roots of the closed-form orbit, the motion without
contact, or one that is shot and followed (``orbits``). While the keys move the choice is held, so that the misfit has
no jump; between two minimisations it is made anew (``explanation``). Beyond a fold, or where the motion without contact
would strike, there is no such motion: then that of the least drive that has one is taken, and a second residual tells
how much that drive is off, in the point's relative uncertainty. A point that is ``LEFT`` out has no residual.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from hashlib import sha256
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.periodic.output_signals import OutputValue, of_orbits, without_contact
from vibeam.periodic.tangents import ModalData, Tangents
from vibeam.studies.fit.points import Points, points_of
from vibeam.studies.fit.surface import Forward, ModalSurface, surface_of
from vibeam.studies.fit.trails import Trails
from vibeam_models.arrays import Array, Index

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.study_plans import FitKey

Models = Callable[[str], tuple[ModalData, Tangents]]  # of a fidelity, at all of its points
MOTIONS = ("harder impact", "softer impact", "no contact", "left out")
NO_CONTACT, LEFT, FOLLOWED = 2, 3, 4  # numbers of motions; from the last one on those of trails
HARD = 3.0  # weight of a drive that is off by the relative uncertainty of a point
HEAVIEST = 1e4
IMPOSSIBLE = 1e9  # residual of values that make no system
SCALE = 3.0  # residual from which on Cauchy's loss grows slowly
ROUGH = 1e-5  # tolerance of the modal data over all bounds, where starts are looked for
NEAR = 0.01  # half-width of a box about given keys, share of the bounds


@dataclass(frozen=True)
class Problem:
    """Points in groups, forward models by fidelity, estimated keys; parameters are shares x (P,) of their bounds.

    ``surfaces``: modal data of each fidelity with closed forms, at all of its points, over the bounds or a box in them.
    ``trails``: motions that are followed, which grow as they are; those of any other fidelity are such alone. ``key``:
    digest of all that it is made of.
    """

    keys: tuple[FitKey, ...]
    groups: tuple[Points, ...]
    forward: dict[str, Forward]
    surfaces: dict[str, ModalSurface]
    notes: tuple[str, ...] = ()
    trails: Trails = field(default_factory=Trails)
    key: str = ""

    @classmethod
    def of(cls, case: Case) -> Problem:
        """Problem of a case with [fit]; ValueError where it cannot be posed."""
        groups, notes = points_of(case)
        assert case.fit is not None
        names = dict.fromkeys(each.fidelity for each in groups)
        forward = {name: Forward.of(case, name, case.fit.keys) for name in names}
        unused = [
            each.key for k, each in enumerate(case.fit.keys) if not any(made.changed[k] for made in forward.values())
        ]
        if unused:
            raise ValueError(
                f"fit.keys: {unused[0]} is set by every fidelity that is fitted: leave it out of their set"
            )
        for each in groups:
            if each.unstable and not forward[each.fidelity].closed:
                told = f"{each.reference}: unstable motions of fidelity.{each.fidelity} have no closed form"
                notes.append(f"{told}: only those are found that stable ones become as the keys move")
        points = [(each.frequency.tobytes(), each.value.tobytes(), each.uncertainty.tobytes()) for each in groups]
        key = sha256(repr((case.text, points)).encode()).hexdigest()
        made = cls(case.fit.keys, tuple(groups), forward, {}, tuple(dict.fromkeys(notes)), key=key)
        return made.within(np.zeros(len(made.keys)), np.ones(len(made.keys)), ROUGH)

    def within(self, low: Array, high: Array, tolerance: float) -> Problem:
        """The same problem with surfaces over a box of shares."""
        found = {
            name: surface_of(each, self.omega_of(name), low, high, tolerance)
            for name, each in self.forward.items()
            if each.closed
        }
        return replace(self, surfaces=found)

    def about(self, x: Array, half: Array | float = NEAR, tolerance: float = ROUGH) -> Problem:
        """The same problem with surfaces over a box of that half-width about shares x, inside the bounds."""
        middle = np.clip(x, half, 1 - half)
        return self.within(middle - half, middle + half, tolerance)

    def only(self, group: Points, forward: Forward | None = None) -> Problem:
        """The same problem of one group alone, by its fidelity's model or another one."""
        forward = forward or self.forward[group.fidelity]
        return replace(self, groups=(group,), forward={group.fidelity: forward}, trails=Trails())

    def omega_of(self, name: str) -> Array:
        """Drive frequencies of all points of a fidelity, rad/s."""
        return np.concatenate([each.omega for each in self.groups if each.fidelity == name])

    @property
    def low(self) -> Array:
        """Lower bounds (P,), SI."""
        return np.array([each.low for each in self.keys])

    @property
    def width(self) -> Array:
        """Distances of the bounds (P,), SI."""
        return np.array([each.high - each.low for each in self.keys])

    @property
    def start(self) -> Array:
        """The case's own values as shares (P,)."""
        return (np.array([each.start for each in self.keys]) - self.low) / self.width

    @property
    def count(self) -> int:
        """Number of points."""
        return sum(len(each) for each in self.groups)

    def values(self, x: Array) -> Array:
        """Values of the keys, SI."""
        return np.asarray(self.low + x * self.width)

    @property
    def frequency(self) -> Array:
        """Frequencies (points,), Hz."""
        return np.concatenate([each.frequency for each in self.groups])

    @property
    def measured(self) -> Array:
        """Measured values (points,), SI."""
        return np.concatenate([each.value for each in self.groups])

    @property
    def uncertainty(self) -> Array:
        """Standard uncertainties (points,), SI."""
        return np.concatenate([each.uncertainty for each in self.groups])

    @property
    def unstable(self) -> NDArray[np.bool_]:
        """Points (points,) that may lie on unstable motions."""
        return np.concatenate([np.full(len(each), each.unstable) for each in self.groups])

    @property
    def hardness(self) -> Array:
        """Weights (points,) of ln(B*/B)."""
        return np.minimum(HARD * np.abs(self.measured) / self.uncertainty, HEAVIEST)

    def parts(self) -> list[tuple[Points, Index, Index]]:
        """Each group, where its points are among all, and where among those of its fidelity."""
        found, first, of_fidelity = [], 0, dict.fromkeys(self.forward, 0)
        for each in self.groups:
            at, own = np.arange(len(each)), of_fidelity[each.fidelity]
            found.append((each, first + at, own + at))
            first, of_fidelity[each.fidelity] = first + len(each), own + len(each)
        return found

    def motions(self, x: Array, samples: int = 0) -> tuple[Array, Array]:
        """Values and ln(B*/B) of all motions at every point, (3, points) each; ``samples``: see ``of_orbits``.

        ValueError where the keys make no system. Without closed forms NaN; with ``samples`` what the model has soon
        after a start upward and downward.
        """
        values, beyond = np.full((3, self.count), np.nan), np.zeros((3, self.count))
        data = {name: each.at(x) for name, each in self.surfaces.items()}
        for group, at, own in self.parts():
            if not self.forward[group.fidelity].closed:
                if samples:
                    values[:2, at] = self.trails.soon(group, self.forward[group.fidelity], x)
                continue
            if group.several:
                continue
            drives, still = data[group.fidelity].driven(own), self.surfaces[group.fidelity].still(len(own))
            for motion in range(3):
                found = value_of(group, drives, still, motion, samples)
                values[motion, at], beyond[motion, at] = found.value, found.beyond
        return values, beyond

    def residuals(
        self, x: Array, chosen: Index, models: Models | None = None, slopes: bool = True
    ) -> tuple[Array, Array]:
        """Residuals (2 points,) and Jacobian (2 points, P) by the shares, with each point's motion held.

        Values that make no system (a restitution of mode 1 that no contact gives) are worse than any that do.
        ``models``: in place of the surfaces. Without ``slopes`` the Jacobian lacks motions that are followed.
        """
        try:
            values, by = self.predicted(x, chosen, models, slopes)
        except ValueError:
            return np.full(2 * self.count, IMPOSSIBLE), np.zeros((2 * self.count, len(x)))
        scale, hardness = np.where(chosen == LEFT, 0.0, 1 / self.uncertainty), self.hardness
        off = np.where(chosen == LEFT, 0.0, values[0] - self.measured) * scale
        by = np.concatenate([by[:, 0] * scale, by[:, 1] * hardness], axis=1)
        return np.concatenate([off, values[1] * hardness]), by.T

    def predicted(
        self, x: Array, chosen: Index, models: Models | None = None, slopes: bool = True
    ) -> tuple[Array, Array]:
        """Values and ln(B*/B) (2, points) of the chosen motions, with derivatives (P, 2, points) by the shares.

        Where there is none at any drive the value is 0 and the drive off by a factor e. NaN of a point left out. A
        motion that is lost goes on as its tangent does.
        """
        values, by = np.zeros((2, self.count)), np.zeros((len(self.keys), 2, self.count))
        values[0, chosen == LEFT] = np.nan
        known = models or (lambda name: self.surfaces[name].with_tangents(x))
        made = {name: known(name) for name in self.surfaces}
        for group, at, own in self.parts():
            if len(some := np.flatnonzero(chosen[at] >= FOLLOWED)):
                numbers = (chosen[at[some]] - FOLLOWED).tolist()
                values[0, at[some]], by[:, 0, at[some]] = self.trails.values(numbers, x, group.omega[some], slopes)
            for motion in np.unique(chosen[at][chosen[at] < LEFT]).tolist():
                some = np.flatnonzero(chosen[at] == motion)
                data, tangents = made[group.fidelity]
                own_data, own_tangents = data.driven(own[some]), tangents.driven(own[some])
                found = value_of(group.some(some), own_data, own_tangents, motion)
                none = ~np.isfinite(found.value + found.beyond)
                values[:, at[some]] = np.where(none, [[0.0], [1.0]], [found.value, found.beyond])
                by[:, 0, at[some]] = np.where(none, 0.0, found.by)
                by[:, 1, at[some]] = np.where(none, 0.0, found.by_beyond)
        return values, by

    def called(self, motion: int) -> str:
        """Motion of that number in words."""
        return MOTIONS[motion] if motion < FOLLOWED else self.trails.every[motion - FOLLOWED].called

    def touching(self, chosen: Index) -> NDArray[np.bool_]:
        """Points (points,) whose motions have contact."""
        return np.array([self.called(each) != MOTIONS[NO_CONTACT] for each in chosen.tolist()])

    def exact(self, x: Array) -> Models:
        """Modal data by the models themselves, with the surfaces' derivatives."""
        values = self.values(x)
        return lambda name: (
            self.forward[name].data(values, self.omega_of(name)), self.surfaces[name].with_tangents(x)[1]
        )  # fmt: skip


def value_of(group: Points, data: ModalData, tangents: Tangents, motion: int, samples: int = 0) -> OutputValue:
    """Quantity of one motion at the points of a group."""
    if motion == NO_CONTACT:
        return without_contact(data, tangents, group.omega, group.quantity, group.gain)
    return of_orbits(data, tangents, group.omega, group.periods, motion, group.quantity, group.gain, samples)


def robust(cost: Array) -> float:
    """Cauchy's loss Σ s² ln(1 + r²/s²) of squared residuals: what is far off counts little more than what is off."""
    return float(SCALE**2 * np.sum(np.log1p(np.minimum(cost, 1e300) / SCALE**2)))
