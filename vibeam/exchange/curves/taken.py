"""Data taken of a file, in one line: columns, units, samples, rate, start; told once to a command that listens.

A picture shows more of it: the curve as it was read, and which of its points are used.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any

from vibeam_models.arguments import shown
from vibeam_models.arrays import Array


def grouped(value: float) -> str:
    """A number with blanks between its thousands."""
    return f"{value:,.6g}".replace(",", " ")


@dataclass(frozen=True)
class TakenColumn:
    """Column that was taken: its ``place`` in the file (``"column 2"``), head, unit, and where the unit is from.

    ``origin`` empty: from the head itself. A ``unit`` that the file does not say is the SI unit that it was taken as.
    """

    place: str
    head: str
    unit: str
    origin: str = ""

    @property
    def named(self) -> str:
        """Place and head."""
        both = self.head and self.place not in ("", self.head)
        return f"{self.place} {shown(self.head)}" if both else self.place or self.head

    @property
    def unit_told(self) -> str:
        """Unit, and where it is from."""
        origin = f" ({self.origin})" if self.origin else ""
        return f"{'a plain number' if self.unit in ('', '1') else self.unit}{origin}"


@dataclass(frozen=True)
class Taken:
    """Data taken of a ``file``: ``kind``, columns, number of ``samples``; ``notes`` on what was cut or shifted.

    ``rate`` in Hz of samples in equal steps, else None; ``start``, ``end``: of the abscissa, in its SI unit ``over``;
    ``zero``: the time of the file that became 0, None: its own.

    >>> value = TakenColumn("column 2", "Acc", "g", "from the row below the heads")
    >>> print(Taken("shock.csv", "time history", (value,), 100, 9000.0, 9000.495, "s", 20000.0))
    taken: column 2 'Acc', g (from the row below the heads), 20 000 Hz from 9 000 s
    """

    file: str
    kind: str
    columns: tuple[TakenColumn, ...]
    samples: int
    start: float
    end: float
    over: str = "s"
    rate: float | None = None
    notes: tuple[str, ...] = ()
    zero: float | None = None

    def __str__(self) -> str:
        span = f"{self.samples} points from {grouped(self.start)} to {grouped(self.end)} {self.over}"
        if self.rate is not None:
            span = f"{grouped(self.rate)} Hz from {grouped(self.start)} {self.over}"
        if self.zero is not None:
            span += f", {'which' if self.zero == self.start else f'of which {grouped(self.zero)} s'} is taken as 0"
        kind = "" if self.kind == "time history" else f"{self.kind}: "
        groups = {each.unit_told: list[str]() for each in self.columns}
        for each in self.columns:
            groups[each.unit_told].append(each.named)
        columns = ", ".join(", ".join([*named, unit]) for unit, named in groups.items())
        return "; ".join([f"taken: {kind}{columns}, {span}", *self.notes])


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


Told = tuple[Callable[[str], None], list[Taken]]
_TOLD: ContextVar[Told | None] = ContextVar("taken", default=None)


def tell(taken: Taken | None) -> None:
    """Tell what was taken of a file to whoever listens, unless it was told before."""
    told = _TOLD.get()
    if told is not None and taken is not None and taken not in told[1]:
        told[1].append(taken)
        told[0](f"{taken.file}: {taken}")


def all_taken() -> dict[str, list[Taken]]:
    """All that was told so far in this context, as ``taken``; empty where nothing was."""
    told = _TOLD.get()
    return {"taken": told[1]} if told and told[1] else {}


@contextmanager
def taken_told(listener: Callable[[str], None]) -> Iterator[None]:
    """Context in which a ``listener`` is told, in a line, what is taken of each file."""
    token = _TOLD.set((listener, []))
    try:
        yield
    finally:
        _TOLD.reset(token)
