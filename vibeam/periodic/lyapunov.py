"""Lyapunov exponents of a motion by products of exact flights and saltation matrices.

The exponents λ are the mean rates at which disturbances of (η, η') grow, in 1/s, 2n of them: the drive's phase is no
state, so none is trivial. Along a motion they are products of its tangent maps (``TangentMaps``: closed-form flow
between events, saltation matrix at each), made orthonormal again and again by QR (Benettin et al. 1980; Müller 1995 for
systems with impacts).

- Of a motion that repeats after n drive periods they are known without a limit: λ = log|μ|/nT with its Floquet
  multipliers μ. The motion is found to round-off by Newton's method first, so this holds to round-off too.
- Of any other they are a mean over a finite time, with the standard error of that mean by batches.
- A rest on the stop loses two directions, an impact with R = 0 one: λ = −∞ there.

Independent of all that, their sum is known: Σλ = −trace D + log(R²) times the impacts a second (one R, no rest).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vibeam.flight.disturbance.maps import tangent_fault
from vibeam.flight.disturbance.tangent import LOST_AT_REST
from vibeam.flight.engine.threads import pause
from vibeam.flight.readout import rests, struck
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.shooting import cycle
from vibeam.periodic.stroboscopic import DECAY, Flown, StroboscopicMap
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arguments import count as counted
from vibeam_models.arguments import number, refuse, require
from vibeam_models.arrays import Array, ValueRecord

BATCHES = 20  # of which the standard error of a mean is taken
ALIGNED = 50  # drive periods over which disturbances turn into their directions before the mean begins
PIECE = 50  # drive periods flown at a time
TOGETHER = 16  # segments over which one disturbance is carried at once
SURE = 2.0  # standard errors by which an exponent must differ from 0 to have a sign


@dataclass(frozen=True, eq=False, repr=False)
class LyapunovSpectrum(ValueRecord):
    """Lyapunov exponents of a motion, in 1/s.

    ``period``: drive periods after which the motion repeats, and the exponents are then those of its Floquet
    multipliers, to round-off; 0: it does not within 16, and they are means over ``time`` s.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> found = vibeam.lyapunov(system, vibeam.Drive(2.0, 0.1))
    >>> found.sign, found.exponents.shape  # neighbours come together
    (-1, (2,))
    """

    exponents: Array  #: (k,), largest first; −∞ for directions that are lost
    errors: Array  #: (k,) standard errors, 0 where the motion repeats
    period: int
    time: float  #: s
    impacts: int  #: within ``time``
    rests: int  #: within ``time``
    state: State  #: on the motion, at the drive's time ``phase_time``
    phase_time: float  #: s within a drive period

    @property
    def largest(self) -> float:
        """Largest exponent, 1/s."""
        return float(self.exponents[0])

    @property
    def sign(self) -> int:
        """1: chaos, −1: neighbours come together; 0: within two standard errors of zero."""
        margin = SURE * float(self.errors[0])
        return int(self.largest > margin) - int(self.largest < -margin)

    @property
    def dimension(self) -> float:
        """Kaplan–Yorke dimension of the attractor in the stroboscopic map; needs all exponents up to it (else NaN)."""
        sums = np.cumsum(self.exponents)
        if sums[0] < 0:
            return 0.0
        falls = np.flatnonzero(sums < 0)
        if not len(falls):
            return float("nan")
        j = int(falls[0])
        return j + float(sums[j - 1] / abs(self.exponents[j]))


def lyapunov(
    system: ImpactSystem,
    drive: Drive,
    state: State | None = None,
    *,
    t_start: float = 0.0,
    settle: int = 300,
    periods: int = 1000,
    count: int | None = None,
) -> LyapunovSpectrum:
    """Compute the largest ``count`` (None: all 2n) Lyapunov exponents of the motion reached from ``state``.

    ``state`` (None: static equilibrium) at ``t_start`` s, ``settle`` drive periods before anything is taken, 0 for a
    state that is on the motion meant: of a periodic one its exponents are those of that motion, stable or not.
    ``periods``: drive periods of the mean where the motion does not repeat. For any damping and law, one stop or two,
    several contacts. ValueError for an R(v) without slope and for integrated laws among several contacts, for arguments
    that make no sense, and where the motion ends on the way (too many impacts).

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> from math import log, pi
    >>> found, orbit = vibeam.lyapunov(system, drive := vibeam.Drive(2.0, 0.1)), vibeam.orbits(system, drive)[0]
    >>> found.period, bool(abs(found.largest - log(abs(orbit.multipliers[0])) / pi) < 1e-9)  # log|μ|/T
    (1, True)
    """
    require("system", system, ImpactSystem)
    require("drive", drive, Drive)
    require("state", state, State, none_too=True)
    begin, settle, periods, wanted = _checked(system, t_start, settle, periods, count)
    here = StroboscopicMap(system, drive, begin)
    if reason := tangent_fault(system):
        raise ValueError(f"system: Lyapunov exponents are not known for {reason}")
    for step in _pieces(settle):
        state = here.flown(state, step).state
    section, start = here.in_flight(state)
    orbit = cycle(section, start)
    if orbit is not None:
        return _of_orbit(orbit, wanted)
    return mean_exponents(section, start, periods, wanted)


def _checked(
    system: ImpactSystem, t_start: float, settle: int, periods: int, count: int | None
) -> tuple[float, int, int, int]:
    faults: list[str] = []
    begin = number("t_start", t_start, faults, least=0.0)
    settling = counted("settle", settle, faults)
    mean = counted("periods", periods, faults, least=BATCHES)
    whole = 2 * system.size
    wanted = whole if count is None else counted("count", count, faults, least=1, most=whole)
    refuse("lyapunov", faults)
    return begin, settling, mean, wanted


def _pieces(periods: int) -> Iterator[int]:
    """Numbers of drive periods flown at a time."""
    while periods > 0:
        yield min(PIECE, periods)
        periods -= PIECE


def _of_orbit(orbit: Orbit, wanted: int) -> LyapunovSpectrum:
    with np.errstate(divide="ignore"):
        found = np.log(np.abs(orbit.multipliers[:wanted])) / orbit.span
    return LyapunovSpectrum(
        found, np.zeros(wanted), orbit.periods, orbit.span, len(orbit.times), orbit.rests, orbit.state, orbit.time
    )


def mean_exponents(section: StroboscopicMap, start: State, periods: int, wanted: int) -> LyapunovSpectrum:
    """The largest ``wanted`` exponents of a motion as means over ``periods``, whether it repeats or not."""
    walk, taken = _Disturbances(section, wanted), np.diff(np.linspace(0, periods, BATCHES + 1).astype(int))
    growths, events = [], np.zeros((1 + BATCHES, 2), dtype=np.int64)
    for batch, size in enumerate((ALIGNED, *taken.tolist())):  # the first is no part of the mean
        walk.logs = np.zeros(wanted)
        for step in _pieces(size):
            flown = section.flown(start, step)
            walk.along(flown)
            start, trace = flown.state, flown.segments.trace
            events[batch] += int(struck(trace).sum()), int(rests(trace).sum())
        growths.append(walk.logs / (size * section.period))
    with np.errstate(invalid="ignore"):
        rates, weights = np.array(growths[1:]), taken / taken.sum()
        mean = weights @ rates
        error = np.std(rates, axis=0, ddof=1) / np.sqrt(BATCHES)
    lost = ~np.isfinite(mean)
    order = np.argsort(-np.where(lost, -np.inf, mean), kind="stable")
    return LyapunovSpectrum(
        np.where(lost, -np.inf, mean)[order], np.where(lost, 0.0, error)[order], 0, periods * section.period,
        int(events[1:, 0].sum()), int(events[1:, 1].sum()), start, section.time,
    )  # fmt: skip


class _Disturbances:
    """Orthonormal disturbances carried along a motion, and the logarithms of what they have grown by."""

    def __init__(self, section: StroboscopicMap, wanted: int) -> None:
        system = section.system
        self.units = section.units[:, None]
        self.ratio, self.most = self.units / section.units, LOST_AT_REST * (1 + len(system.further or ()))
        start = np.random.default_rng(0).standard_normal((2 * system.size, wanted))
        self.frame, self.logs = np.linalg.qr(start)[0], np.zeros(wanted)

    def along(self, flown: Flown) -> None:
        """Carry the disturbances along; directions that are lost have −∞ from then on."""
        maps, whole = flown.maps(), len(self.units)
        for first in range(0, len(maps), TOGETHER):
            part = range(first, min(first + TOGETHER, len(maps)))
            nothing_left = whole <= self.most and any(maps.lost(i) >= whole for i in part)
            if self.frame.shape[1] == 1 and not nothing_left:
                self._take(self.units * maps.carried(self.frame / self.units, part.start, part.stop), 0)
                continue
            for i in part:
                pause()
                steps = maps.steps(i, maps.fastest, DECAY)
                for k, matrix in enumerate(steps, 1):
                    self._take((matrix * self.ratio) @ self.frame, maps.lost(i) if k == len(steps) else 0)

    def _take(self, grown: Array, lost: int) -> None:
        left = min(grown.shape[1], len(self.ratio) - lost)
        self.logs[left:] = -np.inf
        frame, upper = np.linalg.qr(grown)
        self.frame, sizes = frame[:, :left], np.abs(np.diag(upper))[:left]
        with np.errstate(divide="ignore"):
            self.logs[:left] += np.log(sizes)
