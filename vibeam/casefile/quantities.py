"""Quantities in case files: ``'180 mm'`` is 0.18, a number without its unit says so, as does a wrong dimension.

Consistent systems of units, by name: those of a case's numbers without one, and of other programs' matrices.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal, DecimalException
from typing import Any

from vibeam.exchange import units as bases
from vibeam.exchange.faults import as_shown_in_message, suggest
from vibeam.exchange.units import unit_size


@dataclass(frozen=True)
class UnitSystem:
    """A system by its units of ``length`` in m, ``force`` in N and ``time`` in s; that of mass follows.

    Coordinates stay in their own unit, so that translations and rotations need not be told apart: only energies, and
    the rows that read a displacement, become those of SI.
    """

    length: float = 1.0
    force: float = 1.0
    time: float = 1.0

    @property
    def stiffness(self) -> float:
        """Factor of K: J for one unit of energy."""
        return self.force * self.length

    @property
    def damping(self) -> float:
        """Factor of C: J s."""
        return self.stiffness * self.time

    @property
    def mass(self) -> float:
        """Factor of M: J s²."""
        return self.damping * self.time

    def size(self, dimension: Mapping[str, float]) -> Decimal:
        """SI units in one of the system's, of a quantity of that dimension; volts and radians are in all of them."""
        length, force, time = (Decimal(repr(each)) for each in (self.length, self.force, self.time))
        base = {bases.MASS: force * time**2 / length, bases.LENGTH: length, bases.TIME: time}
        size = Decimal(1)
        for name, unit in base.items():
            size *= unit ** Decimal(repr(dimension.get(name, 0.0)))
        return size


POUND = 4.4482216152605  # N, exactly
SI = UnitSystem()

UNIT_SYSTEMS = {
    "SI": SI,
    "mm N s t": UnitSystem(length=1e-3),
    "mm mN s kg": UnitSystem(length=1e-3, force=1e-3),
    "mm kN ms kg": UnitSystem(length=1e-3, force=1e3, time=1e-3),
    "µm µN s kg": UnitSystem(length=1e-6, force=1e-6),
    "in lbf s": UnitSystem(length=0.0254, force=POUND),
    "ft lbf s": UnitSystem(length=0.3048, force=POUND),
}


@dataclass(frozen=True)
class Range:
    """Numbers from ``low`` to ``high``, ``low`` itself only where ``closed``."""

    low: float = -math.inf
    high: float = math.inf
    closed: bool = True

    def check(self, number: float, value: Any) -> None:
        """ValueError, with the value as it was written, if the number is outside."""
        if not (self.low <= number <= self.high) or (number == self.low and not self.closed):
            share = self.high == 1 and 2 <= number <= 100 and "%" not in str(value)
            raise ValueError(
                f"{as_shown_in_message(value)} {'is outside' if math.isfinite(self.high) else 'must be'} {self}"
                + f": if it is a percentage, write '{number:g} %'" * share
            )

    def describe(self) -> str:
        """The range after a unit: ``"> 0"``, ``"in (0, 1]"``, empty where all numbers will do."""
        return f"in {self}" if math.isfinite(self.high) else str(self)

    def schema(self) -> dict[str, float]:
        """The range as JSON schema has it."""
        low = {"minimum" if self.closed else "exclusiveMinimum": self.low} if math.isfinite(self.low) else {}
        return low | ({"maximum": self.high} if math.isfinite(self.high) else {})

    def __str__(self) -> str:
        if self.low == -math.inf:
            return ""
        if self.high == math.inf:
            return f"{'≥' if self.closed else '>'} {self.low:g}"
        return f"{'[' if self.closed else '('}{self.low:g}, {self.high:.7g}]"


ANY = Range()
POSITIVE = Range(0, closed=False)
NOT_NEGATIVE = Range(0)


NUMBER_WITH_UNIT = r"^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?(\s|[A-Za-zµμ%]|1\s*/|$)"


@dataclass(frozen=True)
class Dimension:
    """A kind of quantity: what a message calls it, its SI unit (empty: a plain number), one example.

    ``usual``: units that a number without one may be meant in; none: the SI unit alone.
    """

    phrase: str
    unit: str
    example: str
    usual: tuple[str, ...] = ()
    bare: bool = True  # whether a number without a unit can only mean one thing
    own: tuple[str, str] | None = None  # a unit that means something else elsewhere, in units of ``unit``


