"""Direct integration: the modal equations by scipy's solvers, with an event at every impact."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from vibeam.solvers.integration.coordinates import EXPLICIT, Frame
from vibeam.solvers.integration.impact_events import LONGEST, EventRun, EventSolver
from vibeam.solvers.integration.record_stretches import stretches
from vibeam.solvers.integration.samples import SteppedOutcome
from vibeam.solvers.integration.stepper import NO_MARKS, Watch, cycle, slack
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.record import Record
from vibeam.system.response import Ended
from vibeam.system.state import State
from vibeam_models.arrays import Array
from vibeam_models.laws.mechanics import StopLaw


@dataclass(frozen=True)
class ModalFrame:
    """y = (η, η'): η'' = f = force · level(t) + static − 2ζωη' − ω²η in flight, f − c (c·f)/S at rest on the stop.

    ``level``: sin Ωt, or a record; ``damping``: 2ζω (n,), or (n, n) where it couples the modes; ``law``: R(v).
    """

    stiffness: Array
    damping: Array
    contact: Array
    force: Array
    static: Array
    gap: float
    law: StopLaw
    level: Callable[[float], Any]
    mobility: float
    scale: Array

    @classmethod
    def of(cls, system: ImpactSystem, force: Array, level: Callable[[float], Any]) -> ModalFrame:
        """Frame of a system under the load ``force`` (n,) times ``level`` over time."""
        mobility = system.mobility
        rates = np.where(system.omega > 0, system.omega, 1.0)
        return cls(
            system.omega**2,
            2 * system.zeta * system.omega if system.coupling is None else system.coupling,
            system.contact,
            force,
            system.static,
            system.gap,
            system.contact_law,
            level,
            mobility,
            np.concatenate([np.ones_like(rates), rates]) / np.sqrt(mobility),
        )

    def outward(self, states: Array) -> Array:
        """See ``Frame.outward``."""
        return np.ascontiguousarray(states.T.reshape(-1, 2, len(self.contact)))

    def acceleration(self, t: float, y: Array) -> Array:
        """Acceleration f (n,) without the stop."""
        n = len(self.contact)
        force = self.force * self.level(t) + self.static
        damped = self.damping * y[n:] if self.damping.ndim == 1 else self.damping @ y[n:]
        return np.asarray(force - damped - self.stiffness * y[:n])

    def rate(self, t: float, y: Array) -> Array:
        """See ``Frame.rate``."""
        return np.concatenate((y[len(self.contact) :], self.acceleration(t, y)))

    def rate_at_rest(self, t: float, y: Array) -> Array:
        """See ``Frame.rate_at_rest``."""
        force = self.acceleration(t, y)
        held = force - self.contact * (float(self.contact @ force) / self.mobility)
        return np.concatenate((y[len(self.contact) :], held))

    def excess(self, y: Array) -> Array:
        """See ``Frame.excess``."""
        return np.asarray(self.contact @ y[: len(self.contact)] - self.gap)

    def approach(self, y: Array) -> Array:
        """See ``Frame.approach``."""
        return np.asarray(self.contact @ y[len(self.contact) :])

    def press(self, t: float, y: Array) -> float:
        """See ``Frame.press``."""
        return float(self.contact @ self.acceleration(t, y))

    def touch(self, y: Array) -> Array:
        """See ``Frame.touch``."""
        n = len(self.contact)
        return np.concatenate((y[:n] - self.contact * (self.excess(y) / self.mobility), y[n:]))

    def hold(self, y: Array) -> Array:
        """See ``Frame.hold``."""
        return self._kick(self.touch(y), 0.0)

    def strike(self, y: Array) -> tuple[Frame, Array]:
        """See ``Frame.strike``: η'⁺ = η'⁻ + c p with p = −(1+R) v⁻/S."""
        return self, self._kick(y, self.law.at(float(self.approach(y))))

    def _kick(self, y: Array, restitution: float) -> Array:
        n = len(self.contact)
        impulse = -(1 + restitution) * self.approach(y) / self.mobility
        return np.concatenate((y[:n], y[n:] + self.contact * impulse))


class DirectSolver(EventSolver):
    """Direct integration with impact events: any number of modes, the paper's reference method.

    Options as for ``EventSolver``; method "LSODA" is for systems that fast, damped modes make stiff.
    """

    METHODS = (*EXPLICIT, "LSODA")
    records = True

    def takes(self, system: ImpactSystem) -> None:
        """See ``EventSolver.takes``: accepts R(v) and coupled damping, rejects a yielding stop and a second stop."""
        if system.second_gap is not None or system.contact_law.yields:
            system.require_plain("solver 'direct'")

    def enter(self, drive: Drive, state: State) -> tuple[Frame, Array]:
        """See ``EventSolver.enter``."""
        force = self.system.load * (drive.omega**2 * drive.amplitude)
        frame = ModalFrame.of(self.system, force, lambda t: np.sin(drive.omega * t))
        return frame, np.concatenate([state.displacement, state.velocity])

    def run(
        self,
        drive: Drive | Record,
        state: State,
        start: float,
        end: float,
        watch: Watch | None = None,
        marks: Array = NO_MARKS,
    ) -> SteppedOutcome:
        """See ``Stepper.run``; under a record flights end where the load is not smooth."""
        if isinstance(drive, Drive):
            return super().run(drive, state, start, end, watch, marks)
        parts = stretches(drive, start, end)
        frame = ModalFrame.of(self.system, self.system.load, parts[0].level)
        run = EventRun(
            frame,
            np.concatenate([state.displacement, state.velocity]),
            self.settings,
            cycle(self.system, drive),
            start,
            end,
            watch,
            marks,
        )
        allowed, ended = slack(self.system, state.displacement) + self.settings.atol, Ended.COMPLETE
        run.resting = state.resting
        for part in parts:
            run.frame = replace(frame, level=part.level)
            run.end, run.longest = part.end, min(LONGEST * run.period, part.longest)
            with np.errstate(all="ignore"):
                ended = run.advance(allowed, run.resting)
            if ended is not Ended.COMPLETE:
                break
        return run.outcome(ended)
