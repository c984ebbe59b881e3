"""Observers of a sampled motion: extremes, energies, impacts, period.

Between two samples a motion is taken as the cubic through both values and slopes (an error of the fourth order in
their distance), or as the chord where it is not smooth.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.observe.periodicity import repetition
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.record import Record
from vibeam.system.response import VELOCITIES_KEPT, Ended, FrequencyResponse
from vibeam.system.rows import TimeDerivative
from vibeam.system.state import State
from vibeam_models.arrays import Array

SLACK = 1e-9  # tolerance, as a share of a period, between a sample's time and the period's end


@dataclass(frozen=True)
class SampledPiece:
    """Stretch of motion: samples (m, 2, n) at ascending times (m,), the last one just before the impact that ends it.

    ``impact_times`` and ``impact_velocities`` (k,): the impacts in it; ``rest``: time at rest on the stop, s;
    ``smooth`` (m − 1,): False between samples with an impulse between them, None without any.
    """

    times: Array
    values: Array
    impact_times: Array
    impact_velocities: Array
    rest: float = 0.0
    smooth: NDArray[np.bool_] | None = None

    @property
    def rests(self) -> Array:
        """Begin and end of rests on the stop (k, 2): all of it, or samples with impulses that are no impacts."""
        if self.smooth is None:
            return np.array([[self.times[0], self.times[-1]]] if self.rest > 0 else []).reshape(-1, 2)
        held = ~self.smooth
        held[np.searchsorted(self.times, self.impact_times - (self.times[1] - self.times[0]) / 2) - 1] = False
        return np.stack([self.times[:-1][held], self.times[1:][held]], axis=1)


@dataclass(frozen=True)
class SteppedOutcome:
    """Outcome of a run: reason, time (s) and state at the end; impacts and evaluations of the right-hand side."""

    ended: Ended
    time: float
    state: State
    impacts: int
    evaluations: int


@dataclass(frozen=True)
class SampledMotion:
    """Sampled motion, SI units: ``times`` (m,), modal ``values`` (m, 2, n); at an impact one before, one after.

    ``impact_velocities`` (k,): contact velocities just before, positive toward the stop; ``rest``: time at rest on the
    stop, s; ``rests`` (r, 2) when. ``stats``: impacts, evaluations, cpu_seconds. Between samples it is the cubic
    through both displacements and velocities.
    """

    system: ImpactSystem
    drive: Drive | Record
    times: Array
    values: Array
    impact_times: Array
    impact_velocities: Array
    rest: float
    t_end: float
    state: State
    ended: Ended
    stats: Mapping[str, float]
    rests: Array = field(default_factory=lambda: np.empty((0, 2)))

    @property
    def t_start(self) -> float:
        """Start time, s."""
        return float(self.times[0])

    @property
    def cpu_seconds(self) -> float:
        """CPU time of the integration, s."""
        return float(self.stats["cpu_seconds"])

    def modes_at(self, t: ArrayLike) -> Array:
        """Modal displacements and velocities (…, 2, n) at times t; at an impact those just after."""
        asked = np.asarray(t, dtype=float)
        known, rates = between(self.times, self.values[:, 0], self.values[:, 1], asked.ravel())
        return np.stack([known, rates], axis=1).reshape(*asked.shape, 2, self.system.size)

    def at(self, t: ArrayLike, output: str = "contact") -> Array:
        """Output at times t, m; of one that is a velocity or an acceleration, that, m/s or m/s²."""
        derivative = self.system.derivative(output)
        if derivative is None:
            return np.asarray(self.modes_at(t)[..., 0, :] @ self.system.output(output))
        if derivative.order == 1:
            return np.asarray(self.modes_at(t)[..., 1, :] @ derivative.row)
        return self._acceleration(np.asarray(t, dtype=float), derivative)

    def velocity_at(self, t: ArrayLike, output: str = "contact") -> Array:
        """Rate of an output at times t, m/s; at an impact its value just after."""
        return np.asarray(self.modes_at(t)[..., 1, :] @ self.system.output(output))

    def extremes_between(self, edges: Array, output: str) -> tuple[Array, Array]:
        """Least and greatest value of an output that is a displacement, (b,) each, between ``edges`` (b + 1,), s."""
        times = np.concatenate([self.times, edges])
        order = np.argsort(times, kind="stable")
        values = np.concatenate([self.displacement(output), self.at(edges, output)])[order]
        rates = np.concatenate([self.velocity(output), self.velocity_at(edges, output)])[order]
        times, places = times[order], np.searchsorted(times[order], edges, side="right") - 1
        bins = [slice(low, high + 1) for low, high in pairwise(places.tolist())]
        found = [extremes(times[each], values[each], rates[each]) for each in bins]
        return np.array([low for low, _ in found]), np.array([high for _, high in found])

    def _acceleration(self, t: Array, derivative: TimeDerivative) -> Array:
        """Acceleration by the equations of motion: in flight, or held on the stop by the contact force."""
        system, poses = self.system, self.modes_at(t)
        x, v = poses[..., 0, :], poses[..., 1, :]
        damped = 2 * system.zeta * system.omega * v if system.coupling is None else v @ system.coupling
        load = self.drive.load_at(t)
        force = load[..., None] * system.load + system.static - damped - system.omega**2 * x
        resting = np.searchsorted(self.rests.ravel(), t, side="right") % 2 == 1
        push = np.where(resting, force @ system.contact / system.mobility, 0.0)
        found = (force - push[..., None] * system.contact) @ derivative.row
        return np.asarray(found - derivative.base * load if derivative.base else found)

    def displacement(self, output: str = "contact") -> Array:
        """Output (m,) at ``times``, m; KeyError for an unknown name."""
        return np.asarray(self.values[:, 0] @ self.system.output(output))

    def velocity(self, output: str = "contact") -> Array:
        """Rate of an output (m,) at ``times``, m/s."""
        return np.asarray(self.values[:, 1] @ self.system.output(output))


class SampledReading:
    """Accumulates the pieces of ``hold`` periods, in order (from time 0), to the quantities of a steady point."""

    def __init__(self, system: ImpactSystem, drive: Drive, output: str, hold: int, start: State) -> None:
        self.system, self.drive, self.row, self.hold = system, drive, system.output(output), hold
        self.marks: Array = np.arange(1.0, hold + 1.0) * (2 * np.pi / drive.omega)
        self.strobes = [np.stack([start.displacement, start.velocity])]
        self.high, self.low, self.least = -np.inf, np.inf, np.inf
        self.rest, self.energy = 0.0, np.zeros(system.size)
        self.velocities: list[float] = []

    def add(self, piece: SampledPiece) -> None:
        """Add one piece."""
        low, high = self._extremes(piece, self.row)
        self.low, self.high = min(self.low, low), max(self.high, high)
        self.least = min(self.least, self._extremes(piece, self.system.contact)[0])
        self.energy += energy(piece, self.system.omega)
        self.velocities += list(piece.impact_velocities)
        self.rest += piece.rest
        self._strobe(piece)

    def _extremes(self, piece: SampledPiece, row: Array) -> tuple[float, float]:
        return extremes(piece.times, piece.values[:, 0] @ row, piece.values[:, 1] @ row, piece.smooth)

    def _strobe(self, piece: SampledPiece) -> None:
        slack = SLACK * self.marks[0]
        inside = self.marks[len(self.strobes) - 1 :]
        inside = inside[inside <= piece.times[-1] + slack]
        self.strobes += list(piece.values[np.searchsorted(piece.times, inside - slack)])

    def write(self, response: FrequencyResponse, i: int, repeats: float) -> None:
        """Write the quantities to point ``i``; ``repeats``: tolerance of ``repetition``."""
        span, struck = self.hold * self.marks[0], len(self.velocities)
        response.maximum[i], response.minimum[i] = self.high, self.low
        response.amplitude[i] = (self.high - self.low) / 2
        response.reach[i] = self.system.gap - self.least
        response.impacts_per_period[i] = struck / self.hold
        kept = self.velocities[-VELOCITIES_KEPT:]
        response.impact_velocities[i, VELOCITIES_KEPT - len(kept) :] = kept
        response.impact_velocity[i] = np.mean(self.velocities) if struck else np.nan
        response.rest[i], response.mode_energy[i] = self.rest / span, self.energy / span
        touched = struck > 0 or self.rest > 0
        period = repetition(np.array(self.strobes), self.system.omega, self.drive.omega, repeats)
        response.period[i] = period if touched else -1


def merged(rests: Array) -> Array:
    """Rests (k, 2) in order, those that follow each other without a break as one."""
    if not len(rests):
        return rests.reshape(-1, 2)
    apart = np.flatnonzero(rests[1:, 0] > rests[:-1, 1])
    return np.stack([rests[np.concatenate([[0], apart + 1]), 0], rests[np.concatenate([apart, [-1]]), 1]], axis=1)


def turning_points(times: Array, values: Array, slopes: Array) -> tuple[Array, Array]:
    """Positions (shares 0…1 of each interval) and values of the turning points of the cubics: (2, m − 1) each.

    p(s) = x₀ + a s + b s² + c s³ with p'(s) = a + 2bs + 3cs²; where a cubic does not turn inside, its ends stand in.
    """
    h, rise = np.diff(times), np.diff(values)
    a, end = h * slopes[:-1], h * slopes[1:]
    b, c = 3 * rise - 2 * a - end, a + end - 2 * rise
    with np.errstate(all="ignore"):
        q = -(b + np.copysign(np.sqrt(b * b - 3 * c * a), b))
        shares = np.stack([q / (3 * c), a / q])
    shares = np.clip(np.where(np.isfinite(shares), shares, 0.0), 0.0, 1.0)
    return shares, values[:-1] + shares * (a + shares * (b + shares * c))


def extremes(
    times: Array, values: Array, slopes: Array, smooth: NDArray[np.bool_] | None = None
) -> tuple[float, float]:
    """Least and greatest value of the motion through samples (m,)."""
    turns = turning_points(times, values, slopes)[1]
    if smooth is not None:
        turns = turns[:, smooth]
    low, high = float(np.min(values)), float(np.max(values))
    return (min(low, float(np.min(turns))), max(high, float(np.max(turns)))) if turns.size else (low, high)


def energy(piece: SampledPiece, omega: Array) -> Array:
    """Energy integral ∫ ½(η'² + ω²η²) dt of each mode (n,) over a piece: Simpson's rule, midpoints from the cubics."""
    x, v, h = piece.values[:, 0], piece.values[:, 1], np.diff(piece.times)[:, None]
    ends = (v**2 + omega**2 * x**2) / 2
    rise = np.divide(np.diff(x, axis=0), h, out=np.zeros_like(x[1:]), where=h > 0)
    middle_x = (x[:-1] + x[1:]) / 2 + h * (v[:-1] - v[1:]) / 8
    middle_v = 1.5 * rise - (v[:-1] + v[1:]) / 4
    middle = (middle_v**2 + omega**2 * middle_x**2) / 2
    if piece.smooth is not None:
        middle = np.where(piece.smooth[:, None], middle, (ends[:-1] + ends[1:]) / 2)
    return np.asarray(np.sum(h * (ends[:-1] + 4 * middle + ends[1:]), axis=0) / 6)


def between(known: Array, values: Array, slopes: Array, times: Array) -> tuple[Array, Array]:
    """Values and rates (k, …) at ``times`` (k,), by cubics through samples (m, …) at ``known`` times (m,).

    Of two samples at one time, before and after an impact, the later one counts.
    """
    left = np.clip(np.searchsorted(known, times, side="right") - 1, 0, len(known) - 2)
    step = known[left + 1] - known[left]
    share = np.divide(times - known[left], step, out=np.zeros_like(times), where=step > 0)
    like = (-1, *(1,) * (values.ndim - 1))
    s, h = np.clip(share, 0.0, 1.0).reshape(like), np.where(step > 0, step, 1.0).reshape(like)
    a, ahead, rise = h * slopes[left], h * slopes[left + 1], values[left + 1] - values[left]
    b, c = 3 * rise - 2 * a - ahead, a + ahead - 2 * rise
    return values[left] + s * (a + s * (b + s * c)), (a + s * (2 * b + 3 * s * c)) / h
