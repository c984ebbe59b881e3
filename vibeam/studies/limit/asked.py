"""What is asked of the limit on a command line: numbers with units, stops that yield, numbers of modes."""

from __future__ import annotations

from math import isfinite

from vibeam.casefile.quantities import UnitError, dimension, to_si
from vibeam_models.laws import ContactLaw
from vibeam_models.laws.hertz import Elastic
from vibeam_models.laws.linear import Linear

LEAST = 8  # modes


def quantity(name: str, text: str, unit: str) -> float:
    """Positive number in SI of the option ``name``; ValueError says what is wrong with it."""
    try:
        value = to_si(text, dimension(unit))
    except UnitError as error:
        raise ValueError(f"{name}: {error}") from None
    if not (isfinite(value) and value > 0):
        raise ValueError(f"{name}: {text} must be above 0")
    return value


def laws_of(linear: str | None, hertz: float | None) -> list[ContactLaw]:
    """Elastic stops of these stiffnesses; ValueError for one that is not above 0."""
    laws: list[ContactLaw] = []
    if linear is not None:
        laws.append(Linear(quantity("--linear", linear, "N/m"), damping=0.0))
    if hertz is not None:
        if not (isfinite(hertz) and hertz > 0):
            raise ValueError(f"--hertz: {hertz:g} must be above 0")
        laws.append(Elastic(hertz))
    return laws


def counts(modes: int) -> tuple[int, ...]:
    """Numbers of modes 1, 2, 4 … up to ``modes``; ValueError unless that is a power of two from 8 on."""
    if modes < LEAST or modes & (modes - 1):
        raise ValueError(f"--modes: {modes} must be a power of two from {LEAST} on")
    return tuple(2**k for k in range(modes.bit_length()))
