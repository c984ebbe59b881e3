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
from vibeam.studies.variants import Told, ensembles, plain_finest, usual_numbers
from vibeam_models.arrays import ValueRecord

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
    """Carry the uncertain inputs of a case through its record, at the first value of its factor.

    The finest fidelity is simulated at (2 + d)·``samples`` values of d inputs (independent scramblings of Sobol'
    points). CaseError for a value that the case may not have.
    """
    finest, asked, plan = plain_finest(case), usual_numbers(case), plan_of_record(case)
    count, keys = replicates(samples), [each.key for each in case.uncertain]
    inputs = inputs_of(case.uncertain, saltelli(len(keys), samples, seed)).reshape(-1, len(keys))
    own = case.alone(finest).with_keys({"record.over": plan.over, "record.values": [plan.values[0]]})
    cases = [*(own.with_keys(dict(zip(keys, row, strict=True))) for row in inputs.tolist()), own]
    made = ensembles([(each, finest) for each in cases], asked, told)
    every = np.array([[float(np.mean(each.of(number))) for each in made] for number in asked])
    found = every[:, :-1].reshape(len(asked), samples, -1)
    rows = tuple(
        UncertainNumber(
            number, Distribution.of(float(nominal), each[:, :2].reshape(count, -1)), indices(each[..., None])
        )
        for number, nominal, each in zip(asked, every[:, -1], found, strict=True)
    )
    failed, seconds = int(np.count_nonzero(np.isnan(found[0]))), float(np.mean([each.seconds.sum() for each in made]))
    realisations = max(len(plan.seeds), 1)
    return RecordUncertainty(case, finest, rows, samples, count, len(inputs), seed, failed, seconds, realisations)
