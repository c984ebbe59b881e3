"""Units of measured quantities: size and dimension of a unit such as mm/V or kg m^2, from one table of definitions.

Sizes are decimal numbers, so that 180 mm is 0.18 m to the last bit. An angle is a dimension of its own, so that 1 Hz =
2π rad/s and a bare 1/s is neither.
"""

from __future__ import annotations

import re
from decimal import Decimal
from functools import cache

#: size and dimension of a unit in gram, metre, second, volt and radian
Size = tuple[Decimal, dict[str, float]]
MASS, LENGTH, TIME, VOLTAGE, ANGLE = "[mass]", "[length]", "[time]", "[voltage]", "[angle]"

#: factors by the names of prefixes, the first of them none
PREFIXES = {
    ("",): "1",
    ("nano", "n"): "1e-9",
    ("micro", "µ", "u"): "1e-6",
    ("milli", "m"): "1e-3",
    ("centi", "c"): "1e-2",
    ("kilo", "k"): "1e3",
    ("mega", "M"): "1e6",
    ("giga", "G"): "1e9",
}

#: number of others, or the dimension that a unit is of, by its names
UNITS = {
    ("meter", "metre", "m"): ("1", LENGTH),
    ("inch", "inches", "in"): ("0.0254", "meter"),
    ("foot", "feet", "ft"): ("12", "inch"),
    ("mil", "thou"): ("0.001", "inch"),
    ("micron",): ("1e-6", "meter"),
    ("gram", "g"): ("1", MASS),
    ("tonne", "t"): ("1000", "kilogram"),
    ("pound", "lb", "lbm"): ("0.45359237", "kilogram"),
    ("second", "sec", "s"): ("1", TIME),
    ("minute", "min"): ("60", "second"),
    ("hour", "hr"): ("3600", "second"),
    ("radian", "rad"): ("1", ANGLE),
    ("turn", "rev", "cycle"): ("6.283185307179586476925286766559", "radian"),
    ("degree", "deg", "°"): ("0.01745329251994329576923690768489", "radian"),
    ("hertz", "Hz", "cps"): ("1", "turn/second"),
    ("rpm", "cpm"): ("1", "turn/minute"),
    ("ips",): ("1", "inch/second"),
    ("gn", "gE"): ("9.80665", "meter/second^2"),
    ("Gal",): ("0.01", "meter/second^2"),
    ("newton", "N"): ("1", "kilogram*meter/second^2"),
    ("daN",): ("10", "newton"),
    ("dyne",): ("1e-5", "newton"),
    ("Nm",): ("1", "newton*meter"),
    ("Nmm",): ("0.001", "newton*meter"),
    ("kgf", "kp"): ("9.80665", "newton"),
    ("lbf",): ("1", "pound*gn"),
    ("kip", "kips"): ("1000", "lbf"),
    ("joule", "J"): ("1", "newton*meter"),
    ("pascal", "Pa"): ("1", "newton/meter^2"),
    ("bar",): ("100000", "pascal"),
    ("psi",): ("1", "lbf/inch^2"),
    ("ksi",): ("1000", "psi"),
    ("volt", "V"): ("1", VOLTAGE),
    ("ampere", "amp", "A"): ("1", "newton*meter/second/volt"),
    ("ohm",): ("1", "volt/ampere"),
    ("henry", "H"): ("1", "ohm*second"),
    ("percent",): ("0.01", ""),
}

#: words with prefixes that have one reading in capitals too: MM, but not MPA, which may be mPa
PREFIXED = ("mm", "cm", "um", "µm", "ms", "us", "µs", "kg", "kN", "kHz", "kPa", "msec", "usec", "µsec", "mbar")
CAPITALS = {"M": "m", "S": "s"}  # where all are capitals, as M/S^2

