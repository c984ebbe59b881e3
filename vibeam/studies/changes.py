"""Changes of numbers from a reference to a variant of it, beside what is allowed.

The response of a sweep is compared as a whole: amplitudes, ends of branches, kinds of motion
(``vibeam.runs.comparison.responses``). Under a record differences are paired over the realisations.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import inf, isfinite, nan
from types import MappingProxyType

import numpy as np

from vibeam.periodic.motion_kind import width
from vibeam.runs.comparison.errors import Asked, ResponseComparison
from vibeam.runs.comparison.responses import Response, compared
from vibeam.runs.transient.statistics import paired
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.studies.variants import Ensemble
from vibeam_models.arrays import Array

#: what the comparison of two sweeps says: both errors, and how wide a range has another kind of motion
COMPARED = AMPLITUDES, ENDS, KINDS = tuple(map(AskedNumber, ("amplitudes", "ends_of_branches", "kinds_of_motion")))
PRINCIPAL = ("peak", "hardest_impact")  # quantities by which a model is judged under a record
LEFT_OUT = "left out: "  # begin of the reasons that are not of the model


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


@dataclass(frozen=True)
class ModelVariant:
    """Model of so many ``modes`` beside a reference: ``changes`` of its numbers, ``comparison`` of its sweep.

    ``seconds``: CPU time of its motions; ``why`` it was not made, else empty; ``remarks`` on its numbers.
    """

    changes: tuple[NumberChange, ...] = field(default=(), repr=False)
    comparison: ResponseComparison | None = None
    modes: int = 0
    seconds: float = nan
    why: str = ""
    remarks: tuple[str, ...] = field(default=(), repr=False)

    @property
    def worst(self) -> float:
        """Largest change over what is allowed of it; ∞ where it is not known."""
        return max(
            (each.share for each in self.changes if each.share == each.share and each.allowed < inf), default=inf
        )

    @property
    def left_out(self) -> bool:
        """True where it was left out, and may exist."""
        return self.why.startswith(LEFT_OUT)

    def change(self, number: AskedNumber) -> float:
        """Change of a number; NaN where it is not known."""
        return next((each.change for each in self.changes if each.number == number), nan)


def compared_by(asked: Asked, ours: Response, reference: Response, fine: bool) -> ResponseComparison:
    """Comparison of two sweeps; without ``fine`` ends are bracketed only where that may decide alone."""
    coarse = compared(Response(ours.places), Response(reference.places), asked.frequency)
    known = not fine and coarse.suffices(asked) is False
    return coarse if known else compared(ours, reference, asked.frequency)


def limits_of_record(asked: Asked, numbers: Iterable[AskedNumber]) -> dict[AskedNumber, float]:
    """Limits of the numbers that decide under a record: peaks and the hardest impact, as where it is run."""
    return {each: asked.amplitude for each in numbers if each.quantity in PRINCIPAL}


def limits(asked: Asked) -> dict[AskedNumber, float]:
    """Limits of what the comparison of two sweeps says."""
    return dict(zip(COMPARED, (asked.amplitude, asked.frequency, asked.frequency), strict=True))


def changes(
    reference: Ensemble,
    other: Ensemble,
    found: ResponseComparison | None = None,
    limits: Mapping[AskedNumber, float] = MappingProxyType({}),
) -> tuple[NumberChange, ...]:
    """Changes of all numbers, of a sweep those of its comparison ``found`` first; ``limits``: what is allowed of each.

    Under a record each at the value of the factor at which it is largest.
    """
    made = () if found is None else _of_comparison(found)
    own = (_largest(each, reference, other) for each in reference.numbers)
    return _beside((*made, *own), limits)


def of_comparison(found: ResponseComparison, asked: Asked) -> tuple[NumberChange, ...]:
    """Changes that the comparison of two sweeps says, beside what is ``asked``."""
    return _beside(_of_comparison(found), limits(asked))


def _beside(found: Iterable[NumberChange], limits: Mapping[AskedNumber, float]) -> tuple[NumberChange, ...]:
    return tuple(replace(each, allowed=limits.get(each.number, inf)) for each in found)


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


def _largest(number: AskedNumber, reference: Ensemble, other: Ensemble) -> NumberChange:
    rows = list(zip(reference.of(number), other.of(number), strict=True))
    found = [change_of(number, theirs, ours) for theirs, ours in rows]
    if any(np.isfinite(theirs).any() != np.isfinite(ours).any() for theirs, ours in rows):
        return NumberChange(number, found[0].mean, inf, nan)  # one of the two alone has it: contact, say
    return max(found, key=lambda each: each.size if each.size == each.size else -1.0)


def change_of(number: AskedNumber, theirs: Array, ours: Array) -> NumberChange:
    """Change of a number from ``theirs`` to ``ours``, (s,) each, on the same realisations; ∞ of one that was 0."""
    known = np.isfinite(theirs) & np.isfinite(ours)
    mean = float(np.mean(theirs[known])) if known.any() else nan
    if mean == 0:
        return NumberChange(number, mean, inf if np.any(ours[known]) else 0.0, nan)
    found = paired(ours, theirs)
    return NumberChange(number, mean, found.mean, found.error)
