"""Reference curve as a record: points over frequency, from arrays or from a file."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.faults import suggest
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


QUANTITIES = ("amplitude", "maximum", "minimum", "reach", "impacts_per_period", "impact_velocity", "period")
COLUMNS = ("frequency_hz", "direction", *QUANTITIES)


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

    ``recorded``: an earlier result of a model of ours, which is no reference.
    """

    quantity: str
    points: tuple[Point, ...]
    source: str = ""
    recorded: bool = False

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
