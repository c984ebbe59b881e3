"""Motion of n modes under a piecewise polynomial load among several stops, to any number of digits, by Taylor series.

    η'' + D η' + ω² η = load u(t) + static − Σ_j row_j F_j,      u(t_i + s) = Σ_k a_ik s^k on t_i ≤ t < t_{i+1}, else 0
    a hard stop:   row·η' → −R row·η' at row·η = gap, η'⁺ = η'⁻ − row (1+R) v⁻/row²;  at rest F holds row·η = gap
    a linear stop: F = max(0, k d + b d'), d = row·η − gap > 0

Every stretch lies within a piece of the load and within one set of stops that hold or push; there the motion is one
Taylor series of the differential equation. Nothing here knows a closed form. How no root is missed is told in
``events.py``: Bernstein's coefficients and Descartes' rule. Here all stops are watched at once, and a step ends where
the first of them is met, or at the next knot.

Left out, by ArithmeticError: two stops held at once, an impact while another is held, a touch nearer than the digits.
Work is integrated as polynomials, exactly: of the load, of damping, and what impacts and linear stops' dampers take.
"""

from __future__ import annotations

import math
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import NamedTuple

import gmpy2
from events import (
    SLOWEST,
    Extremes,
    _combine,
    _first_root,
    _reaches,
    _roots_within,
    _value,
    _value_and_slope,
    as_mpf,
    exact,
)
from gmpy2 import mpfr

OPEN, HELD, PUSH, RETREAT = "open", "held", "push", "retreat"


@dataclass(frozen=True)
class Stop:
    """A hard stop with ``restitution``, or a linear one with ``stiffness`` and ``damping``; numbers as in events.py."""

    row: list
    gap: float
    restitution: float | None = None
    stiffness: float | None = None
    damping: float = 0


@dataclass(frozen=True)
class Loaded:
    """A system: rows of n numbers, the matrix D (n, n), its stops; knots (K+1,) and coefficients (K, 4) of the load."""

    omega: list
    damper: list
    load: list
    static: list
    stops: list[Stop]
    knots: list
    pieces: list


class Event(NamedTuple):
    """``kind``: impact, entry (of a linear stop), exit, rest or release; ``speed`` toward the stop just before."""

    kind: str
    stop: int
    time: object
    speed: object


class Series(NamedTuple):
    """Taylor coefficients of the modes, and of the force of each stop that holds or pushes."""

    modes: list
    force: dict


