"""Vibro-impact motion of n modes to any number of digits: the truth that other solvers are judged against.

    η_i'' + 2ζ_iω_i η_i' + ω_i² η_i = load_i Ω²B sin Ωt + static_i,      stop at u = Σ contact_i η_i = gap
    at the stop: η_i'⁺ = η_i'⁻ + contact_i p,   p = −(1+R) v⁻ / S,   S = Σ contact_i²

Nothing here knows a closed form of the motion: it is integrated by long Taylor series of the differential equation in
arbitrary precision. Numbers go in exactly (a double is the number it stands for) and come out as mpmath's ``mpf``; in
between they are gmpy2's ``mpfr``, the same arithmetic at a tenth of the time.

How no impact is missed. On a Taylor step the distance to the stop is a known polynomial. Its Bernstein coefficients
bound it from both sides and, by Descartes' rule, count its roots: all positive is no root, one change of sign is
exactly one. They are formed in doubles with a bound on their rounding; whatever that bound leaves open halves the
step, and since the polynomial is rescaled to each step, doubles decide at any scale, down to the last digits. A root
that is known beforehand (the step starts on the stop) is divided out first. The root itself is found by Newton's
method in full precision.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Literal, NamedTuple

import gmpy2
import mpmath
import numpy as np
from gmpy2 import mpfr
from mpmath import mpf

Number = float | int | str | mpf
Polynomial = list[mpfr]

NOISE = 4e-14  # of Σ|coefficients|: more than all rounding of a Bernstein form of degree ≤ 90 in doubles
SLOWEST = 1.0  # rate, 1/s, that stands for the system's where it has none (a ball that falls)


@dataclass(frozen=True)
class Modes:
    """A system: rows of n numbers (float, int, decimal string or mpf, taken exactly), gap and restitution."""

    omega: Sequence[Number]
    zeta: Sequence[Number]
    contact: Sequence[Number]
    load: Sequence[Number]
    gap: Number = 0
    restitution: Number = 1
    static: Sequence[Number] | None = None


@dataclass(frozen=True)
class Drive:
    """Base motion amplitude · sin(omega t)."""

    omega: Number = 0
    amplitude: Number = 0


@dataclass(frozen=True)
class State:
    """Modal displacement and velocity at ``time``; ``resting``: held on the stop (contact velocity taken as zero)."""

    displacement: Sequence[Number]
    velocity: Sequence[Number]
    resting: bool = False
    time: Number = 0


@dataclass(frozen=True)
class Event:
    """An impact, the begin of a rest (where a chatter accumulates), or a release.

    ``speed`` is the contact velocity just before, positive toward the stop (impacts only, else 0); ``displacement``
    and ``velocity`` are the modal state after it.
    """

    kind: Literal["impact", "rest", "release"]
    time: mpf
    speed: mpf
    displacement: list[mpf]
    velocity: list[mpf]


class Taylor(NamedTuple):
    """The motion in local time s: Taylor coefficients of every mode, and of the contact force where it rests."""

    modes: list[Polynomial]
    force: Polynomial


def impacts(
    system: Modes,
    drive: Drive,
    state: State,
    *,
    count: int | None = None,
    t_end: Number | None = None,
    digits: int = 40,
) -> list[Event]:
    """The impacts from ``state`` on: the first ``count``, or all up to ``t_end``, whichever ends first."""
    motion = Motion(system, drive, state, digits=digits)
    motion.run(t_end=t_end, count=count)
    return [event for event in motion.events if event.kind == "impact"]


class Extremes:
    """Largest and least value of an output row over all of the motion while it is attached to it."""

    def __init__(self, row: Sequence[Number]) -> None:
        self.row = row
        self.maximum: mpfr | None = None
        self.minimum: mpfr | None = None

    def update(self, taylor: Taylor, row: list[mpfr], span: mpfr) -> None:
        """Take in the motion over 0 ≤ s ≤ span."""
        poly = _combine(row, taylor.modes)
        if self._already_inside(poly, span):
            return
        for s in [mpfr(0), span, *(span * t for t in _turning_points(poly, float(span)))]:
            value = _value(poly, s)
            if self.maximum is None or value > self.maximum:
                self.maximum = value
            if self.minimum is None or value < self.minimum:
                self.minimum = value

    def _already_inside(self, poly: Polynomial, span: mpfr) -> bool:
        if self.maximum is None or self.minimum is None:
            return False
        hull, noise = _bernstein(poly, float(span))
        return bool(hull.max() + noise <= float(self.maximum) and hull.min() - noise >= float(self.minimum))


@dataclass
class Motion:
    """A motion under way: ``run`` it on, read ``events``, ``time``, ``state()``.

    ``digits`` of the arithmetic, which the truncation of a step follows. A chatter is followed impact by impact until
    a flight lasts less than ``tiny`` of the fastest time constant; what is left is the geometric limit, whose error is
    of the order of tiny².
    """

    system: Modes
    drive: Drive
    start: State
    digits: int = 40
    tiny: float = 1e-25
    trackers: list[Extremes] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.events: list[Event] = []
        self.steps = 0
        with self.precision():
            self._take_system()
            self._take_state()
            self._begin()

    @contextmanager
    def precision(self) -> Iterator[None]:
        """The arithmetic of this motion."""
        with gmpy2.context(gmpy2.get_context(), precision=math.ceil(self.digits * math.log2(10)) + 16):
            yield

    def state(self) -> State:
        """Where the motion now is."""
        return State(_out(self.x), _out(self.v), self.resting, as_mpf(self.time))

    def run(self, t_end: Number | None = None, count: int | None = None, until: str = "impact") -> None:
        """Go on to ``t_end``, or until ``count`` further events of kind ``until`` have come, whichever is first."""
        if t_end is None and count is None:
            raise ValueError("give t_end, count or both")
        with self.precision():
            end = None if t_end is None else exact(t_end)
            seen = 0
            while (end is None or self.time < end) and (count is None or seen < count):
                before = len(self.events)
                self._step(end)
                seen += sum(event.kind == until for event in self.events[before:])

    def shift(self, by: Number) -> None:
        """Move the free motion by a time, forward or back, that one Taylor series spans, whatever lies there."""
        with self.precision():
            length = exact(by)
            if self.resting or abs(float(length)) * self.rate_free > _reaches(self.digits)[-1]:
                raise ValueError("shift moves a free motion, by less than one series reaches")
            self._advance(self._free(self.digits + 10), length)

    # ------------------------------------------------------------------------------------------------ preparation

    def _take_system(self) -> None:
        system, n = self.system, len(self.system.omega)
        omega, zeta = [exact(w) for w in system.omega], [exact(z) for z in system.zeta]
        self.damping = [2 * z * w for z, w in zip(zeta, omega, strict=True)]
        self.stiffness = [w * w for w in omega]
        self.contact = [exact(c) for c in system.contact]
        self.static = [exact(s) for s in system.static or [0] * n]
        self.gap, self.restitution = exact(system.gap), exact(system.restitution)
        self.drive_omega = exact(self.drive.omega)
        strength = self.drive_omega**2 * exact(self.drive.amplitude)
        self.load = [exact(load) * strength for load in system.load]
        self.S = sum((c * c for c in self.contact), mpfr(0))
        pairs = list(zip(self.damping, self.stiffness, strict=True))
        free = max(_rate(d, k) for d, k in pairs)
        held = _rate(max(self.damping), max(self.stiffness))
        forcing = float(self.drive_omega)
        self.rate_free = max(free, forcing) or SLOWEST
        self.rate_held = max(held, forcing) or SLOWEST

    def _take_state(self) -> None:
        self.time = exact(self.start.time)
        self.x = [exact(x) for x in self.start.displacement]
        self.v = [exact(v) for v in self.start.velocity]
        self.resting = self.start.resting
        self.known = 0  # how many roots of the watched polynomial are known to lie at the start of the next step

    def _begin(self) -> None:
        """Sort out a start that lies on the stop."""
        if self.resting:
            self.v = self._without_contact_velocity()
            if self._leaves(self._held(6).force):
                self.resting = False
                self.known = 2 + self._zeros(self._held(6).force)
            else:
                self.known = self._zeros(self._held(6).force)
            return
        distance = self._distance(self._free(8))
        self.known = self._zeros(distance)
        if not self._leaves(distance):
            return
        if self.known == 0:
            raise ValueError("the start lies beyond the stop")
        if self.known == 1:
            self._impact()
        else:
            self._rest()

    @staticmethod
    def _zeros(poly: Polynomial) -> int:
        """Number of leading coefficients that are exactly zero (all zero: none)."""
        return next((k for k, a in enumerate(poly) if a != 0), 0)

    @classmethod
    def _leaves(cls, poly: Polynomial) -> bool:
        """Whether the polynomial turns negative at once."""
        return poly[cls._zeros(poly)] < 0

    # ------------------------------------------------------------------------------------------------ Taylor series

    def _forcing(self, order: int) -> list[mpfr]:
        """Derivatives 0 … order−2 of sin Ωt at the present time."""
        phase = self.drive_omega * self.time
        f, g = gmpy2.sin(phase), self.drive_omega * gmpy2.cos(phase)
        factor = -self.drive_omega * self.drive_omega
        series = []
        for _ in range(order - 1):
            series.append(f)
            f, g = g, factor * f
        return series

    def _free(self, order: int) -> Taylor:
        """Free flight: every mode for itself, y⁽ᵏ⁺²⁾ = f⁽ᵏ⁾ − d y⁽ᵏ⁺¹⁾ − ω² y⁽ᵏ⁾."""
        sine, weights = self._forcing(order), _inverse_factorials(order, self.digits)
        modes = []
        for y, dy, d, k, load, static in zip(
            self.x, self.v, self.damping, self.stiffness, self.load, self.static, strict=True
        ):
            derivatives = [y, dy]
            y, dy = dy, load * sine[0] + static - d * dy - k * y
            derivatives.append(dy)
            for f in sine[1:]:
                y, dy = dy, load * f - d * dy - k * y
                derivatives.append(dy)
            modes.append([a * b for a, b in zip(derivatives, weights, strict=True)])
        return Taylor(modes, [])

    def _held(self, order: int) -> Taylor:
        """At rest on the stop: the same modes with the contact force that keeps the contact's acceleration zero."""
        sine, weights = self._forcing(order), _inverse_factorials(order, self.digits)
        y, dy, static = self.x, self.v, self.static
        derivatives, forces = [y, dy], []
        for f in sine:
            drift = [
                load * f - d * b - k * a + s
                for a, b, d, k, load, s in zip(y, dy, self.damping, self.stiffness, self.load, static, strict=True)
            ]
            force = _dot(self.contact, drift) / self.S
            forces.append(force)
            static = [0] * len(y)
            y, dy = dy, [a - c * force for a, c in zip(drift, self.contact, strict=True)]
            derivatives.append(dy)
        columns = zip(*derivatives, strict=True)
        modes = [[a * b for a, b in zip(column, weights, strict=True)] for column in columns]
        return Taylor(modes, [a * b for a, b in zip(forces, weights[:-2], strict=True)])

    def _distance(self, taylor: Taylor) -> Polynomial:
        """gap − u as a polynomial in s."""
        poly = [-a for a in _combine(self.contact, taylor.modes)]
        poly[0] += self.gap
        return poly

    def contact_acceleration(self) -> mpf:
        """Acceleration of the contact point without the stop, positive toward the stop."""
        with self.precision():
            return as_mpf(self._contact_acceleration())

    def _contact_acceleration(self) -> mpfr:
        return 2 * _combine(self.contact, self._free(2).modes)[2]

    # ------------------------------------------------------------------------------------------------ one step

    def _step(self, end: mpfr | None) -> None:
        """Advance to the next event, to ``end``, or as far as one Taylor series reaches."""
        span, order = self._first_span()
        taylor = self._held(order) if self.resting else self._free(order)
        watched = (taylor.force if self.resting else self._distance(taylor))[self.known :]
        self._check(watched)
        while (count := _roots_within(watched, span)) is None:
            span /= 2
        length = mpfr(span) if count == 0 else _first_root(watched, span)
        if end is not None and self.time + length > end:
            count, length = 0, end - self.time
        self._advance(taylor, length)
        if count == 1:
            self._event()
        elif end is not None and self.time > end - length / 2**40:
            self.time = end

    def _first_span(self) -> tuple[float, int]:
        """Length of the first try and the order of the series for it: short where the next impact is near."""
        rate = self.rate_held if self.resting else self.rate_free
        reaches = _reaches(self.digits)
        span = reaches[-1] / rate
        if self.known == 1 and not self.resting:
            flight = self._ballistic_flight()
            if 0 < flight < span:
                span = min(span, 1.5 * flight)
        order = next(n for n, reach in enumerate(reaches) if span * rate <= reach * (1 + 1e-12))
        return span, max(order, self.known + 2)

    def _ballistic_flight(self) -> float:
        """Duration of a flight under the present contact acceleration; negative where that pulls away."""
        acceleration = self._contact_acceleration()
        return float(-2 * self._contact_velocity() / acceleration) if acceleration else math.inf

    def _check(self, watched: Polynomial) -> None:
        """The start of a step must be on the right side by more than round-off."""
        if self.known or self.resting:
            near = watched[0] <= 0
        else:
            size = abs(self.gap) + sum(abs(c * x) for c, x in zip(self.contact, self.x, strict=True))
            near = watched[0] <= size * 10.0 ** (3 - self.digits)
        if near:
            raise ArithmeticError(f"t = {float(self.time)}: nearer to the stop than {self.digits} digits can tell")

    def _advance(self, taylor: Taylor, length: mpfr) -> None:
        with_rows = [(tracker, [exact(r) for r in tracker.row]) for tracker in self.trackers]
        for tracker, row in with_rows:
            tracker.update(taylor, row, length)
        moved = [_value_and_slope(poly, length) for poly in taylor.modes]
        self.x, self.v = [y for y, _ in moved], [dy for _, dy in moved]
        self.time += length
        self.known = 0
        self.steps += 1

    # ------------------------------------------------------------------------------------------------ events

    def _event(self) -> None:
        if self.resting:
            self.resting, self.known = False, 3
            self._note("release")
        else:
            self._impact()

    def _impact(self) -> None:
        """Restitution; then flight, or rest where the flights have become too short to follow."""
        speed = self._contact_velocity()
        self._kick((1 + self.restitution) * speed)
        self.known = 1
        self._note("impact", speed)
        acceleration = self._contact_acceleration()
        rebound = self.restitution * speed
        if acceleration > 0 and 2 * rebound * self.rate_held < self.tiny * acceleration:
            if self.restitution == 1:
                raise ArithmeticError("a chatter without loss never ends")
            self.time += 2 * rebound / (acceleration * (1 - self.restitution))
            self._rest()
        elif rebound == 0:
            self.known = 2

    def _rest(self) -> None:
        self.v = self._without_contact_velocity()
        self.resting, self.known = True, 0
        self._note("rest")

    def _contact_velocity(self) -> mpfr:
        return _dot(self.contact, self.v)

    def _without_contact_velocity(self) -> list[mpfr]:
        share = self._contact_velocity() / self.S
        return [v - c * share for v, c in zip(self.v, self.contact, strict=True)]

    def _kick(self, lost: mpfr) -> None:
        """Take ``lost`` from the contact velocity by an impulse at the contact."""
        share = lost / self.S
        self.v = [v - c * share for v, c in zip(self.v, self.contact, strict=True)]

    def _note(self, kind: Literal["impact", "rest", "release"], speed: mpfr | int = 0) -> None:
        self.events.append(Event(kind, as_mpf(self.time), as_mpf(mpfr(speed)), _out(self.x), _out(self.v)))


