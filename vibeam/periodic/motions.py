"""Periodic motions at points of frequency and base amplitude: one record of them, and their closed forms.

A motion has m impacts in n drive periods, or none. Closed forms know those of plain systems: with one impact, from the
quadratic of ``modal_sums``; with several, near those of another model (``nearby_orbits``); without, the drive's
response alone. Extremes and clearance from the stop come from ``train_signal``, stability from the multipliers of the
modes that last from impact to impact. Nothing is flown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from enum import Enum
from typing import Any

import numpy as np

from vibeam.periodic.bifurcation_functions import motions
from vibeam.periodic.modal_sums import fault, offsets
from vibeam.periodic.nearby_orbits import nearby_orbits, stable_trains
from vibeam.periodic.train_signal import clear, excited, extremes, sampled, signal
from vibeam.periodic.trains import Trains, contact_phasor, modal_phasors, repeats_sooner, states_before
from vibeam.system.curves import evenly
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Flags, Index, ValueRecord


class OrbitKind(Enum):
    """Kind of a motion found in a model near one of another model, or the reason why there is none, in words."""

    ORBIT = "the same motion, stable and clear of the stop between its impacts"
    NO_ORBIT = "no such motion near: too close to a fold, or beyond it"
    STRIKES = "it strikes the stop between its impacts"
    UNSTABLE = "it is unstable"
    TOUCHES = "it touches the stop where the first model does not"
    ANOTHER = "it repeats after fewer periods: another motion"

    @property
    def code(self) -> int:
        """Number in arrays."""
        return list(OrbitKind).index(self)


@dataclass(frozen=True, eq=False, repr=False)
class Motions(ValueRecord):
    """Motions at points (points,), each with m impacts in ``periods`` drive periods, m = 0 without contact. SI units.

    ``found`` says where there is one. Impacts, state and what is read of an output are NaN where it is not
    ``admissible``; those of an unstable motion are known.
    """

    omega: Array  #: of the drive (points,), rad/s
    base: Array  #: amplitude of the base motion (points,), m
    periods: int
    found: Index  #: code of an ``OrbitKind`` (points,)
    phases: Array  #: drive phases Ωt of the impacts (points, m), rad
    velocities: Array  #: of the contact just before them, toward the stop (points, m)
    time: Array  #: of the state (points,), the drive's phase 0 at 0: just after the first impact
    displacement: Array  #: of the modes at ``time`` (points, n)
    speed: Array  #: (points, n)
    maximum: Array  #: of the output (points,)
    minimum: Array
    reach: Array  #: gap − min of the contact displacement (points,), m
    impact_velocity: Array  #: mean (points,), NaN without impacts
    uncertainty: Array  #: of ``maximum`` and ``minimum`` (points,)
    reach_uncertainty: Array
    first: Array  #: Newton's first correction of the start (points,), rad and share of the impulse; 0 of a closed form

    def __len__(self) -> int:
        return len(self.omega)

    @property
    def amplitude(self) -> Array:
        """½(max − min) of the output (points,)."""
        return (self.maximum - self.minimum) / 2

    @property
    def admissible(self) -> Flags:
        """Points (points,) with a motion that is clear of the stop between its impacts, stable or not."""
        return self._any_of(OrbitKind.ORBIT, OrbitKind.UNSTABLE)

    @property
    def stable(self) -> Flags:
        """Points (points,) with a stable admissible motion."""
        return self._any_of(OrbitKind.ORBIT)

    def _any_of(self, *kinds: OrbitKind) -> Flags:
        return np.isin(self.found, [each.code for each in kinds])

    @classmethod
    def without_values(cls, omega: Array, base: Array, periods: int, found: Index, impacts: int, modes: int) -> Motions:
        """Motions of which nothing is known yet but ``found``."""
        shapes = {"phases": impacts, "velocities": impacts, "displacement": modes, "speed": modes}
        given: dict[str, Any] = {"omega": omega, "base": base, "periods": periods, "found": found}
        names = [each.name for each in fields(cls) if each.name not in given]
        size = len(omega)
        unknown = {name: np.full((size, shapes[name]) if name in shapes else size, np.nan) for name in names}
        return cls(**(given | unknown))

    def at(self, which: Index) -> Motions:
        """Motions at the points ``which``."""
        return self._made([self], lambda rows: rows[0][which])

    @classmethod
    def joined(cls, parts: Sequence[Motions]) -> Motions:
        """Motions of several sets of points, one after the other."""
        return parts[0]._made(parts, np.concatenate)

    def _made(self, parts: Sequence[Motions], make: Any) -> Motions:
        rows = {each.name: [getattr(part, each.name) for part in parts] for each in fields(self)}
        made = {name: make(row) for name, row in rows.items() if isinstance(row[0], np.ndarray)}
        return Motions(**({name: row[0] for name, row in rows.items()} | made))


TOGETHER = 1024  # motions computed at once, to bound the memory


def predicted(system: ImpactSystem, trains: Trains, output: str) -> Motions:
    """Motions of ``system`` near orbits with impacts of any other model."""
    count = len(trains.omega)
    pieces = [trains.at(np.arange(first, min(first + TOGETHER, count))) for first in range(0, count, TOGETHER)]
    return Motions.joined([_predicted(system, each, output) for each in pieces or [trains]])


def _predicted(system: ImpactSystem, trains: Trains, output: str) -> Motions:
    near = nearby_orbits(system, trains)
    which = np.flatnonzero(near.found)
    codes = np.where(near.found, OrbitKind.ORBIT.code, OrbitKind.NO_ORBIT.code)
    m, moved = trains.phases.shape[1], near.trains.at(which)
    found = Motions.without_values(trains.omega, trains.amplitude, trains.periods, codes, m, system.size)
    found.first[:] = near.first
    if not len(which):
        return found
    modes = excited(system.omega, system.zeta, system.contact, moved)
    contact = sampled(signal(system, modes, "contact"))
    own = extremes(contact, m)
    shown = own if output == "contact" else extremes(sampled(signal(system, modes, output)), m)
    codes[which[~clear(contact, system.gap, m)]] = OrbitKind.STRIKES.code
    left = np.flatnonzero(codes[which] == OrbitKind.ORBIT.code)
    unstable = left[~stable_trains(system, moved.at(left), near.acceleration[which[left]])]
    codes[which[unstable]] = OrbitKind.UNSTABLE.code
    codes[which[repeats_sooner(moved)]] = OrbitKind.ANOTHER.code
    known = np.flatnonzero(found.admissible[which])
    at, velocities = which[known], system.impact_velocity(moved.impulses)
    displacement, before = (each[:, 0] for each in states_before(system, moved.at(known)))
    found.displacement[at], found.speed[at] = displacement, before + moved.impulses[known, :1] * system.contact
    found.time[at] = (moved.phases[:, 0] / moved.omega)[known]
    for row, values in (
        (found.phases, moved.phases), (found.velocities, velocities), (found.impact_velocity, velocities.mean(axis=1)),
        (found.maximum, shown.maximum), (found.minimum, shown.minimum), (found.reach, system.gap - own.minimum),
        (found.uncertainty, shown.uncertainty), (found.reach_uncertainty, own.uncertainty),
    ):  # fmt: skip
        row[at] = values[known]
    return found


def predicted_free(system: ImpactSystem, omega: Array, base: Array, output: str) -> Motions:
    """Motions of ``system`` (points,) where it is to stay clear of the stop; their state is at the drive's phase 0."""
    derivative = system.derivative(output)
    order, moved = (0, 0.0) if derivative is None else (derivative.order, derivative.base)
    row, still = system.row(output), offsets(system)
    size = omega**order * np.abs(contact_phasor(system, omega, base, row) + moved * base)
    swing, rest = np.abs(contact_phasor(system, omega, base)), float(system.contact @ still)
    middle, free = float(row @ still) if order == 0 else 0.0, swing + rest < system.gap
    codes = np.where(free, OrbitKind.ORBIT.code, OrbitKind.TOUCHES.code)
    found, steady = Motions.without_values(omega, base, 1, codes, 0, system.size), modal_phasors(system, omega, base)
    found.first[:] = 0.0
    for values, known in (
        (found.maximum, middle + size), (found.minimum, middle - size), (found.reach, system.gap - rest + swing),
        (found.uncertainty, np.zeros(len(omega))), (found.reach_uncertainty, np.zeros(len(omega))),
        (found.time, np.zeros(len(omega))), (found.displacement, steady.imag.T + still),
        (found.speed, (omega * steady.real).T),
    ):  # fmt: skip
        values[free] = known[free]
    return found


