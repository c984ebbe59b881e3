"""A checker of certificates in interval arithmetic, from the equations of motion alone.

Per flight it takes the start (doubles, to the bit) and writes every mode in closed form with ball arithmetic
(python-flint): x(t) = particular solution + Re Σ C e^{λt}. On a piece the gap and its derivatives are enclosed by a
Taylor polynomial about the middle with the next derivative enclosed over the whole piece; modes that are too fast for
the piece enter by their amplitude. A piece is halved where the enclosure does not decide, at most ``DEPTH`` times.

A flight that starts on the stop has there a root of order m that is exact in the model and round-off in the doubles:
the derivatives below m are taken as zero, after a look that they are round-off, and g(t)/t^m is what must be positive.
"""

from __future__ import annotations

from math import factorial

import flint
import numpy as np
from flint import acb, arb

TERMS = 6
DEPTH = 60
ON_STOP = 2.0**-40
OPEN, CLOSES = 0.0, 1.0
GRANTED = 1e-12
FASTEST = 0.7  # |λ| times half a piece up to which a mode is expanded


class Flight:
    """The gap of one flight as a sum of exponentials, a polynomial and a harmonic, in ball arithmetic."""

    def __init__(self, system, drive, pose, clock):
        self.constant, self.slope, self.bend = arb(system.gap), arb(0), arb(0)  # gap part: a + b t + c t²
        self.waves = []  # (coefficient, λ) with value Re(coefficient e^{λt})
        self.ramps = []  # the same times t
        self.phase, self.w = arb(drive.omega) * arb(clock), arb(drive.omega)
        strength = self.w * self.w * arb(drive.amplitude)
        rows = zip(system.omega, system.zeta, system.contact, system.load, system.static, *pose, strict=True)
        for omega, zeta, contact, load, static, x, v in rows:
            if contact != 0:
                self.add(arb(omega), arb(zeta), arb(contact), arb(load) * strength, arb(static), arb(x), arb(v))

    def add(self, omega, zeta, contact, force, static, x, v):
        """One mode's part of −contact·η."""
        x0, v0 = arb(x), arb(v)
        if omega == 0:
            self.bend -= contact * static / 2
        elif static != 0:
            self.constant -= contact * static / omega**2
            x0 -= static / omega**2
        sigma = zeta * omega
        if force != 0:
            x0, v0 = self.drive(omega, sigma, contact, force, x0, v0)
        self.free(omega, zeta, sigma, contact, x0, v0)

    def drive(self, omega, sigma, contact, force, x0, v0):
        """The particular solution of force · sin(phase + wt), and what it leaves of the start."""
        lam = acb(0, self.w)
        turn = acb(self.phase.cos(), self.phase.sin()) * acb(0, -1)  # Re(turn e^{iwt}) = sin(phase + wt)
        if sigma == 0 and omega == self.w:
            part = turn * force / (2 * lam)  # t e^{iwt}: resonance
            self.ramps.append((-contact * part, lam))
            return x0, v0 - part.real
        part = turn * force / (acb(omega**2 - self.w**2) + 2 * sigma * lam)
        self.waves.append((-contact * part, lam))
        return x0 - part.real, v0 - (part * lam).real

    def free(self, omega, zeta, sigma, contact, x0, v0):
        """The free motion from (x0, v0)."""
        if omega == 0:
            self.constant -= contact * x0
            self.slope -= contact * v0
        elif zeta == 1:
            self.waves.append((acb(-contact * x0), acb(-sigma)))
            self.ramps.append((acb(-contact * (v0 + sigma * x0)), acb(-sigma)))
        else:
            root = acb(omega**2 * (zeta - 1) * (zeta + 1)).sqrt()
            first, second = -sigma + root, -sigma - root
            share = (v0 - second * x0) / (first - second)
            self.waves.append((-contact * share, first))
            self.waves.append((-contact * (x0 - share), second))

    def derivative(self, j, t, half=None):
        """g^{(j)}(t); with ``half`` without the waves too fast for a piece of that half length."""
        total = self.constant + t * (self.slope + t * self.bend) if j == 0 else arb(0)
        total += self.slope + 2 * t * self.bend if j == 1 else 2 * self.bend if j == 2 else 0
        for coefficient, lam in self.waves:
            if half is None or abs(lam) * half < FASTEST:
                total += (coefficient * lam**j * (lam * t).exp()).real
        for coefficient, lam in self.ramps:
            below = j * lam ** (j - 1) if j else acb(0)
            total += (coefficient * (t * lam**j + below) * (lam * t).exp()).real
        return total

    def fast(self, order, low, half):
        """Bound of the order-th derivative of the waves too fast for the piece, from ``low`` on."""
        rates = [(c, lam) for c, lam in self.waves if not abs(lam) * half < FASTEST]
        return sum((abs(c) * abs(lam) ** order * (lam.real * low).exp() for c, lam in rates), arb(0))

    def enclose(self, order, low, high):
        """A ball that holds g^{(order)} on [low, high]."""
        middle, half = (low + high) / 2, (high - low) / 2
        ball = ball_of(low, high)
        step, power, value = ball_of(-half, half), arb(1), arb(0)
        for j in range(TERMS + 1):
            value += self.derivative(order + j, middle if j < TERMS else ball, half) * power / factorial(j)
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

    def put_on_stop(self, order):
        """Take the gap's derivatives below ``order`` at the start for zero; whether they were round-off."""
        zero, size = arb(0), self.size()
        below = [self.derivative(j, zero) for j in range(order)]
        if order > 0:
            self.constant -= below[0]
        if order > 1:
            self.slope -= below[1]
        if order > 2:
            self.bend -= below[2] / 2
        rate = max([abs(lam) for _, lam in self.waves], key=lambda rate: rate.mid(), default=arb(1))
        return all(abs(value) <= ON_STOP * size * rate**j for j, value in enumerate(below))

    def size(self):
        """Of the gap's parts."""
        return abs(self.constant) + sum((abs(c) for c, _ in self.waves), arb(0))


