"""Mechanics of a stop: capabilities of a contact law, each declared where the law is and asked for where it is used.

A rigid stop turns the contact's velocity round in an instant, v⁺ = −R(v) v⁻; one that yields lasts, and pushes with a
force F(d, d′). A law says what it knows: it needs ``name`` and, where it is rigid, ``at``. A room that asks for more is
refused by the law's name, with the cure; which room asks for what is on this package's page.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, Literal, NamedTuple

import numpy as np

from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam_models.laws.free_impact import FreeImpact

RIGID = "its mobility is infinite, so that an impulse and a coefficient of restitution have no meaning"


class Spring(NamedTuple):
    """A force k d + c d′ in a contact: ``stiffness`` k, N/m, and ``damping`` c, N s/m."""

    stiffness: float
    damping: float


@dataclass(frozen=True)
class KernelNumbers:
    """A law as the flight kernels know it: one of their formulas and its numbers, by the names of their rows.

    ``table``: (3, m) speeds, R and dR/dv of the formula "table".
    """

    formula: Literal["constant", "table", "plastic", "viscous", "linear", "hunt-crossley"]
    values: Mapping[str, float] = field(default_factory=dict)
    table: Array | None = None


class StopLaw(ABC):
    """Mechanics of a stop: a contact law as solvers ask it.

    ``yields``: the contact lasts and pushes with a force, else it is an instant. ``integrated``: the contact's motion
    has no closed form and is integrated step by step.
    """

    yields: ClassVar[bool] = False
    integrated: ClassVar[bool] = False

    @property
    @abstractmethod
    def name(self) -> str:
        """Law as a case's stop names it, and messages do."""

    @property
    def constant(self) -> float | None:
        """Coefficient of restitution where it is the same at every velocity; None elsewhere."""
        return None

    @property
    def spring(self) -> Spring | None:
        """Spring and damper where it pushes linearly, so that its contact has a closed form; None elsewhere."""
        return None

    @property
    def converges(self) -> bool:
        """True where impacts that lose less and less, R → 1, still come to an end, as with 1 − R ~ v^b, b < 1."""
        return False

    def kernel_numbers(self) -> KernelNumbers:
        """The kernels' formula and its numbers; ValueError where they have none."""
        cure = "let its contact give TableRestitution.through(law.at, speeds), or take the solver 'direct'"
        if self.yields:
            cure = "let its contact give a LinearStop or a HuntCrossley"
        raise self._lacking("formula in the kernels of exact flight", cure)

    def at(self, velocity: float) -> float:
        """R at an impact velocity ≥ 0, m/s; ValueError for a stop that yields."""
        raise self._lacking("coefficient of restitution R(v)", "its contact lasts: take a rigid law")

    def rebound(self, speeds: Array) -> Array:
        """Contact velocities R(v) v after impacts at ``speeds`` v, m/s."""
        return np.array([self.at(float(speed)) for speed in speeds]) * speeds

    @property
    def has_slope(self) -> bool:
        """True where the law has a ``rebound_slope``."""
        return type(self).rebound_slope is not StopLaw.rebound_slope

    def rebound_slope(self, speeds: Array) -> Array:
        """Derivatives d(R(v) v)/dv of ``rebound`` by the impact velocity."""
        raise self._lacking("derivative of R(v) v", "let the law have rebound_slope, or its contact give a table")

    def coefficients_up_to(self, speeds: Array) -> tuple[Array, Array]:
        """Least and largest R at velocities up to ``speeds``; 1 where nothing is known, which bounds nothing."""
        return np.ones(len(speeds)), np.ones(len(speeds))

    def accumulation_loss(self, speeds: Array) -> Array:
        """Share of the sum 2u/(a·share) of an accumulation's flights, with R at its largest: 1 − R or less."""
        return np.asarray(1 - self.coefficients_up_to(2 * speeds)[1])

    def accumulation(self, speed: Array, least: Array, most: Array, jerk: Array) -> tuple[Array, Array, Array]:
        """Least and most time of an accumulation from launch at ``speed`` u₀, and the most of its change of velocity.

        The contact's acceleration towards the stop stays between ``least`` a⁻ and ``most`` a⁺, ``jerk`` bounds its
        rate. NaN where there is no bound. Formulas: ``vibeam.flight.proof.chatter_tail``.
        """
        low, high = self.coefficients_up_to(2 * speed)
        ratio = np.sqrt(most / least)
        loss = np.where((high * ratio < 1) & (ratio < 2), 1 - high * ratio, np.nan)
        shortest = 2 * speed / most / (1 - low / ratio)
        return shortest, 2 * speed / least / loss, (1 + high) * speed * ratio / loss

    def force(self, depth: Array, rate: Array) -> Array:
        """Contact force, N, at penetrations ``depth`` ≥ 0, m, and their rates; ValueError for a rigid stop."""
        raise self._lacking("contact force", "a rigid stop has an impulse: take a law that yields")

    def balance(self, beyond: float, give: float) -> float:
        """The static force F, N, with penetration d = beyond − give F, ``beyond`` m into the stop and ``give`` m/N."""
        raise self._lacking("static contact force", "let the law have balance, or its contact give a HuntCrossley")

    def free_impact(self, mass: float, speed: float) -> FreeImpact:
        """Contact time, indentation, force and R of a free ``mass``, kg, at a ``speed``, m/s; ValueError when rigid."""
        raise self._lacking("contact time", "a rigid stop is met in an instant: take a law that yields")

    def in_series(self, flexibility: float) -> StopLaw:
        """The linear stop with a spring of ``flexibility`` g (m/N) before it, as a contact without mass has: 1/k + g.

        ValueError for a law that has no such form.
        """
        closed = f'the law "{self.name}" in series with a spring has no closed form' if self.yields else RIGID
        raise without_mass(closed)

    def _lacking(self, what: str, cure: str) -> ValueError:
        return ValueError(f'the contact law "{self.name}" has no {what}: {cure}')


def without_mass(why: str) -> ValueError:
    """The refusal of a stop that a reduction leaves without mass."""
    return ValueError(
        f'contact without mass: {why}: write reduction = "residual_flexibility", or a stop with law = "linear" and '
        'damping = "0 N s/m"'
    )


def stop_law(given: object) -> StopLaw | None:
    """``given`` where it is the mechanics of a stop; None elsewhere."""
    return given if isinstance(given, StopLaw) else None
