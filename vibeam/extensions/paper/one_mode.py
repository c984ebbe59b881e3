"""One mode in the paper's variables, q̈ + 2βq̇ + q = Ω²B sin Ωt under a stop at Δ, and solvers of its stationary motions.

One mode η'' + 2ζω η' + ω² η = load Ω̃²b sin Ω̃t̃ + static with the stop at cη = gap becomes, for the contact's distance
q = cη − u_s from its static place u_s = c·static/ω² and the time t = ωt̃,

    q̈ + 2βq̇ + q = Ω²B sin Ωt for q < Δ, q̇⁺ = −R q̇⁻ at q = Δ      (paper §2)

with β = ζ, Ω = Ω̃/ω, B = c·load·b, Δ = gap − u_s. The equation is homogeneous in q, B and Δ, so its unit of length is
free: it stays the metre, and only times and velocities are scaled. Nothing is approximated.

Of the stationary motions at each frequency the one nearest to the state is followed.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibeam.flight.equilibrium import equilibrium
from vibeam.flight.event_driven import modal_values
from vibeam.solvers.steady import SteadySolver
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import VELOCITIES_KEPT, Ended, FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arguments import refuse
from vibeam_models.arrays import Array

HIGHEST = 16  # longest period in a response, in drive periods


@dataclass(frozen=True)
class Oscillator:
    """β ``damping``, B ``drive``, Δ ``gap``, R ``restitution`` (paper §2); B and Δ in any one unit of length.

    ValueError names every number that is out of range: β in [0, 1), R in [0, 1], all finite.
    """

    damping: float
    drive: float
    gap: float = 0.0
    restitution: float = 1.0

    def __post_init__(self) -> None:
        faults = [] if 0 <= self.damping < 1 else [f"damping {self.damping} is outside [0, 1): it must be underdamped"]
        faults += [] if np.isfinite(self.drive) else [f"drive {self.drive} is not finite"]
        faults += [] if np.isfinite(self.gap) else [f"gap {self.gap} is not finite"]
        faults += [] if 0 <= self.restitution <= 1 else [f"restitution {self.restitution} is outside [0, 1]"]
        refuse("", faults)

    @property
    def damped(self) -> float:
        """ω_D = √(1 − β²)."""
        return float(np.sqrt(1 - self.damping**2))

    def force(self, omega: float, time: float) -> float:
        """Forcing F(t) = Ω²B sin Ωt."""
        return float(omega**2 * self.drive * np.sin(omega * time))

    def harmonic(self, omega: float) -> complex:
        """Phasor H of the motion Im(H e^{iΩt}) without the stop; infinite at an undamped resonance."""
        below = complex(1 - omega**2, 2 * self.damping * omega)
        return omega**2 * self.drive / below if below else complex(np.inf)


@dataclass(frozen=True)
class OneMode:
    """System of one underdamped mode and its conversion to the analytical methods' variables."""

    system: ImpactSystem

    def __post_init__(self) -> None:
        refuse("", one_mode_faults(self.system))

    @property
    def omega(self) -> float:
        """Frequency ω, rad/s: the unit of frequency."""
        return float(self.system.omega[0])

    @property
    def contact(self) -> float:
        """Contact value c of the mode."""
        return float(self.system.contact[0])

    @property
    def static(self) -> float:
        """Static contact displacement u_s without the stop, m."""
        return self.contact * float(self.system.static[0]) / self.omega**2

    def oscillator(self, amplitude: float) -> Oscillator:
        """Oscillator under base motion of ``amplitude`` m."""
        own = self.system
        drive = self.contact * float(own.load[0]) * amplitude
        return Oscillator(float(own.zeta[0]), drive, own.gap - self.static, own.restitution)

    def inward(self, state: State | None) -> Array:
        """(q, q̇) of a state; None: equilibrium. ValueError where it is not one finite number each."""
        both = modal_values(self.system, equilibrium(self.system) if state is None else state)
        place, speed = self.contact * both[:, 0]
        return np.array([place - self.static, speed / self.omega])

    def outward(self, place: Array, resting: bool = False) -> State:
        """State of (q, q̇)."""
        q, speed = float(place[0]), float(place[1])
        return State(
            np.array([(q + self.static) / self.contact]), np.array([speed * self.omega / self.contact]), resting
        )


def one_mode_faults(system: ImpactSystem) -> list[str]:
    """Reasons why the analytical methods cannot take ``system``; empty where they can."""
    if system.size != 1:
        return [f"the analytical methods take one mode, this system has {system.size}: reduce it, or fly it"]
    omega, zeta = float(system.omega[0]), float(system.zeta[0])
    faults = [] if omega > 0 else ["the mode has no stiffness (omega = 0): there is nothing to scale time by"]
    return faults if zeta < 1 else [*faults, f"the mode is not underdamped (zeta = {zeta})"]


@dataclass(frozen=True)
class StationaryMotion:
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


def without_impacts(model: Oscillator, omega: float) -> list[StationaryMotion]:
    """Motion without impacts, where there is one: free of the stop (|H| ≤ Δ), or at rest on it (Ω²|B| ≤ −Δ)."""
    swing, gap = model.harmonic(omega), model.gap
    if abs(swing) <= gap:
        place = np.array([[swing.imag, omega * swing.real]])
        return [StationaryMotion(abs(swing), -abs(swing), place, 0.0, abs(swing) ** 2 * (1 + omega**2) / 2)]
    if omega**2 * abs(model.drive) <= -gap:
        return [StationaryMotion(gap, gap, np.array([[gap, 0.0]]), gap, gap**2, period=1, resting=True)]
    return []


def nearest(motions: Sequence[StationaryMotion], place: Array) -> tuple[StationaryMotion, Array] | None:
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
    def striking(self, model: Oscillator, omega: float) -> list[StationaryMotion]:
        """Stable motions with impacts at Ω."""

    def motions(self, model: Oscillator, omega: float) -> list[StationaryMotion]:
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
            response.ended[index] = Ended.NO_ORBIT.code
            return self.begin(None)
        motion, place = found
        self._write(response, index, motion, hold, output)
        return place, motion.resting

    def end(self, carried: tuple[Array, bool]) -> State:
        """As ``SteadySolver.end``."""
        return self.mode.outward(*carried)

    def _write(self, response: FrequencyResponse, i: int, motion: StationaryMotion, hold: int, output: str) -> None:
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
