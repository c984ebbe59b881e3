"""Units made of common symbols, such as kg m^2 or N/mm: without pint, which takes a third of a second to import."""

from __future__ import annotations

import re
from decimal import Decimal

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
