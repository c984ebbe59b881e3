"""Uncertainty study (``vibeam uncertainty``): uncertain inputs carried through the sweep of each fidelity."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.fineness import alike, finest
from vibeam.case.source import of_source
from vibeam.runs.parallel import EVERY, heartbeat
from vibeam.studies.uncertainty.replicates import quantiles, replicates
from vibeam.studies.uncertainty.samples import Responses, Sampler, errors_of, inputs_of
from vibeam.studies.uncertainty.statistics import (
    LEVELS,
    Distribution,
    ErrorRow,
    Indices,
    error_rows,
    indices,
    saltelli,
)
from vibeam.system.labelled import ViewedTable
from vibeam.system.progress import telling
from vibeam_models.arrays import Array, Flags, ValueRecord

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.study_plans import Uncertain


Progress = Callable[[str], None]
LEAST = 16  # samples
ERRORS = ("amplitude_error", "end_error")  # numbers beside the finest
MISSING = 'the case says nothing of what is uncertain: write [uncertain] with, say, "mass.mass" = "± 2 g"'


@dataclass(frozen=True)
class FidelityUncertainty:
    """One fidelity: ``bands`` (5, points) of its amplitude at ``LEVELS``, ``nominal`` (points,); peak, its frequency.

    In the way of the sweep, Hz: ``jump``, where period 1 around the peak ends; ``begin``, where impacts begin;
    ``doubling``, where period 1 becomes 2. ``amplitude_error``, and ``end_error`` of ends and kinds, beside the finest;
    ``suffices``: shares of the samples in which it surely and perhaps does. ``failed`` of ``samples`` have a point that
    failed; ``seconds``: CPU time a sample.
    """

    fidelity: str
    nominal: Array
    bands: Array
    peak: Distribution
    peak_frequency: Distribution
    jump: Distribution
    begin: Distribution
    doubling: Distribution
    amplitude_error: Distribution
    end_error: Distribution
    suffices: tuple[float, float]
    samples: int
    failed: int
    seconds: float


@dataclass(frozen=True, eq=False, repr=False)
class UncertaintyStudy(ValueRecord, ViewedTable):
    """``rows`` of the fidelities with the same physics, the finest last; indices of its amplitude and its peak.

    ``samples`` of Sobol' points are made of so many independent ``replicates``.
    """

    case: Case
    frequency: Array
    rows: tuple[FidelityUncertainty, ...]
    over_frequency: Indices
    of_peak: Indices
    errors: tuple[ErrorRow, ...]
    samples: int
    replicates: int
    seed: int

    @property
    def finest(self) -> FidelityUncertainty:
        """The finest fidelity."""
        return self.rows[-1]

    @property
    def uncertain(self) -> tuple[Uncertain, ...]:
        """The uncertain inputs."""
        return self.case.uncertain


@of_source
def uncertainty(
    case: Case, progress: Progress | bool | None = None, *, samples: int | None = None, seed: int | None = None
) -> Any:
    """Carry the uncertain inputs of a case through its sweep: an ``UncertaintyStudy``; of one under a record a
    ``RecordUncertainty``, each sample through the same realisations.

    The finest fidelity is run at (2 + d)·``samples`` values of d inputs (independent scramblings of Sobol' points),
    each other one of the same physics at 2·``samples`` of them; None: as the case asks. ``progress``: True shows it, a
    function is told in lines. ValueError where nothing is uncertain or ``samples`` is no power of two ≥ 16, CaseError
    for values that the case may not have.

    >>> import vibeam
    >>> case = vibeam.load("cases/dtu_neutral.toml", {
    ...     "sweep.frequency.points": 2, "sweep.settle": 5, "uncertain": {"stop.restitution": "± 0.02"},
    ...     "reference": None, "fidelity.beam": None, "fidelity.two_modes": None,
    ... })
    >>> study = vibeam.uncertainty(case, samples=16)
    >>> study.finest.fidelity, study.finest.bands.shape
    ('sdof', (5, 2))
    """
    if not case.uncertain:
        raise ValueError(MISSING)
    plan = case.asked["uncertainty"]
    samples, seed = plan.samples if samples is None else samples, plan.seed if seed is None else seed
    if samples < LEAST or samples & (samples - 1):
        raise ValueError(f"samples: {samples}, must be a power of two, {LEAST} or more")
    with telling(progress, "uncertainty") as told:
        if case.record is not None:
            from vibeam.studies.uncertainty.recorded_inputs import record_uncertainty

            return record_uncertainty(case, samples, seed, lambda done, total: _often(told, done, total))
        return _study(case, told, samples, seed)


def _often(told: Progress, done: int, total: int) -> None:
    """Tell of motions, a few times in all."""
    if done and done % max(total // 3, 20) == 0:
        told(f"{done} of {total} motions")


def _study(case: Case, tell: Progress, samples: int, seed: int) -> UncertaintyStudy:
    from vibeam.runs.run import run

    top = finest(case, {name: case.system(name).size for name in case.fidelities})
    names = [name for name in alike(case, case.fidelities, top) if name != top] + [top]
    sampler = Sampler(case, tuple(each.key for each in case.uncertain))
    count, d = 2 + len(case.uncertain), len(case.uncertain)
    inputs = inputs_of(case.uncertain, saltelli(d, samples, seed)).reshape(-1, d)
    both = np.arange(len(inputs)) % count < 2  # A and B, which are distributed as the inputs are
    asked = {name: both | (name == top) for name in names}
    own_row = {name: sampler.nominal(name) for name in names}
    for name in names:
        sweeps = int(asked[name].sum())
        seconds = sweeps * float(own_row[name].seconds[0])
        tell(f"{name}: {sweeps} sweeps" + (f", at most {seconds:.0f} s of CPU time" if seconds > EVERY else ""))
    found = sampler.each(inputs, asked, tell)
    with heartbeat(tell, lambda: "the case as it is"):
        nominal: Any = run(case, show=False, compare=True)
    for each in nominal.compare():
        if each.reference == top and each.fidelity in own_row:
            errors = np.array([errors_of(each.comparison, nominal.asked)[: len(ERRORS)]]).T
            own_row[each.fidelity] = replace(own_row[each.fidelity], **dict(zip(ERRORS, errors, strict=True)))
    rows = tuple(_row(own_row[name], found[name], both[asked[name]], replicates(samples)) for name in names)
    finest_one = found[top]
    return UncertaintyStudy(
        case,
        np.sort(case.sweep.frequency),
        rows,
        indices(finest_one.amplitude.reshape(samples, count, -1)),
        indices(finest_one.peak.reshape(samples, count, 1)),
        error_rows(nominal, {row.fidelity: row.peak for row in rows}),
        samples,
        replicates(samples),
        seed,
    )


def _row(nominal: Responses, found: Responses, both: Flags, count: int) -> FidelityUncertainty:
    """A fidelity's spreads over the samples ``both``, which are ``count`` replicates."""
    amplitude = found.amplitude[both]
    bands = np.full((len(LEVELS), amplitude.shape[1]), np.nan)
    for place, column in enumerate(amplitude.T):
        if np.isfinite(column).sum() > 1:
            bands[:, place] = quantiles(column[np.isfinite(column)], LEVELS)
    spreads = {
        of: Distribution.of(float(getattr(nominal, of)[0]), getattr(found, of)[both].reshape(count, -1))
        for of in ("peak", "peak_frequency", "jump", "begin", "doubling", *ERRORS)
    }
    surely, perhaps = (float(np.mean(each)) for each in (found.suffices[both] == 1, found.suffices[both] != 0))
    return FidelityUncertainty(
        found.fidelity, nominal.amplitude[0], bands, **spreads, suffices=(surely, perhaps), samples=len(amplitude),
        failed=found.failed, seconds=float(np.mean(found.seconds)),
    )  # fmt: skip
