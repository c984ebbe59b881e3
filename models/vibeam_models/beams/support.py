"""Support: what holds a beam at a place, rigidly or by springs; the textbook's ends."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from math import inf
from typing import Any

#: end → (stiffness against deflection, against rotation)
ENDS = {"clamped": (inf, inf), "pinned": (inf, 0.0), "guided": (0.0, inf), "free": (0.0, 0.0)}

#: what a case may write: the end at x = 0, then that at the full length
PAIRS = tuple(f"{one}-{other}" for one in ENDS for other in ENDS)
CANTILEVER = "clamped-free"


@dataclass(frozen=True)
class Support:
    """Support at ``position`` m by ``stiffness`` N/m and ``rotational_stiffness`` N m/rad; inf: rigid, 0: none."""

    position: float
    stiffness: float = inf
    rotational_stiffness: float = 0.0

    @property
    def each(self) -> tuple[float, float]:
        """Stiffness against deflection, and against rotation."""
        return self.stiffness, self.rotational_stiffness


def end_supports(pair: str, length: float) -> tuple[Support, ...]:
    """The supports at the ends of a beam of ``length`` m, ``pair`` one of ``PAIRS``; free ends have none."""
    both = zip((0.0, length), pair.split("-"), strict=True)
    return tuple(Support(x, *ENDS[end]) for x, end in both if end != "free")


def holds(supports: Collection[Support]) -> bool:
    """Whether no rigid motion u = a + bx is left: Σ k (1, x)(1, x)ᵀ + k_θ (0, 1)(0, 1)ᵀ has full rank."""
    places = {each.position for each in supports if each.stiffness > 0}
    return len(places) > 1 or (len(places) == 1 and any(each.rotational_stiffness > 0 for each in supports))


def stiffnesses(table: Any) -> tuple[float, float]:
    """N/m and N m/rad of a support by its keys: None is rigid against deflection, free to turn."""
    return inf if table.stiffness is None else table.stiffness, table.rotational_stiffness or 0.0
