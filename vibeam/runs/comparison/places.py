"""Response of one model in one direction of a sweep as places, and as branches between their ends.

A sweep says at its frequencies what the motion is. Where two neighbours differ in kind, or one motion jumps, further
points are put between them where that counts, each from the state before, until the end of the branch is known to a
``tolerance``: so the ends of branches do not hang on the grid. A motion that the grid's step threw off its branch is
followed on to the branch's own end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from vibeam.periodic.motion_kind import IRREGULAR, JUMP, UNKNOWN, SteadyKind, kinds_of, width
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State, StatesAfter

TOLERANCE = 1e-3  # relative width in frequency to which an end is bracketed
MOST = 30  # points put between two neighbours


@dataclass(frozen=True, eq=False)
class SweptPlace:
    """Motion at one frequency in Hz: its kind, amplitude in the unit of the output, and a way to its ``state``.

    ``cost``: CPU seconds that it took.
    """

    frequency: float
    kind: SteadyKind
    amplitude: float
    cost: float
    state: Callable[[], State | None] = field(default=lambda: None)


class Simulator(Protocol):
    """Steady points of a model, one at a time."""

    @property
    def done(self) -> bool:
        """True where no more of them may be computed."""

    def at(self, frequency: float, state: State | None, settle: bool = True) -> tuple[FrequencyResponse, State]:
        """The point at a frequency in Hz from a state; without ``settle`` read at once."""


def places_of(response: FrequencyResponse, after: StatesAfter | None = None) -> list[SweptPlace]:
    """Places of the points of a response in the order swept, with the states ``after`` them where known."""
    columns = zip(
        response.frequency.tolist(), kinds_of(response), response.amplitude.tolist(),
        np.nan_to_num(response.cpu_seconds).tolist(), strict=True,
    )  # fmt: skip
    return [SweptPlace(*row, _State(after, i)) for i, row in enumerate(columns)]


@dataclass(frozen=True)
class _State:
    """State after a stored point, made when it is asked for."""

    after: StatesAfter | None
    point: int

    def __call__(self) -> State | None:
        return None if self.after is None else self.after.at(self.point)


def simulated(simulator: Simulator, frequency: float, before: SweptPlace | None, settle: bool = True) -> SweptPlace:
    """Place at a frequency, reached from the one ``before``, or from rest."""
    response, state = simulator.at(frequency, None if before is None else before.state(), settle)
    [found] = places_of(response)
    return replace(found, frequency=frequency, state=lambda: state)


def apart(one: SweptPlace, other: SweptPlace) -> bool:
    """Test whether two neighbours are on different branches, as far as they tell."""
    if one.kind != other.kind:
        return True
    larger = max(abs(one.amplitude), abs(other.amplitude))
    return one.kind.repeats and abs(one.amplitude - other.amplitude) > JUMP * larger


def bracketed(places: Sequence[SweptPlace], i: int, simulator: Simulator, tolerance: float) -> list[SweptPlace]:
    """The places, with further ones after the one at ``i`` that bracket the ends of branches there.

    Where the grid's step alone threw the motion off its branch, that is followed on to its own end.
    """
    found = list(places[: i + 1])
    for at in range(i, len(places) - 1):
        more = _halved(found[-1], places[at + 1], simulator, tolerance)
        found += more
        last = more[-1] if more else found[-1]
        again = _reached(last, places[i], places[at + 1], simulator) if more else None
        if again is None:
            return [*found, *places[at + 1 :]]
        found.append(again)
    return found


def is_open(one: SweptPlace, other: SweptPlace, tolerance: float) -> bool:
    """Test whether an end of a branch lies between two neighbours, and is not bracketed yet."""
    if UNKNOWN in (one.kind.periods, other.kind.periods) or one.state() is None:
        return False
    return apart(one, other) and width(one.frequency, other.frequency) > tolerance


def _halved(here: SweptPlace, there: SweptPlace, simulator: Simulator, tolerance: float) -> list[SweptPlace]:
    """Places between two neighbours, which bracket all ends of branches that halving comes upon."""
    pending, found, count = [there], list[SweptPlace](), 0
    while True:
        if is_open(here, pending[-1], tolerance) and count < MOST and not simulator.done:
            pending.append(simulated(simulator, 0.5 * (here.frequency + pending[-1].frequency), here))
            count += 1
        elif len(pending) == 1:
            return found
        else:
            here = pending.pop()
            found.append(here)


def _reached(last: SweptPlace, first: SweptPlace, there: SweptPlace, simulator: Simulator) -> SweptPlace | None:
    """The next place of the grid from the ``last`` before it, where that is on the branch of the ``first`` still."""
    if simulator.done or not apart(last, there) or last.kind != first.kind or last.kind.periods == IRREGULAR:
        return None
    again = simulated(simulator, there.frequency, last)
    return None if apart(last, again) else again


@dataclass(frozen=True, eq=False)
class SweptBranch:
    """Branch of a response from ``start`` to ``end`` in Hz, in the order swept, and its own ``places``.

    ``open_start``, ``open_end``: half the width between the places beside the ends, Hz; 0 at the ends of the sweep.
    """

    kind: SteadyKind
    places: tuple[SweptPlace, ...]
    start: float
    end: float
    open_start: float = 0.0
    open_end: float = 0.0

    @property
    def width(self) -> float:
        """Relative width in frequency."""
        return width(self.start, self.end)


def swept_branches(places: Sequence[SweptPlace], narrowest: float = 0.0) -> list[SweptBranch]:
    """Branches of a response in the order swept; one narrower than ``narrowest`` goes to its wider neighbour.

    To one that has contact as it has, or has none as it: a narrow range with contact stays.
    """
    found = list(_stretches(places))
    while narrow := [i for i in range(len(found)) if found[i].width < narrowest and _hosts(found, i)]:
        found = _absorbed(found, min(narrow, key=lambda i: found[i].width))
    return found


def _stretches(places: Sequence[SweptPlace]) -> Iterator[SweptBranch]:
    first = 0
    for i, place in enumerate(places):
        if i + 1 == len(places) or apart(place, places[i + 1]):
            start, open_start = _end(places, first - 1) if first else (places[0].frequency, 0.0)
            end, open_end = _end(places, i) if i + 1 < len(places) else (place.frequency, 0.0)
            yield SweptBranch(place.kind, tuple(places[first : i + 1]), start, end, open_start, open_end)
            first = i + 1


def _end(places: Sequence[SweptPlace], i: int) -> tuple[float, float]:
    """End between a place and the next one, and half the width between them."""
    one, other = places[i].frequency, places[i + 1].frequency
    return 0.5 * (one + other), 0.5 * abs(other - one)


def _hosts(found: Sequence[SweptBranch], i: int) -> list[int]:
    """Neighbours that a narrow branch may join."""
    own = found[i].kind.strikes
    return [at for at in (i - 1, i + 1) if 0 <= at < len(found) and found[at].kind.strikes == own]


def _absorbed(found: list[SweptBranch], i: int) -> list[SweptBranch]:
    """Branches without a narrow one, which joins its wider neighbour."""
    to = max(_hosts(found, i), key=lambda at: found[at].width)
    first, second = sorted((i, to))
    joined = replace(_joined(found[first], found[second], found[to].places), kind=found[to].kind)
    return _united([*found[:first], joined, *found[second + 1 :]], first)


def _joined(first: SweptBranch, second: SweptBranch, places: tuple[SweptPlace, ...]) -> SweptBranch:
    return replace(second, places=places, start=first.start, open_start=first.open_start)


def _united(found: list[SweptBranch], i: int) -> list[SweptBranch]:
    """Branches of which the one at ``i`` is united with neighbours that go on as it does."""
    for at in (i, i - 1):
        if 0 <= at < len(found) - 1 and _goes_on(found[at], found[at + 1]):
            both = _joined(found[at], found[at + 1], found[at].places + found[at + 1].places)
            found = [*found[:at], both, *found[at + 2 :]]
    return found


def _goes_on(one: SweptBranch, other: SweptBranch) -> bool:
    """Test whether a branch is the same on the other side of what lay between the two."""
    if one.kind != other.kind or not one.kind.repeats:
        return one.kind == other.kind
    levels = np.array([one.places[-1].amplitude, other.places[0].amplitude])
    return bool(np.ptp(levels) <= JUMP * np.abs(levels).max())
