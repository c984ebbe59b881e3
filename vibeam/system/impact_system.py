"""ImpactSystem: the input of a solver, modal equations with a one-sided stop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from vibeam.system.arguments import ROWS, checked
from vibeam.system.number_text import ratio
from vibeam.system.rows import Contact, TimeDerivative
from vibeam_models.arguments import counted, read_only, require, settle
from vibeam_models.arrays import Array, ValueRecord

if TYPE_CHECKING:
    from vibeam_models.laws.mechanics import StopLaw
    from vibeam_models.structure import Structure


ROUND_OFF = 1e-12  # share of the largest modal damping below which a mode without stiffness counts as undamped
SHOWN = 4  # frequencies shown by a repr
DIAGONAL = 1e-6  # admissible share of off-diagonal terms in the modal damping matrix; fine meshes round to 10⁻⁷


@dataclass(frozen=True)
class Drive:
    """Base motion b(t) = amplitude · sin(omega t): rad/s and m. ``amplitude = 0`` means no drive.

    ValueError for ``omega`` that is not finite and ≥ 0, or ``amplitude`` that is not finite.

    >>> import vibeam
    >>> vibeam.Drive(omega=95, amplitude=1e-4)
    Drive(omega=95.0, amplitude=0.0001)
    """

    omega: float
    amplitude: float

    def __post_init__(self) -> None:
        settle(self, "drive", omega={"least": 0.0}, amplitude={})

    def load_at(self, t: Array) -> Array:
        """Factor of the modes' load row at times ``t``: Ω²B sin Ωt, which is −b̈."""
        return np.asarray(self.omega**2 * self.amplitude * np.sin(self.omega * t))


