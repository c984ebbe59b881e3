"""ImpactSystem: what a solver gets, a modal flow with a one-sided stop."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from vibeam_models.structure import Structure

Array = NDArray[np.float64]
DIAGONAL = 1e-6  # share of the modal damping matrix that may lie off its diagonal; fine meshes round to 10⁻⁷


@dataclass(frozen=True)
class Drive:
    """Base motion b(t) = amplitude · sin(omega t): rad/s and m. ``amplitude = 0`` is no drive at all."""

    omega: float
    amplitude: float

    def __post_init__(self) -> None:
        if not (np.isfinite(self.omega) and self.omega >= 0 and np.isfinite(self.amplitude)):
            raise ValueError(f"drive: omega {self.omega} must be finite and ≥ 0, amplitude {self.amplitude} finite")
        object.__setattr__(self, "omega", float(self.omega))
        object.__setattr__(self, "amplitude", float(self.amplitude))


@dataclass(frozen=True)
class ImpactSystem:
    """n modes η_i'' + 2ζ_iω_i η_i' + ω_i² η_i = load_i Ω²B sin Ωt + static_i with a stop at Σ contact_i η_i = gap.

    At the stop η_i'⁺ = η_i'⁻ + contact_i p with p = −(1+R) v⁻ / Σ contact_i². All SI; shapes (n,). ``outputs`` are
    rows on η; ``"contact"`` is always one of them.
    """

    omega: Array
    zeta: Array
    contact: Array
    load: Array
    static: Array
    gap: float
    restitution: float
    outputs: Mapping[str, Array] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """Number of modes."""
        return len(self.omega)

    def output(self, name: str) -> Array:
        """The row (n,) of one output; KeyError names those there are."""
        if name == "contact":
            return self.contact
        if name not in self.outputs:
            raise KeyError(f"no output {name!r}: there are {', '.join(sorted({'contact', *self.outputs}))}")
        return self.outputs[name]

    @classmethod
    def from_modes(
        cls,
        omega: ArrayLike,
        zeta: ArrayLike,
        contact: ArrayLike,
        load: ArrayLike,
        *,
        gap: float = 0.0,
        restitution: float = 1.0,
        outputs: Mapping[str, ArrayLike] | None = None,
        static: ArrayLike | None = None,
    ) -> ImpactSystem:
        """A system by hand from mass-normalised modes.

        ``omega`` rad/s and ``zeta`` ≥ 0 (zeta may be one number for all); ``contact``, ``load`` and ``static`` as in
        the class; ``gap`` m (negative: pressed against the stop); ``restitution`` in [0, 1]. ValueError names every
        argument that is wrong.
        """
        frequencies = np.atleast_1d(np.array(omega, dtype=float))
        n = len(frequencies)
        given = {"omega": omega, "zeta": zeta, "contact": contact, "load": load, "static": static}
        rows = {name: _row(0.0 if value is None else value, n) for name, value in given.items()}
        named = {name: _row(value, n) for name, value in (outputs or {}).items()}
        faults = [f"{name}: must be one number or {n} finite numbers" for name, row in rows.items() if row is None]
        faults += [f"outputs[{name!r}]: must be {n} finite numbers" for name, row in named.items() if row is None]
        faults += _range_faults(rows, gap, restitution)
        if faults:
            raise ValueError("; ".join(faults))
        clean = {name: row for name, row in rows.items() if row is not None}
        shown = {name: row for name, row in named.items() if row is not None}
        return cls(**clean, gap=float(gap), restitution=float(restitution), outputs=shown)

    @classmethod
    def from_structure(cls, structure: Structure, *, gap: float, restitution: float) -> ImpactSystem:
        """The modal form of any Structure, all its modes; its damping must be diagonal in them (ValueError if not)."""
        modes = structure.modes()
        damping = modes.shapes.T @ structure.C @ modes.shapes
        if _off_diagonal(damping) > DIAGONAL:
            raise ValueError("the damping couples the modes: this form needs proportional damping")
        safe = np.where(modes.omega > 0, modes.omega, 1.0)
        outputs = {name: row @ modes.shapes for name, row in structure.outputs.items()}
        return cls.from_modes(
            modes.omega,
            np.diag(damping) / (2 * safe),
            structure.contact @ modes.shapes,
            -(structure.load @ modes.shapes),
            gap=gap,
            restitution=restitution,
            outputs=outputs,
            static=structure.static @ modes.shapes,
        )


def _row(value: ArrayLike, n: int) -> Array | None:
    """``value`` as n finite numbers, or None where it is not."""
    row = np.atleast_1d(np.array(value, dtype=float))
    if row.ndim != 1 or len(row) not in (1, n) or not np.all(np.isfinite(row)):
        return None
    return np.ascontiguousarray(np.broadcast_to(row, n))


def _range_faults(rows: Mapping[str, Array | None], gap: float, restitution: float) -> list[str]:
    omega, zeta, contact = rows["omega"], rows["zeta"], rows["contact"]
    faults = []
    if omega is not None and np.any(omega < 0):
        faults.append("omega: a frequency is negative")
    if zeta is not None and np.any(zeta < 0):
        faults.append("zeta: a damping ratio is negative")
    if contact is not None and not np.any(contact):
        faults.append("contact: no mode moves the contact point")
    if not np.isfinite(gap):
        faults.append(f"gap: {gap} is not finite")
    if not 0 <= restitution <= 1:
        faults.append(f"restitution: {restitution} is outside [0, 1]")
    return faults


def _off_diagonal(matrix: Array) -> float:
    diagonal = np.diag(matrix)
    scale = np.sqrt(np.abs(np.outer(diagonal, diagonal)))
    rest = np.abs(matrix - np.diag(diagonal))
    return float(np.max(rest / np.where(scale > 0, scale, 1.0), initial=0.0))