LENGTH = Dimension("a length", "m", "180 mm", ("mm", "m"))
MASS = Dimension("a mass", "kg", "0.2 kg", ("g", "kg"))
TIME = Dimension("a time", "s", "1 s", ("ms", "s"))
INERTIA = Dimension("a moment of inertia", "kg m^2", "2.84e-5 kg m^2")
PRESSURE = Dimension("a pressure", "Pa", "210 GPa", ("GPa", "Pa"))
DENSITY = Dimension("a density", "kg/m^3", "7850 kg/m^3")
VOLTAGE = Dimension("a voltage", "V", "0.6 V", ("mV", "V"))
PER_VOLT = Dimension("a number per volt", "1/V", "5.16e-4 1/V")
SPEED = Dimension("a speed", "m/s", "0.1 m/s", ("mm/s", "m/s"))
VISCOUS = Dimension("a damping constant", "N s/m", "10 N s/m")
FREQUENCY = Dimension("a frequency", "Hz", "15.5 Hz", ("Hz", "rad/s"))
ANGULAR_FREQUENCY = Dimension("a frequency", "rad/s", "1 rad/s", bare=False)
ANGLE = Dimension("an angle", "rad", "30 deg", ("deg", "rad"))
SWEEP_RATE = Dimension("a sweep rate", "Hz/s", "0.1 Hz/s")
RATIO = Dimension("a plain number", "", "0.5")
ACCELERATION = Dimension("an acceleration", "m/s^2", "9.81 m/s^2", ("m/s^2", "g"), own=("g", "9.80665"))  # not grams
FORCE = Dimension("a force", "N", "5 N")
MOMENT = Dimension("a moment", "N m", "0.1 N m")
STIFFNESS = Dimension("a stiffness", "N/m", "2000 N/m", ("N/m", "N/mm"))
TURNING_STIFFNESS = Dimension("a rotational stiffness", "N m/rad", "500 N m/rad")
RESISTANCE = Dimension("a resistance", "ohm", "4 ohm")
INDUCTANCE = Dimension("an inductance", "H", "1 mH", ("mH", "H"))
FORCE_FACTOR = Dimension("a force per current", "N/A", "20 N/A")


_NAMED = (
    *(LENGTH, MASS, TIME, INERTIA, PRESSURE, DENSITY, VOLTAGE, PER_VOLT, SPEED, FREQUENCY, RATIO),
    *(ANGLE, SWEEP_RATE, ACCELERATION, FORCE, MOMENT, STIFFNESS, VISCOUS, TURNING_STIFFNESS),
    *(RESISTANCE, INDUCTANCE, FORCE_FACTOR),
)


def dimension(unit: str) -> Dimension:
    """The kind of quantity whose SI unit is ``unit``; UnitError for a unit that is not known."""
    if unit_size(unit) is None and unit:
        raise UnitError(_unknown(unit, unit))
    named = (kind for kind in _NAMED if kind.unit == unit)
    return next(named, Dimension(f"a quantity in {unit}", unit, f"1 {unit}"))


_USUAL = ["mm", "m", "cm", "µm", "km", "kg", "g", "s", "ms", "Hz", "kHz", "rad/s", "rpm", "Pa", "kPa", "MPa", "GPa"]

_USUAL += ["V", "mV", "1/V", "kg/m^3", "g/cm^3", "kg m^2", "N/m^2", "m/s", "mm/s", "N s/m", "Hz/s", "%"]

_USUAL += ["m/s^2", "N", "N m", "N/m", "N m/rad", "ohm", "H", "mH", "N/A", "rad", "deg"]

_QUANTITY = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(.*?)\s*", re.DOTALL)
_NOT_FINITE = re.compile(r"\s*[+-]?(nan|inf|infinity)\b.*", re.DOTALL | re.IGNORECASE)


SMALLEST, LARGEST = 1e-100, 1e100  # the models multiply quantities, and square them


class UnitError(ValueError):
    """A value that is not the quantity asked for; the text says what it is instead, or how to write it."""


def to_si(value: Any, kind: Dimension, units: UnitSystem | None = SI) -> float:
    """The value as a finite number in ``kind``'s SI unit; UnitError if it is none.

    ``units``: those of a number without one; None: such a number is none, unless it is 0 or has no dimension.
    """
    if isinstance(value, str):
        number = _from_text(value, kind)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        number = _from_number(value, kind, units)
    else:
        raise UnitError(f"must be {kind.phrase} such as {_example(kind)}, not {as_shown_in_message(value)}")
    if not math.isfinite(number):
        raise UnitError(f"{as_shown_in_message(value)} is not a finite number")
    if number and not SMALLEST <= abs(number) <= LARGEST:
        raise UnitError(
            f"{as_shown_in_message(value)} is beyond the range of a case, {SMALLEST:g} to {LARGEST:g} in SI units"
        )
    return number


