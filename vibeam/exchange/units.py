"""Units of measured quantities: size and dimension of a unit such as mm/V or kg m^2, from one table of definitions.

Sizes are decimal numbers, so that 180 mm is 0.18 m to the last bit. An angle is a dimension of its own, so that 1 Hz =
2π rad/s and a bare 1/s is neither.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from decimal import Decimal
from difflib import get_close_matches
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
