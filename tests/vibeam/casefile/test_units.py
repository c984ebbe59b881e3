"""Quantities: what they are in SI, and what is said of those that are none."""

import math
from contextlib import suppress
from decimal import Decimal

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vibeam.casefile import quantities as units
from vibeam.casefile.quantities import UnitError, to_si
from vibeam.exchange.units import unit_size


@pytest.mark.parametrize(
    ("value", "kind", "expected"),
    [
        ("180 mm", units.LENGTH, 0.18),
        ("180mm", units.LENGTH, 0.18),
        (" -0.1 mm ", units.LENGTH, -1e-4),
        (".5e1 cm", units.LENGTH, 0.05),
        ("5 µm", units.LENGTH, 5e-6),
        ("5 μm", units.LENGTH, 5e-6),  # the Greek letter, which keyboards give
        ("1 in", units.LENGTH, 0.0254),
        (0.18, units.LENGTH, 0.18),
        (1, units.LENGTH, 1.0),
        ("2.4 g", units.MASS, 0.0024),
        ("2.84e-5 kg m^2", units.INERTIA, 2.84e-5),
        ("28.4 kg*mm²", units.INERTIA, 2.84e-5),
        ("210 GPa", units.PRESSURE, 210e9),
        ("5 N/mm^2", units.PRESSURE, 5e6),
        ("7850 kg/m^3", units.DENSITY, 7850.0),
        ("7.85 g/cm**3", units.DENSITY, 7850.0),
        ("600 mV", units.VOLTAGE, 0.6),
        ("5.16e-4 1/V", units.PER_VOLT, 5.16e-4),
        ("5.16e-4 V^-1", units.PER_VOLT, 5.16e-4),
        ("14 Hz", units.FREQUENCY, 14.0),
        ("1.5 kHz", units.FREQUENCY, 1500.0),
        ("900 rpm", units.FREQUENCY, 15.0),
        ("1.5 rad/s", units.FREQUENCY, 1.5 / (2 * math.pi)),
        ("1 rad/s", units.ANGULAR_FREQUENCY, 1.0),
        ("1 Hz", units.ANGULAR_FREQUENCY, 2 * math.pi),
        ("1 %", units.RATIO, 0.01),
        ("0.0001 %", units.RATIO, 1e-6),
        ("0.72", units.RATIO, 0.72),
        ("1 mm/m", units.RATIO, 1e-3),
    ],
)
def test_a_quantity_in_si(value, kind, expected):
    assert to_si(value, kind) == expected


@pytest.mark.parametrize(
    ("value", "kind", "message"),
    [
        ("180 kg", units.LENGTH, "'180 kg' is a mass, not a length"),
        ("3 s", units.FREQUENCY, "'3 s' is a time, not a frequency"),
        ("3 Hz", units.LENGTH, "'3 Hz' is a frequency, not a length"),
        ("3 1/s", units.FREQUENCY, "'3 1/s' is a quantity of dimension time^-1, not a frequency: write Hz or rad/s"),
        ("5 %", units.LENGTH, "'5 %' is a plain number, not a length"),
        ("5 mm", units.RATIO, "'5 mm' is a length, not a plain number"),
        ("5 m/s", units.LENGTH, "'5 m/s' is a speed, not a length"),
        ("5 m^2/s", units.LENGTH, "'5 m^2/s' is a quantity of dimension length^2 time^-1, not a length"),
        ("180 mM", units.LENGTH, "'180 mM' has the unknown unit 'mM'; did you mean 'mm'?"),
        ("2 Gpa", units.PRESSURE, "'2 Gpa' has the unknown unit 'Gpa'; did you mean 'GPa'?"),
        ("0,1 mm", units.LENGTH, "'0,1 mm': write the decimal sign as a point"),
        ("180", units.LENGTH, "'180' has no unit: write '180 mm' or '180 m'"),
        ("9" * 400, units.LENGTH, f"'{'9' * 55} …' has no unit: write '180 mm'"),
        ("mm", units.LENGTH, "'mm' is not a number with a unit: write '180 mm'"),
        ("", units.RATIO, "'' is not a number or a percentage: write 0.5"),
        ("nan mm", units.LENGTH, "'nan mm' is not a finite number"),
        ("-inf", units.RATIO, "'-inf' is not a finite number"),
        (math.nan, units.LENGTH, "nan is not a finite number"),
        (math.inf, units.LENGTH, "inf is not a finite number"),
        ("1e999 mm", units.LENGTH, "'1e999 mm' is not a finite number"),
        ("1e101 m", units.LENGTH, "'1e101 m' is beyond the range of a case, 1e-100 to 1e+100 in SI units"),
        (-1e-101, units.LENGTH, "-1e-101 is beyond the range of a case, 1e-100 to 1e+100 in SI units"),
        ("1e-400 mm", units.LENGTH, "'1e-400 mm' is beyond the range of numbers"),
        ("1e99999999999999999999 mm", units.LENGTH, "'1e99999999999999999999 mm' is beyond the range of numbers"),
        (10**400, units.LENGTH, "a number of more than 38 digits is not a finite number"),
        (True, units.LENGTH, "must be a length such as '180 mm', not true"),
        ([1], units.RATIO, "must be a plain number such as 0.5, not a list"),
        (1, units.ANGULAR_FREQUENCY, "1 may be rad/s or Hz: write '1 rad/s' or '1 Hz'"),
    ],
)
def test_what_is_no_such_quantity_says_what_it_is(value, kind, message):
    with pytest.raises(UnitError) as caught:
        to_si(value, kind)
    assert str(caught.value) == message


