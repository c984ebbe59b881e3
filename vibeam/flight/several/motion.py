"""Event loop of several contacts: to the first root of a gap or a contact force, and what follows there."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import floor, fsum, log2
from threading import local
from typing import Any

import numpy as np

from vibeam.flight.equilibrium import NOISE, Contacts
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import PANEL
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.several.held import HeldRegime, SignalRoot, Unfollowed
from vibeam.flight.several.impact import Strike, stopped, strikes, time_left
from vibeam.flight.several.state import ContactState, Pull, next_state, pressing
from vibeam.system.impact_system import Drive
from vibeam_models.arrays import Array

HELD = regime_layout.TRACE_COLUMNS  # trace column: which contacts are held, a sum of 2^contact
COLUMNS = regime_layout.TRACE_COLUMNS + 1
DEEP = 1e4  # round-offs beyond a stop that no round-off explains
AT_STOP = 4.0  # round-offs within which a gap is none
IDLE = 64  # events in a row that take next to no time and are no impacts
EVENTS_AN_IMPACT = 16  # on average, before a run is given up
SOON = 1e-12  # share of the slowest time scale that no event is told from


@dataclass
class Segment:
    """One row of the trace, and the pose that it starts from."""

    row: Array
    pose: Array


@dataclass
class ContactMotion:
    """State of a motion, and what was traced and counted on the way."""

    pose: Array
    clock: float
    state: ContactState
    fastest: Array  # (k,) largest impact velocity of each contact
    segments: list[Segment] = field(default_factory=list)
    impacts: int = 0
    panels: int = 0
    events: int = 0


class _Own(local):
    """Regimes made so far in the calling thread, and the size of its motion."""

    def __init__(self) -> None:
        self.made: dict[tuple[int, ...], HeldRegime] = {}
        self.size = np.inf


class ContactFlights:
    """The flights of one system for drives of ``slowest`` rad/s and more: regimes of held contacts, made when met."""

    def __init__(self, contacts: Contacts, slowest: float) -> None:
        self.contacts, self.slowest, self._own = contacts, slowest, _Own()

    def __getstate__(self) -> dict[str, Any]:
        return {"contacts": self.contacts, "slowest": self.slowest}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(**state)  # type: ignore[misc]

    def regime(self, held: tuple[int, ...]) -> HeldRegime:
        """The calling thread's regime of the contacts ``held``."""
        made = self._own.made
        if held not in made:
            made[held] = HeldRegime(self.contacts, held, floor(log2(PANEL / self.slowest)))
        made[held].engine.drive[layout.MOTION] = self._own.size
        return made[held]

    def for_size(self, size: float) -> None:
        """The motion's size from now on, see ``equilibrium.size_of_motion``."""
        self._own.size = size

    def begin(self, drive: Drive, pose: Array, clock: float) -> tuple[ContactMotion, int]:
        """A motion from its first pose, and whether it can be one."""
        pose, fastest = np.array(pose, dtype=float), np.zeros(len(self.contacts.gaps))
        gaps, parts = self.contacts.clearances(pose[0])
        motion = ContactMotion(pose, clock, ContactState(), fastest)
        if np.any(gaps < -DEEP * NOISE * parts):
            return motion, layout.PENETRATED
        touched = np.flatnonzero(gaps <= AT_STOP * NOISE * parts).tolist()
        if touched:
            pose[0] = self.contacts.put(pose[0], touched)
            self._follow(drive, motion, self._blank(motion, 0.0), touched, [], regime_layout.PASS)
        return motion, layout.COMPLETE

    def advance(self, drive: Drive, motion: ContactMotion, span: float, limit: int) -> tuple[int, float]:
        """Carry ``motion`` on by ``span`` s: outcome, time done. Segments are traced from time 0 on."""
        done: list[float] = []
        idle, begun, events = 0, motion.impacts, 0
        while (now := fsum(done)) < span:
            before = motion.impacts
            try:
                found = self._first(drive, motion, span - now)
            except Unfollowed as fault:
                return int(fault.args[0]) or layout.UNRESOLVED, now
            self._event(drive, motion, found, now)
            done = [now, found.time]
            soon = found.time * self.slowest < NOISE and motion.impacts == before
            idle, events = idle + 1 if soon else 0, events + 1
            if found.signal < 0:
                return layout.COMPLETE, span
            if idle > IDLE:
                return layout.UNRESOLVED, now
            if motion.impacts - begun >= limit or events > EVENTS_AN_IMPACT * (limit + 100):
                return layout.EVENT_LIMIT, now + found.time
        return layout.COMPLETE, span

    def _first(self, drive: Drive, motion: ContactMotion, span: float) -> SignalRoot:
        """The first root of all signals, in the coordinates of the regime."""
        regime, state, count = self.regime(motion.state.held), motion.state, len(self.contacts.gaps)
        pose = regime.inward(motion.pose)
        signals = {count + i: state.starts.get(j) for i, j in enumerate(state.held)}
        away = [j for j in range(count) if j not in state.held and j not in state.implied]
        signals |= {j: state.starts.get(j) for j in away}
        best = SignalRoot(-1, span, pose, motion.clock, 0)
        for pair, (order, rise) in _pairs(signals):
            found = regime.first(drive.omega, drive.amplitude, pose, motion.clock, best.time, pair, order, rise)
            motion.panels += found.panels
            if found.signal >= 0 or best.pose is pose:
                best = found
        return best

    def _blank(self, motion: ContactMotion, now: float) -> Segment:
        row = np.zeros(COLUMNS)
        row[layout.START], row[layout.AT_CLOCK] = now, motion.clock
        row[layout.WHAT] = layout.RESTING if motion.state.held else layout.FREE
        row[HELD] = float(sum(1 << j for j in motion.state.held))
        return Segment(row, motion.pose.copy())

    def _event(self, drive: Drive, motion: ContactMotion, found: SignalRoot, now: float) -> None:
        """Close the segment at a root, or at the span's end, and see what follows."""
        segment, held = self._blank(motion, now), motion.state.held
        segment.row[layout.DURATION] = found.time
        motion.pose, motion.clock = self.regime(held).outward(found.pose), found.clock
        if found.signal < 0:
            segment.row[layout.END] = layout.SPAN_END
            motion.segments.append(segment)
            if found.time > 0:
                idle = {j: start for j, start in motion.state.starts.items() if start[0] == regime_layout.TOUCHING}
                motion.state = replace(motion.state, starts=idle)
            return
        count = len(self.contacts.gaps)
        met = [found.signal] if found.signal < count else []
        leaving = [] if met else [held[found.signal - count]]
        touched = self._touched(motion, met)
        motion.pose[0] = self.contacts.put(motion.pose[0], touched)
        segment.row[regime_layout.AT_SIDE] = (met or leaving)[0]
        self._follow(drive, motion, segment, touched, leaving, regime_layout.PASS if met else layout.RELEASE)

    def _touched(self, motion: ContactMotion, met: list[int]) -> list[int]:
        """Contacts at their stops: held, met, or as near as round-off can tell, on the way in or out."""
        gaps, parts = self.contacts.clearances(motion.pose[0])
        near = np.flatnonzero(gaps <= AT_STOP * NOISE * parts).tolist()
        return sorted({*motion.state.held, *motion.state.implied, *met, *near})

    def _follow(
        self, drive: Drive, motion: ContactMotion, segment: Segment, touched: list[int], leaving: list[int], end: int
    ) -> None:
        """Impulses, and what the touched contacts do then: ``segment`` and those of no duration after it are traced."""
        pull = Pull.of(self.contacts, drive, motion.pose, motion.clock)
        pressed = [j for j in pressing(self.contacts, pull, motion.state.held) if j not in leaving]
        struck = strikes(self.contacts, motion.pose[1], touched, pressed)
        for strike in struck:
            motion.fastest[strike.contact] = max(motion.fastest[strike.contact], strike.before)
        if struck:
            motion.pose[1] = struck[-1].velocity
            leaving = []
            pull = Pull.of(self.contacts, drive, motion.pose, motion.clock)
        least = NOISE * max((strike.before for strike in struck), default=0.0)
        state = next_state(self.contacts, pull, touched, frozenset(leaving), least)
        last = struck[-1] if struck else None
        left, remainder = -1.0, 0.0
        if last is not None and state.starts.get(last.contact, (0.0,))[0] == 1 and last.contact not in state.held:
            left, remainder, state = self._completed(drive, motion, pull, state, last, touched)
        motion.state = state
        self._trace(motion, segment, struck, end, left, remainder)

    def _completed(
        self, drive: Drive, motion: ContactMotion, pull: Pull, state: ContactState, last: Strike, touched: list[int]
    ) -> tuple[float, float, ContactState]:
        """The accumulation at the contact struck last, completed where it is time: time left, its error, the state."""
        which, after, top = last.contact, state.starts[last.contact][1], float(motion.fastest[last.contact])
        contacts, held = self.contacts, list(state.held)
        slowest = max(drive.omega, self.slowest)
        left, remainder = time_left(contacts, pull, held, which, after, top, slowest)
        if left < 0:
            return left, remainder, state
        before = motion.pose, motion.state
        motion.pose = np.array([motion.pose[0], stopped(contacts.rows[[*held, which]], motion.pose[1])])
        pull = Pull.of(contacts, drive, motion.pose, motion.clock)
        motion.state = next_state(contacts, pull, touched, least=NOISE * after)
        soon = left * self.slowest < SOON  # no event is told from its end
        if which in motion.state.held and (soon or self._first(drive, motion, left).signal < 0):
            return left, remainder, motion.state
        motion.pose, motion.state = before
        return -1.0, 0.0, state

    def _trace(
        self, motion: ContactMotion, segment: Segment, struck: list[Strike], end: int, left: float, remainder: float
    ) -> None:
        motion.events += 1
        motion.impacts += len(struck)
        for strike in struck:
            row = segment.row
            row[layout.END], row[layout.BEFORE] = layout.IMPACT, strike.before
            row[regime_layout.AT_SIDE] = strike.contact
            motion.segments.append(segment)
            if strike is struck[-1]:
                stuck = strike.contact in motion.state.held
                row[layout.LEFT], row[layout.REMAINDER] = max(left, 0.0), remainder
                row[layout.END] = layout.CHATTER if left >= 0 else layout.STUCK if stuck else layout.IMPACT
            else:
                segment = Segment(row.copy(), np.array([motion.pose[0], strike.velocity]))
                segment.row[layout.START] += row[layout.DURATION]
                segment.row[layout.DURATION], segment.row[layout.AT_CLOCK] = 0.0, motion.clock
                segment.row[layout.WHAT] = layout.FREE
        if not struck:
            segment.row[layout.END] = end
            motion.segments.append(segment)


def _pairs(signals: dict[int, tuple[float, float] | None]) -> list[tuple[tuple[int, ...], tuple[float, float]]]:
    """Signals one or two at a time, as the kernels watch them: the second of two starts positive."""
    special = [which for which, start in signals.items() if start is not None]
    plain = [which for which, start in signals.items() if start is None]
    found: list[tuple[tuple[int, ...], tuple[float, float]]] = []
    while special or plain:
        first = special.pop(0) if special else plain.pop(0)
        second = [plain.pop(0)] if plain else []
        found.append(((first, *second), signals[first] or (0.0, 0.0)))
    return found
