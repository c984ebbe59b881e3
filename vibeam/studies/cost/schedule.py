"""Which runs fit into the time: the cheapest next, whatever fidelity or solver it is; the rest is named."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush

from vibeam.studies.cost.settings import Ladder, Setting


@dataclass(frozen=True)
class Schedule:
    """A ladder to climb on one fidelity; ``estimate``: seconds that its first rung will take."""

    fidelity: str
    ladder: Ladder
    estimate: float


@dataclass(frozen=True)
class LeftOut:
    """A run that did not take place, and why."""

    fidelity: str
    run: str
    why: str


Run = Callable[[str, Setting], float | None]


def run_schedule(tracks: Sequence[Schedule], left: Callable[[], float], run: Run) -> list[LeftOut]:
    """Run rung by rung, always the one that is estimated to be cheapest, while ``left()`` seconds allow it.

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
