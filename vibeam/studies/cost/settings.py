"""Every solver's ladder of settings, from the loosest and cheapest to the strictest: declared here, in one place."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

RTOLS = (1e-3, 1e-4, 1e-6, 1e-8, 1e-10)

STEPS = (100, 300, 1000, 3000, 10_000)

ORDERS = {"RK23": 3, "RK45": 5, "DOP853": 8, "LSODA": 8}  # of a step's error: tolerance^(−1/order) steps

ATOL = 1e-2  # absolute tolerance over relative tolerance and size of the motion: the paper's 1e-8 for 1e-4 and 1e-2

LIMITS = {"direct": 200, "zhuravlev": 200, "ivanov": 20_000}  # events, or evaluations, a period: they give up there


@dataclass(frozen=True)
class Setting:
    """One solver at one setting; ``growth``: about how many times as much it costs as the rung below it."""

    solver: str
    method: str = ""
    setting: str = ""
    options: Mapping[str, Any] = field(default_factory=dict)
    growth: float = 1.0

    @property
    def label(self) -> str:
        """As tables and messages name it."""
        return " ".join(filter(None, (self.solver, self.method, self.setting)))


Ladder = tuple[Setting, ...]


def ladders(solver: str, size: float) -> list[Ladder]:
    """The ladders of one solver for motions of about ``size`` m at the contact; a single point is a ladder of one."""
    return LADDERS[solver](size)


def _single(solver: str, **points: Mapping[str, Any]) -> Callable[[float], list[Ladder]]:
    rungs: list[Ladder] = [(Setting(solver, method=name, options=options),) for name, options in points.items()]
    return lambda size: rungs or [(Setting(solver),)]


def _tolerances(solver: str, *methods: str) -> Callable[[float], list[Ladder]]:
    return lambda size: [tuple(_tolerance(solver, method, size, i) for i in range(len(RTOLS))) for method in methods]


def _tolerance(solver: str, method: str, size: float, index: int) -> Setting:
    rtol = RTOLS[index]
    looser = RTOLS[max(index - 1, 0)]
    options = {"method": method, "rtol": rtol, "atol": ATOL * rtol * size, "limit": LIMITS[solver]}
    return Setting(solver, method, f"rtol {rtol:.0e}", options, (looser / rtol) ** (1 / ORDERS[method]))


def _steps(size: float) -> list[Ladder]:
    grown = [1.0, *(fine / coarse for coarse, fine in pairwise(STEPS))]
    rungs = [
        Setting("moreau", "", f"{count} steps", {"steps": count}, grow)
        for count, grow in zip(STEPS, grown, strict=True)
    ]
    return [tuple(rungs)]


LADDERS: dict[str, Callable[[float], list[Ladder]]] = {
    "flight": _single("flight"),
    "orbit": _single("orbit"),
    "averaging": _single("averaging", paper={"damping": "paper"}, log={"damping": "log"}),
    "mapping": _single("mapping"),
    "direct": _tolerances("direct", "RK23", "RK45", "DOP853", "LSODA"),
    "zhuravlev": _tolerances("zhuravlev", "RK23", "DOP853"),
    "ivanov": _tolerances("ivanov", "RK23", "DOP853"),
    "moreau": _steps,
}
