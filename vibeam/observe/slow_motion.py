"""Slow part of a motion between two impacts, linear in its unknowns; the rest are the fast modes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array


@dataclass(frozen=True)
class SlowPart:
    """Sum of a polynomial, the response to the drive and free vibrations of the slow modes.

    ``degree``: of the polynomial (0: a constant, −1: none); ``drive``: rad/s, None where it is left out; ``omega`` and
    ``zeta``: of the free vibrations, none by default. A polynomial alone asks for no knowledge of the rig.
    """

    degree: int = 0
    drive: float | None = None
    omega: tuple[float, ...] = ()
    zeta: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if self.degree < -1 or len(self.omega) != len(self.zeta) or not all(0 <= z < 1 for z in self.zeta):
            raise ValueError("slow part: degree ≥ −1, as many zeta as omega, each in [0, 1)")
        if self.degree == -1 and self.drive is None and not self.omega:
            raise ValueError("slow part: nothing in it")

    @property
    def size(self) -> int:
        """Number of functions."""
        return self.degree + 1 + 2 * (self.drive is not None) + 2 * len(self.omega)

    def columns(self, t: Array) -> tuple[Array, Array]:
        """Functions and their rates (m, k) at times (m,), s, best counted from the stretch's begin."""
        power = np.arange(self.degree + 1)
        values, rates = [t[:, None] ** power], [power * t[:, None] ** np.maximum(power - 1, 0)]
        exponents = [] if self.drive is None else [1j * self.drive]
        exponents += [complex(-z * w, w * np.sqrt(1 - z * z)) for w, z in zip(self.omega, self.zeta, strict=True)]
        for exponent in exponents:
            turn = np.exp(exponent * t)
            rate = exponent * turn
            values += [turn.real[:, None], turn.imag[:, None]]
            rates += [rate.real[:, None], rate.imag[:, None]]
        return np.concatenate(values, axis=1), np.concatenate(rates, axis=1)


def slow_part(system: ImpactSystem, drive: Drive, modes: int = 1) -> SlowPart:
    """Slow part of a system: constant, drive and its first ``modes`` modes."""
    slow = np.argsort(system.omega)[:modes]
    return SlowPart(0, drive.omega, tuple(system.omega[slow].tolist()), tuple(system.zeta[slow].tolist()))


def further_modes(system: ImpactSystem, first: int = 2, last: int = 3) -> SlowPart:
    """Free vibrations of modes ``first`` to ``last``, counted from 1 by frequency: to be fitted beside a slow part.

    Overdamped ones are left out; ValueError where none remains.
    """
    order = np.argsort(system.omega)[first - 1 : last]
    order = order[system.zeta[order] < 1]
    return SlowPart(-1, None, tuple(system.omega[order].tolist()), tuple(system.zeta[order].tolist()))


def fitted(slow: SlowPart, time: ArrayLike, values: ArrayLike, origin: float) -> tuple[Array, Array]:
    """Least-squares coefficients (k,) and residual of the values (m,); ValueError for too few samples."""
    t, x = np.asarray(time, dtype=float) - origin, np.asarray(values, dtype=float)
    columns = slow.columns(t)[0]
    if len(t) <= slow.size:
        raise ValueError(f"slow part: {len(t)} samples for {slow.size} unknowns")
    found = solved(columns, x)
    return found, x - columns @ found


def solved(columns: Array, values: Array) -> Array:
    """Least squares with columns scaled to unit size, so that none is dropped because its unit is small."""
    size = np.linalg.norm(columns, axis=0)
    size = np.where(size > 0, size, 1.0)
    return np.asarray(np.linalg.lstsq(columns / size, values, rcond=None)[0] / size)