_TOKEN = re.compile(r" ?(?:([A-Za-zµ%°]+)(?:'s|\.(?=/))?|([()/])|([*·×⋅∙]|[.-](?=[A-Za-zµ(]))|(1)(?= ?/))")
_POWER = re.compile(r" ?(?:\^|\*\*) ?(?:[({]([+-]?[0-9])[)}]|([+-]?[0-9]))|(-?[1-9])(?![0-9])|(⁻?[¹²³⁴])")
_RAISED = str.maketrans("⁻¹²³⁴", "-1234")
LONGEST, MOST = 40, 6  # characters of a unit, and its factors
LETTERS = 5  # of the longest symbol: a longer name is a word, as Millimeter
Factors = list[tuple[str, int]]


@cache
def unit_size(unit: str) -> Size | None:
    """Size in base units and dimension of a product of known units, with prefixes or not; None for anything else.

    Written as in ``m/s^2``, or as instruments do: m/s2, m/sec², m.s-2, (m/s^2), M/S2.
    """
    found = None if len(unit) > LONGEST or unit != unit.strip() else _product(unit)
    if not found or len(found) > MOST:
        return None
    size, dimension, capitals = Decimal(1), dict[str, float](), unit.isupper()
    for name, exponent in found:
        one = _named(CAPITALS.get(name, name) if capitals else name)
        if one is None:
            return None
        size *= one[0] ** exponent
        for base, power in one[1].items():
            dimension[base] = dimension.get(base, 0.0) + power * exponent
    return size, {base: power for base, power in dimension.items() if power}


def _product(unit: str) -> Factors | None:
    """Names of units in a product, each with its power but 0; None where it is none.

    A division is by the next factor alone: kg/m s is kg s/m.
    """
    groups, signs, at, ready = [Factors()], [1], 0, False  # ready: a factor is behind, an operator may follow
    while at < len(unit):
        found = _TOKEN.match(unit, at)
        if not found:
            return None
        at, (name, mark, times, one) = found.end(), found.groups()
        if times or mark == "/":
            if not (ready or (mark and not groups[-1])):
                return None
            signs[-1], ready = -1 if mark else 1, False
        elif mark == "(":
            groups.append([])
            signs.append(1)
            ready = False
        elif mark == ")" and (len(groups) == 1 or not ready):
            return None
        else:
            inner = groups.pop() if mark else [] if one else [(name, 1)]
            if mark:
                signs.pop()
            raised = _POWER.match(unit, at)
            at = raised.end() if raised else at
            power = int(next(filter(None, raised.groups())).translate(_RAISED)) if raised else 1
            groups[-1] += [(each, exponent * power * signs[-1]) for each, exponent in inner]
            signs[-1], ready = 1, True
    whole = ready and len(groups) == 1
    return [(name.replace("%", "percent"), exponent) for name, exponent in groups[0] if exponent] if whole else None


@cache
def _named(name: str) -> Size | None:
    """Size of a unit by its name or symbol, behind a prefix or none; a name may be in the plural, or in capitals."""
    for ending in ("", "s"):
        for prefixes, factor in PREFIXES.items():
            for prefix in prefixes:
                inner = name.removeprefix(prefix).removesuffix(ending)
                if prefix + inner + ending == name and (found := _defined(inner)) and (len(inner) > 1 or not ending):
                    return Decimal(factor) * found[0], found[1]
    small = name.casefold()
    plain = _small_letters().get(small) or _small_letters().get(small.removesuffix("s"), name)
    mixed = plain in ("Hz", "kHz") or (len(plain) > 2 and name == plain[:1] + plain[1:].title())  # mSec, but not mM
    plain = small if plain == name and len(name) > LETTERS else plain
    alike = name.isupper() or name.istitle() or mixed
    return _named(plain) if alike and plain != name else None


@cache
def _small_letters() -> dict[str, str]:
    """Words of more than one letter that have one reading, whatever the case of their letters; GAL is a gallon."""
    every = [*(each for names in UNITS for each in names), *PREFIXED]
    return {each.casefold(): each for each in every if len(each) > 1 and each != "Gal"}


def _defined(name: str) -> Size | None:
    for names, (number, of) in UNITS.items():
        if name in names:
            size, dimension = (Decimal(1), {of: 1.0}) if of.startswith("[") else unit_size(of) or (Decimal(1), {})
            return Decimal(number) * size, dimension
    return None
