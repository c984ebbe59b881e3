"""Units of measured quantities: size and dimension of a unit such as mm/V; pint reads those that are not common."""

from __future__ import annotations

import re
from decimal import Decimal
from functools import cache
from typing import Any

from vibeam.case.common_units import Size, common_unit

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