def ball_of(low, high):
    """The ball from ``low`` to ``high``."""
    return low.union(high)


def is_open(flight, low, high, depth=DEPTH):
    """Whether g > 0 is proved on [low, high]."""
    if flight.enclose(0, low, high) > 0:
        return True
    if depth == 0 or flight.derivative(0, (low + high) / 2) <= 0:
        return False
    middle = (low + high) / 2
    return is_open(flight, low, middle, depth - 1) and is_open(flight, middle, high, depth - 1)


def lifts(flight, order, high, depth=DEPTH):
    """Whether g > 0 is proved on (0, high]."""
    if flight.lifting(order, high) > 0:
        return True
    return depth > 0 and lifts(flight, order, high / 2, depth - 1) and is_open(flight, high / 2, high)


def closes(flight, low, end, slack, depth=DEPTH):
    """Whether g is proved positive on [low, end − slack] and to pass zero once within ``slack`` of ``end``."""
    after = end + slack
    if not flight.derivative(0, after) < 0 or not flight.derivative(0, max_of(end - slack, low)) > 0:
        return False
    return falls(flight, low, end - slack, after, depth)


def falls(flight, low, before, after, depth):
    """Whether g > 0 on [low, s] and g' < 0 on [s, after] for some s ≤ before."""
    if flight.enclose(1, low, after) < 0:
        return True
    middle = (low + before) / 2
    return depth > 0 and is_open(flight, low, middle) and falls(flight, middle, before, after, depth - 1)


def max_of(a, b):
    """The larger of two balls, by their middles."""
    return a if a.mid() > b.mid() else b


def check(certificate, slack=1e-10, bits=200):
    """Faults found (a list of texts), and the number of pieces proved.

    ``slack``: how near to its written end a flight must close, relative to the flight's length; at least ``GRANTED`` of
    the slowest mode's time is granted to the doubles in which starts and ends are written.
    """
    flint.ctx.prec = bits
    faults, proved = [], 0
    for i in np.flatnonzero(~certificate.resting):
        pieces = certificate.pieces[certificate.pieces[:, 0] == i]
        if certificate.durations[i] > 0:
            faults += [f"flight {i}: {text}" for text in check_flight(certificate, i, pieces, slack)]
            proved += len(pieces)
    return faults, proved


def check_flight(certificate, i, pieces, slack):
    """Faults of one flight."""
    flight = Flight(certificate.system, certificate.drive, certificate.starts[i], certificate.clocks[i])
    duration, order = certificate.durations[i], int(certificate.orders[i])
    if not len(pieces):
        return ["no piece covers it"]
    if pieces[0, 1] != 0 or np.any(pieces[1:, 1] != pieces[:-1, 1] + pieces[:-1, 2]):
        return ["its pieces leave a hole"]
    if abs(pieces[-1, 1] + pieces[-1, 2] - duration) > 4e-16 * duration:
        return ["its pieces do not reach its end"]
    if not flight.put_on_stop(order):
        return ["it is said to start on the stop and does not"]
    moving = certificate.system.omega[certificate.system.omega > 0]
    least = GRANTED / min(moving) if len(moving) else 0.0
    return [text for piece in pieces for text in check_piece(flight, order, piece, max(slack * duration, least))]


def check_piece(flight, order, piece, slack):
    """Faults of one piece; a flight closes within ``slack`` s of its written end."""
    low, high, claim = arb(piece[1]), arb(piece[1]) + arb(piece[2]), piece[3]
    if claim == OPEN:
        good = lifts(flight, order, high) if order and piece[1] == 0 else is_open(flight, low, high)
        return [] if good else [f"not proved open on ({piece[1]}, {piece[1] + piece[2]}]"]
    if claim != CLOSES:
        return [f"nothing is claimed from {piece[1]} on"]
    if order and piece[1] == 0:
        low = high / 2
        if not lifts(flight, order, low):
            low = high / 1024
            if not lifts(flight, order, low):
                return ["not proved to lift"]
    return [] if closes(flight, low, high, arb(slack)) else [f"not proved to close at {float(high.mid())}"]