@dataclass(frozen=True, eq=False, repr=False)
class ImpactSystem(ValueRecord):
    """n modes η_i'' + 2ζ_iω_i η_i' + ω_i² η_i = load_i Ω²B sin Ωt + static_i with a stop at Σ contact_i η_i = gap.

    At the stop η_i'⁺ = η_i'⁻ + contact_i p with p = −(1+R) v⁻ / Σ contact_i². All SI; shapes (n,). ``outputs`` are
    rows on η; ``"contact"`` is always one of them. What is None is not there and costs nothing:

    - ``law``: R(v) in place of ``restitution``, or a stop that yields and pushes with a force (``vibeam_models``);
    - ``coupling``: (n, n) modal damping matrix, symmetric, in place of 2ζω where damping couples the modes;
    - ``second_gap``: a second stop with the same law on the other side, at Σ contact_i η_i = −second_gap;
    - ``derivatives``: outputs that are velocities or accelerations, by name;
    - ``further``: stops elsewhere, each a ``Contact`` with row, gap and restitution or law of its own.

    Rows may be lists; they are kept as read-only arrays. ValueError names every argument that is wrong: a row that is
    not n finite numbers, negative ``omega`` or ``zeta``, ``contact`` all zero, ``restitution`` outside [0, 1], a
    ``coupling`` that is not symmetric or feeds energy in, a ``second_gap`` at or below −gap. ``from_modes`` is the same
    with one number for a row of equal ones.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes([1.0, 6.0], 0.01, [1.0, 2.0], [1.0, 0.5], gap=1e-3, restitution=0.7)
    >>> system.size, system.mobility  # Σ contact²
    (2, 5.0)
    """

    omega: Array
    zeta: Array
    contact: Array
    load: Array
    static: Array
    gap: float
    restitution: float
    outputs: Mapping[str, Array] = field(default_factory=dict)
    law: StopLaw | None = None
    coupling: Array | None = None
    second_gap: float | None = None
    derivatives: Mapping[str, TimeDerivative] = field(default_factory=dict)
    further: tuple[Contact, ...] | None = None

    def __post_init__(self) -> None:
        for name, value in checked(self).items():
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        rates = ", ".join(f"{rate:.6g}" for rate in self.omega[:SHOWN]) + (", …" if self.size > SHOWN else "")
        law = f"restitution={ratio(self.restitution, 'g')}" if self.law is None else f"law={self.law!r}"
        second = "" if self.second_gap is None else f", second_gap={self.second_gap:g}"
        coupled = "" if self.coupling is None else ", coupled damping"
        second += "" if self.further is None else f", {counted(len(self.further), 'further contact')}"
        stop, outputs = f"gap={self.gap:g}{second}, {law}{coupled}", ", ".join([*self.outputs, *self.derivatives])
        return f"ImpactSystem({counted(self.size, 'mode')}, omega {rates} rad/s, {stop}, outputs {outputs or 'none'})"

    @cached_property
    def contact_law(self) -> StopLaw:
        """Law of the contact with the stop: ``law``, or one coefficient of restitution."""
        from vibeam_models.laws.restitution import Restitution

        return Restitution(self.restitution) if self.law is None else self.law

    @property
    def beyond_plain(self) -> tuple[str, ...]:
        """Describe the features beyond a plain system (uncoupled modes, one stop, one coefficient of restitution)."""
        if self.law is None and self.coupling is None and self.second_gap is None and self.further is None:
            return ()
        named = {
            f'the contact law "{self.law.name if self.law else ""}"': self.law,
            "damping that couples the modes": self.coupling,
            "a second stop": self.second_gap,
            "several contacts": self.further,
        }
        return tuple(name for name, part in named.items() if part is not None)

    def require_plain(self, who: str) -> None:
        """Raise ValueError, naming ``who`` cannot take it, where the system is more than plain."""
        if self.beyond_plain:
            raise ValueError(f"{who} cannot take {' or '.join(self.beyond_plain)}: the solver 'flight' can")

    def moves_as(self, other: ImpactSystem) -> bool:
        """Test whether two systems move identically, to the bit, whatever their outputs."""
        names = (each.name for each in fields(self) if each.name not in ("outputs", "derivatives"))
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in names)

    @property
    def size(self) -> int:
        """Number of modes."""
        return len(self.omega)

    @property
    def mobility(self) -> float:
        """Velocity of the contact after a unit impulse there, Σ c_i², 1/kg."""
        return float(self.contact @ self.contact)

    def impact_velocity(self, impulse: Array) -> Array:
        """Contact velocity v⁻ = −p Σ c_i²/(1 + R) before impacts that take the ``impulse`` p, m/s."""
        return -impulse * self.mobility / (1 + self.restitution)

    def output(self, name: str) -> Array:
        """Row (n,) on η of one output; KeyError names the known outputs, ValueError one that is a derivative."""
        derivative = self.derivative(name)
        if derivative is not None:
            raise ValueError(f"output {name!r} is no displacement but a derivative in time: {derivative.called}")
        return self.contact if name == "contact" else self.outputs[name]

    def row(self, name: str) -> Array:
        """Row (n,) on η of one output, or of what it is the derivative of; KeyError names the known outputs."""
        derivative = self.derivative(name)
        return self.output(name) if derivative is None else np.asarray(derivative.row)

    def derivative(self, name: str) -> TimeDerivative | None:
        """An output that is a derivative in time, None of one that is a row on η; KeyError names the known outputs."""
        require("output", name, str)
        if name not in ("contact", *self.outputs, *self.derivatives):
            known = sorted({"contact", *self.outputs, *self.derivatives})
            raise KeyError(f"no output {name!r}: there are {', '.join(known)}")
        return self.derivatives.get(name)

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
        law: StopLaw | None = None,
        coupling: ArrayLike | None = None,
        second_gap: float | None = None,
        derivatives: Mapping[str, TimeDerivative] | None = None,
        further: Sequence[Contact] | None = None,
    ) -> ImpactSystem:
        """Build a system from mass-normalised modes.

        ``omega`` rad/s and ``zeta`` ≥ 0 (zeta may be one number for all); ``contact``, ``load`` and ``static`` as in
        the class; ``gap`` m (negative: pressed against the stop); ``restitution`` in [0, 1], or any ``law``;
        ``coupling``, which then says all damping, ``second_gap`` m, ``derivatives`` and ``further`` contacts as in the
        class. ValueError names every argument that is wrong.
        """
        frequencies, ratios = read_only(omega), read_only(zeta)
        n = 1 if frequencies is None else frequencies.size
        rows = (omega, zeta, contact, load, 0.0 if static is None else static)
        given: dict[str, Any] = {name: _row(value, n) for name, value in zip(ROWS, rows, strict=True)}
        given |= {"gap": gap, "restitution": restitution, "law": law, "coupling": coupling, "second_gap": second_gap}
        given |= {"outputs": {} if outputs is None else outputs, "derivatives": derivatives or {}, "further": further}
        if isinstance(outputs, Mapping):
            given["outputs"] = {name: _row(row, n) for name, row in outputs.items()}
        damper = None if coupling is None else read_only(coupling)
        if damper is not None and damper.shape == (n, n) and ratios is not None and not np.any(ratios < 0):
            moving = np.where(given["omega"] > 0, given["omega"], 1.0)
            given |= {"zeta": np.maximum(np.diag(damper), 0.0) / (2 * moving), "coupling": damper}
        return cls(**given)

    @classmethod
    def from_structure(
        cls,
        structure: Structure,
        *,
        gap: float,
        restitution: float = 1.0,
        law: StopLaw | None = None,
        second_gap: float | None = None,
        further: Mapping[str, tuple[Any, ...]] | None = None,
    ) -> ImpactSystem:
        """Build the modal form of any Structure, all its modes; coupled damping is kept as ``coupling``, and so is
        that of a mode without stiffness, which has no damping ratio. ``further``: by the name of the output whose row
        they have, gap, restitution and law (or none) of further contacts.

        ValueError as in the class, for matrices that are no structure's, and for a contact without mass at a stop that
        is no spring. Own matrices M, C and K, here two masses
        of 1 kg and 0.2 kg in a row on a base that shakes, the second one at the stop, in their lowest mode:

        >>> import vibeam
        >>> M, K = [[1.0, 0.0], [0.0, 0.2]], [[5000.0, -2000.0], [-2000.0, 2000.0]]
        >>> C = [[0.5, -0.2], [-0.2, 0.2]]
        >>> own = vibeam.Structure(
        ...     M, C, K, load=[-1.0, -0.2], static=[0.0, 0.0], contact=[0.0, 1.0], outputs={"first": [1.0, 0.0]}
        ... )
        >>> system = vibeam.ImpactSystem.from_structure(vibeam.modal(own, 1).structure, gap=1e-3, restitution=0.7)
        >>> system
        ImpactSystem(1 mode, omega 48.7496 rad/s, gap=0.001, restitution=0.7, outputs first)
        >>> vibeam.simulate(system, vibeam.Drive(omega=50.0, amplitude=1e-4), t_end=2.0)
        Trajectory(0 … 2 s, 1 mode, 10 impacts, 0 rests, COMPLETE)
        """
        if structure.contact_flexibility:
            from vibeam_models.laws.restitution import Restitution

            law = (law or Restitution(1.0)).in_series(structure.contact_flexibility)
        modes = structure.modes()
        damping = structure.modal_damping(modes)
        couples = _off_diagonal(damping) > DIAGONAL or np.any(np.diag(damping)[modes.omega == 0] > 0)
        safe = np.where(modes.omega > 0, modes.omega, 1.0)
        outputs = {name: row @ modes.shapes for name, row in structure.outputs.items()}
        return cls.from_modes(
            modes.omega,
            np.diag(damping) / (2 * safe),
            _unmoved(structure.contact @ modes.shapes, modes.omega),
            -(structure.load @ modes.shapes),
            gap=gap,
            restitution=restitution,
            outputs=outputs,
            static=structure.static @ modes.shapes,
            law=law,
            coupling=(damping + damping.T) / 2 if couples else None,
            second_gap=second_gap,
            further=None if not further else [Contact(outputs[name], *each) for name, each in further.items()],
        )


def _row(value: Any, n: int) -> Any:
    """Expand one number to n equal entries; anything else is returned unchanged."""
    row = read_only(value)
    if row is None:
        return value
    return np.full(n, row.ravel()[0]) if row.size == 1 and row.ndim < 2 else row


def _unmoved(contact: Array, omega: Array) -> Array:
    """Values of the modes at the contact, 0 where it is round-off of a rigid-body mode that leaves it at rest."""
    return np.where((omega == 0) & (np.abs(contact) <= ROUND_OFF * np.max(np.abs(contact))), 0.0, contact)


def _off_diagonal(matrix: Array) -> float:
    diagonal = np.diag(matrix)
    scale = np.sqrt(np.abs(np.outer(diagonal, diagonal)))
    rest = np.abs(matrix - np.diag(diagonal))
    return float(np.max(rest / np.where(scale > 0, scale, 1.0), initial=0.0))
