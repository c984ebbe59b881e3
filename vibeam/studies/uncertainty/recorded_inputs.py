"""Uncertain inputs carried through a record: distributions of the motions' numbers, what they hang on, a cheaper mean.

Every sample is run through the same realisations as the case: what of a number scatters is what the inputs do, not the
noise of the load. A number of a sample is its mean over the seeds, at the first value of the factor.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.case import plan_of_record
from vibeam.case.fineness import alike
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.studies.uncertainty.mean_of_peak import PILOT, Allocation, MeanPeak, Pilot, allocation, estimate
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

    ``cheaper``: None where no other fidelity saves any. ``failed`` of ``samples`` did not run to the record's end.
    """

    case: Case
    fidelity: str
    rows: tuple[UncertainNumber, ...]
    cheaper: MeanPeak | None
    samples: int
    seed: int
    failed: int
    seconds: float
    realisations: int


def record_uncertainty(case: Case, samples: int, seed: int, told: Told | None = None) -> RecordUncertainty:
    """Carry the uncertain inputs of a case through its record.

    The finest fidelity is flown at (2 + d)·``samples`` values of d inputs (Sobol' sequence), each other one of the same
    rig at as many as its cost allows. CaseError for a value that the case may not have.
    """
    finest = plain_finest(case)
    flown = _Samples(case, seed, told)
    shares = saltelli(len(case.uncertain), samples, seed)
    inputs = inputs_of(case.uncertain, shares)
    flown_all, seconds = flown.at(finest, inputs, nominal=True)
    found, nominal = flown_all[:, :-1], flown_all[:, -1]
    both = found[:, : 2 * samples]
    spread = [Distribution.of(float(own), each) for own, each in zip(nominal, both, strict=True)]
    parts = indices(found, len(case.uncertain), seed)
    rows = tuple(
        UncertainNumber(each, spread[at], Indices(*(part[:, at : at + 1] for part in (
            parts.first, parts.total, parts.low, parts.high))))
        for at, each in enumerate(flown.asked)
    )  # fmt: skip
    cheaper = cheaper_mean(case, flown, finest, inputs[: 2 * samples], both[0], seconds, seed)
    failed = int(np.count_nonzero(np.isnan(found[0])))
    count = max(len(plan_of_record(case).seeds), 1)
    return RecordUncertainty(case, finest, rows, cheaper, found.shape[1], seed, failed, seconds, count)


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


def cheaper_mean(
    case: Case, flown: _Samples, finest: str, inputs: Array, known: Array, seconds: float, seed: int
) -> MeanPeak | None:
    """Mean of the first number by multi-fidelity Monte Carlo; None where no other fidelity saves any.

    ``known`` (m,): the finest's numbers at ``inputs`` (m, d), each of which cost ``seconds``.
    """
    others = [name for name in alike(case, case.fidelities, finest) if name != finest]
    pilots = {name: flown.at(name, inputs[:PILOT]) for name in others}
    values = {finest: known[:PILOT]} | {name: found[0] for name, (found, _) in pilots.items()}
    costs = {finest: seconds} | {name: each for name, (_, each) in pilots.items()}
    pilot = Pilot(values, costs)
    chosen = allocation(pilot)
    if len(chosen.names) < 2:
        return None
    count = len(known)
    most = [seconds * count / costs[name] for name in chosen.names]  # no model is run for longer than the finest alone
    counts = chosen.counts(max(PILOT, count // 4), most)
    drawn = np.random.default_rng([seed, 1]).random((max(max(counts) - len(inputs), 0), inputs.shape[1]))
    further = np.concatenate([inputs, inputs_of(case.uncertain, drawn)]) if len(drawn) else inputs
    several = {finest: known[: counts[0]]}
    for name, number in zip(chosen.names[1:], counts[1:], strict=True):
        start = len(pilots[name][0][0])
        rest = flown.at(name, further[start:number])[0][0] if number > start else np.empty(0)
        several[name] = np.concatenate([pilots[name][0][0], rest])[:number]
    spent = sum(number * costs[name] for name, number in zip(chosen.names, counts, strict=True))
    alone_ = Allocation((finest,), (1.0,), (1.0,), 1.0)
    correlations = {name: pilot.correlation(name) for name in others}
    return MeanPeak(
        chosen, counts, correlations, costs, estimate(alone_, {finest: known}, seconds * count, seed),
        estimate(chosen, several, spent, seed),
    )  # fmt: skip
