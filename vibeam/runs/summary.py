"""Summary of each fidelity: peak, period-1 range, distance to the finest, CPU time; remarks on what is odd in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.runs.comparison.differences import listed
from vibeam.system.number_text import ratio
from vibeam.system.response import Branches, Difference, Peak, complete, modes_of

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.result import Result
    from vibeam_models.scene import AnyScene


@dataclass(frozen=True)
class Summary:
    """Summary of one fidelity: frequencies in Hz, amplitudes in the unit of the output, times in s.

    ``peak``: the highest complete point of all directions, whether its motion repeats or not.
    ``period_one``: for each direction the lowest and highest frequency of the contiguous period-1 range with impacts
    around its largest amplitude, None where there is none. ``distance``: to the finest fidelity with the same values
    of its own (``set``), None for that itself. ``restitution``: of the contact, ``first_mode_restitution``: that of
    mode 1.
    """

    fidelity: str
    modes: int
    peak: Peak
    period_one: Mapping[str, tuple[float, float] | None]
    distance: Difference | None
    cpu_seconds: float
    cost_ratio: float
    impacts: int
    failed: int
    restitution: float
    first_mode_restitution: float

    @property
    def nanoseconds_per_impact(self) -> float:
        """CPU time an impact in ns, NaN without impacts."""
        return 1e9 * self.cpu_seconds / self.impacts if self.impacts else float("nan")


def compare(result: Result) -> list[Summary]:
    """Summarise every fidelity, in the case's order; the reference is the one with most modes."""
    if not result:
        return []
    cheapest = min(_total(branches, "cpu_seconds") for branches in result.values())
    finest = result.finest
    return [_summary(result, n, None if n == finest[n] else result[finest[n]], cheapest) for n in result]


def _summary(result: Result, name: str, finest: Branches | None, cheapest: float) -> Summary:
    branches = result[name]
    contact, first = result.restitutions(name)
    cpu = _total(branches, "cpu_seconds")
    return Summary(
        fidelity=name,
        modes=modes_of(branches),
        peak=branches.peak,
        period_one={direction: response.period_one for direction, response in branches.items()},
        distance=None if finest is None else branches.off(finest),
        cpu_seconds=cpu,
        cost_ratio=cpu / cheapest if cheapest > 0 else float("nan"),
        impacts=int(_total(branches, "impacts")),
        failed=sum(int(np.count_nonzero(~complete(response))) for _, response in branches.items()),
        restitution=contact,
        first_mode_restitution=first,
    )


def _total(branches: Branches, name: str) -> float:
    return float(sum(np.nansum(getattr(response, name)) for _, response in branches.items()))


YIELDS = 'let the stop yield (law = "linear" or "hertz")'

BARE = (
    "a coefficient of restitution at a contact without a mass of its own is ill-posed: with each mode more, mode 1 has "
    f"less of the contact's mobility, and in the end none. Put a mass at the contact, or {YIELDS}."
)

NEGATIVE = (
    "R₁ < 0, mode 1 goes on into the stop after an impact: one coefficient of restitution is ill-posed where so little "
    f"of the contact's mobility is mode 1's. Take fewer modes, put a mass at the contact, or {YIELDS}."
)


def remarks(result: Result) -> list[str]:
    """Remarks on fidelities that never touch the stop, and on those whose mode 1 sees R₁ < 0; what is assumed."""
    clear = [name for name, branches in result.items() if stays_clear(branches)]
    cure = "narrow the gap, or drive harder" if result.overview is None else result.overview.cure
    notes = [f"{listed(clear)}: no impact at any frequency: {cure}"] if clear else []
    below = {row.fidelity: row.first_mode_restitution for row in compare(result)}
    return [*notes, *ill_posed(below, result.case.scene), *assumed(result.case)]


def assumed(case: Case) -> list[str]:
    """Sentences about what the structures of a case's fidelities assume, each once."""
    return list(dict.fromkeys(said for name in case.fidelities for said in case.scene_of(name).assumed))


def ill_posed(first_mode: Mapping[str, float], scene: AnyScene) -> list[str]:
    """Remark on fidelities with R₁ < 0, with the stop that yields as the table of a case.

    ``first_mode``: R₁ by name, NaN where the law has no coefficient; ``scene``: with the stop that has one.
    """
    below = [f"{name} ({value:.2g})" for name, value in first_mode.items() if value < 0]
    if not below:
        return []
    cure = f"\n{yielding(scene)}" if scene.stop is not None and scene.stop.law is None else ""
    return [f"{listed(below)}: {NEGATIVE}{cure}"]


def yielding(scene: Any) -> str:
    """Table of the stop made to yield, to be pasted into the case in place of its own."""
    from vibeam_models.yielding_stop import yielding_stop

    return f"In place of [stop] as it is:\n{yielding_stop(scene)}"


def beyond(row: str, needed: float, scene: Any) -> str:
    """Remark on a first mode's restitution that no coefficient at the contact gives: it would be ``needed``."""
    return (
        f"{row}: R₁ = {ratio(scene.stop.usual_restitution, 'g')} would take R = {ratio(needed)} at the contact, and "
        f"none is above 1. Take fewer modes, put a mass at the contact, or {YIELDS}.\n{yielding(scene)}"
    )


def stays_clear(branches: Branches) -> bool:
    """Test whether every point is complete and none touches the stop."""
    return all(np.all(complete(each) & (each.period == -1)) for _, each in branches.items())
