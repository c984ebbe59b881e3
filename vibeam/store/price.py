"""Price of a long computation, from steps of it that are computed for a while and thrown away."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil, inf, sqrt
from time import process_time

import numpy as np

from vibeam.store.blocks import packed
from vibeam.store.parts import LongWork, WorkStep

SAMPLES = 12  # of each name, at least, where its steps are long: pieces of them then
GOLDEN = (sqrt(5) - 1) / 2
FLOOR = 0.05  # of the price: what other programs on the machine, caches and clocks make of equal work
TURN = 1800.0  # s that one part takes, about
MOST_PARTS = 1000  # of an array of jobs, as many queues have it


@dataclass(frozen=True)
class Price:
    """CPU ``seconds`` of one core, good to the relative ``error`` (two standard deviations of the samples, and 5 %).

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
        budget = seconds * guesses[name] / sum(guesses.values())
        found = np.array(list(_samples(work, name, cut, budget)))
        items, costs, sizes = found.T
        rate = costs.sum() / items.sum()
        cost += rate * cut.stop
        size += sizes.sum() / items.sum() * cut.stop
        left = max(0.0, 1 - items.sum() / cut.stop)
        spread = (costs - rate * items).std(ddof=1) if len(found) > 1 else inf if left else 0.0
        variance += left * (cut.stop / items.mean() * spread) ** 2 / len(found) if left else 0.0
    error = 2 * sqrt(variance) / cost + FLOOR if cost else FLOOR
    total = sum(map(work.size, work.every))
    return Price(cost, error, total, size, work.files, len(work.every), _memory(), process_time() - begun)


def _samples(work: LongWork, name: str, cut: range, budget: float) -> Iterator[tuple[int, float, int]]:
    """Items, CPU s and bytes of steps all over a name, pieces of them where they are long; the first is not counted."""
    middle = cut.stop // 2
    _timed(work, WorkStep(0, name, middle, middle + 1))
    _, one, _ = _timed(work, WorkStep(0, name, middle, middle + 1))
    whole = [(first, min(first + cut.step, cut.stop)) for first in cut]
    length, used, at = max(1, min(cut.step, int(budget / SAMPLES / max(one, 1e-6)))), 0.0, 0.5
    if length < cut.step and budget < cut.stop * one:
        whole = [(first, min(first + length, cut.stop)) for first in range(0, cut.stop, length)]
    taken = set[int]()
    while len(taken) < len(whole) and (used < budget or len(taken) < 3):
        place = int(at * len(whole))
        at = (at + GOLDEN) % 1
        while place in taken:
            place = (place + 1) % len(whole)
        taken.add(place)
        sample = _timed(work, WorkStep(place, name, *whole[place]))
        used += sample[1]
        yield sample


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
