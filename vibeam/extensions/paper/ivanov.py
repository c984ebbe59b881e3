"""Ivanov's coordinates (paper eq. 11–15): one mode, impacts without events.

From x, x' of ``zhuravlev`` (x ≥ 0 the distance to the stop, x'' + 2ζωx' + ω²x = N(t), x'⁺ = −R x'⁻ at x = 0) to z, v:

    x = |z|,   x' = sgn z · [1 − k sgn(zv)] v,   k = (1−R)/(1+R).

Before an impact |z| falls, so zv < 0 and |x'⁻| = (1+k)|v|; behind it zv > 0 and |x'⁺| = (1−k)|v|. With v continuous
x'⁺/x'⁻ = −(1−k)/(1+k) = −R: the impact law holds by itself. From z' = x' sgn z and x'' as above

    z' = [1 − k sgn(zv)] v,
    v' = sgn z · (N(t) − ω²|z|)/(1 − k sgn(zv)) − 2ζω v.

Where v passes 0 away from the stop, x' is 0 too, and nothing jumps but the factor in v'. R = 0 means k = 1: the factor
behind the impact is 0 and the map cannot be inverted.

The price: the right-hand side jumps at z = 0 and v = 0, inside the integrator's steps, and step control has to find
every jump by rejected steps. Rest on the stop would be a sliding motion about z = v = 0 that explicit methods follow by
rattling without end. Here a motion that is pressed (N − ω²|z| < 0) and would rise less than ``atol``,
|z| + x'²/2|N − ω²|z|| ≤ atol, is frozen, z' = v' = 0, until the load lifts it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from vibeam.extensions.paper.zhuravlev import Distance
from vibeam.flight.equilibrium import equilibrium
from vibeam.solvers.integration.coordinates import only_one_mode
from vibeam.solvers.integration.impact_events import LONGEST, EvaluationCount, TooManyEvaluations, samples
from vibeam.solvers.integration.samples import SampledPiece, SteppedOutcome
from vibeam.solvers.integration.stepper import NO_MARKS, AdaptiveStepper, Watch, cycle, slack
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended
from vibeam.system.state import State
from vibeam_models.arrays import Array


@dataclass(frozen=True)
class IvanovCoordinates:
    """Coordinates y = (z, v), whose rates are counted."""

    of: Distance
    loss: float
    atol: float
    evaluations: EvaluationCount

    def inward(self, state: State) -> tuple[float, float]:
        """(z, v) on the side z ≥ 0."""
        x, slope = self.of.distance(state)
        return max(x, 0.0), slope / (1 - self.loss * float(np.sign(slope)))

    def rate(self, t: float, y: Array) -> tuple[float, float]:
        """(z', v')."""
        self.evaluations.add(t)
        z, v = y
        factor, push = self._factor(z, v), self._push(t, z)
        if self._at_rest(z, factor * v, push):
            return 0.0, 0.0
        side = 1.0 if z > 0 or (z == 0 and v >= 0) else -1.0
        return factor * v, side * push / factor - self.of.damping * v

    def _factor(self, z: float, v: float) -> float:
        return 1 - self.loss if z * v > 0 else 1 + self.loss if z * v < 0 else 1.0

    def _push(self, t: float, z: float) -> float:
        return self.of.load(t) - self.of.stiffness * abs(z)

    def _at_rest(self, z: float, slope: float, push: float) -> bool:
        return push < 0 and slope * slope <= 2 * push * (abs(z) - self.atol)

    def resting(self, times: Array, states: Array) -> float:
        """Time that samples (m,), (2, m) spend at rest."""
        parts = [(z, self._factor(z, v) * v, self._push(t, z)) for t, z, v in zip(times, *states, strict=True)]
        frozen = np.array([self._at_rest(*part) for part in parts])
        return float(np.sum(np.diff(times)[frozen[1:] & frozen[:-1]]))

    def outward(self, states: Array, side: float) -> tuple[Array, Array]:
        """x and x' (m,) of states (2, m) of one flight on the side ±1."""
        z, v = states
        return side * z, side * (1 - self.loss * side * np.sign(v)) * v


