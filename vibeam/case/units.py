"""Units of measured quantities: size and dimension of a unit such as mm/V or kg m^2.

Products of common symbols are read without pint, which takes a third of a second to import; pint reads the others.
"""

from __future__ import annotations

import re
from decimal import Decimal
from functools import cache
from typing import Any

#: size and dimension of a unit in gram, metre, second, volt and radian
Size = tuple[Decimal, dict[str, float]]
MASS, LENGTH, TIME, VOLTAGE, ANGLE = "[mass]", "[length]", "[time]", "[voltage]", "[angle]"
_TURN = "6.283185307179586476925286766559"
_FORCE = {MASS: 1, LENGTH: 1, TIME: -2}
_PRESSURE = {MASS: 1, LENGTH: -1, TIME: -2}

SYMBOLS: dict[str, tuple[str, dict[str, int]]] = {
    "m": ("1", {LENGTH: 1}),
    "mm": ("1e-3", {LENGTH: 1}),
    "cm": ("1e-2", {LENGTH: 1}),
    "µm": ("1e-6", {LENGTH: 1}),
    "g": ("1", {MASS: 1}),
    "kg": ("1e3", {MASS: 1}),
    "s": ("1", {TIME: 1}),
    "ms": ("1e-3", {TIME: 1}),
    "rad": ("1", {ANGLE: 1}),
    "Hz": (_TURN, {ANGLE: 1, TIME: -1}),
    "kHz": (f"{_TURN}e3", {ANGLE: 1, TIME: -1}),
    "N": ("1e3", _FORCE),
    "Pa": ("1e3", _PRESSURE),
    "MPa": ("1e9", _PRESSURE),
    "GPa": ("1e12", _PRESSURE),
    "V": ("1", {VOLTAGE: 1}),
    "mV": ("1e-3", {VOLTAGE: 1}),
    "A": ("1e3", {MASS: 1, LENGTH: 2, TIME: -3, VOLTAGE: -1}),
    "ohm": ("1e-3", {VOLTAGE: 2, MASS: -1, LENGTH: -2, TIME: 3}),
    "H": ("1e-3", {VOLTAGE: 2, MASS: -1, LENGTH: -2, TIME: 4}),
    "mH": ("1e-6", {VOLTAGE: 2, MASS: -1, LENGTH: -2, TIME: 4}),
    "%": ("0.01", {}),
}

_FACTOR = re.compile(r"(/|[ *·]|^)([A-Za-zµ%]+)(?:\^(-?[1-9]))?")
_PRODUCT = re.compile(rf"(?:1(?=/)|(?=[A-Za-zµ%]))(?:{_FACTOR.pattern})+")


def common_unit(unit: str) -> Size | None:
    """Size and dimension of a product of common symbols; None for any other unit."""
    factors = _FACTOR.findall(unit.removeprefix("1")) if _PRODUCT.fullmatch(unit) else []
    if not factors or not all(symbol in SYMBOLS for _, symbol, _ in factors):
        return None
    size, dimension = Decimal(1), dict[str, float]()
    for sign, symbol, power in factors:
        exponent = int(power or 1) * (-1 if sign == "/" else 1)
        one, powers = SYMBOLS[symbol]
        size *= +(Decimal(one) ** exponent)
        for name, each in powers.items():
            dimension[name] = dimension.get(name, 0.0) + each * exponent
    return size, {name: power for name, power in dimension.items() if power}


# An angle is a dimension of its own here, so that 1 Hz = 2π rad/s and a bare 1/s is neither.
_DEFINITIONS = """
nano- = 1e-9 = n-
micro- = 1e-6 = µ- = u-
milli- = 1e-3 = m-
centi- = 1e-2 = c-
kilo- = 1e3 = k-
mega- = 1e6 = M-
giga- = 1e9 = G-
meter = [length] = m = metre
inch = 0.0254 * meter = in
gram = [mass] = g
tonne = 1000 * kilogram = t
second = [time] = s
minute = 60 * second = min
radian = [angle] = rad
turn = 6.283185307179586476925286766559 * radian = rev
degree = turn / 360 = deg
hertz = turn / second = Hz
rpm = turn / minute
newton = kilogram * meter / second ** 2 = N
pascal = newton / meter ** 2 = Pa
volt = [voltage] = V
ampere = newton * meter / second / volt = A
ohm = volt / ampere
henry = ohm * second = H
percent = 0.01
"""

_POWER = r"(?: ?(?:\^|\*\*) ?-?[0-9]|⁻?[¹²³])?"
_UNIT = re.compile(rf"(?:1 ?/ ?)?[A-Za-zµ%]+{_POWER}(?:(?: ?[*/·] ?| )[A-Za-zµ%]+{_POWER}){{0,5}}")


@cache
def unit_size(unit: str) -> Size | None:
    """Size in base units and dimension of a unit, or None; pint reads plain products of units that are not common."""
    if len(unit) > 40 or not _UNIT.fullmatch(unit):
        return None
    if (common := common_unit(unit)) is not None:
        return common
    registry = _registry()
    try:
        one = registry.Quantity(Decimal(1), registry.parse_units(unit.replace("%", "percent")))
        base = one.to_base_units()
        return Decimal(base.magnitude), {str(name): float(power) for name, power in base.dimensionality.items()}
    except Exception:  # whatever pint's parser makes of rubbish, it is not a unit
        return None


@cache
def _registry() -> Any:
    """Pint with the few units of this bench: its own thousand take ten times as long to read."""
    import pint

    registry: Any = pint.UnitRegistry(None, non_int_type=Decimal)
    registry.load_definitions(_DEFINITIONS.strip().splitlines())
    return registry
