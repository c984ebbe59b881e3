"""Base of the analytical solvers: stationary motions at each frequency; the one nearest to the state is followed."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibeam.solvers.one_mode.oscillator import OneMode, Oscillator
from vibeam.solvers.steady import SteadySolver
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import VELOCITIES_KEPT, Ended, FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Array

NOTHING_FOUND = Ended.NO_ORBIT  # no stable motion of the solver's kind


@dataclass(frozen=True)
class Motion:
    """Stationary motion of an ``Oscillator``, nondimensional.

    ``places`` (m, 2): (q, q̇) at drive phase 0, one for each shift of the motion by whole drive periods.
    ``velocity``: before impact, NaN without; ``mean`` of q and ``square`` of q² + q̇² in time.
    """

    high: float
    low: float
    places: Array
    mean: float
    square: float
    period: int = -1
    impacts_per_period: float = 0.0
    velocity: float = np.nan
    resting: bool = False


def without_impacts(model: Oscillator, omega: float) -> list[Motion]:
    """Motion without impacts, where there is one: free of the stop (|H| ≤ Δ), or at rest on it (Ω²|B| ≤ −Δ)."""
    swing, gap = model.harmonic(omega), model.gap
    if abs(swing) <= gap:
        place = np.array([[swing.imag, omega * swing.real]])
        return [Motion(abs(swing), -abs(swing), place, 0.0, abs(swing) ** 2 * (1 + omega**2) / 2)]
    if omega**2 * abs(model.drive) <= -gap:
        return [Motion(gap, gap, np.array([[gap, 0.0]]), gap, gap**2, period=1, resting=True)]
    return []


def nearest(motions: Sequence[Motion], place: Array) -> tuple[Motion, Array] | None:
    """Motion that passes nearest to ``place`` (q, q̇) at drive phase 0, and its own place; None without motions."""
    passed = [(float(np.hypot(*(at - place))), index, at) for index, m in enumerate(motions) for at in m.places]
    if not passed:
        return None
    _, index, at = min(passed, key=lambda one: one[:2])
    return motions[index], at


class StationarySolver(SteadySolver):
    """Solver by stationary motions: at each frequency the one nearest to the carried state.

    Hysteresis follows: a branch is kept as long as it exists and is stable. ``settle`` is ignored (there is no
    transient), ``hold`` sets only the number of impact velocities. Where no motion is found the point is NaN with
    its reason, and the next one starts from equilibrium. ``strikes_only``: never take a motion without impacts.
    """

    def __init__(self, system: ImpactSystem, strikes_only: bool = False) -> None:
        """Raise ValueError where the system is not one underdamped mode with stiffness."""
        self.mode, self.system, self.strikes_only = OneMode(system), system, strikes_only

    @abstractmethod
    def striking(self, model: Oscillator, omega: float) -> list[Motion]:
        """Stable motions with impacts at Ω."""

    def motions(self, model: Oscillator, omega: float) -> list[Motion]:
        """All stable motions at Ω known to this solver."""
        return self.striking(model, omega) + ([] if self.strikes_only else without_impacts(model, omega))

    def begin(self, state: State | None) -> tuple[Array, bool]:
        """Place of the state, (q, q̇), and whether it rests on the stop."""
        return self.mode.inward(state), False

    def point(
        self, response: FrequencyResponse, index: int, drive: Drive, carried: tuple[Array, bool], settle: int,
        hold: int, output: str,
    ) -> tuple[Array, bool]:  # fmt: skip
        """As ``SteadySolver.point``."""
        response.impacts[index] = response.evaluations[index] = 0
        model = self.mode.oscillator(drive.amplitude)
        found = nearest(self.motions(model, drive.omega / self.mode.omega), carried[0])
        if found is None:
            response.ended[index] = NOTHING_FOUND.code
            return self.begin(None)
        motion, place = found
        self._write(response, index, motion, hold, output)
        return place, motion.resting

    def end(self, carried: tuple[Array, bool]) -> State:
        """As ``SteadySolver.end``."""
        return self.mode.outward(*carried)

    def _write(self, response: FrequencyResponse, i: int, motion: Motion, hold: int, output: str) -> None:
        mode = self.mode
        share = float(self.system.output(output)[0]) / mode.contact
        ends = sorted(share * (extreme + mode.static) for extreme in (motion.low, motion.high))
        response.minimum[i], response.maximum[i] = ends
        response.amplitude[i] = (ends[1] - ends[0]) / 2
        response.reach[i] = self.system.gap - mode.static - motion.low
        response.period[i], response.rest[i] = motion.period, float(motion.resting)
        response.impacts_per_period[i] = motion.impacts_per_period
        response.impact_velocity[i] = motion.velocity * mode.omega
        count = min(VELOCITIES_KEPT, int(hold * motion.impacts_per_period + 1e-9))
        response.impact_velocities[i, VELOCITIES_KEPT - count :] = motion.velocity * mode.omega
        square = motion.square + 2 * mode.static * motion.mean + mode.static**2
        response.mode_energy[i] = square * (mode.omega / mode.contact) ** 2 / 2
        response.ended[i] = Ended.COMPLETE.code
