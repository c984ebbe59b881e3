"""Price of a long computation, from steps of it that are computed for a while and thrown away."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil, sqrt
from time import process_time

import numpy as np

from vibeam.store.blocks import packed
from vibeam.store.long_work import LongWork, WorkStep
from vibeam_models.arrays import Array

SAMPLES = 12  # of each name, about, where its steps are long: pieces of them then
EVENLY = 9  # samples all over a name, before those where costs change most
FLOOR = 0.05  # of the price: what other programs on the machine, caches and clocks make of equal work
TURN = 1800.0  # s that one part takes, about
MOST_PARTS = 1000  # of an array of jobs, as many queues have it


@dataclass(frozen=True)
class Price:
    """CPU ``seconds`` of one core, good to the relative ``error`` (two standard deviations, and 5 %).

    ``points``, ``files`` and ``steps`` of all; ``bytes`` on disk, and as many again while they are gathered;
    ``memory``: bytes of a process of one thread, None where the system does not say; ``sampled``: CPU s of the samples.
    """

    seconds: float
    error: float
    points: int
    bytes: float
    files: int
    steps: int
    memory: int | None
    sampled: float

    @property
    def core_hours(self) -> float:
        """The time in hours of a core."""
        return self.seconds / 3600

    @property
    def parts(self) -> int:
        """Number of parts that take about half an hour each, as far as there are files and places in a queue."""
        return max(1, min(ceil(self.seconds / TURN), self.files, MOST_PARTS))

    @property
    def minutes_a_part(self) -> int:
        """Minutes to ask for a part: twice what it takes on a core, ten at least."""
        return max(10, ceil(2 * self.seconds * (1 + self.error) / self.parts / 60))


def price(work: LongWork, seconds: float = 30.0) -> Price:
    """The price of ``work``, after about so many ``seconds`` of it in one thread; of a short one after all of it."""
    begun, cost, variance, size = process_time(), 0.0, 0.0, 0.0
    guesses = {name: len(cut) * work.seconds.get(name, 1.0) for name, cut in work.steps.items()}
    for name, cut in work.steps.items():
        found = _samples(work, name, cut, seconds * guesses[name] / sum(guesses.values()))
        first, items, costs, sizes = found.T
        rates = costs / items
        gaps, between = (
            _gaps(cut.stop, first, items),
            np.concatenate((rates[:1], (rates[1:] + rates[:-1]) / 2, rates[-1:])),
        )
        cost += float(costs.sum() + gaps @ between)
        variance += float(np.sum((gaps * _jumps(rates)) ** 2))
        size += float(sizes.sum() / items.sum() * cut.stop)
    error = 2 * sqrt(variance) / cost + FLOOR if cost else FLOOR
    total = sum(map(work.size, work.every))
    return Price(cost, error, total, size, work.files, len(work.every), _memory(), process_time() - begun)


def _gaps(stop: int, first: Array, items: Array) -> Array:
    """Numbers of items before the first sample, between samples, and after the last."""
    return np.concatenate((first[:1], first[1:] - (first + items)[:-1], [stop - first[-1] - items[-1]]))


def _jumps(rates: Array) -> Array:
    """Half the difference of an item's cost across each gap, which a jump in it can be off; at an end, the next."""
    inner = np.abs(np.diff(rates)) / 2 if len(rates) > 1 else rates / 2
    return np.concatenate((inner[:1], np.abs(np.diff(rates)) / 2, inner[-1:]))


def _samples(work: LongWork, name: str, cut: range, budget: float) -> Array:
    """First item, items, CPU s and bytes of steps, in their order: some evenly, then where costs change most.

    Where a step is long it is a piece of it: what is taken together costs less than one by one, so that a piece is as
    long as the budget affords.
    """
    middle, length, cost = cut.stop // 2, 1, 0.0
    _timed(work, WorkStep(0, name, middle, middle + 1))  # what is loaded or made at first is no price
    while length < cut.step and cost < budget / SAMPLES:
        length = min(2 * length, cut.step)
        first = min(middle, max(cut.stop - length, 0))
        cost = _timed(work, WorkStep(0, name, first, min(first + length, cut.stop)))[1]
    places, used = range(0, cut.stop, length), 0.0
    taken: dict[int, tuple[int, float, int]] = {}
    evenly = list(dict.fromkeys(np.linspace(0, len(places) - 1, EVENLY).round().astype(int).tolist()))
    while len(taken) < len(places) and (used < budget or len(taken) < 3):
        place = evenly.pop(len(evenly) // 2) if evenly else _next(taken, len(places))
        first = places[place]
        taken[place] = _timed(work, WorkStep(place, name, first, min(first + length, cut.stop)))
        used += taken[place][1]
    return np.array([(places[place], *taken[place]) for place in sorted(taken)])


def _next(taken: Mapping[int, tuple[int, float, int]], count: int) -> int:
    """The place in the middle of the gap in which most can be missed: by a jump, or by a tenth of what it holds."""
    found = np.array(sorted(taken))
    rates = np.array([taken[place][1] / taken[place][0] for place in found.tolist()])
    gaps = _gaps(count, found, np.ones(len(found), dtype=int))
    held = np.concatenate((rates[:1], np.maximum(rates[1:], rates[:-1]), rates[-1:]))
    widest = int(np.argmax(gaps * (_jumps(rates) + held / 10)))
    begin = 0 if widest == 0 else int(found[widest - 1]) + 1
    return begin + int(gaps[widest]) // 2


def _timed(work: LongWork, step: WorkStep) -> tuple[int, float, int]:
    begun = process_time()
    content = packed(work.evaluate(step))
    return step.last - step.first, process_time() - begun, len(content)


def _memory() -> int | None:
    """Bytes that this process has taken at most; None where the system does not say."""
    if sys.platform == "win32":
        return None
    import resource

    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most if sys.platform == "darwin" else most * 1024
