"""Reference of a cost study, bounded by a second solver, and the errors of a run against it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from vibeam.case.case import Case
from vibeam.exchange.curves.record import SAME_FREQUENCY
from vibeam.flight.engine.threads import Clock, OutOfTime
from vibeam.studies.cost.measure import AperiodicSample, Measurement, Plan, Setting, measure
from vibeam.studies.cost.trajectories import APART, distance, velocity_error
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import Difference, FrequencyResponse, complete, periodic
from vibeam_models.arrays import Array

QUANTILES = (0.1, 0.5, 0.9)
NONE = float("nan")


@dataclass(frozen=True)
class RunErrors:
    """Errors against a reference run, relative unless stated; NaN where there is nothing to compare.

    ``amplitude``: over the frequencies where both motions are periodic. ``statistics``: where neither is, the worst of
    mean and quantiles of amplitude and impact velocity; ``scatter``: that of the reference's first half against its
    second. ``kind``: frequencies where one repeats and the other does not. ``path`` (Hausdorff, time in drive periods
    and displacement in its size) and ``impact_velocities`` on a path from the same start.
    """

    amplitude: Difference = field(default_factory=Difference)
    kind: int = 0
    statistics: float = NONE
    scatter: float = NONE
    impact_velocities: float = NONE
    path: float = NONE


def errors(found: Measurement, truth: Measurement, plan: Plan) -> RunErrors:
    """Compute the errors of ``found`` against ``truth``, both of one plan."""
    one, other = found.response, truth.response
    kind = np.count_nonzero(complete(one) & complete(other) & (periodic(one) != periodic(other)))
    return RunErrors(
        amplitude=one.off(other),
        kind=int(kind),
        **_statistics(found, truth),
        **_path(found, truth, plan),
    )


def _statistics(found: Measurement, truth: Measurement) -> dict[str, Any]:
    both = [index for index in truth.clouds if index in found.clouds]
    if not both:
        return {}
    halves = [(_half(truth.clouds[i], 0), _half(truth.clouds[i], 1)) for i in both]
    return {
        "statistics": max(sample_distance(found.clouds[i], truth.clouds[i]) for i in both),
        "scatter": max(sample_distance(first, second) for first, second in halves),
    }


def sample_distance(cloud: AperiodicSample, truth: AperiodicSample) -> float:
    """Worst difference of means and quantiles of two samples, each over the truth's mean; NaN for one empty or 0."""
    pairs = ((cloud.amplitude, truth.amplitude), (cloud.velocity, truth.velocity))
    gaps = [np.abs(_shape(ours) - _shape(theirs)) / abs(np.mean(theirs)) for ours, theirs in pairs if np.any(theirs)]
    return float(np.max(gaps)) if gaps else NONE


def _shape(values: Array) -> Array:
    return np.array([np.mean(values), *np.quantile(values, QUANTILES)]) if len(values) else np.full(4, np.nan)


def _half(cloud: AperiodicSample, which: int) -> AperiodicSample:
    return AperiodicSample(np.array_split(cloud.amplitude, 2)[which], np.array_split(cloud.velocity, 2)[which])


def _path(found: Measurement, truth: Measurement, plan: Plan) -> dict[str, Any]:
    if found.path is None or truth.path is None:
        return {}
    period = 2 * np.pi / plan.drive.omega
    ours, theirs = found.path, truth.path
    velocity = velocity_error(
        ours.impact_times, ours.impact_velocities, theirs.impact_times, theirs.impact_velocities, APART * period
    )
    size = float(np.ptp(truth.path.at(truth.path.times))) / 2 or plan.size
    fastest = float(np.max(truth.path.impact_velocities, initial=0.0)) or NONE
    return {
        "impact_velocities": velocity / fastest,
        "path": distance(found.path, truth.path, period, size),
    }


FLIGHT, ORBIT = Setting("flight"), Setting("orbit")
STRICT = 1e-12
MOST = 12  # largest number of modes for strict integration
WINDOW = 3  # drive periods of strict integration


