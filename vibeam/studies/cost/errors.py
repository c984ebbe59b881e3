"""Error measures between two runs: curves, peaks, statistics, impacts and paths."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.studies.cost.measure import AperiodicSample, Measured, Plan
from vibeam.studies.cost.trajectories import APART, distance, matched
from vibeam.system.response import Difference, complete, periodic
from vibeam_models.arrays import Array

QUANTILES = (0.1, 0.5, 0.9)
NONE = float("nan")


@dataclass(frozen=True)
class Errors:
    """Errors against a reference run, relative unless stated; NaN where there is nothing to compare.

    ``amplitude``, ``velocity`` (mean impact velocity) and ``energy``: over the frequencies where both motions are
    periodic. ``statistics``: where neither is, the worst of mean and quantiles of amplitude and impact velocity;
    ``scatter``: that of the reference's first half against its second. ``kind``: frequencies where one repeats and the
    other does not. ``period_one_end`` in Hz. Impact times and ``path`` (Hausdorff, time in drive periods and
    displacement in its size) on a path from the same start, ``missed`` and ``invented`` impacts on it.
    """

    amplitude: Difference = field(default_factory=Difference)
    velocity: float = NONE
    energy: float = NONE
    kind: int = 0
    period_one_end: float = NONE
    statistics: float = NONE
    scatter: float = NONE
    impact_times: float = NONE
    impact_velocities: float = NONE
    missed: int = 0
    invented: int = 0
    path: float = NONE


def errors(found: Measured, truth: Measured, plan: Plan) -> Errors:
    """Compute the errors of ``found`` against ``truth``, both of one plan."""
    one, other = found.response, truth.response
    both, ends = periodic(one) & periodic(other), [each.period_one for each in (one, other)]
    kind = np.count_nonzero(complete(one) & complete(other) & (periodic(one) != periodic(other)))
    return Errors(
        amplitude=one.off(other),
        velocity=_worst(one.impact_velocity, other.impact_velocity, both),
        energy=_worst(one.mode_energy.sum(axis=1), other.mode_energy.sum(axis=1), both),
        kind=int(kind),
        period_one_end=ends[0][1] - ends[1][1] if ends[0] and ends[1] else NONE,
        **_statistics(found, truth),
        **_path(found, truth, plan),
    )


def _worst(values: Array, truth: Array, where: NDArray[np.bool_]) -> float:
    where = where & np.isfinite(values) & np.isfinite(truth) & (truth != 0)
    return float(np.max(np.abs(values[where] / truth[where] - 1))) if where.any() else NONE


def _statistics(found: Measured, truth: Measured) -> dict[str, Any]:
    both = [index for index in truth.clouds if index in found.clouds]
    if not both:
        return {}
    halves = [(_half(truth.clouds[i], 0), _half(truth.clouds[i], 1)) for i in both]
    return {
        "statistics": max(sample_distance(found.clouds[i], truth.clouds[i]) for i in both),
        "scatter": max(sample_distance(first, second) for first, second in halves),
    }


def sample_distance(cloud: AperiodicSample, truth: AperiodicSample) -> float:
    """Worst difference of means and quantiles of two samples, each over the truth's mean; NaN for an empty sample."""
    pairs = ((cloud.amplitude, truth.amplitude), (cloud.velocity, truth.velocity))
    gaps = [np.abs(_shape(ours) - _shape(theirs)) / abs(np.mean(theirs)) for ours, theirs in pairs if len(theirs)]
    return float(np.max(gaps)) if gaps else NONE


def _shape(values: Array) -> Array:
    return np.array([np.mean(values), *np.quantile(values, QUANTILES)]) if len(values) else np.full(4, np.nan)


def _half(cloud: AperiodicSample, which: int) -> AperiodicSample:
    return AperiodicSample(np.array_split(cloud.amplitude, 2)[which], np.array_split(cloud.velocity, 2)[which])


def _path(found: Measured, truth: Measured, plan: Plan) -> dict[str, Any]:
    if found.path is None or truth.path is None:
        return {}
    period = 2 * np.pi / plan.drive.omega
    ours, theirs = found.path, truth.path
    impacts = matched(
        ours.impact_times, ours.impact_velocities, theirs.impact_times, theirs.impact_velocities, APART * period
    )
    size = float(np.ptp(truth.path.at(truth.path.times))) / 2 or plan.size
    fastest = float(np.max(truth.path.impact_velocities, initial=0.0)) or NONE
    return {
        "impact_times": impacts.time / period,
        "impact_velocities": impacts.velocity / fastest,
        "missed": impacts.missed,
        "invented": impacts.invented,
        "path": distance(found.path, truth.path, period, size),
    }
