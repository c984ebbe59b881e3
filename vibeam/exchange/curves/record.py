"""Data of measured files as records: what was taken of one, in a line; a reference curve, and the form of its file."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from math import isfinite

import numpy as np
from numpy.typing import ArrayLike

from vibeam.exchange.faults import suggest
from vibeam.exchange.units import factor as factor  # by which a column and its scale become SI
from vibeam_models.arguments import counted, shown
from vibeam_models.arrays import Array

QUANTITIES = ("amplitude", "maximum", "minimum", "reach", "impacts_per_period", "impact_velocity", "period")
SAME_FREQUENCY = 1e-9  # relative tolerance
COLUMNS = ("frequency_hz", "direction", *QUANTITIES)


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
        span = f"{counted(self.samples, 'point')} from {grouped(self.start)} to {grouped(self.end)} {self.over}"
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


@dataclass(frozen=True)
class Point:
    """Point of a reference: frequency in Hz, value and standard uncertainty in SI; None: not given.

    ``line``: of the file, or row of the arrays. A point without a value and period is not compared.
    """

    line: int
    frequency: float
    direction: str | None
    value: float | None
    period: int | None
    uncertainty: float | None = None


@dataclass(frozen=True)
class ReferenceCurve:
    """Reference curve: ``points`` of one ``quantity``, and their ``source``.

    ``recorded``: an earlier result of a model of ours, which is no reference. ``taken``: of which columns of its file.

    >>> import vibeam
    >>> curve = vibeam.ReferenceCurve.of([14.0, 15.0], [2e-4, 3.7e-4], direction="up")
    >>> [(point.frequency, point.value) for point in curve.points]
    [(14.0, 0.0002), (15.0, 0.00037)]
    """

    quantity: str
    points: tuple[Point, ...]
    source: str = ""
    recorded: bool = False
    taken: Taken | None = field(default=None, compare=False, repr=False)

    @classmethod
    def of(
        cls, frequency: ArrayLike, value: ArrayLike, quantity: str = "amplitude", *,
        uncertainty: ArrayLike | None = None, direction: str | Sequence[str] | None = None, source: str = "arrays",
    ) -> ReferenceCurve:  # fmt: skip
        """Curve from arrays (n,): Hz and SI; a value of NaN is not compared. ValueError for what is no curve.

        ``uncertainty``: standard deviations, (n,) or one. ``direction``: ``"up"`` or ``"down"``, of all points or each;
        None: not known.
        """
        f, v = np.asarray(frequency, dtype=float), np.asarray(value, dtype=float)
        if f.ndim != 1 or f.shape != v.shape or not len(f):
            raise ValueError(f"frequency {f.shape} and value {v.shape} must be of one shape (n,)")
        if not (np.isfinite(f).all() and (f > 0).all()):
            raise ValueError("every frequency must be a finite number above 0 Hz")
        if quantity not in QUANTITIES:
            raise ValueError(f"unknown quantity {quantity!r}; {suggest(quantity, QUANTITIES)}")
        u = np.broadcast_to(np.asarray(np.nan if uncertainty is None else uncertainty, dtype=float), f.shape)
        if (u < 0).any():
            raise ValueError("an uncertainty is a standard deviation: it cannot be negative")
        ways = [direction] * len(f) if direction is None or isinstance(direction, str) else list(direction)
        if len(ways) != len(f) or not {*ways} <= {"up", "down", None}:
            raise ValueError(f"the direction is up or down, of all points or of each of the {len(f)}")
        rows = zip(range(1, len(f) + 1), f.tolist(), ways, v.tolist(), u.tolist(), strict=True)
        return cls(quantity, tuple(Point(n, a, way, given(b), None, given(c)) for n, a, way, b, c in rows), source)

    def along(self, directions: Collection[str]) -> list[Point]:
        """List the points with a value or period on branches of these directions; those of no direction are on any."""
        compared = [point for point in self.points if not point.value is point.period is None]
        return [point for point in compared if point.direction is None or point.direction in directions]

    @property
    def frequency(self) -> Array:
        """Frequencies in Hz, shape (points,)."""
        return np.array([point.frequency for point in self.points])

    @property
    def value(self) -> Array:
        """Values in SI, shape (points,); NaN: not given."""
        return np.array([np.nan if point.value is None else point.value for point in self.points])

    @property
    def uncertainty(self) -> Array:
        """Standard uncertainties in SI, shape (points,); NaN: not given."""
        return np.array([np.nan if point.uncertainty is None else point.uncertainty for point in self.points])

    @property
    def direction(self) -> tuple[str | None, ...]:
        """Direction of each point: ``"up"``, ``"down"``, None where not known."""
        return tuple(point.direction for point in self.points)


def given(number: float) -> float | None:
    """Number, None where it is NaN or ∞."""
    return number if isfinite(number) else None


ROLES = ("frequency", "direction", "period", "uncertainty")  # columns besides that of the quantity


@dataclass(frozen=True)
class ReferenceForm:
    """Columns of a reference file and their treatment: value = ``scale`` · column + ``offset``, in ``unit``.

    ``columns``: head, or number from 1, of each role: ``frequency``, the quantity's name, ``uncertainty``,
    ``direction``, ``period``. ``units`` of the roles go before what heads say; a column without one is in SI.
    ``unit``: the SI unit of the quantity, ``"1"`` in a case without units. ``scale_unit``: unit of the scale, such as
    ``mm/V``. ``window``: frequencies (Hz) kept. ``uncertainty``: standard uncertainty (one standard deviation) of every
    value, ``relative`` to it or in ``unit``. Empty ``separator`` or ``decimal``: found out from the file.

    >>> import vibeam
    >>> vibeam.ReferenceForm(unit="mm", scale=0.5).scale  # of a file that has peak to peak
    0.5
    """

    columns: Mapping[str, str | int] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    unit: str = ""
    scale: float = 1.0
    scale_unit: str = ""
    offset: float = 0.0
    window: tuple[float, float] | None = None
    uncertainty: float | None = None
    relative: bool = False
    separator: str = ""
    decimal: str = ""

    @property
    def own(self) -> bool:
        """True where a file may be of vibeam's own form: no columns, units or signs are said."""
        return not (self.columns or self.units or self.separator or self.decimal or self.scale_unit)