KINDS = HARDER, SOFTER, FREE = range(3)  # the two motions with one impact a drive period, and the one without contact


def unsuited(system: ImpactSystem) -> str:
    """Reason why a system has no closed-form motions; empty where it has."""
    if np.any(system.omega == 0):
        return "it has a mode without stiffness"
    if system.beyond_plain:
        return f"no closed-form motions with {' or '.join(system.beyond_plain)}"
    return fault(system)


def closed_motions(
    system: ImpactSystem, omega: Array, base: Array, output: str, kind: int, periods: int = 1
) -> Motions:
    """Motions of one ``kind`` at drives ``omega`` (points,) rad/s and ``base`` amplitudes (points,) m, exact.

    Those with contact have one impact in ``periods`` drive periods. For systems that are not ``unsuited``.
    """
    if kind == FREE:
        return predicted_free(system, omega, base, output)
    roots = motions(system, periods, omega, base, np.full(len(omega), system.gap)).roots
    trains = Trains(roots.phase[:, kind, None], roots.impulse[:, kind, None], omega, base, periods)
    return predicted(system, trains, output)


def closed_amplitudes(
    system: ImpactSystem, omega: Array, base: Array, output: str, kinds: Sequence[int] = KINDS
) -> Array:
    """Amplitude of the stable closed-form motions (points, KINDS); NaN where there is none, or it was not asked for."""
    amplitudes = np.full((len(omega), len(KINDS)), np.nan)
    damped = bool(np.all(system.zeta > 0))
    for kind in kinds if not unsuited(system) else ():
        if kind != FREE or damped:  # without impacts an undamped mode keeps what disturbed it
            found = closed_motions(system, omega, base, output, kind)
            amplitudes[:, kind] = np.where(found.stable, found.amplitude, np.nan)
    return amplitudes


