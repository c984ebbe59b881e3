"""Rows of a system with more to them: a further stop, elsewhere or across; an output that is a time derivative."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam_models.arguments import number, read_only, refuse, shown
from vibeam_models.arrays import Array, ValueRecord

if TYPE_CHECKING:
    from vibeam_models.laws.mechanics import StopLaw


@dataclass(frozen=True, eq=False, repr=False)
class Contact(ValueRecord):
    """A stop at Σ row_i η_i = ``gap`` (m), ``row`` (n,) positive toward it, with a coefficient of ``restitution``.

    ``law``: R(v) in its place, or a stop that yields and pushes with a force (``vibeam_models``). ValueError names
    every argument that is wrong: a row that is not finite numbers or all zero, a gap that is not finite, a restitution
    outside [0, 1], a law that is none.

    >>> import vibeam
    >>> sides = [vibeam.Contact([-1.0], gap=0.2, restitution=0.5)]  # a second stop, opposite
    >>> vibeam.ImpactSystem.from_modes(1.0, 0.0, 1.0, 1.0, gap=0.1, further=sides).further[0].gap
    0.2
    """

    row: Array
    gap: float
    restitution: float = 1.0
    law: StopLaw | None = None

    def __post_init__(self) -> None:
        faults: list[str] = []
        row = read_only(self.row)
        if row is None or row.ndim != 1 or not row.size or not np.isfinite(row).all() or not row.any():
            faults.append("row: must be finite numbers, one a mode, not all zero")
        gap = number("gap", self.gap, faults)
        coefficient = number("restitution", self.restitution, faults, least=0.0, most=1.0)
        law, coefficient = checked_law(self.law, coefficient, faults)
        refuse("contact", faults)
        self.__dict__.update(row=row, gap=gap, restitution=coefficient, law=law)

    @property
    def contact_law(self) -> StopLaw:
        """Law of the contact: ``law``, or one coefficient of restitution."""
        from vibeam_models.laws.restitution import Restitution

        return Restitution(self.restitution) if self.law is None else self.law


def checked_law(given: Any, restitution: Any, faults: list[str]) -> tuple[Any, Any]:
    """Check the contact law beside the coefficient of restitution; a constant one stands for its coefficient."""
    if given is None:
        return None, restitution
    from vibeam_models.laws.mechanics import stop_law

    law = stop_law(given)
    if law is None:
        faults.append(f"law: {shown(given)} is no contact law of vibeam_models.laws")
    elif law.constant is not None:
        return None, law.constant
    return law, restitution


CALLED = {1: "velocity", 2: "acceleration"}


@dataclass(frozen=True, eq=False, repr=False)
class TimeDerivative(ValueRecord):
    """The output row·η' (``order`` 1, m/s) or row·η'' + base·b̈ (``order`` 2, m/s²), ``row`` (n,).

    b̈ = −Ω²B sin Ωt is the acceleration of the base: with ``base`` = 1 an acceleration is absolute, as an accelerometer
    reads it. Accelerations are those of flight, rest and lasting contact, whose force they include; the impulses of a
    rigid stop, infinite for no time, are not among them. ValueError for another order, a row that is not finite, or
    a ``base`` with a velocity.

    >>> import vibeam
    >>> speed = vibeam.TimeDerivative([1.0], order=1)
    >>> vibeam.ImpactSystem.from_modes(1.0, 0.0, 1.0, 1.0, derivatives={"speed": speed}).derivative("speed").called
    'velocity'
    """

    row: Any
    order: int
    base: float = 0.0

    def __post_init__(self) -> None:
        faults: list[str] = []
        row = read_only(self.row)
        if row is None or row.ndim != 1 or not np.isfinite(row).all():
            faults.append("row: must be finite numbers, one a mode")
        if self.order not in CALLED:
            faults.append(f"order: {self.order!r} must be 1, a velocity, or 2, an acceleration")
        object.__setattr__(self, "row", row)
        object.__setattr__(self, "base", number("base", self.base, faults))
        if self.order == 1 and self.base:
            faults.append("base: goes with an acceleration alone: velocities are relative to the base")
        refuse("derivative", faults)

    def taking(self, modes: Any) -> TimeDerivative:
        """The same read from some of the modes, or from these in another order."""
        return replace(self, row=self.row[modes])

    @property
    def called(self) -> str:
        """Name of the derivative."""
        return CALLED[self.order]
