"""Readout of motions with several contacts: a period's extremes, energies and impacts; holds, and derivatives."""

from __future__ import annotations

import numpy as np

from vibeam.flight.equilibrium import Contacts
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import REPEATS, SAME
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.readout import STRUCK
from vibeam.flight.several.held import HeldRegime, Unfollowed
from vibeam.flight.several.motion import HELD, ContactFlights, ContactMotion
from vibeam.flight.several.state import Pull
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array

NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)
TURN = 4.0  # radians of the fastest mode to a panel of Gauss' quadrature
MOST_PANELS = 256  # a segment


def holds_of(trace: Array, end: float, contact: int | None) -> Array:
    """(m, 2): begin and end, s, of the stretches of a motion until ``end`` in which a contact, or any, was held.

    A hold begins where the accumulation of impacts before it is over.
    """
    bits = trace[:, HELD].astype(np.int64)
    held = (bits if contact is None else bits >> contact & 1) > 0
    change = np.diff(np.concatenate([[False], held, [False]]).astype(int))
    times, first = np.append(trace[:, layout.START], end), np.flatnonzero(change == 1)
    before = trace[np.maximum(first - 1, 0)]
    accumulated = (first > 0) & (before[:, layout.END] == layout.CHATTER)
    accumulated &= (contact is None) | (before[:, regime_layout.AT_SIDE] == contact)
    return np.stack([times[first] + np.where(accumulated, before[:, layout.LEFT], 0.0), times[change == -1]], axis=1)


def held_in(row: Array, count: int) -> tuple[int, ...]:
    """The contacts held in a segment, of its trace row."""
    bits = int(row[HELD])
    return tuple(j for j in range(count) if bits >> j & 1)


class PointReader:
    """One point of a sweep, filled period by period as ``kernels.layout`` has it."""

    def __init__(self, flights: ContactFlights, drive: Drive, row: Array, reading: int) -> None:
        self.flights, self.drive, self.row, self.reading = flights, drive, row, reading
        self.result, self.energy = np.zeros(layout.RESULT_ROWS), np.zeros(len(row))
        self.result[[layout.HIGH, layout.LEAST, layout.CONTACT_LEAST]] = -np.inf, np.inf, np.inf
        self._share: tuple[Array, float] | None = None  # of a period that the next ones repeat

    def note(self, motion: ContactMotion, strobes: list[Array]) -> int:
        """Read off the segments of the period that ``motion`` ended, begun at the last strobe: the outcome."""
        before, rested = self.energy.copy(), self.result[layout.REST_TIME]
        for segment in motion.segments:
            self._count(segment.row)
            if self._share is None and segment.row[layout.DURATION] > 0:
                try:
                    self._read(segment.row, segment.pose)
                except Unfollowed:
                    return layout.UNRESOLVED
        if self._share is not None:
            self.energy += self._share[0]
            self.result[layout.REST_TIME] += self._share[1]
        elif _distance(self._rates, motion.pose - strobes[-1]) <= SAME * _distance(self._rates, motion.pose):
            self._share = self.energy - before, self.result[layout.REST_TIME] - rested
        return layout.COMPLETE

    @property
    def _rates(self) -> Array:
        return np.hypot(self.flights.contacts.system.omega, self.drive.omega)

    def _count(self, row: Array) -> None:
        if row[layout.END] not in STRUCK:
            return
        self.result[layout.VELOCITY + int(self.result[layout.STRUCK]) % layout.KEPT] = row[layout.BEFORE]
        self.result[layout.STRUCK] += 1
        self.result[layout.SPEED_SUM] += row[layout.BEFORE]

    def _read(self, row: Array, pose: Array) -> None:
        duration, held = float(row[layout.DURATION]), held_in(row, len(self.flights.contacts.gaps))
        self.result[layout.REST_TIME] += duration if row[layout.WHAT] != layout.FREE else 0.0
        regime, clock = self.flights.regime(held), float(row[layout.AT_CLOCK])
        inner = regime.inward(pose)
        after, weights = _nodes(regime, duration)
        poses = regime.outward(regime.poses(self.drive.omega, self.drive.amplitude, inner, clock, after))
        self._extremes(regime, inner, clock, duration, poses)
        if self.reading >= layout.EVERYTHING:
            omega = self.flights.contacts.system.omega
            self.energy += weights @ (poses[:, 1] ** 2 + (omega * poses[:, 0]) ** 2) / 2

    def _extremes(self, regime: HeldRegime, inner: Array, clock: float, duration: float, poses: Array) -> None:
        """Widen the extremes of the output, and of the first contact where they are asked for."""
        contact, result = self.flights.contacts.system.contact, self.result
        ask = [(self.row, layout.HIGH, 1.0), (self.row, layout.LEAST, -1.0)]
        ask += [(contact, layout.CONTACT_LEAST, -1.0)] if self.reading >= layout.REACH_TOO else []
        for row, place, sign in ask:
            swing = float(np.max(np.abs(poses[:, 0]) @ np.abs(row)))
            above = 4.0 * swing + 1e-300
            drive = self.drive
            top = regime.highest(drive.omega, drive.amplitude, inner, clock, duration, sign * row, above)
            result[place] = sign * max(sign * result[place], top)


def _nodes(regime: HeldRegime, duration: float) -> tuple[Array, Array]:
    """Times and weights of Gauss' quadrature over a segment."""
    fastest = float(np.max(regime.engine.omega))
    panels = int(np.clip(np.ceil(fastest * duration / TURN), 1, MOST_PANELS))
    width = duration / panels
    places = (np.arange(panels)[:, None] + (NODES + 1) / 2) * width
    return places.ravel(), np.tile(WEIGHTS * width / 2, panels)


def _distance(rates: Array, apart: Array) -> float:
    """Size of a difference of states in velocity units."""
    return float(np.sqrt(np.sum(apart[1] ** 2 + (rates * apart[0]) ** 2)))


def repetition(omega: Array, drive: float, strobes: Array, longest: int) -> int:
    """The least k ≤ longest such that each of the last k strobes repeats the one k periods before, else 0."""
    rates, hold = np.hypot(omega, drive), len(strobes) - 1
    size = max(_distance(rates, each) for each in strobes)
    for k in range(1, min(longest, hold // 2) + 1):
        apart = (_distance(rates, strobes[turn] - strobes[turn - k]) for turn in range(hold - k + 1, hold + 1))
        if max(apart) <= REPEATS * size:
            return k
    return 0


def derivatives_in(
    system: ImpactSystem, drive: Drive, rows: Array, clocks: Array, poses: Array, row: Array, order: int
) -> Array:
    """Derivative of the ``order`` 2 or 3 of what a ``row`` reads, at states in the segments ``rows`` of a trace."""
    contacts, found = Contacts.of(system), np.empty(len(rows))
    for i, (segment, clock) in enumerate(zip(rows, clocks.tolist(), strict=True)):
        held = contacts.rows[list(held_in(segment, len(contacts.gaps)))]
        found[i] = row @ Pull.of(contacts, drive, poses[i], clock).constrained(held)[order - 2]
    return found
