"""Error measures between two runs: curves, peaks, statistics, impacts and paths."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.studies.cost.measure import AperiodicSample, Measured, Plan
from vibeam.studies.cost.trajectories import APART, distance, matched
from vibeam.system.response import FrequencyResponse, complete, period_one_range, periodic

Array = NDArray[np.float64]

QUANTILES = (0.1, 0.5, 0.9)

NONE = float("nan")


@dataclass(frozen=True)
class Errors:
    """Errors against a reference run, relative unless stated; NaN where there is nothing to compare.

    ``amplitude_*``, ``velocity`` (mean impact velocity) and ``energy``: over the ``points`` of ``total`` frequencies
    where both motions are periodic. ``statistics``: where neither is, the worst of mean and quantiles of amplitude and
    impact velocity; ``scatter``: that of the reference's first half against its second. ``kind``: frequencies where one
    repeats and the other does not. Peaks are those of the parabola through the three highest points; ``period_one_end``
    in Hz. Impact times and ``path`` (Hausdorff, time in drive periods and displacement in its size) on a path from
    the same start, ``missed`` and ``invented`` impacts on it.
    """

    amplitude_max: float = NONE
    amplitude_rms: float = NONE
    amplitude_mean: float = NONE  #: signed
    velocity: float = NONE
    energy: float = NONE
    points: int = 0
    total: int = 0
    kind: int = 0
    peak_height: float = NONE
    peak_frequency: float = NONE
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
    off = relative(one.amplitude, other.amplitude, common(one, other))
    kind = np.count_nonzero(complete(one) & complete(other) & (periodic(one) != periodic(other)))
    return Errors(
        amplitude_max=float(np.max(np.abs(off), initial=-np.inf)) if len(off) else NONE,
        amplitude_rms=float(np.sqrt(np.mean(off**2))) if len(off) else NONE,
        amplitude_mean=float(np.mean(off)) if len(off) else NONE,
        velocity=_worst(one.impact_velocity, other.impact_velocity, common(one, other)),
        energy=_worst(one.mode_energy.sum(axis=1), other.mode_energy.sum(axis=1), common(one, other)),
        points=len(off),
        total=len(other),
        kind=int(kind),
        **_peaks(one, other),
        **_statistics(found, truth),
        **_path(found, truth, plan),
    )


def common(one: FrequencyResponse, other: FrequencyResponse) -> NDArray[np.bool_]:
    """Mask (points,) where both motions are periodic and the second moves."""
    return np.asarray(periodic(one) & periodic(other) & (other.amplitude > 0))


def relative(values: Array, truth: Array, where: NDArray[np.bool_]) -> Array:
    """Signed relative differences at the selected points."""
    return np.asarray(values[where] / truth[where] - 1)


def _worst(values: Array, truth: Array, where: NDArray[np.bool_]) -> float:
    where = where & np.isfinite(values) & np.isfinite(truth) & (truth != 0)
    return float(np.max(np.abs(relative(values, truth, where)))) if where.any() else NONE


def _peaks(one: FrequencyResponse, other: FrequencyResponse) -> dict[str, Any]:
    """Peaks of two runs; compared only where the run has all the points of the reference."""
    ends = [period_one_range(each) for each in (one, other)]
    end = ends[0][1] - ends[1][1] if ends[0] and ends[1] else NONE
    if np.any(periodic(other) & ~complete(one)):
        return {"period_one_end": end}
    (f, a), (true_f, true_a) = peak(one), peak(other)
    return {"peak_frequency": f / true_f - 1, "peak_height": a / true_a - 1, "period_one_end": end}


def peak(response: FrequencyResponse) -> tuple[float, float]:
    """Frequency (Hz) and height of the top of the parabola through the highest periodic point and its neighbours."""
    fine = periodic(response)
    if not fine.any():
        return NONE, NONE
    heights = np.where(fine, response.amplitude, -np.inf)
    top = int(np.argmax(heights))
    f, a = response.frequency, response.amplitude
    near = slice(top - 1, top + 2)
    if not 0 < top < len(f) - 1 or not np.all(fine[near]):
        return float(f[top]), float(a[top])
    curve = np.polyfit(f[near] - f[top], a[near], 2)
    if curve[0] >= 0:
        return float(f[top]), float(a[top])
    shift = float(np.clip(-curve[1] / (2 * curve[0]), f[top - 1] - f[top], f[top + 1] - f[top]))
    return float(f[top]) + shift, float(np.polyval(curve, shift))


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
