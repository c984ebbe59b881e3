"""Common units: pint, reading the same definitions, finds the same size and dimension."""

from decimal import Decimal
from itertools import product

import pytest

from vibeam.case.units import SYMBOLS, _registry, common_unit

PRODUCTS = [
    *SYMBOLS,
    *("kg m^2", "kg/m^3", "g/cm^3", "N/m^2", "N s/m", "N m/rad", "m/s^2", "1/V", "1/s", "N/mm", "mm^4", "1/s^2"),
    *(f"{one}{sign}{other}" for one, sign, other in product(("N", "kHz", "µm"), (" ", "/", "*", "·"), ("s", "mV^2"))),
    *("N/m s", "m/s/s", "s^-1", "kg m^2/s^2"),
]


@pytest.mark.parametrize("unit", PRODUCTS)
def test_a_common_unit_is_what_pint_says(unit: str) -> None:
    registry = _registry()
    base = registry.Quantity(Decimal(1), registry.parse_units(unit.replace("%", "percent"))).to_base_units()
    found = common_unit(unit)
    assert found is not None
    assert found[0] == pytest.approx(Decimal(base.magnitude), rel=Decimal("1e-26"))
    assert found[1] == {str(name): float(power) for name, power in base.dimensionality.items()}


@pytest.mark.parametrize(
    "unit", ["", "1", "1/", "m//s", "kN", "parsec", "m^0", "m^", "m^12", "m s ", " m", "2/m", "m2", "1m"]
)
def test_other_units_are_left_to_pint(unit: str) -> None:
    assert common_unit(unit) is None
