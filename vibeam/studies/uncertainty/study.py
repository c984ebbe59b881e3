"""Uncertainty study (``vibeam uncertainty``): uncertain inputs carried through the sweep of each fidelity."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.run.result import finest_of
from vibeam.studies.uncertainty.multifidelity import Allocation, Estimate, Pilot, allocation, estimate
from vibeam.studies.uncertainty.samples import Coarse, Responses, Sampler, inputs_of
from vibeam.studies.uncertainty.sensitivity import Indices, indices, saltelli
from vibeam.studies.uncertainty.spread import LEVELS, Spread
from vibeam.studies.uncertainty.validation import ErrorRow, error_rows

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.plans import Uncertain

Array = NDArray[np.float64]

Progress = Callable[[str], None]

PILOT = 32  # samples from which correlations and costs are taken

MISSING = 'the case says nothing of what is uncertain: write [uncertain] with, say, "mass.mass" = "± 2 g"'


@dataclass(frozen=True)
class FidelityUncertainty:
    """One fidelity: ``bands`` (5, points) of its amplitude at ``LEVELS``, ``nominal`` (points,); peak, its frequency.

    ``jump``: where period 1 around the peak ends in the way of the sweep, Hz. ``failed`` of ``samples`` have a point
    that failed; ``seconds``: CPU time a sample.
    """

    fidelity: str
    nominal: Array
    bands: Array
    peak: Spread
    peak_frequency: Spread
    jump: Spread
    samples: int
    failed: int
    seconds: float


@dataclass(frozen=True)
class MeanPeak:
    """Mean of the finest fidelity's peak: by that alone, and by several models (``chosen``) with ``counts`` of runs.

    ``correlations`` with the finest, from the pilot. ``saving``: cost of the finest alone over that of the several, at
    equal variance, as measured.
    """

    chosen: Allocation
    counts: tuple[int, ...]
    correlations: Mapping[str, float]
    seconds: Mapping[str, float]
    alone: Estimate
    several: Estimate

    @property
    def saving(self) -> float:
        """(error² · seconds) of the finest alone over that of the several."""
        return self.alone.error**2 * self.alone.seconds / (self.several.error**2 * self.several.seconds)


@dataclass(frozen=True)
class UncertaintyStudy:
    """``rows`` of the fidelities with the same physics, the finest last; indices of its amplitude and its peak."""

    case: Case
    frequency: Array
    rows: tuple[FidelityUncertainty, ...]
    over_frequency: Indices
    of_peak: Indices
    mean_peak: MeanPeak | None
    errors: tuple[ErrorRow, ...]
    samples: int
    seed: int

    @property
    def finest(self) -> FidelityUncertainty:
        """The finest fidelity."""
        return self.rows[-1]

    @property
    def uncertain(self) -> tuple[Uncertain, ...]:
        """The uncertain inputs."""
        return self.case.uncertain


def uncertainty(
    case: Case, tell: Progress = lambda line: None, *, samples: int = 128, seed: int = 0
) -> UncertaintyStudy:
    """Carry the uncertain inputs of a case through its sweep.

    The finest fidelity is run at (2 + d)·``samples`` values of d inputs (Sobol' sequence), each other one of the same
    physics at 2·``samples`` of them. ValueError where nothing is uncertain or ``samples`` is no power of two ≥ 16,
    CaseError for values that the case may not have.
    """
    if not case.uncertain:
        raise ValueError(MISSING)
    if samples < PILOT // 2 or samples & (samples - 1):
        raise ValueError(f"samples: {samples}, must be a power of two, {PILOT // 2} or more")
    from vibeam.run.run import run

    nominal = run(case, show=False, compare=True)
    finest = finest_of(nominal)
    own = case.fidelities
    names = [name for name in nominal if name != finest and own[name].changes == own[finest].changes] + [finest]
    sampler = Sampler(case, tuple(each.key for each in case.uncertain))
    shares = saltelli(len(case.uncertain), samples, seed)
    inputs = inputs_of(case.uncertain, shares)
    found = {}
    for name in names:
        count = len(inputs) if name == finest else 2 * samples
        tell(f"{name}: {count} sweeps")
        found[name] = sampler(name, inputs[:count])
    rows = tuple(_row(sampler.nominal(name), found[name], 2 * samples) for name in names)
    whole = found[finest]
    return UncertaintyStudy(
        case,
        np.sort(case.sweep.frequency),
        rows,
        indices(whole.amplitude.T, len(case.uncertain), seed),
        indices(whole.peak[None], len(case.uncertain), seed),
        _mean_peak(sampler, found, finest, 2 * samples, seed, tell),
        error_rows(nominal, {row.fidelity: row.peak for row in rows}),
        samples,
        seed,
    )


def _row(nominal: Responses, found: Responses, count: int) -> FidelityUncertainty:
    amplitude = found.amplitude[:count]
    bands = np.full((len(LEVELS), amplitude.shape[1]), np.nan)
    known = np.isfinite(amplitude).sum(axis=0) > 1
    bands[:, known] = np.nanquantile(amplitude[:, known], LEVELS, axis=0)

    def spread(of: str) -> Spread:
        return Spread.of(float(getattr(nominal, of)[0]), getattr(found, of)[:count])

    return FidelityUncertainty(
        found.fidelity,
        nominal.amplitude[0],
        bands,
        spread("peak"),
        spread("peak_frequency"),
        spread("jump"),
        count,
        found.failed,
        float(np.mean(found.seconds)),
    )


def _mean_peak(
    sampler: Sampler, found: Mapping[str, Responses], finest: str, count: int, seed: int, tell: Progress
) -> MeanPeak | None:
    """Mean of the finest one's peak, by a quarter of its runs and as many of cheaper models as serve it best.

    Cheaper are the other fidelities, and all but the finest by a coarse sweep: correlations and costs are measured.
    """
    models = {name: _Model(sampler, name, known) for name, known in found.items()}
    first = found[finest].inputs[:PILOT]
    for name in found if len(found) > 1 and sampler.coarse is None else ():
        if name != finest:
            coarse = replace(sampler, coarse=Coarse())
            models[f"{name}, coarse sweep"] = _Model(coarse, name, coarse(name, first))
    order = [finest, *(name for name in models if name != finest)]
    pilot = Pilot(
        {name: models[name].known.peak[:PILOT] for name in order},
        {name: float(np.mean(models[name].known.seconds[:PILOT])) for name in order},
    )
    chosen = allocation(pilot)
    if len(chosen.names) < 2:
        return None
    budget = pilot.seconds[finest] * count  # no model is run for longer than the finest alone
    counts = chosen.counts(max(PILOT, count // 4), [budget / pilot.seconds[name] for name in chosen.names])
    runs = dict(zip(chosen.names, counts, strict=True))
    inputs = _further(sampler, found[finest].inputs[:count], max(counts), seed)
    tell(f"mean of the peak: {', '.join(f'{number} × {name}' for name, number in runs.items())}")
    values = {name: models[name].peaks(inputs[:number]) for name, number in runs.items()}
    seconds = sum(pilot.seconds[name] * number for name, number in runs.items())
    alone = estimate(
        Allocation((finest,), (1.0,), (1.0,), 1.0), {finest: found[finest].peak[:count]},
        pilot.seconds[finest] * count, seed,
    )  # fmt: skip
    correlations = {name: pilot.correlation(name) for name in order[1:]}
    return MeanPeak(chosen, counts, correlations, pilot.seconds, alone, estimate(chosen, values, seconds, seed))


@dataclass(frozen=True)
class _Model:
    """A fidelity by one kind of sweep, and its responses to the first inputs."""

    sampler: Sampler
    fidelity: str
    known: Responses

    def peaks(self, inputs: Array) -> Array:
        """Peaks (m,) at inputs that begin with those known."""
        known = min(len(inputs), len(self.known.inputs))
        known = int(np.argmin(np.append((inputs[:known] == self.known.inputs[:known]).all(axis=1), False)))
        if known == len(inputs):
            return self.known.peak[:known]
        return np.concatenate([self.known.peak[:known], self.sampler(self.fidelity, inputs[known:]).peak])


def _further(sampler: Sampler, inputs: Array, count: int, seed: int) -> Array:
    """``count`` inputs: those given, then independent ones."""
    missing = max(count - len(inputs), 0)
    shares = np.random.default_rng([seed, 1]).random((missing, len(sampler.keys)))
    further = inputs_of(sampler.case.uncertain, shares) if missing else inputs[:0]
    return np.concatenate([inputs, further])[:count]
