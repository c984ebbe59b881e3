"""Derivatives of a system's modal data by parameters, for exact derivatives of what follows from them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array


@dataclass(frozen=True)
class ModalData:
    """What periodic motions of a system follow from: modal rows (n,), gap, restitution, drive (points,) in m.

    ``sigma`` is ζω, 1/s; ``row`` the output's.
    """

    omega: Array
    sigma: Array
    contact: Array
    load: Array
    static: Array
    row: Array
    gap: float
    restitution: float
    drive: Array

    @classmethod
    def of(cls, system: ImpactSystem, output: str, drive: Array) -> ModalData:
        """Modal data of a system under base amplitudes ``drive`` (points,) m; KeyError for an unknown output."""
        return cls(
            system.omega, system.zeta * system.omega, system.contact, system.load, system.static, system.output(output),
            system.gap, system.restitution, drive,
        )  # fmt: skip

    @property
    def zeta(self) -> Array:
        """Damping ratios (n,)."""
        return np.asarray(self.sigma / self.omega)

    def driven(self, which: NDArray[np.int64]) -> ModalData:
        """Same data with the drives at the indices ``which``."""
        return replace(self, drive=self.drive[which])

    def packed(self) -> Array:
        """All in one row."""
        rows = (self.omega, self.sigma, self.contact, self.load, self.static, self.row)
        return np.concatenate([*rows, [self.gap, self.restitution], self.drive])

    @classmethod
    def unpacked(cls, row: Array, modes: int) -> ModalData:
        """Modal data of so many modes from ``packed``."""
        omega, sigma, contact, load, static, output = row[: 6 * modes].reshape(6, modes)
        gap, restitution, *_ = row[6 * modes :].tolist()
        return cls(omega, sigma, contact, load, static, output, gap, restitution, row[6 * modes + 2 :])


@dataclass(frozen=True)
class Tangents:
    """Derivatives of ``ModalData`` by P parameters: each of its members with one more axis (P, …) in front."""

    omega: Array
    sigma: Array
    contact: Array
    load: Array
    static: Array
    row: Array
    gap: Array
    restitution: Array
    drive: Array

    def driven(self, which: NDArray[np.int64]) -> Tangents:
        """Same derivatives with the drives at the indices ``which``."""
        return replace(self, drive=self.drive[:, which])

    @classmethod
    def unpacked(cls, rows: Array, modes: int) -> Tangents:
        """Derivatives (P, all) of ``ModalData.packed`` of so many modes."""
        rest = rows[:, 6 * modes :]
        omega, sigma, contact, load, static, row = (rows[:, k * modes : (k + 1) * modes] for k in range(6))
        return cls(omega, sigma, contact, load, static, row, rest[:, 0], rest[:, 1], rest[:, 2:])


def aligned(data: ModalData, like: ModalData) -> ModalData:
    """Same data with the modes' signs, which are arbitrary, as in ``like``."""
    rows = ("contact", "load", "static", "row")
    total = np.zeros(len(data.omega))
    for name in rows:
        one, other = getattr(data, name), getattr(like, name)
        size = float(np.abs(other).max())
        total += one * other / size**2 if size > 0 else 0.0
    sign = np.where(total < 0, -1.0, 1.0)
    return replace(data, **{name: sign * getattr(data, name) for name in rows})
