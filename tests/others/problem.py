"""A problem of others with a printed number: theirs to the digit, ours, and on how many digits both agree.

A row that could not fail proves nothing: ``test_problems.py`` spoils every model by thirty times what its row lets
pass, through ``spoiled``, by which ``systems.py`` and the rows multiply frequencies, stiffnesses and constant forces.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

EXACT = 1e-12  # round-off
TABLE: list[Problem] = []
_factor = 1.0


def spoiled() -> float:
    """Factor of what decides a model's number: 1, unless a test makes the model wrong."""
    return _factor


@contextmanager
def spoiling(factor: float) -> Any:
    """Context in which every model is wrong by a factor."""
    global _factor
    before, _factor = _factor, factor
    try:
        yield
    finally:
        _factor = before


@dataclass(frozen=True)
class Problem:
    """Row of the book: what ``source`` prints for a ``quantity`` of a ``problem``, and ``ours``.

    ``theirs``: numbers as printed, so that their digits count; ``method``: how they were found there; ``adds``: what
    ours has beyond it (an error bound, a certificate, no time step). ``within``: the largest relative difference from
    theirs that passes, and ``why`` it is not round-off; ``of_largest``: relative to the largest of the row's numbers,
    where some are small by chance. Where theirs is off, ``right`` is the value that holds, ``reason`` says from where
    it is known and why theirs is off, and ours is held to ``right`` instead. ``formula``: what a source prints that
    prints no number; theirs are then its values at the row's parameters, and the row is none of the book's count.
    ``where``: the case or function that computes ours. ``slow``: not in the gate.
    """

    problem: str
    quantity: str
    source: str
    theirs: tuple[str, ...]
    ours: Callable[[], ArrayLike]
    within: float
    why: str
    method: str
    adds: str
    where: str
    right: ArrayLike | None = None
    reason: str = ""
    slow: bool = False
    of_largest: bool = False
    formula: str = ""

    def __post_init__(self) -> None:
        if (self.right is None) != (not self.reason):
            raise ValueError(f"{self.problem}, {self.quantity}: a right value and its reason go together")
        TABLE.append(self)

    @property
    def expected(self) -> np.ndarray:
        """The numbers that ours is held to."""
        return np.asarray(self.right if self.right is not None else [float(each) for each in self.theirs], dtype=float)

    def found(self) -> np.ndarray:
        """Our numbers, in the order of theirs."""
        return np.atleast_1d(np.asarray(self.ours(), dtype=float)).ravel()

    def check(self) -> np.ndarray:
        """Our numbers; AssertionError where one is not within what the row lets pass."""
        found = self.found()
        self.hold(found, self.expected.ravel(), self.within)
        return found

    def hold(self, found: np.ndarray, expected: np.ndarray, within: float) -> None:
        """AssertionError where numbers are further than ``within`` from what is expected of this row."""
        said = f"{self.problem}, {self.quantity}: {self.source}"
        largest = within * np.abs(expected).max() if self.of_largest else 0.0
        np.testing.assert_allclose(found, expected, rtol=0.0 if largest else within, atol=largest, err_msg=said)


def digits(printed: str) -> int:
    """Significant digits of a number as printed; a whole number's trailing zeros count."""
    mantissa = printed.lower().lstrip("+-").split("e")[0].replace(".", "").lstrip("0")
    return len(mantissa) or 1


def agreed(printed: str, found: float) -> int:
    """Digits of the printed number on which ours agrees: it lies within half a unit of the last of them."""
    said, count = float(printed), digits(printed)
    if said == 0:
        return count if found == 0 else 0
    unit = 10.0 ** (np.floor(np.log10(abs(said))) + 1)
    off = abs(found - said) * (1 - 1e-9)
    return next((n for n in range(count, 0, -1) if off <= 0.5 * unit / 10.0**n), 0)
