"""ImpactSystem: what a solver gets, a modal flow with a one-sided stop."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from vibeam_models.compliant import CompliantStop
    from vibeam_models.contact import Restitution, VelocityRestitution
    from vibeam_models.structure import Structure

Array = NDArray[np.float64]
ROUND_OFF = 1e-12  # share of the largest modal damping below which a mode without stiffness has none
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
    rows on η; ``"contact"`` is always one of them. What is None is not there and costs nothing:

    - ``law``: R(v) in place of ``restitution``, or a stop that yields and pushes with a force (``vibeam_models``);
    - ``coupling``: (n, n) modal damping matrix, symmetric, in place of 2ζω where damping couples the modes;
    - ``second_gap``: a second stop with the same law on the other side, at Σ contact_i η_i = −second_gap.
    """

    omega: Array
    zeta: Array
    contact: Array
    load: Array
    static: Array
    gap: float
    restitution: float
    outputs: Mapping[str, Array] = field(default_factory=dict)
    law: VelocityRestitution | CompliantStop | None = None
    coupling: Array | None = None
    second_gap: float | None = None

    @property
    def beyond_plain(self) -> tuple[str, ...]:
        """What makes the system more than modes by themselves with one stop and one coefficient of restitution."""
        named = {
            f'the contact law "{self.law.name if self.law else ""}"': self.law,
            "damping that couples the modes": self.coupling,
            "a second stop": self.second_gap,
        }
        return tuple(name for name, part in named.items() if part is not None)

    def require_plain(self, who: str) -> None:
        """ValueError, naming ``who`` cannot take it, where the system is more than plain."""
        if self.beyond_plain:
            raise ValueError(f"{who} cannot take {' or '.join(self.beyond_plain)}: the solver 'flight' can")

    def moves_as(self, other: ImpactSystem) -> bool:
        """Whether the two are the same to the bit, whatever is read off them."""
        names = (each.name for each in fields(self) if each.name != "outputs")
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in names)

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
        law: Restitution | VelocityRestitution | CompliantStop | None = None,
        coupling: ArrayLike | None = None,
        second_gap: float | None = None,
    ) -> ImpactSystem:
        """A system by hand from mass-normalised modes.

        ``omega`` rad/s and ``zeta`` ≥ 0 (zeta may be one number for all); ``contact``, ``load`` and ``static`` as in
        the class; ``gap`` m (negative: pressed against the stop); ``restitution`` in [0, 1], or any ``law``;
        ``coupling``, which then says all damping, and ``second_gap`` m as in the class. ValueError names every
        argument that is wrong.
        """
        from vibeam_models.contact import Restitution

        frequencies = np.atleast_1d(np.array(omega, dtype=float))
        n = len(frequencies)
        given = {"omega": omega, "zeta": zeta, "contact": contact, "load": load, "static": static}
        rows = {name: _row(0.0 if value is None else value, n) for name, value in given.items()}
        named = {name: _row(value, n) for name, value in (outputs or {}).items()}
        faults = [f"{name}: must be one number or {n} finite numbers" for name, row in rows.items() if row is None]
        faults += [f"outputs[{name!r}]: must be {n} finite numbers" for name, row in named.items() if row is None]
        if isinstance(law, Restitution):
            restitution, law = law.coefficient, None
        faults += _range_faults(rows, gap, restitution)
        damper = None if coupling is None else np.array(coupling, dtype=float)
        faults += _coupling_faults(damper, n) + _second_faults(gap, second_gap)
        if faults:
            raise ValueError("; ".join(faults))
        clean = {name: row for name, row in rows.items() if row is not None}
        shown = {name: row for name, row in named.items() if row is not None}
        if damper is not None:
            moving = np.where(frequencies > 0, frequencies, 1.0)
            clean["zeta"] = np.maximum(np.diag(damper), 0.0) / (2 * moving)
        return cls(
            **clean,
            gap=float(gap),
            restitution=float(restitution),
            outputs=shown,
            law=law,
            coupling=damper,
            second_gap=None if second_gap is None else float(second_gap),
        )

    @classmethod
    def from_structure(
        cls,
        structure: Structure,
        *,
        gap: float,
        restitution: float = 1.0,
        law: Restitution | VelocityRestitution | CompliantStop | None = None,
        second_gap: float | None = None,
    ) -> ImpactSystem:
        """The modal form of any Structure, all its modes; damping that couples them is kept as ``coupling``, and so is
        that of a mode without stiffness, which has no damping ratio.
        """
        modes = structure.modes()
        damping = modes.shapes.T @ structure.C @ modes.shapes
        couples = _off_diagonal(damping) > DIAGONAL or _drags(modes.omega, damping)
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
            law=law,
            coupling=(damping + damping.T) / 2 if couples else None,
            second_gap=second_gap,
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


def _coupling_faults(damper: Array | None, n: int) -> list[str]:
    if damper is None:
        return []
    if damper.shape != (n, n) or not np.all(np.isfinite(damper)):
        return [f"coupling: must be {n} × {n} finite numbers"]
    size = float(np.max(np.abs(damper), initial=0.0))
    if np.max(np.abs(damper - damper.T), initial=0.0) > 1e-9 * size:
        return ["coupling: must be symmetric"]
    feeds = np.min(np.linalg.eigvalsh(damper), initial=0.0) < -1e-9 * size
    return ["coupling: feeds energy into the motion (it has a negative eigenvalue)"] if feeds else []


def _second_faults(gap: float, second_gap: float | None) -> list[str]:
    if second_gap is None or (np.isfinite(second_gap) and second_gap > -gap):
        return []
    return [f"second_gap: {second_gap} must be finite and above −gap = {0.0 - gap}, or nothing fits between the stops"]


def _drags(omega: Array, damping: Array) -> bool:
    """Whether a mode without stiffness is damped, beyond round-off: 2ζω cannot say so."""
    return bool(np.any(np.diag(damping)[omega == 0] > ROUND_OFF * np.max(np.abs(damping), initial=0.0)))


def _off_diagonal(matrix: Array) -> float:
    diagonal = np.diag(matrix)
    scale = np.sqrt(np.abs(np.outer(diagonal, diagonal)))
    rest = np.abs(matrix - np.diag(diagonal))
    return float(np.max(rest / np.where(scale > 0, scale, 1.0), initial=0.0))