@dataclass
class Flight:
    """A motion under way from (place, speed) at ``time``; ``held`` names the stop that it rests on at the start."""

    system: Loaded
    place: list
    speed: list
    time: float = 0
    held: int | None = None
    digits: int = 40
    tiny: float = 1e-25  # of the fastest time constant: shorter flights are left to the geometric limit
    trackers: list[Extremes] = field(default_factory=list)
    ledger: bool = False

    def __post_init__(self):
        self.events, self.steps = [], 0
        with self.precision():
            own = self.system
            self.x, self.v, self.time = _all(self.place), _all(self.speed), exact(self.time)
            self.stiffness = [exact(w) ** 2 for w in own.omega]
            self.damper = [_all(row) for row in own.damper]
            self.load, self.static = _all(own.load), _all(own.static)
            self.rows, self.gaps = [_all(stop.row) for stop in own.stops], _all(stop.gap for stop in own.stops)
            self.square = [_dot(row, row) for row in self.rows]
            self.knots, self.pieces = _all(own.knots), [_all(piece) for piece in own.pieces]
            self.state = [HELD if j == self.held else OPEN for j in range(len(own.stops))]
            self.known = [0] * len(own.stops)
            self.work = dict.fromkeys(("load", "static", "damping", "stops"), mpfr(0))
            self.rate = self._fastest()
            if self.held is not None:
                share = self._speed_at(self.held) / self.square[self.held]
                self.v = [v - c * share for v, c in zip(self.v, self.rows[self.held], strict=True)]
            self._find_piece()
            self._begin()

    @contextmanager
    def precision(self):
        """The arithmetic of this motion."""
        with gmpy2.context(gmpy2.get_context(), precision=math.ceil(self.digits * math.log2(10)) + 16):
            yield

    def run(self, end, most=100_000):
        """Go on to ``end``; ArithmeticError after ``most`` events."""
        with self.precision():
            end = exact(end)
            while self.time < end:
                self._step(end)
                if len(self.events) > most:
                    raise ArithmeticError("too many events")
        return self

    def energy(self):
        """½ η'² + ½ ω² η², and what linear stops that push have stored."""
        with self.precision():
            own = sum(v * v + k * x * x for x, v, k in zip(self.x, self.v, self.stiffness, strict=True))
            return as_mpf(own / 2 + sum(self._stored(j) for j, kind in enumerate(self.state) if kind == PUSH))

    # ------------------------------------------------------------------------------------------------ preparation

    def _fastest(self):
        """Bound of the growth of derivatives in any regime, for the length of steps."""
        d = max(sum(abs(float(b)) for b in row) for row in self.damper)
        k = max(map(float, self.stiffness))
        for j, stop in enumerate(self.system.stops):
            if stop.stiffness is not None:
                size = sum(abs(float(c)) for c in self.rows[j]) * max(abs(float(c)) for c in self.rows[j])
                d, k = d + float(stop.damping) * size, k + float(stop.stiffness) * size
        return (d + math.sqrt(d * d + 4 * k)) / 2 or SLOWEST

    def _find_piece(self):
        self.piece = sum(knot <= self.time for knot in self.knots) - 1  # −1 before the record, K behind it

    def _piece_end(self):
        return self.knots[self.piece + 1] if self.piece + 1 < len(self.knots) else None

    def _begin(self):
        """Sort out stops that are touched at the start of a piece, or of the motion."""
        series = self._series(8)
        for j, kind in enumerate(self.state):
            if kind == OPEN:
                gap = self._gap(series, j)
                if self.known[j] or gap[0] != 0:
                    if gap[0] < 0 and not self.known[j]:
                        raise ArithmeticError("the start lies beyond a stop")
                    continue
                self.known[j] = next((k for k, a in enumerate(gap) if a != 0), 8)
                if self.known[j] < 8 and gap[self.known[j]] < 0:
                    self._touched(j)
                    return
            elif kind == HELD:
                zeros = next((k for k, a in enumerate(series.force[j]) if a != 0), None)
                self.known[j] = zeros or 0
                if zeros is not None and series.force[j][zeros] < 0:
                    self.state[j], self.known[j] = OPEN, 2 + zeros
                    self._note("release", j)
                    return

    def _touched(self, j):
        """At a stop at the start of the motion, on the way in."""
        if self.system.stops[j].stiffness is not None:
            self._enter(j)
        elif self._speed_at(j) > 0:
            self._strike(j)
        else:
            self._rest(j)

    # ------------------------------------------------------------------------------------------------ Taylor series

    def _load(self):
        """Coefficients of u about the present time."""
        if not 0 <= self.piece < len(self.pieces):
            return [mpfr(0)] * 4
        s, a = self.time - self.knots[self.piece], self.pieces[self.piece]
        return [sum(math.comb(k, j) * a[k] * s ** (k - j) for k in range(j, 4)) for j in range(4)]

    def _series(self, order):
        u, own, n = self._load(), self.system.stops, len(self.x)
        x = [[a, b] for a, b in zip(self.x, self.v, strict=True)]
        force = {j: [] for j, kind in enumerate(self.state) if kind in (HELD, PUSH)}
        for k in range(order - 1):
            drive = [self.load[i] * u[k] if k < 4 else mpfr(0) for i in range(n)]
            if k == 0:
                drive = [a + b for a, b in zip(drive, self.static, strict=True)]
            pull = [
                drive[i]
                - self.stiffness[i] * x[i][k]
                - (k + 1) * sum(b * x[m][k + 1] for m, b in enumerate(self.damper[i]) if b)
                for i in range(n)
            ]
            for j in sorted(force, key=lambda j: self.state[j] == HELD):  # a hold comes last: it balances all others
                row = self.rows[j]
                if self.state[j] == PUSH:
                    depth = sum(c * each[k] for c, each in zip(row, x, strict=True)) - (self.gaps[j] if k == 0 else 0)
                    rate = (k + 1) * sum(c * each[k + 1] for c, each in zip(row, x, strict=True))
                    force[j].append(exact(own[j].stiffness) * depth + exact(own[j].damping) * rate)
                else:
                    force[j].append(_dot(row, pull) / self.square[j])
                pull = [a - c * force[j][k] for a, c in zip(pull, row, strict=True)]
            for i in range(n):
                x[i].append(pull[i] / ((k + 1) * (k + 2)))
        return Series(x, force)

    def _gap(self, series, j):
        poly = [-a for a in _combine(self.rows[j], series.modes)]
        poly[0] += self.gaps[j]
        return poly

    def _watched(self, series):
        """What must stay positive: (stop, what its root is, polynomial without its roots at the start)."""
        found = []
        for j, kind in enumerate(self.state):
            if kind == OPEN:
                found.append((j, "meet", self._gap(series, j)[self.known[j] :]))
            elif kind in (HELD, PUSH):
                found.append((j, "leave", series.force[j][self.known[j] :]))
            else:
                gap, own = self._gap(series, j), self.system.stops[j]
                pull = [exact(own.stiffness) * a for a in gap]
                pull = [
                    a + exact(own.damping) * (k + 1) * b for k, (a, b) in enumerate(zip(pull, gap[1:], strict=False))
                ]
                found += [(j, "out", [-a for a in gap]), (j, "again", pull[self.known[j] :])]
        return found

    # ------------------------------------------------------------------------------------------------ one step

    def _step(self, end):
        """Advance to the next event, the next knot, ``end``, or as far as one series reaches."""
        limit = min(end, self._piece_end() or end)
        reaches, left = _reaches(self.digits), limit - self.time
        span = min(reaches[-1] / self.rate, float(left) * (1 + 1e-9))
        span = min(span, self._short_flight())
        order = next(n for n, reach in enumerate(reaches) if n > 8 and span * self.rate <= reach * (1 + 1e-9))
        series = self._series(order)
        watched = self._watched(series)
        for _, _, poly in watched:
            if poly[0] <= 0:
                raise ArithmeticError("a stop is touched nearer than the digits tell")
        counts = [None]
        while None in counts:
            inside = [_scaled(poly, span) for _, _, poly in watched]
            counts = [_roots_within(poly, 1.0) for poly in inside]
            if None in counts:
                span /= 2
        roots = [
            (span * _first_root(poly, 1.0), j, what)
            for (j, what, _), poly, n in zip(watched, inside, counts, strict=True) if n
        ]  # fmt: skip
        length, j, what = min(roots, default=(exact(span), -1, ""), key=lambda each: each[0])
        if length >= left:
            length, j, what = left, -1, ""
        self._advance(series, length)
        if length == left:
            self.time = limit
        if what:
            self._follow(j, what)
        elif length == left and limit == self._piece_end():
            self.piece += 1
            self._begin()

    def _short_flight(self):
        """A little more than the flight under the present acceleration, after an impact."""
        found = math.inf
        for j, kind in enumerate(self.state):
            if kind == OPEN and self.known[j] == 1:
                gap = self._gap(self._series(3), j)
                if gap[2] < 0 < gap[1]:
                    found = min(found, float(-1.5 * gap[1] / gap[2]))
        return found

    def _advance(self, series, length):
        for tracker in self.trackers:
            own = Series([_scaled(poly, length) for poly in series.modes], {})
            tracker.update(own, _all(tracker.row), mpfr(1))
        if self.ledger:
            self._account(series, length)
        moved = [_value_and_slope(poly, length) for poly in series.modes]
        self.x, self.v = [y for y, _ in moved], [dy for _, dy in moved]
        self.time += length
        self.known = [0] * len(self.known)
        self.steps += 1

    def _account(self, series, length):
        """Works over a step, as integrals of products of series."""
        rates = [[k * a for k, a in enumerate(poly)][1:] for poly in series.modes]
        self.work["load"] += _integral(_times(_combine(self.load, rates), self._load()), length)
        self.work["static"] += _value(_combine(self.static, series.modes), length) - _dot(self.static, self.x)
        for row, rate in zip(self.damper, rates, strict=True):
            self.work["damping"] += _integral(_times(rate, _combine(row, rates)), length)
        for j in series.force:
            damping = exact(self.system.stops[j].damping)
            if self.state[j] == PUSH and damping:
                speed = _combine(self.rows[j], rates)
                self.work["stops"] += damping * _integral(_times(speed, speed), length)

    # ------------------------------------------------------------------------------------------------ events

    def _follow(self, j, what):
        own = self.system.stops[j]
        if what == "meet" and own.stiffness is not None:
            self._enter(j)
        elif what == "meet":
            self._strike(j)
        elif what == "leave" and self.state[j] == HELD:
            self.state[j], self.known[j] = OPEN, 3
            self._note("release", j)
        elif what == "leave" and own.damping:
            self.state[j], self.known[j] = RETREAT, 1
            self.work["stops"] += self._stored(j)  # the spring goes back against its own damper
        elif what in ("leave", "out"):
            self.state[j], self.known[j] = OPEN, 1
            self._note("exit", j)
        else:
            self.state[j], self.known[j] = PUSH, 1
            self.work["stops"] -= self._stored(j)

    def _stored(self, j):
        return exact(self.system.stops[j].stiffness) * (_dot(self.rows[j], self.x) - self.gaps[j]) ** 2 / 2

    def _enter(self, j):
        speed = self._speed_at(j)
        self.state[j], self.known[j] = PUSH, 0 if self.system.stops[j].damping else 1
        self._note("entry", j, speed)

    def _strike(self, j):
        """Restitution; then flight, or rest where the flights have become too short to follow."""
        if HELD in self.state:
            raise ArithmeticError("an impact while another stop is held")
        speed, R = self._speed_at(j), exact(self.system.stops[j].restitution)
        share = (1 + R) * speed / self.square[j]
        self.v = [v - c * share for v, c in zip(self.v, self.rows[j], strict=True)]
        self.work["stops"] += (1 - R * R) * speed * speed / self.square[j] / 2
        self._note("impact", j, speed)
        self.known[j] = 1
        acceleration, rebound = -2 * self._gap(self._series(3), j)[2], R * speed
        if acceleration > 0 and 2 * rebound * self.rate < self.tiny * acceleration:
            if R == 1:
                raise ArithmeticError("a chatter without loss never ends")
            self.time += 2 * rebound / (acceleration * (1 - R))
            self._rest(j)
        elif rebound == 0:
            self.known[j] = 2

    def _rest(self, j):
        share = self._speed_at(j) / self.square[j]
        self.v = [v - c * share for v, c in zip(self.v, self.rows[j], strict=True)]
        self.state[j], self.known[j] = HELD, 0
        self._note("rest", j)

    def _speed_at(self, j):
        return _dot(self.rows[j], self.v)

    def _note(self, kind, j, speed=0):
        self.events.append(Event(kind, j, as_mpf(self.time), as_mpf(mpfr(speed))))


def _all(row):
    return [exact(a) for a in row]


def _dot(a, b):
    return sum((x * y for x, y in zip(a, b, strict=True)), mpfr(0))


def _times(a, b):
    """Product of two polynomials, to the order of the longer."""
    n = max(len(a), len(b))
    found = [mpfr(0)] * n
    for i, x in enumerate(a):
        for k, y in enumerate(b[: n - i]):
            found[i + k] += x * y
    return found


def _scaled(poly, span):
    """The polynomial in s/span: its coefficients as doubles stay in range at any scale of time."""
    found, power = [], mpfr(1)
    for a in poly:
        found.append(a * power)
        power *= span
    return found


def _integral(poly, span):
    return _value([mpfr(0), *(a / (k + 1) for k, a in enumerate(poly))], span)
