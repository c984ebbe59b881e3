"""Mean of the finest fidelity's peak from few of its runs and many of cheaper models, and what that saves.

Cheaper models are the other fidelities; all but the finest by a coarse sweep; all of them in closed form, the finest
too, which follows the finest's sweep to round-off where that is on a motion with one impact a period; and a quadratic
surface of the finest's closed form (of its sweep, where it has none). Which of them are used, and how often, follows
from correlations and costs as measured. A structure that was assembled a short while ago is kept: so the cost of each
is taken at inputs of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from vibeam.studies.uncertainty.multifidelity import Allocation, MeanEstimate, Pilot, allocation, estimate
from vibeam.studies.uncertainty.samples import Coarse, Responses, Sampler, inputs_of
from vibeam.studies.uncertainty.surrogates import ClosedFormPeaks, Surface, known, runs
from vibeam_models.arrays import Array

Progress = Callable[[str], None]
PILOT = 32  # samples from which correlations are taken
POINTS = 60  # frequencies of a closed form at least, of a sweep that has as many
MOST = 20_000  # runs of any model
TIMED = 12  # further samples from which costs are taken


@dataclass(frozen=True)
class MeanPeak:
    """Mean of the finest fidelity's peak: by that alone, and by several models (``chosen``) with ``counts`` of runs.

    ``correlations`` with the finest, from the pilot; ``seconds``: CPU time a run, of the pilot. ``saving``: cost of the
    finest alone over that of the several, at equal variance, as measured.
    """

    chosen: Allocation
    counts: tuple[int, ...]
    correlations: Mapping[str, float]
    seconds: Mapping[str, float]
    alone: MeanEstimate
    several: MeanEstimate

    @property
    def saving(self) -> float:
        """(error² · seconds) of the finest alone over that of the several."""
        return self.alone.error**2 * self.alone.seconds / (self.several.error**2 * self.several.seconds)


@dataclass(frozen=True)
class _PeakModel:
    """A fidelity by one kind of solution, its responses to the first inputs, and CPU ``seconds`` of another one."""

    sampler: Callable[[str, Array], Responses]
    fidelity: str
    known: Responses
    seconds: float
    before: float = 0.0  # CPU seconds that it takes once

    def peaks(self, inputs: Array) -> tuple[Array, float]:
        """Peaks (m,) at inputs that begin with those known, and the CPU time that they cost."""
        count = min(len(inputs), len(self.known.inputs))
        same = (inputs[:count] == self.known.inputs[:count]).all(axis=1)
        count = int(np.argmin(np.append(same, False)))
        if count == len(inputs):
            return self.known.peak[:count], count * self.seconds
        further = self.sampler(self.fidelity, inputs[count:])
        seconds = count * self.seconds + float(further.seconds.sum())
        return np.concatenate([self.known.peak[:count], further.peak]), seconds


def mean_of_peak(
    sampler: Sampler, found: Mapping[str, Responses], finest: str, count: int, seed: int, tell: Progress
) -> MeanPeak | None:
    """Mean of the finest one's peak, by a quarter of its runs and as many of cheaper models as serve it best.

    None where no cheaper model saves any.
    """
    models = _models(sampler, found, finest, seed)
    pilot = Pilot(
        {name: each.known.peak[:PILOT] for name, each in models.items()},
        {name: each.seconds for name, each in models.items()},
    )
    chosen = allocation(pilot)
    if len(chosen.names) < 2:
        return None
    budget = pilot.seconds[finest] * count  # no model is run for longer than the finest alone
    most = [min(budget / pilot.seconds[name], MOST) for name in chosen.names]
    counts = chosen.counts(max(PILOT, count // 4), most)
    asked = dict(zip(chosen.names, counts, strict=True))
    inputs = _further(sampler, found[finest].inputs[:count], max(counts), seed)
    tell(f"mean of the peak: {', '.join(f'{number} × {name}' for name, number in asked.items())}")
    several = {name: models[name].peaks(inputs[:number]) for name, number in asked.items()}
    values = {name: peaks for name, (peaks, _) in several.items()}
    seconds = sum(each for _, each in several.values()) + sum(models[name].before for name in several)
    alone = estimate(
        Allocation((finest,), (1.0,), (1.0,), 1.0), {finest: found[finest].peak[:count]},
        pilot.seconds[finest] * count, seed,
    )  # fmt: skip
    correlations = {name: pilot.correlation(name) for name in models if name != finest}
    return MeanPeak(chosen, counts, correlations, pilot.seconds, alone, estimate(chosen, values, seconds, seed))


def _models(sampler: Sampler, found: Mapping[str, Responses], finest: str, seed: int) -> dict[str, _PeakModel]:
    """The finest model, then the cheaper ones, by name."""
    first = found[finest].inputs[:PILOT]
    rng = np.random.default_rng([seed, 2])

    def timed(kind: Callable[[str, Array], Responses], name: str) -> _PeakModel:
        apart = inputs_of(sampler.case.uncertain, rng.random((TIMED, len(sampler.keys))))
        return _PeakModel(kind, name, kind(name, first), float(np.mean(kind(name, apart).seconds)))

    models = {
        name: _PeakModel(sampler, name, found[name], float(np.mean(found[name].seconds)))
        for name in (finest, *(name for name in found if name != finest))
    }
    coarse = replace(sampler, coarse=Coarse())
    models |= {f"{name}, coarse sweep": timed(coarse, name) for name in found if name != finest}
    every = max(len(sampler.case.sweep.frequency) // POINTS, 1)
    closed = ClosedFormPeaks(sampler.case, sampler.keys, every)
    models |= {f"{name}, closed form": timed(closed, name) for name in found if known(sampler.case, name)}
    cheapest = closed if known(sampler.case, finest) else sampler
    drawn = inputs_of(sampler.case.uncertain, rng.random((runs(len(sampler.keys)), len(sampler.keys))))
    surface = Surface.of(cheapest, finest, drawn)
    if surface is not None:
        models[f"{finest}, quadratic surface"] = replace(timed(surface, finest), before=surface.seconds)
    return models


def _further(sampler: Sampler, inputs: Array, count: int, seed: int) -> Array:
    """``count`` inputs: those given, then independent ones."""
    missing = max(count - len(inputs), 0)
    shares = np.random.default_rng([seed, 1]).random((missing, len(sampler.keys)))
    further = inputs_of(sampler.case.uncertain, shares) if missing else inputs[:0]
    return np.concatenate([inputs, further])[:count]
