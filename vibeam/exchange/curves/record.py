"""Reference curve as a record: points over frequency; the form of the file that gives them, with its units."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from difflib import get_close_matches
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from vibeam.exchange.faults import suggest
from vibeam.exchange.units import LONGEST, unit_size
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.exchange.curves.taken import Taken

QUANTITIES = ("amplitude", "maximum", "minimum", "reach", "impacts_per_period", "impact_velocity", "period")
SAME_FREQUENCY = 1e-9  # relative tolerance
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


def factor(unit: str, wanted: str, scale_unit: str = "") -> float:
    """Factor from a column's unit, times ``scale_unit``, to the SI unit ``wanted``; ValueError where they do not suit.

    A column without a unit is in ``wanted``; with a scale in volts. ``g`` and ``G``, with ``m`` or ``µ`` before it, are
    of the acceleration of free fall where that makes it one of ``wanted``, else grams. How a value is taken, as in
    ``mm rms``, is no part of its unit (``taking``).
    """
    if not taking(unit)[0] and not scale_unit:
        return 1.0
    plain = _plain(unit) if unit else "V" if "V" in scale_unit else ""
    (more, further), (aim, target) = _sized(scale_unit), _sized(wanted)
    known = list[str]()
    for each in (plain, _FREE_FALL.sub(r"\1gn", plain), _METRES.sub(r"(m s\1)", plain)):
        found = unit_size(each) if each not in PLAIN else (Decimal(1), {})
        if found is not None and _times(found[1], further) == target:
            return float(found[0] * more / aim)
        known += [each] * (found is not None)
    if not known:
        raise ValueError(f"the unit {unit!r} is not known{meant(plain, wanted)}")
    by = f" times the scale's {scale_unit!r}" if scale_unit else ""
    raise ValueError(f"the unit {unit!r}{by} is not one of {wanted or 'a plain number'}")


CURES = {"rms": 1.41421, "peak to peak": 0.5}  # scale by which values become amplitudes
PLAIN = ("", "1", "-", "none", "ratio")  # units of a plain number
USUAL = (
    "m/s^2", "mm/s^2", "m/s", "mm/s", "m", "mm", "µm", "in", "N", "kN", "lbf", "N m", "s", "ms", "Hz", "kHz", "rpm",
)  # fmt: skip
_FREE_FALL = re.compile(r"(?<![A-Za-zµ])([mµu]?)[gG](?:'?s|_?n|-force)?(?![A-Za-z])")
_METRES = re.compile(r"(?<![A-Za-zµ])ms(\^?[-⁻][1-4¹²³⁴])")  # ms-2: of two readings the one that is asked
_WORDS = r"rms|r\.m\.s\.|0-pk|pk-pk|peak[ -](?:to[ -])?peak|p-p|pk|peak|pp"
_TAKING = re.compile(rf"(.*?)[\s_(,-]*(?:\b|(?<=[gGVm_]))({_WORDS})\)?", re.IGNORECASE)


def taking(unit: str) -> tuple[str, str]:
    """A unit, and how its values are taken: ``rms``, ``peak``, ``peak to peak``; empty: as they are."""
    found = _TAKING.fullmatch(unit.strip()) if len(unit) <= 2 * LONGEST else None
    if not found:
        return unit, ""
    word = found[2].casefold()
    return found[1], "rms" if word[0] == "r" else "peak" if word in ("pk", "0-pk", "peak") else "peak to peak"


def _plain(unit: str) -> str:
    """A unit alone, out of brackets and blanks."""
    plain = taking(unit)[0].strip().rstrip(" .").replace("μ", "µ").replace(" per ", "/").replace(" squared", "^2")
    return plain[1:-1].strip() if plain[:1] + plain[-1:] in ("[]", "{}") else plain


def meant(unit: str, wanted: str) -> str:
    """The unit of the quantity ``wanted`` that an unknown one may be meant as, as the end of a message."""
    usual = [each for each in USUAL if (found := unit_size(each)) and found[1] == _sized(wanted)[1]]
    near = get_close_matches(unit.casefold(), [each.casefold() for each in usual], 1, 0.5)
    return f": {next(each for each in usual if each.casefold() == near[0])}?" if near else ""


def _sized(unit: str) -> tuple[Decimal, dict[str, float]]:
    if unit in ("", "1", "-"):
        return Decimal(1), {}
    found = unit_size(unit)
    if found is None:
        raise ValueError(f"the unit {unit!r} is not known")
    return found


def _times(one: Mapping[str, float], other: Mapping[str, float]) -> dict[str, float]:
    powers = {name: one.get(name, 0.0) + other.get(name, 0.0) for name in {*one, *other}}
    return {name: power for name, power in powers.items() if power}


def known_unit(unit: str) -> bool:
    """Test whether a unit is known, ``%`` and a plain number (``1``) among them."""
    plain = _plain(unit)
    return plain in (*PLAIN, "%") or any(
        unit_size(each) is not None for each in (plain, _FREE_FALL.sub(r"\1gn", plain))
    )