POINTS = 16  # frequencies evaluated at once, evenly spread


@dataclass(frozen=True, eq=False)
class ClosedCurve:
    """Amplitudes (points, KINDS) at the frequencies ``which`` of the grid, NaN where there is no such motion.

    ``peak``: the largest over the whole grid, NaN without any.
    """

    which: Index
    amplitude: Array
    peak: float


def closed_curve(system: ImpactSystem, omega: Array, base: Array, output: str) -> ClosedCurve:
    """Closed-form motions of a plain system over ``omega`` (rad/s, ascending), under base motion ``base`` (m)."""
    which = evenly(0, len(omega) - 1, POINTS)
    found = closed_amplitudes(system, omega[which], base[which], output)
    if not np.isfinite(found).any():
        return ClosedCurve(which, found, np.nan)
    kind = int(np.nanargmax(found)) % len(KINDS)
    low, high, height = 0, len(omega) - 1, float(np.nanmax(found))
    near, values = which, found[:, kind]
    while len(near) < high - low + 1:  # the neighbours of the highest, until they are next to it on the grid
        top = int(np.nanargmax(values))
        low, high = int(near[max(top - 1, 0)]), int(near[min(top + 1, len(near) - 1)])
        near = evenly(low, high, POINTS)
        values = closed_amplitudes(system, omega[near], base[near], output, (kind,))[:, kind]
        height = max(height, float(np.nanmax(values)))
    return ClosedCurve(which, found, height)