class IvanovSolver(AdaptiveStepper):
    """Integration in Ivanov's coordinates: one mode, 0 < R ≤ 1, no events.

    Options as for ``AdaptiveStepper``; ``limit``: evaluations of the right-hand side in a drive period. Jumps make
    settled runs repeat to some 10 rtol. No "LSODA": a multistep method fails, or never ends, at the jumps. Impacts
    are located at changes of sign between samples, four a step; a run that is stopped ends at its start without a path.
    """

    LIMIT = 20_000
    REPEATS = 30

    def takes(self, system: ImpactSystem) -> None:
        """As ``AdaptiveStepper.takes``: one mode, R > 0."""
        only_one_mode("ivanov", system)
        if system.restitution <= 0:
            raise ValueError("ivanov: restitution 0 makes its coordinates singular: take R > 0, or 'direct'")

    def run(
        self, drive: Drive, state: State, start: float, end: float, watch: Watch | None = None, marks: Array = NO_MARKS
    ) -> SteppedOutcome:
        """See ``Stepper.run``."""
        from scipy.integrate import solve_ivp

        restitution, distance = self.system.restitution, Distance.of(self.system, drive)
        loss, period = (1 - restitution) / (1 + restitution), cycle(self.system, drive)
        evaluations = EvaluationCount(period, self.settings.limit)
        coordinates = IvanovCoordinates(distance, loss, self.settings.atol, evaluations)
        if distance.distance(state)[0] < -slack(self.system, state.displacement) - self.settings.atol:
            return SteppedOutcome(Ended.PENETRATED, start, state, 0, 0)
        if end <= start:
            return SteppedOutcome(Ended.COMPLETE, end, state, 0, 0)
        try:
            with np.errstate(all="ignore"):
                found = solve_ivp(
                    coordinates.rate, (start, end), coordinates.inward(state), method=self.settings.method,
                    rtol=self.settings.rtol, atol=self.settings.atol * distance.scale, max_step=LONGEST * period,
                    dense_output=watch is not None,
                )  # fmt: skip
        except TooManyEvaluations:
            return self._stopped(Ended.EVENT_LIMIT, start, evaluations)
        if found.status < 0 or not np.all(np.isfinite(found.y[:, -1])):
            return self._stopped(Ended.NOT_FINITE, start, evaluations)
        if watch is not None:
            _pass_on(coordinates, found, watch, marks)
        last = distance.modal(*coordinates.outward(found.y[:, -1:], side_of(found.y[:, -1])))[0]
        impacts = int(np.count_nonzero(np.diff(np.signbit(found.y[0]))))
        return SteppedOutcome(Ended.COMPLETE, end, State(last[0], last[1]), impacts, evaluations.all)

    def _stopped(self, ended: Ended, start: float, evaluations: EvaluationCount) -> SteppedOutcome:
        return SteppedOutcome(ended, start, equilibrium(self.system), 0, evaluations.all)


def side_of(y: Array) -> float:
    """Side sgn z; on the stop the side towards which v points."""
    return float(np.sign(y[0]) or np.sign(y[1]) or 1.0)


def _pass_on(coordinates: IvanovCoordinates, found: Any, watch: Watch, marks: Array) -> None:
    """Pass the motion on as flights, cut where z changes sign."""
    times = samples(found.t, marks)
    z = found.sol(times)[0]
    cuts = np.flatnonzero(z[1:] * z[:-1] < 0)
    roots = [_root(lambda t: float(found.sol(t)[0]), times[i], times[i + 1]) for i in cuts]
    edges = [times[0], *roots, times[-1]]
    for i, (first, last) in enumerate(pairwise(edges)):
        inside = times[(times > first) & (times < last)]
        at = np.concatenate([[first], inside, [last]])
        side = side_of(np.array(found.sol((at[0] + at[1]) / 2)))
        states = found.sol(at)
        x, slope = coordinates.outward(states, side)
        struck = i < len(roots)
        speed = -slope[-1:] if struck else NO_MARKS
        when = at[-1:] if struck else NO_MARKS
        watch(SampledPiece(at, coordinates.of.modal(x, slope), when, speed, coordinates.resting(at, states)))


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq

    return float(brentq(function, low, high, xtol=1e-15 * abs(high) + 1e-300, rtol=1e-15))
