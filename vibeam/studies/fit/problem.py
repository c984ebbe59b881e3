"""Weighted residuals of measured points on the branches that they lie on, and their exact Jacobian.

A point is compared with one motion of its frequency: one of the two roots of the closed-form orbit, or the motion
without contact. While the parameters move the choice is held, so that the cost has no jump; between two minimisations
each point takes the nearest motion that is one (clear of the stop in between, and stable unless it was controlled).
Beyond a fold, or where the motion without contact would strike, there is no such motion: then that of the least drive
that has one is taken, and a second residual tells how much that drive is off, in the point's relative uncertainty.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.orbits.output_derivatives import Value, of_orbits, without_contact
from vibeam.orbits.tangents import ModalData, Tangents
from vibeam.studies.fit.forward import Forward
from vibeam.studies.fit.points import Points, points_of

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.plans import FitKey

Array = NDArray[np.float64]

Index = NDArray[np.int64]

MOTIONS = ("harder impact", "softer impact", "no contact")

NO_CONTACT = 2

HARD = 3.0  # weight of a drive that is off by the relative uncertainty of a point

HEAVIEST = 1e4

IMPOSSIBLE = 1e9  # residual of values that make no system


@dataclass(frozen=True)
class Problem:
    """Points in groups, forward models by fidelity, estimated keys; parameters are shares x (P,) of their bounds."""

    keys: tuple[FitKey, ...]
    groups: tuple[Points, ...]
    forward: dict[str, Forward]
    notes: tuple[str, ...] = ()

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
        return cls(case.fit.keys, tuple(groups), forward, tuple(notes))

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
    def hardness(self) -> Array:
        """Weights (points,) of ln(B*/B)."""
        return np.minimum(HARD * np.abs(self.measured) / self.uncertainty, HEAVIEST)

    def motions(self, x: Array) -> tuple[Array, Array]:
        """Values and ln(B*/B) of all motions at every point, (3, points) each."""
        found = [self._of_group(each, *self.still(each, x)) for each in self.groups]
        return tuple(np.concatenate([each[part] for each in found], axis=1) for part in (0, 1))  # type: ignore[return-value]

    def still(self, group: Points, x: Array) -> tuple[ModalData, Tangents]:
        """Modal data of a group, without derivatives."""
        data = self.forward[group.fidelity].data(self.values(x), group.omega)
        return data, Tangents.unpacked(np.zeros((0, len(data.packed()))), len(data.omega))

    def _of_group(self, group: Points, data: ModalData, tangents: Tangents) -> tuple[Array, Array]:
        found = [value_of(group, data, tangents, motion) for motion in range(3)]
        return np.stack([each.value for each in found]), np.stack([each.beyond for each in found])

    def residuals(self, x: Array, chosen: Index) -> tuple[Array, Array]:
        """Residuals (2 points,) and Jacobian (2 points, P) by the shares, with each point's motion held.

        Values that make no system (a restitution of mode 1 that no contact gives) are worse than any that do.
        """
        try:
            values, jacobian = self.predicted(x, chosen)
        except ValueError:
            return np.full(2 * self.count, IMPOSSIBLE), np.zeros((2 * self.count, len(x)))
        off = (values[0] - self.measured) / self.uncertainty
        rows = jacobian * self.width[:, None, None]
        return (
            np.concatenate([off, values[1] * self.hardness]),
            np.concatenate([rows[:, 0] / self.uncertainty, rows[:, 1] * self.hardness], axis=1).T,
        )

    def predicted(self, x: Array, chosen: Index) -> tuple[Array, Array]:
        """Values and ln(B*/B) (2, points) of the chosen motions, with derivatives (P, 2, points) by the keys."""
        values, by = np.zeros((2, self.count)), np.zeros((len(self.keys), 2, self.count))
        models, first = self._models(x), 0
        for group in self.groups:
            data, tangents = models[group.reference, group.periods]
            own = chosen[first : first + len(group)]
            for motion in np.unique(own).tolist():
                at = np.flatnonzero(own == motion)
                found = value_of(_some(group, at), _drives(data, at), _tangent_drives(tangents, at), motion)
                _put_in(values, by, first + at, found)
            first += len(group)
        return values, by

    def _models(self, x: Array) -> dict[tuple[str, int], tuple[ModalData, Tangents]]:
        """Modal data and tangents for every group, one structure a fidelity."""
        found = {}
        for name, forward in self.forward.items():
            groups = [each for each in self.groups if each.fidelity == name]
            data, tangents = forward.with_tangents(self.values(x), np.concatenate([each.omega for each in groups]))
            first = 0
            for each in groups:
                at = np.arange(first, first + len(each))
                found[each.reference, each.periods] = _drives(data, at), _tangent_drives(tangents, at)
                first += len(each)
        return found


def value_of(group: Points, data: ModalData, tangents: Tangents, motion: int) -> Value:
    """Quantity of one motion at the points of a group."""
    if motion == NO_CONTACT:
        return without_contact(data, tangents, group.omega, group.quantity, group.gain)
    return of_orbits(data, tangents, group.omega, group.periods, motion, group.quantity, group.gain)


def _put_in(values: Array, by: Array, at: Index, found: Value) -> None:
    """Enter a motion's values; one that exists at no drive is 0 and a drive off by a factor e."""
    none = ~np.isfinite(found.value + found.beyond)
    values[0, at], values[1, at] = np.where(none, 0.0, found.value), np.where(none, 1.0, found.beyond)
    by[:, 0, at], by[:, 1, at] = np.where(none, 0.0, found.by), np.where(none, 0.0, found.by_beyond)


def _some(group: Points, at: Index) -> Points:
    from dataclasses import replace

    return replace(group, **{name: getattr(group, name)[at] for name in ("frequency", "value", "uncertainty")})


def _drives(data: ModalData, at: Index) -> ModalData:
    from dataclasses import replace

    return replace(data, drive=data.drive[at])


def _tangent_drives(tangents: Tangents, at: Index) -> Tangents:
    from dataclasses import replace

    return replace(tangents, drive=tangents.drive[:, at])
