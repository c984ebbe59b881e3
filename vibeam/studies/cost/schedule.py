"""Schedule within a budget: the cheapest run next, of any fidelity and solver; the others are listed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush

from vibeam.studies.cost.settings import Ladder, Setting


@dataclass(frozen=True)
class Schedule:
    """Series of settings of one solver on one fidelity; ``estimate``: seconds of its first setting."""

    fidelity: str
    ladder: Ladder
    estimate: float


@dataclass(frozen=True)
class LeftOut:
    """Run that did not take place, and why."""

    fidelity: str
    run: str
    why: str


Run = Callable[[str, Setting], float | None]


def run_schedule(tracks: Sequence[Schedule], left: Callable[[], float], run: Run) -> list[LeftOut]:
    """Run setting by setting, always the one estimated to be cheapest, while ``left()`` seconds allow it.

    ``run(fidelity, rung)`` gives the seconds it took, None where that ladder had better not be climbed further. A
    rung's estimate is what the one below it took, times its ``growth``. Gives what was left out.
    """
    heap = [(track.estimate, order, 0, track) for order, track in enumerate(tracks)]
    heapify(heap)
    out: list[LeftOut] = []
    while heap:
        estimate, order, index, track = heappop(heap)
        rungs = track.ladder[index:]
        if estimate > left():
            out += _left_out(track.fidelity, rungs, estimate, max(left(), 0.0))
            continue
        took = run(track.fidelity, rungs[0])
        if took is None:
            why = f"{rungs[0].label} broke down before it"
            out += [LeftOut(track.fidelity, rung.label, why) for rung in rungs[1:]]
        elif len(rungs) > 1:
            heappush(heap, (took * rungs[1].growth, order, index + 1, track))
    return out


def _left_out(fidelity: str, rungs: Ladder, estimate: float, left: float) -> list[LeftOut]:
    out = []
    for index, rung in enumerate(rungs):
        estimate *= rung.growth if index else 1.0
        out.append(LeftOut(fidelity, rung.label, f"about {estimate:.2g} s, with {left:.2g} s of the budget left"))
    return out
