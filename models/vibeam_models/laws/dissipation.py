"""Restitution of a free mass by the damping of its contact, for the forces that other programs have, and back.

With the depth d, its rate u, stiffness k, exponent p and mass m the force is k d^p and beside it

    pushing   2 ζ s √(k m) d^{(p−1)/2} u, s² = (p + 1)/2, and zero wherever the sum would pull
    bound     the same, which pulls at the end, until d = 0
    loading   the same while u > 0, nothing while u < 0
    product   a u k d^p (Hunt and Crossley)
    limited   2 ζ √(k m) u for p = 1, but never larger than the spring's force

The first three are a linear oscillator each: with q = d^{(p+1)/2} and dτ = √(k/m) d^{(p−1)/2} dt, q″ + 2 ζ s q′ + s² q
= 0 (Antypov & Elliott, EPL 94 (2011) 50004, for p = 3/2; Feng, arXiv:2603.27764 (2026), for all p). So R depends on ζ
alone, neither on the speed nor on p.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import atan, atanh, cos, cosh, exp, log, pi, sin, sinh, sqrt

from vibeam_models.laws.compliant import contact_damping_ratio, hunt_crossley_product, linear_restitution
from vibeam_models.laws.free_impact import product_restitution

SINGULAR = 1e-9  # distance from ζ = 1 at which limits are taken


def bound_restitution(zeta: float) -> float:
    """R = e^{−πζ/√(1−ζ²)} of a damper that pulls too; 0 from ζ = 1 on."""
    return exp(-pi * zeta / sqrt(1 - zeta**2)) if zeta < 1 else 0.0


def bound_damping_ratio(restitution: float) -> float:
    """ζ = −ln R/√(π² + ln² R), of R > 0."""
    return -log(restitution) / sqrt(pi**2 + log(restitution) ** 2)


def limited_restitution(zeta: float) -> float:
    """R of k d + c u with |c u| ≤ k d: 2 k d until c u = k d, from there linear until nothing is left of the force.

    With k = m = v = 1 the first part ends where tan √2 t = 2√2 ζ. There u = d/2ζ, as in a linear oscillator at the
    phase tan w t = 2ζw/(1 + 2ζ²), w² = 1 − ζ², whose R is known.
    """
    zeta = zeta if abs(zeta - 1) > SINGULAR else 1 + SINGULAR
    w, speed = sqrt(abs(1 - zeta) * (1 + zeta)), 1 / sqrt(1 + 8 * zeta**2)  # speed: cos √2 t
    turns = (atan, cos, sin) if zeta < 1 else (atanh, cosh, sinh)
    turn = turns[0](2 * zeta * w / (1 + 2 * zeta**2))
    return linear_restitution(zeta) * speed * exp(zeta * turn / w) / (turns[1](turn) - zeta / w * turns[2](turn))


def _damped(depth: float, rate: float, exponent: float, zeta: float) -> float:
    return float(depth**exponent + zeta * sqrt(2 * (exponent + 1)) * depth ** ((exponent - 1) / 2) * rate)


@dataclass(frozen=True)
class Dissipation:
    """Kind of damping: R by its ``strength``, ζ or x = a v, and back; its ``force`` for k = m = 1.

    ``force`` is of depth, rate, exponent and strength. ``lets_go``: the contact ends where that is zero, else where the
    depth is.
    """

    restitution: Callable[[float], float]
    strength: Callable[[float], float]
    force: Callable[[float, float, float, float], float] = _damped
    lets_go: bool = False

    def duration(self, exponent: float, strength: float) -> float:
        """Contact time of the impact at speed 1 with k = m = 1, integrated to about 10⁻⁹."""
        from scipy.integrate import solve_ivp

        def pushed(depth: float, rate: float) -> float:
            return self.force(max(depth, 0.0), rate, exponent, strength)

        def left(_: float, state: tuple[float, float]) -> float:
            return pushed(*state) if self.lets_go and state[1] < 0 else state[0]

        left.terminal, left.direction = True, -1  # type: ignore[attr-defined]
        moved = solve_ivp(
            lambda _, state: (state[1], -pushed(*state)), (0.0, 1e6), (0.0, 1.0), "DOP853", events=left, rtol=1e-10,
            atol=1e-12,
        )  # fmt: skip
        return float(moved.t_events[0][0])


KINDS: Mapping[str, Dissipation] = {
    "pushing": Dissipation(linear_restitution, contact_damping_ratio, lets_go=True),
    "bound": Dissipation(bound_restitution, bound_damping_ratio),
    "loading": Dissipation(  # turns at the depth of the damped oscillator, elastic from there
        lambda zeta: sqrt(linear_restitution(zeta)),
        lambda restitution: contact_damping_ratio(restitution**2),
        lambda depth, rate, *law: _damped(depth, max(rate, 0.0), *law),
    ),
    "product": Dissipation(
        product_restitution, hunt_crossley_product, lambda depth, rate, p, x: float(depth**p * (1 + x * rate))
    ),
    "limited": Dissipation(
        limited_restitution,
        lambda restitution: contact_damping_ratio(restitution, limited_restitution),
        lambda depth, rate, _, zeta: depth + min(2 * zeta * rate, depth),
        lets_go=True,
    ),
}