@pytest.mark.parametrize("unit", ["m^9^9^9", "m**99", "m^(9**9)", "m+m", "__import__('os')", "m " * 30, "2 m", "m\n"])
def test_a_unit_is_never_computed_with(unit):
    with pytest.raises(UnitError):
        to_si(f"1 {unit}x", units.LENGTH)


@settings(deadline=None)
@given(st.floats(-1e12, 1e12).filter(lambda x: x == 0 or abs(x) > 1e-12))
def test_millimetres_are_the_nearest_number_to_a_thousandth(x):
    assert to_si(f"{x!r} mm", units.LENGTH) == float(Decimal(repr(x)) / 1000)


@settings(deadline=None)
@given(st.floats(1e-9, 1e9))
def test_plain_numbers_and_their_own_unit_agree(x):
    assert to_si(x, units.FREQUENCY) == to_si(f"{x!r} Hz", units.FREQUENCY)


@settings(deadline=None)
@given(st.text())
def test_any_text_is_a_finite_number_or_a_unit_error(text):
    with suppress(UnitError):
        assert math.isfinite(to_si(text, units.LENGTH))


@settings(deadline=None)
@given(st.from_regex(r"[0-9]{1,3} [a-zA-Zµ%^*/()0-9 ²-]{0,12}", fullmatch=True))
def test_anything_like_a_unit_is_a_finite_number_or_a_unit_error(text):
    test_any_text_is_a_finite_number_or_a_unit_error.hypothesis.inner_test(text)


def test_units_are_what_their_definitions_say():
    """SI brochure, 9th ed., tables 4, 7 and 8; inch of 1959; an angle is a dimension, so that Hz is a turn a second."""
    turn = Decimal("6.283185307179586476925286766559")
    for unit, factor, same in (
        ("N", 1, "kg m/s^2"), ("Pa", 1, "N/m²"), ("GPa", 10**9, "newton / meter ** 2"), ("N/mm", 1000, "N m^-1"),
        ("A", 1, "N m/s/V"), ("ohm", 1, "V/A"), ("mH", Decimal("1e-3"), "ohm s"), ("t", 1000, "kilograms"),
        ("Hz", turn, "rad/s"), ("rpm", 1, "rev/min"), ("deg", 1 / Decimal(360), "turn"), ("min", 60, "s"),
        ("in", Decimal("25.4"), "mm"), ("µm", Decimal("1e-4"), "cm"), ("um", 1, "micrometre"), ("Mm", 10**15, "nm"),
        ("g/cm^3", 1000, "kg/m^3"),
        ("mm^4", Decimal("1e-12"), "m·m·m*m"), ("1/s^2", 1, "1 / s s^-1 s^2 / s ** 3 * s"),
        ("%", Decimal("0.01"), "m/m"), ("meters", 1, "m"), ("1/V", 1, "volt⁻¹"),
    ):  # fmt: skip
        (size, dimension), (other, of) = unit_size(unit), unit_size(same)
        assert dimension == of, unit
        assert size == pytest.approx(factor * other, rel=Decimal("1e-26")), unit


def test_anything_else_is_no_unit():
    wrong = ["", "1", "1/", "m//s", "parsec", "m^0", "m^", "m^12", "m s ", " m", "2/m", "m22", "1m", "Ns", "cc", "kkg"]
    assert [unit for unit in wrong if unit_size(unit) is not None] == []