# ---------------------------------------------------------------------------------------------------- numbers


def exact(value: Number | mpfr) -> mpfr:
    """``value`` in the present precision: doubles, integers and mpf as they are, strings as decimals."""
    if isinstance(value, mpf):
        sign, mantissa, exponent, _ = value._mpf_
        number = mpfr(int(mantissa))
        number = gmpy2.mul_2exp(number, exponent) if exponent >= 0 else gmpy2.div_2exp(number, -exponent)
        return -number if sign else number
    return mpfr(float(value)) if isinstance(value, np.floating) else mpfr(value)


def as_mpf(value: mpfr) -> mpf:
    """``value`` as mpmath's number, every bit of it."""
    mantissa, exponent = value.as_mantissa_exp()
    return mpmath.mp.make_mpf(mpmath.libmp.from_man_exp(int(mantissa), int(exponent)))


def _out(values: list[mpfr]) -> list[mpf]:
    return [as_mpf(v) for v in values]


def _dot(a: list[mpfr], b: list[mpfr]) -> mpfr:
    return sum((x * y for x, y in zip(a, b, strict=True)), mpfr(0))


def _rate(damping: mpfr, stiffness: mpfr) -> float:
    """Bound r of all derivatives: |y⁽ᵏ⁺¹⁾| grows no faster than r|y⁽ᵏ⁾|, r² = damping r + stiffness."""
    d, k = float(damping), float(stiffness)
    return (d + math.sqrt(d * d + 4 * k)) / 2


