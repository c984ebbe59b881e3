"""Schedule within a budget: the cheapest run next, of any fidelity and solver; the others are listed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from math import isfinite

from vibeam.studies.cost.settings import Series, Setting

OVER = "over the whole budget"


@dataclass(frozen=True)
class Schedule:
    """Series of settings of one solver on one fidelity; ``estimate``: seconds of its first setting, maybe inf."""

    fidelity: str
    series: Series
    estimate: float


@dataclass(frozen=True)
class LeftOut:
    """Run that did not take place, and why."""

    fidelity: str
    run: str
    why: str


Run = Callable[[str, Setting], float | None]


def run_schedule(schedules: Sequence[Schedule], left: Callable[[], float], run: Run) -> list[LeftOut]:
    """Run setting by setting, always the one estimated to be cheapest, while ``left()`` seconds allow it.

    ``run(fidelity, setting)`` gives the seconds it took, None where stricter settings are of no use. A
    setting's estimate is the cost of the one before it times its ``growth``. Returns the runs left out.
    """
    heap = [(schedule.estimate, order, 0, schedule) for order, schedule in enumerate(schedules)]
    heapify(heap)
    out: list[LeftOut] = []
    while heap:
        estimate, order, index, schedule = heappop(heap)
        settings = schedule.series[index:]
        if estimate > left():
            out += _left_out(schedule.fidelity, settings, estimate, max(left(), 0.0))
            continue
        seconds = run(schedule.fidelity, settings[0])
        if seconds is None:
            why = f"{settings[0].label} broke down before it"
            out += [LeftOut(schedule.fidelity, setting.label, why) for setting in settings[1:]]
        elif len(settings) > 1:
            heappush(heap, (seconds * settings[1].growth, order, index + 1, schedule))
    return out


def _left_out(fidelity: str, settings: Series, estimate: float, left: float) -> list[LeftOut]:
    out = []
    for index, setting in enumerate(settings):
        estimate *= setting.growth if index else 1.0
        why = f"about {estimate:.2g} s, with {left:.2g} s of the budget left" if isfinite(estimate) else OVER
        out.append(LeftOut(fidelity, setting.label, why))
    return out
