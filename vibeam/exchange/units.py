"""Units of measured quantities: size and dimension of a unit such as mm/V or kg m^2, from one table of definitions.

Sizes are decimal numbers, so that 180 mm is 0.18 m to the last bit. An angle is a dimension of its own, so that 1 Hz =
2π rad/s and a bare 1/s is neither.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
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
    ("inch", "in"): ("0.0254", "meter"),
    ("gram", "g"): ("1", MASS),
    ("tonne", "t"): ("1000", "kilogram"),
    ("second", "s"): ("1", TIME),
    ("minute", "min"): ("60", "second"),
    ("radian", "rad"): ("1", ANGLE),
    ("turn", "rev"): ("6.283185307179586476925286766559", "radian"),
    ("degree", "deg"): ("0.01745329251994329576923690768489", "radian"),
    ("hertz", "Hz"): ("1", "turn/second"),
    ("rpm",): ("1", "turn/minute"),
    ("newton", "N"): ("1", "kilogram*meter/second^2"),
    ("joule", "J"): ("1", "newton*meter"),
    ("pascal", "Pa"): ("1", "newton/meter^2"),
    ("volt", "V"): ("1", VOLTAGE),
    ("ampere", "A"): ("1", "newton*meter/second/volt"),
    ("ohm",): ("1", "volt/ampere"),
    ("henry", "H"): ("1", "ohm*second"),
    ("percent",): ("0.01", ""),
}

_POWER = r"(?: ?(?:\^|\*\*) ?(-?[0-9])|(⁻?[¹²³]))?"
_FACTOR = re.compile(rf"( ?[*/·] ?| |^)([A-Za-zµ%]+){_POWER}")
_PRODUCT = re.compile(rf"(?:1 ?/ ?)?[A-Za-zµ%]+{_POWER}(?:(?: ?[*/·] ?| )[A-Za-zµ%]+{_POWER}){{0,5}}")
_RAISED = str.maketrans("⁻¹²³", "-123")


@cache
def unit_size(unit: str) -> Size | None:
    """Size in base units and dimension of a product of known units, with prefixes or not; None for anything else."""
    if len(unit) > 40 or not _PRODUCT.fullmatch(unit):
        return None
    size, dimension = Decimal(1), dict[str, float]()
    factors = [(name, exponent) for name, exponent in _factors(unit.replace("%", "percent")) if exponent]
    for name, exponent in factors:
        one = _named(name)
        if one is None:
            return None
        size *= one[0] ** exponent
        for base, power in one[1].items():
            dimension[base] = dimension.get(base, 0.0) + power * exponent
    return (size, {base: power for base, power in dimension.items() if power}) if factors else None


def _factors(unit: str) -> Iterator[tuple[str, int]]:
    """Names of units in a product, each with its power."""
    for sign, name, power, raised in _FACTOR.findall(re.sub("^1 ?(?=/)", "", unit)):
        exponent = int(power or raised.translate(_RAISED) or 1)
        yield name, -exponent if "/" in sign else exponent


@cache
def _named(name: str) -> Size | None:
    """Size of a unit by its name or symbol, behind a prefix or none; a name may be in the plural."""
    for ending in ("", "s"):
        for prefixes, factor in PREFIXES.items():
            for prefix in prefixes:
                inner = name.removeprefix(prefix).removesuffix(ending)
                if prefix + inner + ending == name and (found := _defined(inner)) and (len(inner) > 1 or not ending):
                    return Decimal(factor) * found[0], found[1]
    return None


def _defined(name: str) -> Size | None:
    for names, (number, of) in UNITS.items():
        if name in names:
            size, dimension = (Decimal(1), {of: 1.0}) if of.startswith("[") else unit_size(of) or (Decimal(1), {})
            return Decimal(number) * size, dimension
    return None
