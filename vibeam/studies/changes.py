"""Changes of numbers from a reference to a variant of it, beside what is allowed.

The response of a sweep is compared as a whole: amplitudes, ends of branches, kinds of motion
(``vibeam.runs.comparison.responses``). Under a record differences are paired over the realisations.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite, nan

import numpy as np

from vibeam.periodic.motion_kind import width
from vibeam.runs.comparison.errors import ResponseComparison
from vibeam.runs.transient.statistics import paired
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.studies.variants import PEAK, Ensemble
from vibeam_models.arrays import Array

#: what the comparison of two sweeps says: both errors, and how wide a range has another kind of motion
COMPARED = AMPLITUDES, ENDS, KINDS = tuple(map(AskedNumber, ("amplitudes", "ends_of_branches", "kinds_of_motion")))


@dataclass(frozen=True)
class NumberChange:
    """Change of a number in another model, as a share of the reference's ``mean``: the worst value of the factor.

    ``error``: standard error of the paired ``change``, NaN of one realisation; NaN throughout where either has none.
    ``allowed``: largest size that is allowed, ∞ of a number that decides nothing.
    """

    number: AskedNumber
    mean: float
    change: float
    error: float
    allowed: float = inf

    @property
    def size(self) -> float:
        """Size of the change, its error counted twice; NaN where it is not known."""
        return abs(self.change) + (2 * self.error if isfinite(self.error) else 0.0)

    @property
    def share(self) -> float:
        """Size over what is allowed; 0 of a number that decides nothing, NaN where it is not known."""
        return self.size / self.allowed if self.allowed < inf else 0.0


def changes(
    reference: Ensemble,
    other: Ensemble,
    found: ResponseComparison | None = None,
    limits: Mapping[AskedNumber, float] | None = None,
) -> tuple[NumberChange, ...]:
    """Changes of all numbers, of a sweep those of its comparison ``found`` first; ``limits``: what is allowed of each.

    Under a record each at the value of the factor at which it is largest.
    """
    made = () if found is None else _of_comparison(found)
    own = (_largest(each, reference, other, found is not None) for each in reference.numbers)
    return tuple(replace(each, allowed=(limits or {}).get(each.number, inf)) for each in (*made, *own))


def _of_comparison(found: ResponseComparison) -> Iterator[NumberChange]:
    """Both errors of a comparison, and the width of the widest difference in kind; 0 without any, ∞ of contact alone.

    Half of what an error is uncertain by stands for its standard error: what it may be at most is counted.
    """
    at, ends = found.scattered, max(found.ends, key=lambda each: abs(each.error) + each.open, default=None)
    none = nan, 0.0, 0.0
    yield NumberChange(AMPLITUDES, *(none if at is None else (at.reference, at.error, at.scatter)))
    yield NumberChange(ENDS, *(none if ends is None else (ends.reference.frequency, ends.error, ends.open / 2)))
    spans = [(0.5 * (each.low + each.high), inf if each.alone else each.width, each.open / 2) for each in found.kinds]
    spans += [(0.5 * (low + high), width(low, high), 0.0) for _, low, high in found.unknown]
    yield NumberChange(KINDS, *max(spans, key=lambda each: each[1] + 2 * each[2], default=none))


def _largest(number: AskedNumber, reference: Ensemble, other: Ensemble, swept: bool) -> NumberChange:
    rows = zip(reference.of(number), other.of(number), strict=True)
    found = [change_of(number, theirs, ours) for theirs, ours in rows]
    if swept and np.isfinite(reference.of(number)).all() != np.isfinite(other.of(number)).all():
        return NumberChange(number, found[0].mean, inf, nan)  # one of the two alone has it
    return max(found, key=lambda each: each.size if each.size == each.size else -1.0)


def change_of(number: AskedNumber, theirs: Array, ours: Array) -> NumberChange:
    """Change of a number from ``theirs`` to ``ours``, (s,) each, on the same realisations; ∞ of one that was 0."""
    known = np.isfinite(theirs) & np.isfinite(ours)
    mean = float(np.mean(theirs[known])) if known.any() else nan
    if mean == 0:
        return NumberChange(number, mean, inf if np.any(ours[known]) else 0.0, nan)
    found = paired(ours, theirs)
    return NumberChange(number, mean, found.mean, found.error)


def worst(found: Sequence[NumberChange], quantity: str = PEAK) -> float:
    """Largest size of the changes of a quantity that are known; NaN without any."""
    sizes = [each.size for each in found if each.number.quantity == quantity]
    return max((each for each in sizes if each == each), default=nan)
