"""Units as instruments, exporters and people spell them: the size in what is asked, or refused with the one meant.

The spellings are those of public files: exports of oscilloscopes, of loggers and phones, of LabVIEW, Test.Lab, NI,
Simulink, Dewesoft, HBM, PULSE and Klipper, universal files, data sets of bearings, of earthquakes and of structures.
"""

from __future__ import annotations

from itertools import product

import pytest

from vibeam.exchange.units import factor, known_unit, taking

G, LB, IN = 9.80665, 0.45359237, 0.0254
ACCELERATION = {
    "m/s^2": 1, "m/s2": 1, "m/s²": 1, "m/s**2": 1, "m/sec^2": 1, "m/sec2": 1, "m/sec²": 1, "(m/s^2)": 1, "[m/s^2]": 1,
    "m.s-2": 1, "m s^-2": 1, "m·s^-2": 1, "m s⁻²": 1, "m*s^-2": 1, "m/s/s": 1, "M/S2": 1, "M/S^2": 1, "m/(s^2)": 1,
    "meter/second^2": 1, "meters/second^2": 1, "metre/second^2": 1, "mm/s^2": 1e-3, "mm/s2": 1e-3, "mm/s²": 1e-3,
    "mm/sec^2": 1e-3, "MM/S2": 1e-3, "cm/s^2": 1e-2, "cm/s2": 1e-2, "cm/sec2": 1e-2, "cm/sec^2": 1e-2, "cm/s/s": 1e-2,
    "µm/s^2": 1e-6, "μm/s²": 1e-6, "um/s^2": 1e-6, "km/s^2": 1e3, "Gal": 1e-2, "mGal": 1e-5, "gn": G, "g": G, "G": G,
    "g's": G, "G's": G, "gs": G, "Gs": G, "[g]": G, "{g}": G, "mg": 1e-3 * G, "mG": 1e-3 * G, "µg": 1e-6 * G,
    "ug": 1e-6 * G, "gE": G, "g rms": G, "g_rms": G, "gRMS": G, "grms": G, "Grms": G, "G RMS": G, "g pk": G, "gpk": G,
    "g peak": G, "g pk-pk": G, "g (rms)": G, "m/s² rms": 1, "m/s^2 (RMS)": 1, "m/s^2 pk": 1, "in/s^2": IN, "in/s2": IN,
    "in/sec^2": IN, "inch/s^2": IN, "ft/s^2": 12 * IN, "ft/s2": 12 * IN, "ft/sec^2": 12 * IN, "feet/second^2": 12 * IN,
    "ms-2": 1, "ms^-2": 1, "ms⁻²": 1, "m⋅s⁻²": 1, "m∙s^-2": 1, "m/s^{2}": 1, "m s^{-2}": 1, "m per s^2": 1,
    "meters per second squared": 1, "in./s^2": IN, "g-force": G, "G-force": G, "g_n": G,
}  # fmt: skip
VELOCITY = {
    "m/s": 1, "m/sec": 1, "M/S": 1, "meters/second": 1, "mm/s": 1e-3, "mm/sec": 1e-3, "MM/S": 1e-3, "mm/s rms": 1e-3,
    "mm/s RMS": 1e-3, "mm/s (rms)": 1e-3, "mm/s pk": 1e-3, "mm s-1": 1e-3, "mm.s-1": 1e-3, "mm·s⁻¹": 1e-3, "cm/s": 1e-2,
    "cm/sec": 1e-2, "µm/s": 1e-6, "um/s": 1e-6, "nm/s": 1e-9, "km/s": 1e3, "in/s": IN, "in/sec": IN, "ips": IN,
    "IPS": IN, "ft/s": 12 * IN, "km/hr": 1 / 3.6, "inch/sec": IN,
    "ms-1": 1, "ms^-1": 1, "in./s": IN, "mm per second": 1e-3,
}  # fmt: skip
LENGTH = {
    "m": 1, "meter": 1, "meters": 1, "Meters": 1, "metre": 1, "metres": 1, "mm": 1e-3, "MM": 1e-3, "[mm]": 1e-3,
    "mm pp": 1e-3, "mm p-p": 1e-3, "mm pk-pk": 1e-3, "mm peak to peak": 1e-3, "cm": 1e-2, "um": 1e-6, "µm": 1e-6,
    "μm": 1e-6, "UM": 1e-6, "micron": 1e-6, "microns": 1e-6, "Microns": 1e-6, "µm pk-pk": 1e-6, "nm": 1e-9, "km": 1e3,
    "millimeter": 1e-3, "millimeters": 1e-3, "in": IN, "inch": IN, "inches": IN, "Inches": IN, "mil": 1e-3 * IN,
    "mils": 1e-3 * IN, "mils pp": 1e-3 * IN, "mil p-p": 1e-3 * IN, "thou": 1e-3 * IN, "ft": 12 * IN, "feet": 12 * IN,
    "foot": 12 * IN, "Micrometer": 1e-6, "Millimeter": 1e-3, "MILLIMETERS": 1e-3, "Micrometres": 1e-6, "mmpp": 1e-3,
}  # fmt: skip
FORCE = {
    "N": 1, "Newton": 1, "Newtons": 1, "newtons": 1, "NEWTON": 1, "[N]": 1, "kN": 1e3, "KN": 1e3, "mN": 1e-3, "MN": 1e6,
    "µN": 1e-6, "uN": 1e-6, "kg m/s^2": 1, "lbf": LB * G, "lbsf": None, "Lbf": LB * G, "LBF": LB * G, "kgf": G, "kp": G,
    "kip": 1e3 * LB * G, "kips": 1e3 * LB * G, "cN": 1e-2, "daN": 10, "dyn": None, "dyne": 1e-5, "tf": None,
}  # fmt: skip
TIME = {
    "s": 1, "S": 1, "sec": 1, "Sec": 1, "SEC": 1, "secs": 1, "second": 1, "Second": 1, "seconds": 1, "Seconds": 1,
    "[s]": 1, "(s)": 1, "ms": 1e-3, "msec": 1e-3, "mSec": 1e-3, "millisecond": 1e-3, "milliseconds": 1e-3, "us": 1e-6,
    "µs": 1e-6, "μs": 1e-6, "usec": 1e-6, "µsec": 1e-6, "ns": 1e-9, "min": 60, "minutes": 60, "hr": 3600, "hours": 3600,
    "Milliseconds": 1e-3, "Microsecond": 1e-6,
}  # fmt: skip
FREQUENCY = {
    "Hz": 1, "HZ": 1, "hz": 1, "[Hz]": 1, "Hertz": 1, "hertz": 1, "kHz": 1e3, "KHz": 1e3, "khz": 1e3, "KHZ": 1e3,
    "MHz": 1e6, "mHz": 1e-3, "rpm": 1 / 60, "RPM": 1 / 60, "cpm": 1 / 60, "CPM": 1 / 60, "rev/min": 1 / 60, "cps": 1,
    "cycles/s": 1, "cycles/sec": 1, "Kilohertz": 1e3,
    "rad/s": 0.15915494309189535, "rad/sec": 0.15915494309189535, "RAD/S": 0.15915494309189535, "deg/s": 1 / 360,
}  # fmt: skip
RATIOS = {
    ("m/s^2/N", "m/s^2/N"): 1, ("(m/s^2)/N", "m/s^2/N"): 1, ("g/N", "m/s^2/N"): G, ("g/lbf", "m/s^2/N"): 1 / LB,
    ("(m/s²)/N", "m/s^2/N"): 1, ("m/N", "m/N"): 1, ("mm/N", "m/N"): 1e-3, ("µm/N", "m/N"): 1e-6, ("in/lbf", "m/N"):
    IN / (LB * G), ("m/s/N", "m/s/N"): 1, ("(m/s)/N", "m/s/N"): 1, ("N/mm", "N/m"): 1e3, ("mV/g", "V s^2/m"): 1e-3 / G,
    ("V", "V"): 1, ("Volt", "V"): 1, ("Volts", "V"): 1, ("Vpp", "V"): 1, ("Millivolts", "V"): 1e-3,
    ("mV/ms-2", "V s^2/m"): 1e-3, ("ms-2/N", "m/s^2/N"): 1, ("Nmm", "N m"): 1e-3,
    ("volts", "V"): 1, ("mV", "V"): 1e-3, ("N m", "N m"): 1,
    ("N.m", "N m"): 1, ("Nm", "N m"): 1, ("N*m", "N m"): 1, ("N·m", "N m"): 1, ("lbf in", "N m"): LB * G * IN,
    ("psi", "Pa"): LB * G / IN**2, ("ksi", "Pa"): 1e3 * LB * G / IN**2, ("MPa", "Pa"): 1e6, ("bar", "Pa"): 1e5,
    ("mbar", "Pa"): 100, ("kPa", "Pa"): 1e3, ("-", ""): 1, ("1", ""): 1,
}  # fmt: skip
OF = {"m/s^2": ACCELERATION, "m/s": VELOCITY, "m": LENGTH, "N": FORCE, "s": TIME, "Hz": FREQUENCY}
KNOWN = [(unit, asked, size) for asked, units in OF.items() for unit, size in units.items() if size is not None]
KNOWN += [(unit, asked, size) for (unit, asked), size in RATIOS.items()]
#: unknown spellings, what is asked, and the unit that the message names
REFUSED = [
    ("lbsf", "N", "lbf"), ("Nn", "N", "N"), ("m/ss", "m/s", "m/s"), ("m/s3^", "m/s^2", "m/s^2"),
    ("mm/s^^2", "m/s^2", "mm/s^2"), ("hzz", "Hz", "Hz"), ("sekunden", "s", ""), ("tf", "N", ""),
    ("dyn", "N", "N"), ("counts", "m/s^2", ""), ("LSB", "m/s^2", ""), ("ADC", "m/s^2", ""), ("dB", "m", ""),
    ("EU", "m/s^2", ""), ("a.u.", "m", ""), ("rppm", "Hz", "rpm"), ("furlong", "m", ""), ("mmm", "m", "mm"),
    ("yards", "m", ""), ("kHzz", "Hz", "kHz"), ("sq", "s", "s"),
]  # fmt: skip
FOREIGN = [("V", "m/s^2"), ("mV", "m/s^2"), ("Volts", "m"), ("mm", "m/s^2"), ("g", "m"), ("N", "m/s^2"), ("Hz", "s"),
           ("s", "Hz"), ("1/s", "Hz"), ("kg", "N"), ("lb", "N"), ("°", "m"), ("%", "m"), ("ms2", "m/s^2"),
           ("m/s^2", "m"), ("mGal", "m")]  # fmt: skip


