"""Motion of n modes against stops that yield, to any number of digits, by Taylor series of the differential equation.

    η'' + D η' + ω² η = load Ω²B sin Ωt + static − Σ c F,    F = max(0, k d^p (1 + a d') + b d'),    d = c·η − gap > 0

with p = 1, a = 0 for a linear stop with damping b, and b = 0 for Hertz' and Hunt and Crossley's law. A second stop has
the row −c. Where p is no whole number the force has no Taylor series at d = 0: the motion is entered a time τ after the
crossing, so short that F is nothing to all digits, and steps shrink with the distance to the next such point, until the
force is nothing again. Nothing here is shared with the solvers, nor with ``events``.
"""

from __future__ import annotations

from dataclasses import dataclass

import gmpy2
import numpy as np
from gmpy2 import mpfr

ORDER = 50
FREE, PUSH, RETREAT = range(3)
SAME = 1e-12
SAMPLES = np.linspace(0.0, 1.0, 65)[1:]


@dataclass(frozen=True)
class Yielding:
    """A system: all numbers are taken exactly. ``damper`` (n, n), ``gaps`` of one stop or two."""

    omega: list
    damper: list
    contact: list
    load: list
    static: list
    gaps: list
    stiffness: float
    exponent: float = 1.0
    rate: float = 0.0  # a
    damping: float = 0.0  # b


