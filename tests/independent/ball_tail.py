"""Bounds of what an endless series of impacts still takes, in ball arithmetic.

After an impact that throws the contact off at u₀, with the contact's acceleration a towards the stop: a flight that
starts at u with a in [a⁻, a⁺] lasts 2u/a⁺ to 2u/a⁻ and comes back at u/ρ to uρ, ρ² = a⁺/a⁻. With R in [r, R] < 1/ρ:

    (2u₀/a⁺) / (1 − r/ρ)  ≤  T  ≤  (2u₀/a⁻) / (1 − Rρ)

The impacts to come change a: impulses that sum up to P move the other modes, in the norm √(Σ ω²x² + x'²) that free
motion never raises, by P√S at most, so a = c·η'' by √(|Dc|² + Σ ω²c²) P√S; and S P ≤ (1 + R) u₀ρ/(1 − Rρ). Bounds
that follow from themselves with room to spare hold by induction from impact to impact.

With R = 1 − κv^b, b < 1, R tends to 1 and ρ must too: over a flight a changes by J 2u/a⁻ at most, J a bound of the
jerk, so ρ ≤ 1 + θu, θ = J/a⁻²; launch velocities fall by u κ'u^b at least and u κ''u^b at most, κ', κ'' = κ ∓
θu₀^{1−b}, and summed up like the integral of u^{−b}/κ:

    (1 − κ''u₀^b)^b u₀^{1−b}/(κ''(1 − b))  ≤  Σ u  ≤  u₀^{1−b}/(κ'(1 − b))
"""

from __future__ import annotations

from flint import arb

GRANTED = 2  # times the first estimate: the room within which the bounds must hold


def tail_bounds(own, law, restitution, gap, side, speed):
    """Least and most time (balls) after an impact that leaves at ``speed``, ``gap`` the signal then; or None."""
    a = -gap.derivative(2, arb(0))
    low, high = rates(law, restitution, 2 * speed)
    if not (a > 0 and speed > 0):
        return None
    viscous = low is None
    kappa, b = (arb(law.factor), arb(law.exponent)) if viscous else (arb(0), arb(0))
    share = kappa * (1 - b) * speed**b if viscous else 1 - high
    if not share > 0:
        return None
    most, impulse = GRANTED * 2 * speed / (a * share), GRANTED * 2 * speed / (own.mobility * share)
    drawn = -gap.enclose(2, arb(0), most)
    swayed = stiffness(own, side, 1) * impulse * own.mobility.sqrt()
    least_a, most_a = lower(drawn) - swayed, upper(drawn) + swayed
    if not least_a > 0:
        return None
    if viscous:
        jerk = upper(abs(gap.enclose(3, arb(0), most))) + stiffness(own, side, 2) * impulse * own.mobility.sqrt()
        sums = viscous_sums(kappa, b, speed, jerk / least_a**2)
        if sums is None:
            return None
        found, given = (2 * sums[0] / most_a, 2 * sums[1] / least_a), 2 * sums[1] * (1 + speed * jerk / least_a**2)
    else:
        rho = (most_a / least_a).sqrt()
        if not (1 - high * rho > 0 and rho < 2):
            return None
        found = 2 * speed / most_a / (1 - low / rho), 2 * speed / least_a / (1 - high * rho)
        given = (1 + high) * speed * rho / (1 - high * rho)
    return found if found[1] < most and given < impulse * own.mobility else None


def rates(law, restitution, speed):
    """Least and largest R up to a speed; (None, None) of one that tends to 1."""
    if law is None:
        return arb(restitution), arb(restitution)
    if hasattr(law, "factor"):
        return None, None
    if not hasattr(law, "speeds"):
        return arb(1), arb(1)
    count = next((i + 1 for i, v in enumerate(law.speeds) if v >= speed), len(law.speeds))
    return arb(min(law.coefficients[:count])), arb(max(law.coefficients[:count]))


def viscous_sums(kappa, b, speed, theta):
    """Least and largest sum of the launch velocities."""
    weaker, stronger = kappa - theta * speed ** (1 - b), kappa + theta * speed ** (1 - b)
    if not (weaker > 0 and stronger * speed**b < 1 and theta * speed < 1):
        return None
    whole = speed ** (1 - b) / (1 - b)
    return (1 - stronger * speed**b) ** b * whole / stronger, whole / weaker


def stiffness(own, side, order):
    """By how much a state of energy norm 1 moves c·η'' (order 1), at most c·η''' (order 2)."""
    row = own.stops[side][0]
    braked = [sum((own.damper[i][k] * row[k] for k in range(own.n)), arb(0)) for i in range(own.n)]
    bent = [o * c for o, c in zip(own.omega, row, strict=True)]
    norm = sum((x * x for x in braked + bent), arb(0)).sqrt()
    if order == 1:
        return norm
    rate = max((abs(o) for o in own.omega), key=lambda o: o.mid())
    rate += sum((abs(x) for line in own.damper for x in line), arb(0))
    return 2 * norm * rate


def lower(ball):
    """Its lower end."""
    return ball.mid() - ball.rad()


def upper(ball):
    """Its upper end."""
    return ball.mid() + ball.rad()
