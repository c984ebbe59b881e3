"""Contacts of a system as arrays, and forces that only push: least squares with μ ≥ 0."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vibeam.flight.linear.regimes import damper_of
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array

NOISE = 16 * 2.220446049250313e-16  # share of the parts of a sum below which it is their round-off

SOFT = (
    1e-3  # rate of a mode without stiffness, as a share of the slowest other one, where the least energy is asked for
)


@dataclass(frozen=True)
class Contacts:
    """k contacts of a system: the first stop, the second one on its other side if there is one, the further ones."""

    system: ImpactSystem
    rows: Array  # (k, n)
    gaps: Array  # (k,)
    restitutions: Array  # (k,)

    @classmethod
    def of(cls, system: ImpactSystem) -> Contacts:
        """The contacts of ``system``, in their order."""
        found = [(system.contact, system.gap, system.restitution)]
        if system.second_gap is not None:
            found.append((-system.contact, system.second_gap, system.restitution))
        found += [(each.row, each.gap, each.restitution) for each in system.further or ()]
        rows, gaps, restitutions = zip(*found, strict=True)
        return cls(system, np.array(rows), np.array(gaps), np.array(restitutions))

    @cached_property
    def spring(self) -> Array:
        """ω² (n,)."""
        return self.system.omega**2

    @cached_property
    def damper(self) -> Array:
        """Modal damping matrix (n, n)."""
        return damper_of(self.system)

    @cached_property
    def yields(self) -> Array:
        """1/ω² (n,), large and finite for a mode without stiffness."""
        omega = self.system.omega
        slowest = float(np.min(omega[omega > 0], initial=np.inf))
        loose = SOFT * slowest if np.isfinite(slowest) else 1.0
        return np.asarray(np.where(omega > 0, omega, loose) ** -2.0)

    def clearances(self, displacement: Array) -> tuple[Array, Array]:
        """Gap of every contact (k,), and the sum of the sizes of its parts."""
        return self.gaps - self.rows @ displacement, np.abs(self.gaps) + np.abs(self.rows) @ np.abs(displacement)

    def approaches(self, velocity: Array) -> Array:
        """Velocity toward every stop (k,); 0 where it is the round-off of its parts."""
        found = self.rows @ velocity
        return np.where(np.abs(found) > NOISE * (np.abs(self.rows) @ np.abs(velocity)), found, 0.0)

    def put(self, displacement: Array, touched: list[int]) -> Array:
        """The displacement with the contacts ``touched`` exactly at their stops, moved there with the least energy."""
        if len(touched) == 1:  # far quicker than by a pseudo-inverse
            row = self.rows[touched[0]]
            give = row * self.yields
            return np.asarray(displacement - give * ((row @ displacement - self.gaps[touched[0]]) / (give @ row)))
        rows = self.rows[touched]
        soft = rows * self.yields
        beyond = rows @ displacement - self.gaps[touched]
        return np.asarray(displacement - soft.T @ (np.linalg.pinv(soft @ rows.T, hermitian=True) @ beyond))


def one_sided(rows: Array, vector: Array) -> Array:
    """μ ≥ 0 (k,) that minimises |vector − rowsᵀ μ|: what is left is not positive along any row, 0 where μ > 0.

    Lawson & Hanson, Solving Least Squares Problems, 1974, ch. 23.
    """
    if len(rows) == 1:
        return np.maximum(rows @ vector, 0.0) / float(rows[0] @ rows[0])
    from scipy.optimize import nnls

    sizes, size = np.linalg.norm(rows, axis=1), float(np.linalg.norm(vector)) or 1.0
    found, _ = nnls((rows / sizes[:, None]).T, vector / size)
    return np.asarray(found * size / sizes)


def multipliers(rows: Array) -> Array:
    """(k, n): what takes a vector to the μ that minimise |vector − rowsᵀ μ|, whatever their sign."""
    if len(rows) == 1:
        return np.asarray(rows / float(rows[0] @ rows[0]))
    return np.asarray(np.linalg.pinv(rows @ rows.T, hermitian=True) @ rows)


def within(row: Array, rows: Array) -> bool:
    """Whether a row is a sum of others, to round-off."""
    if not len(rows):
        return False
    left = row - (multipliers(rows) @ row) @ rows
    return bool(np.linalg.norm(left) <= 1e-10 * np.linalg.norm(row))