@lru_cache(maxsize=256)
def _inverse_factorials(order: int, digits: int) -> list[mpfr]:
    """1/k! for k = 0 … order; ``digits`` keeps precisions apart."""
    return [1 / mpfr(math.factorial(k)) for k in range(order + 1)]


@lru_cache(maxsize=16)
def _reaches(digits: int) -> list[float]:
    """For each order N the largest rate·step whose first left-out term is 10^−digits of the second-derivative term."""
    longest = digits + 10
    return [0.0] * 5 + [
        math.exp((math.lgamma(n + 1) - math.log(2) - digits * math.log(10)) / (n - 2)) for n in range(5, longest + 1)
    ]


# ---------------------------------------------------------------------------------------------------- polynomials


def _combine(row: list[mpfr], modes: list[Polynomial]) -> Polynomial:
    total = [row[0] * a for a in modes[0]]
    for r, mode in zip(row[1:], modes[1:], strict=True):
        total = [t + r * a for t, a in zip(total, mode, strict=True)]
    return total


def _value(poly: Polynomial, s: mpfr) -> mpfr:
    value = poly[-1]
    for a in poly[-2::-1]:
        value = value * s + a
    return value


def _value_and_slope(poly: Polynomial, s: mpfr) -> tuple[mpfr, mpfr]:
    value, slope = poly[-1], mpfr(0)
    for a in poly[-2::-1]:
        slope = slope * s + value
        value = value * s + a
    return value, slope


