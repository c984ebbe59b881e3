"""Response of one model near the orbits of another: what a reduced model's motions would be in the full model.

Each orbit is carried over by ``nearby_orbits``; extremes and clearance from the stop come from ``train_signal``, its
stability from the multipliers of the modes that last from impact to impact. Nothing is flown. A motion without impacts
is the drive's response alone.
"""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.periodic.modal_sums import fault, offsets, resonant
from vibeam.periodic.multipliers import largest, monodromy
from vibeam.periodic.nearby_orbits import nearby_orbits
from vibeam.periodic.train_signal import clear, excited, extremes, sampled, signal
from vibeam.periodic.train_sums import Trains, ahead, contact_phasor, repeats_sooner
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Flags

TOGETHER = 1024  # motions computed at once, to bound the memory
LASTS = 1e-6  # share left of a mode at the next impact, below which it takes no part in the stability
SLOWEST = 20  # modes at most in the stability of several impacts


class Found(Enum):
    """What became of an orbit in the other model; the value says it in words."""

    ORBIT = "the same motion, stable and clear of the stop between its impacts"
    NO_ORBIT = "no such motion near: too close to a fold, or beyond it"
    STRIKES = "it strikes the stop between its impacts"
    UNSTABLE = "it is unstable"
    TOUCHES = "it touches the stop where the first model does not"
    ANOTHER = "it repeats after fewer periods: another motion"

    @property
    def code(self) -> int:
        """Number in arrays."""
        return list(Found).index(self)


class PredictedResponse(NamedTuple):
    """Response of the other model (points,), SI units as in ``FrequencyResponse``; NaN where ``found`` is not ORBIT.

    ``uncertainty``: of ``maximum`` and ``minimum``; ``reach_uncertainty``: of the reach. ``first``: size of the first
    Newton correction of the impacts, rad and share of the impulse, 0 without impacts.
    """

    maximum: Array
    minimum: Array
    reach: Array
    impact_velocity: Array
    uncertainty: Array
    reach_uncertainty: Array
    found: NDArray[np.int64]
    first: Array

    @property
    def amplitude(self) -> Array:
        """½(max − min) of the output."""
        return (self.maximum - self.minimum) / 2


def unpredictable(system: ImpactSystem, omega: float, periods: int) -> str:
    """Reason why nothing can be predicted of this model; empty where it can."""
    if np.any(system.omega == 0):
        return "it has a mode without stiffness"
    return fault(system) or resonant(system, omega, periods)


def predicted(system: ImpactSystem, trains: Trains, output: str) -> PredictedResponse:
    """Response of ``system`` near orbits with impacts of any other model."""
    count = len(trains.omega)
    pieces = [trains.at(np.arange(first, min(first + TOGETHER, count))) for first in range(0, count, TOGETHER)]
    parts = [_predicted(system, each, output) for each in pieces or [trains]]
    return PredictedResponse._make(np.concatenate(rows) for rows in zip(*parts, strict=True))


def _predicted(system: ImpactSystem, trains: Trains, output: str) -> PredictedResponse:
    near = nearby_orbits(system, trains)
    which = np.flatnonzero(near.found)
    found = np.where(near.found, Found.ORBIT.code, Found.NO_ORBIT.code)
    moved, values = near.trains.at(which), np.full((6, len(near.found)), np.nan)
    if len(which):
        m, modes = trains.phases.shape[1], excited(system, moved)
        contact = sampled(signal(system, modes, "contact"))
        own = extremes(contact, m)
        shown = own if output == "contact" else extremes(sampled(signal(system, modes, output)), m)
        speeds = -moved.impulses * float(system.contact @ system.contact) / (1 + system.restitution)
        found[which[~clear(contact, system.gap, m)]] = Found.STRIKES.code
        rows = (shown.maximum, shown.minimum, system.gap - own.minimum, speeds.mean(axis=1))
        values[:, which] = *rows, shown.uncertainty, own.uncertainty
        left = np.flatnonzero(found[which] == Found.ORBIT.code)
        unstable = left[~_stable(system, moved.at(left), near.acceleration[which[left]])]
        found[which[unstable]] = Found.UNSTABLE.code
        found[which[repeats_sooner(moved)]] = Found.ANOTHER.code
    values[:, found != Found.ORBIT.code] = np.nan
    return PredictedResponse._make((*values, found, near.first))


def predicted_free(system: ImpactSystem, omega: Array, amplitude: Array, output: str) -> PredictedResponse:
    """Response of ``system`` (points,) where it is to stay clear of the stop."""
    derivative = system.derivative(output)
    order, base = (0, 0.0) if derivative is None else (derivative.order, derivative.base)
    row, still = system.row(output), offsets(system)
    size = omega**order * np.abs(contact_phasor(system, omega, amplitude, row) + base * amplitude)
    swing, rest = np.abs(contact_phasor(system, omega, amplitude)), float(system.contact @ still)
    middle = float(row @ still) if order == 0 else 0.0
    free, nothing = swing + rest < system.gap, np.zeros(len(omega))
    rows = (middle + size, middle - size, system.gap - rest + swing, np.full(len(omega), np.nan))
    values = np.where(free, np.stack([*rows, nothing, nothing]), np.nan)
    return PredictedResponse._make((*values, np.where(free, Found.ORBIT.code, Found.TOUCHES.code), nothing))


def _stable(system: ImpactSystem, trains: Trains, acceleration: Array) -> Flags:
    """Test whether all multipliers of the modes that last are within the unit circle.

    ``acceleration`` (points, m): of the contact just before each impact.
    """
    if not len(trains.omega):
        return np.zeros(0, dtype=bool)
    velocity = -trains.impulses * float(system.contact @ system.contact) / (1 + system.restitution)
    relative = acceleration / velocity
    if trains.phases.shape[1] == 1:
        return np.asarray(largest(system, trains.span, relative[:, 0]) < 1)
    order = np.argsort(trains.phases, axis=1)
    turned = np.take_along_axis(trains.phases, order, axis=1)
    flights, ends = ahead(turned, trains), np.roll(np.take_along_axis(relative, order, axis=1), -1, axis=1)
    left = np.exp(-system.zeta * system.omega * float(flights.min()))
    modes = np.flatnonzero((left > LASTS) | (system.zeta > 1))
    modes = modes[np.argsort(system.omega[modes])][:SLOWEST]
    scale = np.concatenate([system.omega[modes], np.ones(len(modes))])
    whole = np.eye(2 * len(modes))
    for k in range(flights.shape[1]):
        whole = (monodromy(system, flights[:, k], ends[:, k], modes) * scale[:, None] / scale) @ whole
    return np.asarray(np.abs(np.linalg.eigvals(whole)).max(axis=1) < 1)
