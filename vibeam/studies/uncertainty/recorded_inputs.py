"""Uncertain inputs carried through a record: distributions of the motions' numbers, what they hang on.

Every sample is run through the same realisations as the case: what of a number scatters is what the inputs do, not the
noise of the load. A number of a sample is its mean over the seeds, at the first value of the factor.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.case import plan_of_record
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.studies.uncertainty.replicates import replicates
from vibeam.studies.uncertainty.samples import inputs_of
from vibeam.studies.uncertainty.statistics import Distribution, Indices, indices, saltelli
from vibeam.studies.variants import (
    Ensemble,
    Told,
    ensembles,
    plain_finest,
    usual_numbers,
)
from vibeam_models.arrays import Array, ValueRecord

if TYPE_CHECKING:
    from vibeam.case.case import Case


@dataclass(frozen=True)
class UncertainNumber:
    """A number of the finest fidelity's motions over the samples; ``indices`` of each input in its variance."""

    number: AskedNumber
    spread: Distribution
    indices: Indices


@dataclass(frozen=True, eq=False, repr=False)
class RecordUncertainty(ValueRecord):
    """Uncertain inputs of a case under a record: ``rows`` of the finest ``fidelity``'s numbers, over its samples.

    ``failed`` of all ``motions`` did not run to the record's end.
    """

    case: Case
    fidelity: str
    rows: tuple[UncertainNumber, ...]
    samples: int
    replicates: int
    motions: int
    seed: int
    failed: int
    seconds: float
    realisations: int


def record_uncertainty(case: Case, samples: int, seed: int, told: Told | None = None) -> RecordUncertainty:
    """Carry the uncertain inputs of a case through its record.

    The finest fidelity is simulated at (2 + d)·``samples`` values of d inputs (independent scramblings of Sobol'
    points). CaseError for a value that the case may not have.
    """
    finest = plain_finest(case)
    flown = _Samples(case, seed, told)
    count, d = replicates(samples), len(case.uncertain)
    inputs = inputs_of(case.uncertain, saltelli(d, samples, seed)).reshape(-1, d)
    every, seconds = flown.at(finest, inputs, nominal=True)
    found = every[:, :-1].reshape(-1, samples, 2 + d)
    spread = [
        Distribution.of(float(own), each[:, :2].reshape(count, -1))
        for own, each in zip(every[:, -1], found, strict=True)
    ]
    parts = indices(np.moveaxis(found, 0, -1))
    rows = tuple(
        UncertainNumber(each, spread[at], Indices(*(part[:, at : at + 1] for part in (
            parts.first, parts.total, parts.low, parts.high))))
        for at, each in enumerate(flown.asked)
    )  # fmt: skip
    failed, realisations = int(np.count_nonzero(np.isnan(found[0]))), max(len(plan_of_record(case).seeds), 1)
    return RecordUncertainty(case, finest, rows, samples, count, len(inputs), seed, failed, seconds, realisations)


class _Samples:
    """Motions of a case at values of its uncertain inputs, all through the same realisations."""

    def __init__(self, case: Case, seed: int, told: Told | None) -> None:
        self.case, self.seed, self.told = case, seed, told
        self.keys = [each.key for each in case.uncertain]
        self.asked = usual_numbers(case)

    def at(self, fidelity: str, inputs: Array, nominal: bool = False) -> tuple[Array, float]:
        """Numbers (q, m) of a fidelity at inputs (m, d), and the CPU time of a sample, s; ``nominal``: those at the
        case's own values behind them."""
        plan = plan_of_record(self.case)
        own = self.case.alone(fidelity).with_keys({"record.over": plan.over, "record.values": [plan.values[0]]})
        cases = [own.with_keys(dict(zip(self.keys, row, strict=True))) for row in inputs.tolist()] + [own] * nominal
        made: list[Ensemble] = ensembles([(each, fidelity) for each in cases], self.asked, self.told)
        numbers = np.array([[float(np.mean(each.of(asked))) for each in made] for asked in self.asked])
        return numbers, float(np.mean([each.seconds.sum() for each in made]))
