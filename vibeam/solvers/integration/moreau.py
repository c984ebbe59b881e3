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

import numpy as np

from vibeam.flight.engine.entries import march
from vibeam.flight.kernels import layout
from vibeam.solvers.integration.samples import SampledPiece, SteppedOutcome
from vibeam.solvers.integration.stepper import NO_MARKS, Stepper, Watch, cycle, onto_stop, pause_at, slack
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.record import Record
from vibeam.system.response import Ended
from vibeam.system.state import State
from vibeam_models.arguments import count, number, refuse
from vibeam_models.arrays import Array

EDGE = 1e-9  # tolerance, as a share of a step, for a span to be a whole number of steps


class MoreauSolver(Stepper):
    """Moreau–Jean time stepping: any number of modes, any R, no step control."""

    records = True

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

        ``steps`` a drive period (a motion takes the nearest number above it that fits its span); under a record a
        period of the slowest mode, at least as many in all of the record, none longer than the median of its pieces.
        ``theta`` from ½ (undamped) to 1 (fully implicit). ``repeats``: how far states a period apart may differ, as a
        share of the motion's size; None: 30/steps (impacts hop between steps). Impacts slower than one step's free
        acceleration count as rest. ValueError for others.
        """
        faults: list[str] = []
        self.steps = count("steps", steps, faults, least=8)
        self.theta = number("theta", theta, faults, least=0.5, most=1.0)
        refuse("solver", faults)
        self.system, self.repeats = system, 30 / self.steps if repeats is None else repeats

    def run(
        self,
        drive: Drive | Record,
        state: State,
        start: float,
        end: float,
        watch: Watch | None = None,
        marks: Array = NO_MARKS,
    ) -> SteppedOutcome:
        """See ``Stepper.run``; ``marks`` must be whole periods from ``start``. The returned state is off the stop."""
        system, longest = self.system, self._longest(drive)
        if float(system.contact @ state.displacement) - system.gap > slack(system, state.displacement):
            return SteppedOutcome(Ended.PENETRATED, start, state, 0, 0)
        count = int(np.ceil((end - start) / longest - EDGE))
        pose, h = np.stack([state.displacement, state.velocity]), (end - start) / max(count, 1)
        march_on = _March(self, drive, pose, h, watch)
        for call, first in enumerate(range(0, count, self.steps)):
            pause_at(call)
            march_on.chunk(start, first, min(self.steps, count - first))
        ended = Ended.COMPLETE if np.all(np.isfinite(pose)) else Ended.NOT_FINITE
        return SteppedOutcome(ended, end, State.reached(onto_stop(system, pose[0]), pose[1]), march_on.impacts, count)

    def _longest(self, drive: Drive | Record) -> float:
        """Length of a step at most, s; under a record also the median of its pieces, and a ``steps``-th of it."""
        longest = cycle(self.system, drive) / self.steps
        if isinstance(drive, Drive):
            return longest
        return min(longest, drive.duration / self.steps, float(np.median(np.diff(drive.times))))


class _March:
    """Arrays of one run, and its impacts."""

    def __init__(self, solver: MoreauSolver, drive: Drive | Record, pose: Array, h: float, watch: Watch | None) -> None:
        system, n, most = solver.system, solver.system.size, solver.steps
        self.drive, self.pose, self.h, self.watch, self.impacts = drive, pose, h, watch, 0
        size = drive.omega**2 * drive.amplitude if isinstance(drive, Drive) else 1.0
        self.rows = moreau_rows(system, size, h, solver.theta)
        self.scheme = np.array([h, solver.theta, system.gap, system.restitution])
        kept = most if watch else 0
        self.samples, self.pushed = np.empty((kept + 1 if watch else 0, 2, n)), np.zeros(kept)
        self.strikes, self.totals = np.empty((most, 2)), np.zeros(2, dtype=np.int64)

    def chunk(self, start: float, first: int, count: int) -> None:
        """Advance by steps ``first`` to ``first + count``."""
        times: Array = start + self.h * np.arange(first, first + count + 1, dtype=float)
        if self.watch is not None:
            self.samples[0] = self.pose
        drive = self.drive
        levels = np.sin(drive.omega * times) if isinstance(drive, Drive) else drive.load_at(times)
        march(
            self.rows, self.scheme, levels, self.pose, self.samples, self.pushed,
            self.strikes, self.totals,
        )  # fmt: skip
        self.impacts += int(self.totals[layout.MOREAU_IMPACTS])
        if self.watch is not None:
            self.watch(self._piece(times, count))

    def _piece(self, times: Array, count: int) -> SampledPiece:
        strikes = self.strikes[: self.totals[layout.MOREAU_IMPACTS]]
        struck = times[strikes[:, 0].astype(int)] + self.h
        rest, smooth = float(self.totals[layout.MOREAU_HELD]) * self.h, self.pushed[:count] == 0.0
        return SampledPiece(times, self.samples[: count + 1].copy(), struck, strikes[:, 1].copy(), rest, smooth)


def moreau_rows(system: ImpactSystem, size: float, h: float, theta: float) -> Array:
    """Rows (ROWS, n) of a system for the kernel, its load ``size`` times as large, for steps of ``h`` s."""
    rows = np.zeros((layout.MOREAU_ROWS, system.size))
    stiffness, damping = system.omega**2, 2 * system.zeta * system.omega
    inverse = 1 / (1 + theta * h * damping + (theta * h) ** 2 * stiffness)
    rows[:-1] = stiffness, damping, system.contact, system.load * size, system.static, inverse
    return rows
