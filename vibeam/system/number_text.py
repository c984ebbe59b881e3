"""Numbers as text: unit prefixes by size (a switch in µm and kHz, a beam in mm and Hz), shares as percent."""

from __future__ import annotations

import math
from collections.abc import Mapping

Steps = tuple[tuple[float, str, float], ...]  # smallest SI size, unit, factor from SI
LENGTHS: Steps = ((1.0, "m", 1.0), (1e-4, "mm", 1e3), (1e-7, "µm", 1e6), (0.0, "nm", 1e9))
SPEEDS: Steps = ((10.0, "m/s", 1.0), (1e-4, "mm/s", 1e3), (1e-7, "µm/s", 1e6), (0.0, "nm/s", 1e9))
ACCELERATIONS: Steps = ((1e-1, "m/s²", 1.0), (1e-4, "mm/s²", 1e3), (0.0, "µm/s²", 1e6))
JERKS: Steps = ((0.0, "m/s³", 1.0),)
ANGLES: Steps = ((1.0, "rad", 1.0), (1e-4, "mrad", 1e3), (0.0, "µrad", 1e6))
TURNING: Steps = ((1.0, "rad/s", 1.0), (1e-4, "mrad/s", 1e3), (0.0, "µrad/s", 1e6))
STRAINS: Steps = ((0.0, "µε", 1e6),)
STRAINING: Steps = ((1.0, "1/s", 1.0), (0.0, "µε/s", 1e6))
FREQUENCIES: Steps = ((1e10, "GHz", 1e-9), (1e7, "MHz", 1e-6), (1e4, "kHz", 1e-3), (0.0, "Hz", 1.0))
MASSES: Steps = ((1.0, "kg", 1.0), (1e-3, "g", 1e3), (0.0, "mg", 1e6))
TIMES: Steps = ((1.0, "s", 1.0), (1e-4, "ms", 1e3), (0.0, "µs", 1e6))
MODULI: Steps = ((1e9, "GPa", 1e-9), (1e6, "MPa", 1e-6), (0.0, "Pa", 1.0))

#: prefixes of an output's quantity and of its rate
OF_QUANTITY: Mapping[str, tuple[Steps, Steps]] = {
    "displacement": (LENGTHS, SPEEDS),
    "velocity": (SPEEDS, ACCELERATIONS),
    "acceleration": (ACCELERATIONS, JERKS),
    "slope": (ANGLES, TURNING),
    "strain": (STRAINS, STRAINING),
}

#: prefixes of a key's SI unit
OF_UNIT: Mapping[str, Steps] = {
    "m": LENGTHS, "m/s": SPEEDS, "m/s^2": ACCELERATIONS, "rad": ANGLES, "Hz": FREQUENCIES, "kg": MASSES, "s": TIMES,
    "Pa": MODULI,
}  # fmt: skip


def shown_in(unit: str, *values: float) -> tuple[str, float]:
    """Unit and factor that suit the largest of values in an SI ``unit``; that unit itself where it takes no prefix."""
    largest = max((abs(each) for each in values if math.isfinite(each)), default=0.0)
    return prefixed(OF_UNIT[unit], largest) if unit in OF_UNIT and largest > 0 else (unit, 1.0)


def with_unit(value: float, unit: str, digits: int = 4) -> str:
    """A value of an SI unit, with the prefix that suits it."""
    name, factor = shown_in(unit, value)
    return f"{value * factor:.{digits}g} {name}".strip()


def prefixed(steps: Steps, largest: float, usual: int = 1) -> tuple[str, float]:
    """Unit and factor that suit the ``largest`` SI value; those of step ``usual`` where it is 0 or unknown."""
    known = math.isfinite(largest) and largest > 0
    _, name, factor = next(step for step in steps if largest >= step[0]) if known else steps[usual]
    return name, factor


ONE = 1e-13  # difference from 0 and 1 that is round-off


def ratio(value: float, form: str = ".4g", whole: float = 1.0) -> str:
    """Ratio in a format; in more digits where that says 0 or the ``whole``, and it is neither: 0.999999999."""
    texts = (f"{value:{each}}" for each in (form, *(f".{digits}g" for digits in range(1, 18))))
    return next(each for each in texts if abs(float(each)) not in (0, whole) or abs(value - float(each)) <= ONE * whole)


MOST = 100.0  # largest share shown as a number: what is further off is off altogether
ROUND_OFF = 1e-9  # share of what a number comes from, below which it is round-off


def percent(value: float) -> str:
    """Share as percent, to three digits; of one beyond ``MOST`` that it is more."""
    if value > MOST:
        return "∞" if math.isinf(value) else f"> {100 * MOST:.0f} %"
    return f"{float(ratio(100 * value, '.3g', 100.0)):.15g} %" if math.isfinite(value) else "–"


def without_round_off(value: float, of: float) -> float:
    """The value; 0 where it is round-off of what it comes from, numbers as large as ``of``."""
    return 0.0 if abs(value) <= ROUND_OFF * abs(of) else value


def signed(value: float) -> str:
    """Signed share as percent, to three digits, one where it is below 10⁻⁵; 0 below 10⁻⁶, which is dust."""
    if not math.isfinite(value):
        return "–"
    if value > MOST:
        return f"> +{100 * MOST:.0f} %"
    if abs(value) >= 1e-5:
        return f"{float(ratio(100 * value, '.3g', 100.0)):+.15g} %"
    return f"{float(f'{100 * value:.0e}'):+.4f} %" if abs(value) >= 1e-6 else "0"


WORDS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")


def modes_in_words(count: int) -> str:
    """Number of modes in a sentence: ``two modes``; above twelve in digits."""
    return f"{WORDS[count] if count < len(WORDS) else count} mode{'' if count == 1 else 's'}"


def begun(text: str) -> str:
    """The text with a capital letter at its beginning."""
    return text[:1].upper() + text[1:]
