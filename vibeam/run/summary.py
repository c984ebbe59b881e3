"""Summary of each fidelity: peak, period-1 range, distance to the finest, CPU time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vibeam.run.result import finest_of
from vibeam.system.response import Difference, Peak, complete, modes_of

if TYPE_CHECKING:
    from vibeam.run.result import Result
    from vibeam.system.response import Branches


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
    finest = {name: finest_of(result, name) for name in result}
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