def test_the_list_is_long_enough() -> None:
    assert len({unit for unit, _, _ in KNOWN}) + len(REFUSED) >= 150


@pytest.mark.parametrize(("unit", "asked", "size"), KNOWN)
def test_a_spelling_has_its_size(unit: str, asked: str, size: float) -> None:
    assert factor(unit, asked) == pytest.approx(size, rel=1e-12)
    assert known_unit(unit)


@pytest.mark.parametrize(("unit", "asked", "meant"), REFUSED)
def test_an_unknown_one_is_refused_with_the_one_meant(unit: str, asked: str, meant: str) -> None:
    with pytest.raises(ValueError, match="is not known") as caught:
        factor(unit, asked)
    assert str(caught.value).endswith(f": {meant}?") if meant else str(caught.value).endswith("is not known")


@pytest.mark.parametrize(("unit", "asked"), FOREIGN)
def test_a_unit_of_another_quantity_is_refused(unit: str, asked: str) -> None:
    with pytest.raises(ValueError, match="is not one of"):
        factor(unit, asked)


def neighbours(unit: str) -> list[tuple[str, str]]:
    """Spellings near one, by kind; those that mean another unit, as mM of MM, are not among them."""
    plain = unit.replace("^", "").replace("²", "2")
    near = [("bracket", f"({unit})"), ("bracket", f"[{unit}]"), ("blank", f" {unit} "), ("rms", f"{unit} rms")]
    near += [("rms", f"{unit} (RMS)"), ("rms", f"{unit} pk-pk"), ("power", plain)]
    near += [("power", unit.replace("^2", power)) for power in ("²", "**2", "^(2)", "2")]
    return [(kind, each) for kind, each in near if each != unit]


