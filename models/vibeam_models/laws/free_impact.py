"""Impact of a free mass on a stop that yields, in closed form up to one integral: contact time, indentation, force.

Linear, m d″ + c d′ + k d = 0 with ω = √(k/m), ζ = c/2√(km) = cos θ: contact ends after 2θ/(ω sin θ), the depth is
(v/ω) e^{−θ cot θ} and the force m v ω e^{−(3θ−π) cot θ} where ζ < ½, else c v at once.

Hunt–Crossley, m u du = −k d^p (1 + a u) dd with u = d′: k d^{p+1}/(p + 1) = m (G(v) − G(u)), with
G(u) = u/a − ln(1 + a u)/a², ½u² without loss. The time is ∫ m du / (k d^p (1 + a u)) from −R v to v: without loss
Hertz's 2.943 d/v for p = 3/2 (Johnson, *Contact Mechanics*, eq. 11.24).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import acos, acosh, exp, inf, log1p, sqrt, tan, tanh

NEAR = 1e-7  # of the ends of an impact, as a share of its speed


@dataclass(frozen=True)
class FreeImpact:
    """Impact of a free mass: ``duration`` s, ``depth`` m, largest ``force`` N, ``restitution`` R."""

    duration: float
    depth: float
    force: float
    restitution: float


def linear_impact(stiffness: float, damping: float, mass: float, speed: float) -> FreeImpact:
    """Impact on k d + c d′, N/m and N s/m, of a ``mass`` in kg at a ``speed`` in m/s."""
    omega = sqrt(stiffness / mass)
    zeta = damping / (2 * sqrt(stiffness * mass))
    if zeta == 1:
        turn, cot, time = 1.0, 1.0, 2 / omega
    elif zeta < 1:
        turn = acos(zeta)
        cot, time = 1 / tan(turn), 2 * turn / (omega * sqrt(1 - zeta**2))
    else:
        turn = acosh(zeta)
        cot, time = 1 / tanh(turn), 2 * turn / (omega * sqrt(zeta**2 - 1))
    force = mass * omega * exp(-(3 * acos(zeta) - acos(-1)) * cot) if zeta < 0.5 else damping
    return FreeImpact(time, speed / omega * exp(-turn * cot), force * speed, exp(-2 * turn * cot))


def hunt_crossley_impact(stiffness: float, loss: float, exponent: float, mass: float, speed: float) -> FreeImpact:
    """Impact on k d^p (1 + a d′), N/m^p and s/m, of a ``mass`` in kg at a ``speed`` in m/s."""
    from scipy.integrate import quad
    from scipy.optimize import minimize_scalar

    x, power = loss * speed, exponent + 1

    def left(u: float) -> float:  # (G(v) − G(u))/v² at u v
        return hunt_crossley_loss(x, -u)

    back = product_restitution(x)
    scale = (power * mass * speed**2 / stiffness) ** (1 / power)  # depth d = scale · left^{1/(p+1)}

    side = -exponent / power

    def smooth(u: float) -> float:  # the integrand without its singular ends, where it has no digits of its own
        inside = min(max(u, -back + NEAR), 1 - NEAR)
        return float((left(inside) / ((1 - inside) * (inside + back))) ** side / (1 + x * inside))

    inside = quad(smooth, -back, 1.0, weight="alg", wvar=(side, side), epsrel=1e-10, limit=400)[0]

    def force(u: float) -> float:
        return float(stiffness * scale**exponent * max(left(u), 0.0) ** (exponent / power) * (1 + x * u))

    most = minimize_scalar(lambda u: -force(u), bounds=(-back, 1.0), method="bounded", options={"xatol": 1e-10})
    time = mass * speed / (stiffness * scale**exponent) * inside
    return FreeImpact(float(time), float(scale * left(0.0) ** (1 / power)), float(-most.fun), back)


def product_restitution(product: float) -> float:
    """R of Hunt and Crossley's law by x = a v: x (1 + R) = ln((1 + x)/(1 − x R))."""
    return falling_zero(lambda restitution: hunt_crossley_loss(product, restitution), 0.0, 1.0) if product else 1.0


def hunt_crossley_loss(x: float, restitution: float) -> float:
    """(x (1 + R) − ln((1 + x)/(1 − xR))) / x², a power series where x is small; falls with R."""
    if x < 0.05:
        return float(-sum(x ** (j - 2) * (restitution**j - (-1) ** j) / j for j in range(2, 16)))
    inside = -x * restitution
    return float((x * (1 + restitution) - log1p(x) + (log1p(inside) if inside > -1 else -inf)) / x**2)


def falling_zero(function: Callable[[float], float], low: float, high: float) -> float:
    """The zero of a falling function, to the last digit."""
    for _ in range(200):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        low, high = (middle, high) if function(middle) > 0 else (low, middle)
    return (low + high) / 2
