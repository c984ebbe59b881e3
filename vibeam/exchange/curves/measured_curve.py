"""Measured curve as it was read, with what is cut of it, for a picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from vibeam_models.arrays import Array


@dataclass(frozen=True, eq=False)
class MeasuredCurve:
    """Curve as it was read, for a picture: ``value`` (n,), or (m, n) of several, at ``at`` (n,), in SI.

    ``used`` (n,): points that are not cut. ``fit``: places (k,), and what was fitted there. ``labels``: of the axes,
    heads with units. ``timed``: over time, not frequency.
    """

    at: Array
    value: Array
    used: Any
    fit: tuple[Array, Array] | None = None
    labels: tuple[str, str] = ("", "")
    name: str = ""
    timed: bool = False

    @property
    def cut(self) -> int:
        """Number of points that are not used."""
        return len(self.used) - int(sum(self.used))

    @property
    def title(self) -> str:
        """Name, and how many points are cut."""
        return f"{self.name}: {self.cut} of {len(self.used)} points are cut" if self.cut else self.name


def label(head: str, unit: str) -> str:
    """Label of an axis: the head of a column, and its unit where it has one."""
    return f"{head} in {unit.replace('^2', '²')}" if unit not in ("", "1") else head
