"""Settings of every solver, from the loosest and cheapest to the strictest, as declared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from vibeam.solvers import SOLVERS

RTOLS = (1e-3, 1e-4, 1e-6, 1e-8, 1e-10)
STEPS = (100, 300, 1000, 3000, 10_000)
ORDERS = {"RK23": 3, "RK45": 5, "DOP853": 8, "LSODA": 8}  # order of a step's error: tolerance^(−1/order) steps
ATOL = 1e-2  # absolute tolerance over relative tolerance and size of the motion: the paper's 1e-8 for 1e-4 and 1e-2


@dataclass(frozen=True)
class Setting:
    """One solver at one setting; ``growth``: about the ratio of its cost to that of the setting before it."""

    solver: str
    method: str = ""
    setting: str = ""
    options: Mapping[str, Any] = field(default_factory=dict)
    growth: float = 1.0

    @property
    def label(self) -> str:
        """Name in tables and messages."""
        return " ".join(filter(None, (self.solver, self.method, self.setting)))


Series = tuple[Setting, ...]


def series_of(solver: str, size: float) -> list[Series]:
    """Series of settings of one solver for contact motions of about ``size`` m; a single point is a series of one."""
    declared = SOLVERS[solver].settings
    found: list[Series] = [(Setting(solver, method=name, options=values),) for name, values in declared.options.items()]
    found += [_tolerances(solver, method, size, declared.limit) for method in declared.methods]
    found += [_steps(solver)] if declared.steps else []
    return found or [(Setting(solver),)]


def _tolerances(solver: str, method: str, size: float, limit: int) -> Series:
    return tuple(_tolerance(solver, method, size, limit, index) for index in range(len(RTOLS)))


def _tolerance(solver: str, method: str, size: float, limit: int, index: int) -> Setting:
    rtol, looser = RTOLS[index], RTOLS[max(index - 1, 0)]
    options = {"method": method, "rtol": rtol, "atol": ATOL * rtol * size, "limit": limit}
    return Setting(solver, method, f"rtol {rtol:.0e}", options, (looser / rtol) ** (1 / ORDERS[method]))


def _steps(solver: str) -> Series:
    grown = [1.0, *(fine / coarse for coarse, fine in pairwise(STEPS))]
    return tuple(
        Setting(solver, "", f"{count} steps", {"steps": count}, growth)
        for count, growth in zip(STEPS, grown, strict=True)
    )