@lru_cache(maxsize=128)
def _to_bernstein(degree: int) -> np.ndarray:
    """Matrix from power to Bernstein coefficients on [0, 1]: C(j,k)/C(n,k), all within 0 … 1."""
    return np.array([[math.comb(j, k) / math.comb(degree, k) for k in range(degree + 1)] for j in range(degree + 1)])


@lru_cache(maxsize=128)
def _halves(degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Matrices from the Bernstein coefficients on [0, 1] to those on its two halves (de Casteljau)."""
    n = degree + 1
    left = np.array([[math.comb(j, k) / 2**j for k in range(n)] for j in range(n)])
    return left, left[::-1, ::-1].copy()


def _scaled(poly: Polynomial, span: float) -> np.ndarray:
    """Coefficients in doubles of the polynomial in s/span."""
    return np.array([float(a) for a in poly]) * span ** np.arange(len(poly))


def _bernstein(poly: Polynomial, span: float) -> tuple[np.ndarray, float]:
    """Bernstein coefficients on 0 ≤ s ≤ span in doubles, and a bound on their rounding."""
    scaled = _scaled(poly, span)
    return _to_bernstein(len(poly) - 1) @ scaled, NOISE * float(np.abs(scaled).sum())


def _roots_within(poly: Polynomial, span: float) -> int | None:
    """Number of roots in (0, span) of a polynomial positive at 0, if that is certainly 0 or 1; else None."""
    return _count(*_bernstein(poly, span))


def _count(coefficients: np.ndarray, noise: float) -> int | None:
    """Roots by Descartes' rule where the first coefficient is positive; one doubtful sign at the change is no doubt."""
    positive = coefficients > noise
    if positive.all():
        return 0
    negative = coefficients < -noise
    change = int(np.argmin(positive))
    return 1 if change > 0 and negative[-1] and negative[change + 1 :].all() else None


def _first_root(poly: Polynomial, span: float) -> mpfr:
    """The one root within (0, span): found in doubles, finished by Newton's method in full precision."""
    s = mpfr(span * _root_in_doubles(_scaled(poly, span).tolist()))
    enough = mpfr(span) / mpfr(2) ** (gmpy2.get_context().precision - 12)
    for _ in range(12):
        value, slope = _value_and_slope(poly, s)
        change = value / slope
        s -= change
        if abs(change) <= enough:
            break
    else:
        raise ArithmeticError("Newton's method does not settle")
    if not 0 < s <= span * (1 + 1e-12):
        raise ArithmeticError("Newton's method left the interval")
    return s


def _root_in_doubles(a: list[float]) -> float:
    """The root in (0, 1) of a polynomial positive at 0 and negative at 1: Newton kept inside a shrinking bracket."""
    low, high, t = 0.0, 1.0, 0.5
    for _ in range(80):
        value = slope = 0.0
        for c in reversed(a):
            slope = slope * t + value
            value = value * t + c
        low, high = (t, high) if value > 0 else (low, t)
        new = t - value / slope if slope else low
        new = new if low < new < high else (low + high) / 2
        if abs(new - t) < 1e-15:
            break
        t = new
    return new


def _turning_points(poly: Polynomial, span: float) -> list[float]:
    """Where in (0, 1) the polynomial in s/span has its extremes, near enough for 1e-20 in their values."""
    scaled = np.abs(_scaled(poly, span)).sum()
    slopes = _scaled(poly, span)[1:] * np.arange(1, len(poly))
    noise = NOISE * float(np.abs(slopes).sum())
    found: list[float] = []
    pending = [(0.0, 1.0, _to_bernstein(len(slopes) - 1) @ slopes)]
    left, right = _halves(len(slopes) - 1)
    while pending:
        low, high, b = pending.pop()
        if (b > noise).all() or (b < -noise).all():
            continue
        if np.abs(b).max() * (high - low) <= 1e-20 * scaled:
            found.append((low + high) / 2)
            continue
        middle = (low + high) / 2
        pending += [(low, middle, left @ b), (middle, high, right @ b)]
    return found