@dataclass
class Motion:
    """A motion under way from ``place``, ``speed`` at ``time``; ``touches`` counts entries."""

    system: Yielding
    omega: float
    amplitude: float
    place: list
    speed: list
    time: float
    digits: int = 40

    def __post_init__(self):
        self.place, self.speed = [mpfr(x) for x in self.place], [mpfr(x) for x in self.speed]
        self.time, self.kind, self.side, self.touches = mpfr(self.time), FREE, 0, 0
        self.tiny = mpfr(10) ** (-self.digits)

    def run(self, end):
        """Carry it on to time ``end``; the state (2n) there."""
        end = mpfr(end)
        while self.time < end:
            series, force, h = self._series(end)
            met = self._event(series, force, h)
            s = h if met is None else met
            self.place = [value(x, s) for x in series]
            self.speed = [value(rates(x), s) for x in series]
            self.time = end if met is None and s >= end - self.time else self.time + s
            if met is not None or self.kind == PUSH:
                self._follow(met is not None)
        return self.place + self.speed

    def _row(self, side):
        return [mpfr(c) if side == 0 else -mpfr(c) for c in self.system.contact]

    def _depth(self, series, side):
        row = self._row(side)
        found = [sum(c * x[j] for c, x in zip(row, series, strict=True)) for j in range(len(series[0]))]
        found[0] -= mpfr(self.system.gaps[side])
        return found

    def _series(self, end):
        own, n, w = self.system, len(self.place), mpfr(self.omega)
        strength, row, stiff = (
            w * w * mpfr(self.amplitude),
            self._row(self.side),
            [mpfr(each) ** 2 for each in own.omega],
        )
        turn = [gmpy2.sin(w * self.time), gmpy2.cos(w * self.time)]
        x = [[a, b] for a, b in zip(self.place, self.speed, strict=True)]
        deep, power, pushed, scale = [], [], [], mpfr(1)
        for j in range(ORDER - 1):
            base = strength * scale * turn[j % 2] * (1, 1, -1, -1)[j % 4]
            scale = scale * w / (j + 1)
            if self.kind == PUSH:
                pushed.append(self._force(x, row, deep, power, j))
            for k in range(n):
                pull = own.load[k] * base - stiff[k] * x[k][j]
                pull += own.static[k] if j == 0 else 0
                pull -= sum(own.damper[k][i] * x[i][j + 1] for i in range(n) if own.damper[k][i]) * (j + 1)
                pull -= row[k] * pushed[j] if self.kind == PUSH else 0
                x[k].append(pull / ((j + 1) * (j + 2)))
        size = max(abs(each) for each in self.place + self.speed) + self.tiny
        h = end - self.time
        for k in range(n):
            for j in (ORDER - 1, ORDER):
                if x[k][j] != 0:
                    h = min(h, (self.tiny * size / abs(j * x[k][j])) ** (mpfr(1) / (j - 1)))
        return x, pushed, h

    def _force(self, x, row, d, power, j):
        """Coefficient j of F, from those of x up to j + 1."""
        own, p = self.system, mpfr(self.system.exponent)
        for i in range(len(d), j + 2):
            d.append(sum(c * each[i] for c, each in zip(row, x, strict=True)))
            d[0] -= mpfr(own.gaps[self.side]) if i == 0 else 0
        if p == 1:
            power.append(d[j])
        elif j == 0:
            power.append(d[0] ** p)
        else:
            weighed = sum(((p + 1) * i - j) * d[i] * power[j - i] for i in range(1, j + 1))
            power.append(weighed / (j * d[0]))
        found = mpfr(own.stiffness) * power[j] + mpfr(own.damping) * (j + 1) * d[j + 1]
        if own.rate:
            dashed = sum(power[j - i] * (i + 1) * d[i + 1] for i in range(j + 1))
            found += mpfr(own.stiffness) * mpfr(own.rate) * dashed
        return found

    def _event(self, series, force, h):
        """First root in (0, h] of what ends the regime, None without one."""
        if self.kind == FREE:
            found = [(root(self._depth(series, side), h, 1), side) for side in range(len(self.system.gaps))]
            found = [(s, side) for s, side in found if s is not None]
            if not found:
                return None
            s, self.side = min(found)
            return s
        if self.kind == RETREAT:
            return root(self._depth(series, self.side), h, -1)
        if self.system.exponent == 1 and self.system.damping:
            return root(force, h, -1)
        if self.system.exponent == 1:
            return root(self._depth(series, self.side), h, -1)
        return None

    def _follow(self, met):
        row = self._row(self.side)
        deep = sum(c * x for c, x in zip(row, self.place, strict=True)) - mpfr(self.system.gaps[self.side])
        rate = sum(c * v for c, v in zip(row, self.speed, strict=True))
        if self.kind == FREE:
            if self.system.exponent != 1:
                self._on(mpfr(10) ** (-self.digits // 2) / mpfr(max(self.system.omega) + self.omega))
            self.kind, self.touches = PUSH, self.touches + 1
        elif self.kind == RETREAT:
            self.kind = FREE
        elif self.system.exponent == 1:
            self.kind = RETREAT if met and self.system.damping else FREE if met else PUSH
        elif rate < 0 and deep < -rate * mpfr(10) ** (-self.digits // 2):
            self.kind = FREE

    def _on(self, tau):
        series, _, _ = self._series(self.time + tau)
        self.place, self.speed = [value(x, tau) for x in series], [value(rates(x), tau) for x in series]
        self.time += tau


def value(poly, s):
    """Value of a polynomial."""
    total = mpfr(0)
    for c in reversed(poly):
        total = total * s + c
    return total


def rates(poly):
    """Coefficients of the derivative."""
    return [j * c for j, c in enumerate(poly)][1:]


def root(poly, h, sign):
    """First place in (0, h] where sign·poly rises through 0, by samples and Newton's method; None without one.

    A start at 0 to a third of all digits is a crossing just passed.
    """
    scaled = np.array([float(c * h**j) for j, c in enumerate(poly)])
    if abs(scaled[0]) < SAME * np.abs(scaled).max():
        scaled[0] = 0.0
    at = sign * np.polyval(scaled[::-1], SAMPLES)
    before = np.concatenate([[sign * scaled[0]], at[:-1]])
    rises = np.flatnonzero((before < 0) & (at >= 0))
    if not len(rises):
        return None
    s, slope = h * mpfr(float(SAMPLES[rises[0]])), rates(poly)
    for _ in range(60):
        change = value(poly, s) / value(slope, s)
        s -= change
        if abs(change) <= abs(s) * mpfr(10) ** (-int(gmpy2.get_context().precision * 0.28)):
            break
    return s


def flown(system, drive, state, begin, end, digits=40):
    """State (2n) at ``end`` from ``state`` (2n) at ``begin``, and the number of touches; drive = (omega, amplitude)."""
    n = len(system.omega)
    with gmpy2.context(precision=int(digits * 3.33) + 20):
        motion = Motion(system, *drive, state[:n], state[n:], begin, digits)
        return motion.run(end), motion.touches


def tangent(system, drive, state, begin, end, digits=40):
    """Map (2n, 2n) by central differences of two flights a direction, 10^(−digits/3) apart."""
    with gmpy2.context(precision=int(digits * 3.33) + 20):
        small, columns = mpfr(10) ** (-digits // 3), []
        for k in range(len(state)):
            ends = []
            for way in (1, -1):
                start = [mpfr(x) + (way * small if i == k else 0) for i, x in enumerate(state)]
                ends.append(flown(system, drive, start, begin, end, digits)[0])
            columns.append([float((a - b) / (2 * small)) for a, b in zip(*ends, strict=True)])
    return np.array(columns).T
