"""Moreau–Jean time stepping: fixed steps, impacts as impulses within a step; coarse and robust.

With velocities v, w the contact row, u = w·v, and θ-averages (·)_θ = θ(·)_{k+1} + (1−θ)(·)_k, a step is

    v_{k+1} = v_k + h (load Ω²B sin Ωt + static − 2ζω v − ω²η)_θ + w p,      η_{k+1} = η_k + h v_θ,

and where the stop would be reached at mid-step, w·η_k + ½h u_k ≥ gap, Newton's law as a complementarity of velocities

    0 ≤ −p  ⊥  −(u_{k+1} + R u_k) ≥ 0.

The modes are uncoupled, so that v_{k+1} = v_free + M̂⁻¹ w p with M̂ = 1 + 2ζω θh + ω²θ²h², and one contact makes it
p = −max(0, w·v_free + R u_k)/(wᵀM̂⁻¹w). (M. Jean, *The non-smooth contact dynamics method*, Comput. Methods Appl. Mech.
Engrg. 177, 1999; V. Acary, B. Brogliato, *Numerical Methods for Nonsmooth Dynamical Systems*, Springer 2008, ch. 10.)

First order in h once there are impacts; no impact is lost, accumulations end, and rest on the stop
is the same formula. For θ ≥ ½ it is stable at any step, but modes with ωh > 1 are not resolved, and M̂ then makes them
stiffer to the impulse than they are. The contact overshoots the stop by up to h u. At R = 1 a rest keeps bouncing by
one step's acceleration, and half of it shows as flight.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numpy as np
from numba import njit
from numpy.typing import NDArray

from vibeam.flight.pause import pause
from vibeam.solvers.integration.samples import Outcome, Piece
from vibeam.solvers.integration.stepper import NO_MARKS, Stepper, Watch, cycle, onto_stop, slack
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended
from vibeam.system.state import State
from vibeam_models.arguments import count, number, refuse

Array = NDArray[np.float64]

F = TypeVar("F", bound=Callable[..., Any])


# rows (ROWS, n): ω², 2ζω, contact, load Ω²B, static, 1/(1 + 2ζω θh + ω²θ²h²), workspace for the free velocities
STIFFNESS, DAMPING, CONTACT, LOAD, STATIC, INVERSE, FREE = range(7)

ROWS = 7

# scheme (4,): h, θ, gap, R
STEP, THETA, GAP, RESTITUTION = range(4)

# strikes (≥ count, 2): step, contact velocity before; totals (2,): impacts, steps held on the stop
IMPACTS, HELD = range(2)


def _compiled(function: F) -> F:
    return cast(F, njit(cache=True, nogil=True, error_model="numpy")(function))


@_compiled
def march(
    rows: Array, scheme: Array, sines: Array, pose: Array, samples: Array, pushed: Array, strikes: Array,
    totals: NDArray[np.int64],
) -> None:  # fmt: skip
    """Advance ``pose`` (2, n) by len(sines) − 1 steps; ``sines``: sin Ωt at their ends.

    ``samples`` (steps + 1, 2, n) and ``pushed`` (steps,) receive the states and the impulses, unless empty.
    """
    n, h, theta = rows.shape[1], scheme[STEP], scheme[THETA]
    mobility = 0.0
    for k in range(n):
        mobility += rows[CONTACT, k] * rows[CONTACT, k] * rows[INVERSE, k]
    watched = samples.shape[0] > 0
    totals[IMPACTS] = totals[HELD] = 0
    for i in range(sines.shape[0] - 1):
        force = theta * sines[i + 1] + (1.0 - theta) * sines[i]
        excess, before, free = -scheme[GAP], 0.0, 0.0
        for k in range(n):
            x, v = pose[0, k], pose[1, k]
            pull = rows[DAMPING, k] * v + rows[STIFFNESS, k] * (x + h * theta * v)
            rows[FREE, k] = v + h * (rows[LOAD, k] * force + rows[STATIC, k] - pull) * rows[INVERSE, k]
            excess += rows[CONTACT, k] * x
            before += rows[CONTACT, k] * v
            free += rows[CONTACT, k] * rows[FREE, k]
        impulse = 0.0
        if excess + 0.5 * h * before >= 0.0 and free + scheme[RESTITUTION] * before > 0.0:
            impulse = -(free + scheme[RESTITUTION] * before) / mobility
            if before > max(0.0, free - before):
                strikes[totals[IMPACTS], 0], strikes[totals[IMPACTS], 1] = i, before
                totals[IMPACTS] += 1
            else:
                totals[HELD] += 1
        for k in range(n):
            after = rows[FREE, k] + rows[CONTACT, k] * rows[INVERSE, k] * impulse
            pose[0, k] += h * (theta * after + (1.0 - theta) * pose[1, k])
            pose[1, k] = after
            if watched:
                samples[i + 1, 0, k], samples[i + 1, 1, k] = pose[0, k], after
        if watched:
            pushed[i] = impulse


EDGE = 1e-9  # tolerance, as a share of a step, for a span to be a whole number of steps


class MoreauSolver(Stepper):
    """Moreau–Jean time stepping: any number of modes, any R, no step control."""

    def __init__(
        self,
        system: ImpactSystem,
        slowest: float,
        span: float = 0.0,
        *,
        steps: int = 1000,
        theta: float = 0.5,
        repeats: float | None = None,
    ) -> None:
        """``slowest`` and ``span`` are ignored.

        ``steps`` a drive period (a motion takes the nearest number above it that fits its span); ``theta`` from ½
        (undamped) to 1 (fully implicit). ``repeats``: how far states a period apart may differ, as a share of the
        motion's size; None: 30/steps (impacts hop between steps). Impacts slower than one step's free acceleration
        count as rest. ValueError for others.
        """
        faults: list[str] = []
        self.steps = count("steps", steps, faults, least=8)
        self.theta = number("theta", theta, faults, least=0.5, most=1.0)
        refuse("solver", faults)
        self.system, self.repeats = system, 30 / self.steps if repeats is None else repeats

    def run(
        self, drive: Drive, state: State, start: float, end: float, watch: Watch | None = None, marks: Array = NO_MARKS
    ) -> Outcome:
        """See ``Stepper.run``; ``marks`` must be whole periods from ``start``. The returned state is off the stop."""
        system, longest = self.system, cycle(self.system, drive) / self.steps
        if float(system.contact @ state.displacement) - system.gap > slack(system, state.displacement):
            return Outcome(Ended.PENETRATED, start, state, 0, 0)
        count = int(np.ceil((end - start) / longest - EDGE))
        pose, h = np.stack([state.displacement, state.velocity]), (end - start) / max(count, 1)
        march_on = _March(self, drive, pose, h, watch)
        for first in range(0, count, self.steps):
            pause()
            march_on.chunk(start, first, min(self.steps, count - first))
        ended = Ended.COMPLETE if np.all(np.isfinite(pose)) else Ended.NOT_FINITE
        return Outcome(ended, end, State.reached(onto_stop(system, pose[0]), pose[1]), march_on.impacts, count)


class _March:
    """Arrays of one run, and its impacts."""

    def __init__(self, solver: MoreauSolver, drive: Drive, pose: Array, h: float, watch: Watch | None) -> None:
        system, n, most = solver.system, solver.system.size, solver.steps
        self.drive, self.pose, self.h, self.watch, self.impacts = drive, pose, h, watch, 0
        self.rows = moreau_rows(system, drive, h, solver.theta)
        self.scheme = np.array([h, solver.theta, system.gap, system.restitution])
        kept = most if watch else 0
        self.samples, self.pushed = np.empty((kept + 1 if watch else 0, 2, n)), np.zeros(kept)
        self.strikes, self.totals = np.empty((most, 2)), np.zeros(2, dtype=np.int64)

    def chunk(self, start: float, first: int, count: int) -> None:
        """Advance by steps ``first`` to ``first + count``."""
        times: Array = start + self.h * np.arange(first, first + count + 1, dtype=float)
        if self.watch is not None:
            self.samples[0] = self.pose
        march(
            self.rows, self.scheme, np.sin(self.drive.omega * times), self.pose, self.samples, self.pushed,
            self.strikes, self.totals,
        )  # fmt: skip
        self.impacts += int(self.totals[IMPACTS])
        if self.watch is not None:
            self.watch(self._piece(times, count))

    def _piece(self, times: Array, count: int) -> Piece:
        strikes = self.strikes[: self.totals[IMPACTS]]
        struck = times[strikes[:, 0].astype(int)] + self.h
        rest, smooth = float(self.totals[HELD]) * self.h, self.pushed[:count] == 0.0
        return Piece(times, self.samples[: count + 1].copy(), struck, strikes[:, 1].copy(), rest, smooth)


def moreau_rows(system: ImpactSystem, drive: Drive, h: float, theta: float) -> Array:
    """Rows (ROWS, n) of a system for the kernel, for steps of ``h`` s."""
    rows = np.zeros((ROWS, system.size))
    stiffness, damping = system.omega**2, 2 * system.zeta * system.omega
    inverse = 1 / (1 + theta * h * damping + (theta * h) ** 2 * stiffness)
    load = system.load * (drive.omega**2 * drive.amplitude)
    rows[:-1] = stiffness, damping, system.contact, load, system.static, inverse
    return rows