PLAINLY = ("m/s^2", "mm/s^2", "in/s^2", "g", "mm/s", "m", "mm", "µm", "N", "kN", "s", "ms", "Hz", "kHz", "V")
HOMES = {each: asked for each, asked, _ in KNOWN}
NEAR = [(unit, near) for unit in PLAINLY for _, near in neighbours(unit)]


@pytest.mark.parametrize(("unit", "near"), NEAR)
def test_a_neighbour_in_brackets_blanks_and_powers_is_the_same(unit: str, near: str) -> None:
    assert factor(near, HOMES[unit]) == factor(unit, HOMES[unit])


@pytest.mark.parametrize(
    "word", ["meter", "inch", "second", "newton", "volt", "micron", "mil", "pound", "minute", "hour"]
)
def test_a_word_may_be_in_the_plural_and_in_capitals(word: str) -> None:
    """``INCHES`` and ``Inches`` too; letters in disorder, ``inChes``, are no word."""
    plural = f"{word}es" if word == "inch" else f"{word}s"
    asked = {"second": "s", "minute": "s", "hour": "s", "newton": "N", "volt": "V", "pound": "kg"}.get(word, "m")
    sizes = {factor(each, asked) for each in (word, plural, word.upper(), plural.upper(), plural.title())}
    assert len(sizes) == 1


@pytest.mark.parametrize(("unit", "asked"), [*product(["mM", "Mm", "kG", "MPA", "hS", "mHZ"], ["m", "s", "Hz", "N"])])
def test_case_that_could_mislead_is_not_read_as_another_unit(unit: str, asked: str) -> None:
    """``mM`` is a millimole, ``Mm`` 1000 km: neither is ever a millimetre."""
    try:
        size = factor(unit, asked)
    except ValueError:
        return
    assert (unit, size) in {("Mm", 1e6)}


@pytest.mark.parametrize(
    ("spelt", "unit", "how"),
    [("g rms", "g", "rms"), ("gRMS", "g", "rms"), ("mm (rms)", "mm", "rms"), ("mm pk-pk", "mm", "peak to peak"),
     ("mils p-p", "mils", "peak to peak"), ("mm peak to peak", "mm", "peak to peak"), ("g pk", "g", "peak"),
     ("µm 0-pk", "µm", "peak"), ("mm/s r.m.s.", "mm/s", "rms"), ("rms", "", "rms"), ("mm", "mm", ""),
     ("ppm", "ppm", "")],
)  # fmt: skip
def test_how_values_are_taken_is_no_part_of_their_unit(spelt: str, unit: str, how: str) -> None:
    assert taking(spelt) == (unit, how)