@dataclass(frozen=True)
class Bound:
    """Bound on the reference's error: relative difference of two independent solvers from flight.

    ``amplitude``: the closed-form orbits, at the ``points`` of ``total`` frequencies with one impact a
    period. ``path``, ``impacts``: integration by DOP853 at 1e-12 over three periods, of displacement (Hausdorff) and
    impact velocity. NaN where a comparison is impossible; ``note`` gives the reason.
    """

    amplitude: float
    points: int
    total: int
    path: float
    impacts: float
    note: str = ""

    @property
    def value(self) -> float:
        """Stated bound: of amplitudes where available, else of paths."""
        return self.amplitude if np.isfinite(self.amplitude) else self.path

    @property
    def sentence(self) -> str:
        """Bound as a sentence."""
        sentences = []
        if self.points:
            agreed = f"flight and closed-form orbits agree to {self.amplitude:.1e} in amplitude"
            sentences.append(f"{agreed} at {self.points} of {self.total} frequencies")
        if np.isfinite(self.impacts):
            sentences.append(
                f"flight and DOP853 at 1e-12 to {self.impacts:.1e} in impact velocity over {WINDOW} periods"
            )
        return "; ".join([*sentences, *filter(None, [self.note])])


def bound(
    system: ImpactSystem, exact: Measurement, plan: Plan, clock: Clock = lambda: 0.0, budget: float = np.inf
) -> Bound:
    """Compute both comparisons with ``exact``, integrating for ``budget`` seconds of the ``clock`` at most."""
    by_orbit, refusal = _closed_form(system, exact, plan)
    by_steps, failure = _integrated(system, plan, clock, budget)
    return Bound(
        abs(by_orbit.amplitude.worst), by_orbit.amplitude.points, by_orbit.amplitude.total, by_steps.path,
        by_steps.impact_velocities, "; ".join(filter(None, [refusal, failure])),
    )  # fmt: skip


def _closed_form(system: ImpactSystem, exact: Measurement, plan: Plan) -> tuple[RunErrors, str]:
    """Distance to the closed-form orbits, or the reason why there are none."""
    if system.beyond_plain:
        return RunErrors(), f"no closed-form orbits with {' or '.join(system.beyond_plain)}"
    alone = _single_impacts(exact.response)
    return errors(measure(system, ORBIT, replace(plan, window=0)), replace(exact, response=alone), plan), ""


def given(case: Case, frequency: Array) -> FrequencyResponse:
    """Curve of the case's reference file at ``frequency`` (Hz); ValueError for a missing point."""
    points = curve(case)
    response = FrequencyResponse.empty(frequency, 1)
    for index, each in enumerate(frequency):
        near = [value for f, value in points.items() if abs(f - each) <= SAME_FREQUENCY * each]
        if not near:
            raise ValueError(f"cost.frequency: {each:g} Hz is no point of reference {case.cost.reference!r}")
        response.amplitude[index], response.period[index] = near[0]
    response.ended[:], response.impacts_per_period[:] = 0, 1.0
    return response


def curve(case: Case) -> dict[float, tuple[float, int]]:
    """Amplitude and period (1 where not given) over frequency (Hz) of the case's reference file, first branch."""
    points = case.references[case.cost.reference or ""].points()
    direction = points[0].direction if points else "up"
    given_points = [point for point in points if point.direction == direction and point.value is not None]
    return {p.frequency: (p.value or 0.0, 1 if p.period is None else p.period) for p in given_points}


def _single_impacts(response: FrequencyResponse) -> FrequencyResponse:
    """Response with all but its simplest motions marked as aperiodic: an orbit solver knows no others."""
    simple = (response.period == -1) | ((response.period == 1) & (response.impacts_per_period <= 1))
    return replace(response, period=np.where(simple, response.period, 0))


def _integrated(system: ImpactSystem, plan: Plan, clock: Clock, budget: float) -> tuple[RunErrors, str]:
    if system.size > MOST:
        return RunErrors(), f"{system.size} modes are too many to integrate at {STRICT:.0e}"
    short = replace(plan.at(0), settle=0, hold=1, cloud=0, window=WINDOW)
    options = {"method": "DOP853", "rtol": STRICT, "atol": STRICT * 1e-2 * plan.size}
    try:
        strict = measure(system, Setting("direct", options=options), short, clock, clock() + budget)
    except ValueError as refusal:
        return RunErrors(), f"no integration: {refusal}"
    except OutOfTime:
        return RunErrors(), f"integration at {STRICT:.0e} takes more than {budget:.2g} s"
    return errors(strict, measure(system, FLIGHT, short), short), strict.failure