def suits(text: str, kind: Dimension) -> bool:
    """Test whether a number with its unit is a quantity of this kind."""
    try:
        to_si(text, kind)
    except UnitError:
        return False
    return True


def with_unit(value: Any, kind: Dimension, units: UnitSystem | None = SI) -> Any:
    """A value as cases of all units have it: a number that ``to_si`` takes with its SI unit, text as it is."""
    bare = isinstance(value, int | float) and kind.unit
    return f"{to_si(value, kind, units)!r} {kind.unit}" if bare else value


def _example(kind: Dimension) -> str:
    return repr(kind.example) if kind.unit else kind.example


def _from_number(value: float, kind: Dimension, units: UnitSystem | None) -> float:
    try:
        number = float(value)
    except OverflowError:
        return math.inf
    if not (number and kind.unit and math.isfinite(number)):
        return number
    if not kind.bare:
        raise UnitError(f"{as_shown_in_message(value)} may be rad/s or Hz: write '{number:g} rad/s' or '{number:g} Hz'")
    if units is None:
        raise UnitError(f'{_without_unit(str(value), kind)}, or units = "SI" at the top of the case')
    if units is SI:
        return number
    return float(Decimal(str(value)) * units.size((unit_size(kind.unit) or (1, {}))[1]))


def _without_unit(number: str, kind: Dimension, shown: str = "") -> str:
    """The fault of a number without its unit, with what it may be meant as."""
    meant = " or ".join(f"'{number} {unit}'" for unit in kind.usual or (kind.unit,))
    return f"{shown or number} has no unit: write {meant if len(number) < 40 else _example(kind)}"


def _from_text(text: str, kind: Dimension) -> float:
    found = _QUANTITY.fullmatch(text)
    if not found:
        if _NOT_FINITE.fullmatch(text):
            return math.nan
        what = "a number with a unit" if kind.unit else "a number or a percentage"
        raise UnitError(f"{as_shown_in_message(text)} is not {what}: write {_example(kind)}")
    number, unit = found[1], found[2].replace("μ", "µ")
    if not unit and kind.unit:
        raise UnitError(_without_unit(number, kind, as_shown_in_message(text)))
    factor = _factor(unit, kind, text) if unit else Decimal(1)
    try:
        exact = Decimal(number) * factor
    except DecimalException:
        exact = Decimal("nan")
    if exact.is_nan() or (exact and not float(exact)):
        raise UnitError(f"{as_shown_in_message(text)} is beyond the range of numbers")
    return float(exact)


def _factor(unit: str, kind: Dimension, text: str) -> Decimal:
    """Factor from ``unit`` to the kind's unit; UnitError names what ``text`` is where there is none."""
    if kind.own and unit == kind.own[0]:
        return Decimal(kind.own[1])
    found = unit_size(unit)
    if found is None:
        raise UnitError(_unknown(unit, text))
    factor, dimension = found
    wanted_factor, wanted = unit_size(kind.unit) or (Decimal(1), {})
    if dimension != wanted:
        raise UnitError(
            f"{as_shown_in_message(text)} is {_phrase(dimension)}, not {kind.phrase}{_hint(dimension, kind)}"
        )
    return factor / wanted_factor


def _unknown(unit: str, text: str) -> str:
    if unit.startswith(","):
        return f"{as_shown_in_message(text)}: write the decimal sign as a point"
    return f"{as_shown_in_message(text)} has the unknown unit {as_shown_in_message(unit)}; {suggest(unit, _USUAL)}"


def _phrase(dimension: dict[str, float]) -> str:
    for kind in _NAMED:
        if (unit_size(kind.unit) or (1, {}))[1] == dimension:
            return kind.phrase
    powers = (f"{name.strip('[]')}^{power:g}" for name, power in sorted(dimension.items()))
    return f"a quantity of dimension {' '.join(powers)}"


def _hint(dimension: dict[str, float], kind: Dimension) -> str:
    if kind.phrase == FREQUENCY.phrase and dimension == {"[time]": -1}:
        return ": write Hz or rad/s"
    return ""
