"""A signal in ball arithmetic (python-flint): polynomial + Σ Re C e^{λt} + Σ Re C t e^{λt}, and what encloses it.

On a piece the signal and its derivatives are enclosed by a Taylor polynomial about the middle with the next derivative
enclosed over the whole piece; exponentials that are too fast for the piece enter by their amplitude.
"""

from __future__ import annotations

from math import factorial

from flint import acb, arb

TERMS = 6
ON_STOP = 2.0**-40
FASTEST = 0.7  # |λ| times half a piece up to which an exponential is expanded


class Signal:
    """constant + slope t + bend t² + Σ Re(C e^{λt}) over ``waves`` + Σ Re(C t e^{λt}) over ``ramps``."""

    def __init__(self, constant=0, slope=0, bend=0, waves=(), ramps=()):
        self.constant, self.slope, self.bend = arb(constant), arb(slope), arb(bend)
        self.waves, self.ramps = list(waves), list(ramps)

    def add(self, factor, other):
        """Add ``factor`` times another signal to this one."""
        if factor != 0:
            self.constant += factor * other.constant
            self.slope += factor * other.slope
            self.bend += factor * other.bend
            for c, lam in other.waves:
                self.add_wave(factor * c, lam)
            self.ramps += [(factor * c, lam) for c, lam in other.ramps]

    def add_wave(self, coefficient, lam):
        """Add Re(C e^{λt}), to one of the very same λ where there is one: steady responses of all modes have Ω's."""
        for i, (c, other) in enumerate(self.waves):
            if other is lam:
                self.waves[i] = c + coefficient, lam
                return
        self.waves.append((coefficient, lam))

    def rate(self):
        """The derivative as a signal."""
        waves = [(c * lam, lam) for c, lam in self.waves] + self.ramps
        return Signal(self.slope, 2 * self.bend, 0, waves, [(c * lam, lam) for c, lam in self.ramps])

    def derivative(self, j, t, half=None):
        """The j-th derivative at t; with ``half`` without the waves too fast for a piece of that half length."""
        total = self.derivative_of_polynomial(j, t)
        for coefficient, lam in self.waves:
            if half is None or abs(lam) * half < FASTEST:
                total += (coefficient * lam**j * (lam * t).exp()).real
        for coefficient, lam in self.ramps:
            below = j * lam ** (j - 1) if j else acb(0)
            total += (coefficient * (t * lam**j + below) * (lam * t).exp()).real
        return total

    def derivative_of_polynomial(self, j, t):
        """The j-th derivative of constant + slope t + bend t²."""
        if j == 0:
            return self.constant + t * (self.slope + t * self.bend)
        return self.slope + 2 * t * self.bend if j == 1 else 2 * self.bend if j == 2 else arb(0)

    def derivatives(self, first, count, t, half):
        """``count`` derivatives at t from the ``first`` on, as ``derivative`` gives them one by one."""
        found = [self.derivative_of_polynomial(first + j, t) for j in range(count)]
        for coefficient, lam in self.waves:
            if abs(lam) * half < FASTEST:
                term = coefficient * lam**first * (lam * t).exp()
                for j in range(count):
                    found[j] += term.real
                    term *= lam
        for coefficient, lam in self.ramps:
            term = coefficient * (lam * t).exp()
            for j in range(first, first + count):
                found[j - first] += (term * (t * lam**j + (j * lam ** (j - 1) if j else 0))).real
        return found

    def least(self, low):
        """A bound from below from ``low`` on: constant less every wave's size there; None where a part may grow."""
        steady = self.slope == 0 and self.bend == 0 and not self.ramps
        if not (steady and all(lam.real <= 0 for _, lam in self.waves)):
            return None
        return self.constant - sum((abs(c) * (lam.real * low).exp() for c, lam in self.waves), arb(0))

    def fast(self, order, low, half):
        """Bound of the order-th derivative of the waves too fast for the piece, from ``low`` on."""
        rates = [(c, lam) for c, lam in self.waves if not abs(lam) * half < FASTEST]
        return sum((abs(c) * abs(lam) ** order * (lam.real * low).exp() for c, lam in rates), arb(0))

    def enclose(self, order, low, high):
        """A ball that holds the order-th derivative on [low, high]."""
        middle, half = (low + high) / 2, (high - low) / 2
        ball = ball_of(low, high)
        step, power, value = ball_of(-half, half), arb(1), arb(0)
        terms = [*self.derivatives(order, TERMS, middle, half), self.derivative(order + TERMS, ball, half)]
        for j, term in enumerate(terms):
            value += term * power / factorial(j)
            power *= step
        hidden = self.fast(order, low, half)
        return value + ball_of(-hidden, hidden)

    def lifting(self, order, high):
        """A ball that holds g(t)/t^order on [0, high], its derivatives below ``order`` being zero."""
        t, zero = ball_of(arb(0), high), arb(0)
        value, power = arb(0), arb(1)
        for j in range(order, order + TERMS + 1):
            value += self.derivative(j, zero if j < order + TERMS else t, high) * power / factorial(j)
            power *= t
        hidden = self.fast(order, zero, high) / factorial(order)
        return value + ball_of(-hidden, hidden)

    def put_on_root(self, order, size):
        """Take the derivatives below ``order`` at the start for zero; whether they were round-off of ``size``."""
        zero = arb(0)
        below = [self.derivative(j, zero) for j in range(order)]
        if order > 0:
            self.constant -= below[0]
        if order > 1:
            self.slope -= below[1]
        if order > 2:
            self.bend -= below[2] / 2
        rate = max([abs(lam) for _, lam in self.waves], key=lambda rate: rate.mid(), default=arb(1))
        return all(abs(value) <= ON_STOP * (size + self.size()) * rate**j for j, value in enumerate(below))

    def size(self):
        """Of the signal's parts."""
        return abs(self.constant) + sum((abs(c) for c, _ in self.waves), arb(0))


def ball_of(low, high):
    """The ball from ``low`` to ``high``."""
    return low.union(high)
