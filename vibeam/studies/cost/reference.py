"""Reference of a cost study: the finest fidelity by the exact flight solver, bounded by a second solver."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from vibeam.exchange.curves.record import SAME_FREQUENCY
from vibeam.flight.engine.threads import Clock, OutOfTime
from vibeam.studies.cost.errors import Errors, errors
from vibeam.studies.cost.measure import Measured, Plan, measure
from vibeam.studies.cost.settings import Setting
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case


FLIGHT, ORBIT = Setting("flight"), Setting("orbit")
STRICT = 1e-12
MOST = 12  # largest number of modes for strict integration
WINDOW = 3  # drive periods of strict integration


@dataclass(frozen=True)
class Bound:
    """Bound on the reference's error: relative difference of two independent solvers from flight.

    ``amplitude``, ``velocity``: the closed-form orbits, at the ``points`` of ``total`` frequencies with one impact a
    period. ``path``, ``impacts``: integration by DOP853 at 1e-12 over three periods, of displacement (Hausdorff) and
    impact velocity. NaN where a comparison is impossible; ``note`` gives the reason.
    """

    amplitude: float
    velocity: float
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
    system: ImpactSystem, exact: Measured, plan: Plan, clock: Clock = lambda: 0.0, budget: float = np.inf
) -> Bound:
    """Compute both comparisons with ``exact``, integrating for ``budget`` seconds of the ``clock`` at most."""
    by_orbit, refusal = _closed_form(system, exact, plan)
    by_steps, failure = _integrated(system, plan, clock, budget)
    return Bound(
        abs(by_orbit.amplitude.worst), by_orbit.velocity, by_orbit.amplitude.points, by_orbit.amplitude.total,
        by_steps.path,
        by_steps.impact_velocities, "; ".join(filter(None, [refusal, failure])),
    )  # fmt: skip


def _closed_form(system: ImpactSystem, exact: Measured, plan: Plan) -> tuple[Errors, str]:
    """Distance to the closed-form orbits, or the reason why there are none."""
    if system.beyond_plain:
        return Errors(), f"no closed-form orbits with {' or '.join(system.beyond_plain)}"
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


def _integrated(system: ImpactSystem, plan: Plan, clock: Clock, budget: float) -> tuple[Errors, str]:
    if system.size > MOST:
        return Errors(), f"{system.size} modes are too many to integrate at {STRICT:.0e}"
    short = replace(plan.at(0), settle=0, hold=1, cloud=0, window=WINDOW)
    options = {"method": "DOP853", "rtol": STRICT, "atol": STRICT * 1e-2 * plan.size}
    try:
        strict = measure(system, Setting("direct", options=options), short, clock, clock() + budget)
    except ValueError as refusal:
        return Errors(), f"no integration: {refusal}"
    except OutOfTime:
        return Errors(), f"integration at {STRICT:.0e} takes more than {budget:.2g} s"
    return errors(strict, measure(system, FLIGHT, short), short), strict.failure
