"""A drive of several harmonics for what takes one: the others as oscillators that no impact moves.

Between impacts everything is linear, so the steady response Im(H_j e^{ijΩt}) of the modes to the harmonic j is taken
out of them, and the motion that is left feels the first harmonic and the impacts alone. What the contact then misses,
Im(z e^{ijΩt}) with z = Σ w_k H_k, is the free motion of an oscillator without damping at jΩ. It is one mode more, with
the share ``LIGHT`` of the contact's row and so much the larger a displacement: its share of the contact mobility, and
with it what an impulse does to its motion, is ``LIGHT``², below round-off. (Finite elements know it as the large-mass
method.) A second one, a quarter of its period ahead and unseen by the contact, gives outputs their own phases.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arguments import refuse, require
from vibeam_models.arrays import Array, Complex

Shares = Iterable[tuple[int, float, float]]  # order, share of the first harmonic's Ω²B, phase in rad
LIGHT = 1e-8  # contact row of an oscillator, as a share of the modes'
NEAR = 1e-12  # |ω² − (jΩ)² + 2iζωjΩ| over (jΩ)² below which a mode has no steady response


@dataclass(frozen=True)
class Harmonic:
    """``acceleration`` · sin(``order`` Ωt + ``phase``) beside a drive's Ω²B sin Ωt: m/s² (N of a force), rad.

    ValueError for an order that is no whole number above 1, or a number that is not finite.

    >>> import vibeam
    >>> vibeam.Harmonic(order=3, acceleration=0.2)
    Harmonic(order=3, acceleration=0.2, phase=0.0)
    """

    order: int
    acceleration: float
    phase: float = 0.0

    def __post_init__(self) -> None:
        faults = [] if isinstance(self.order, int) and self.order > 1 else [f"order: {self.order!r}, the first is 2"]
        if not np.isfinite([self.acceleration, self.phase]).all():
            faults.append(f"{self.acceleration} m/s² and {self.phase} rad must be finite")
        refuse("harmonic", faults)


@dataclass(frozen=True, eq=False)
class SeveralHarmonics:
    """``plain`` under ``drive`` and further ``harmonics``: ``system`` under the same ``drive`` moves as it.

    States go in by ``enter`` and come out by ``leave``, at a time of the motion. What is read off contact and outputs
    is the motion's own; ``mode_energy`` is not, for the modes' steady responses are taken out.
    ValueError where an undamped mode is at a harmonic's frequency, and for several contacts.

    >>> import vibeam
    >>> plain = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, gap=0.1)
    >>> made = vibeam.SeveralHarmonics(plain, vibeam.Drive(0.8, 0.1), (vibeam.Harmonic(3, 0.02),))
    >>> made.system.size  # with two oscillators of the harmonic
    3
    """

    plain: ImpactSystem
    drive: Drive
    harmonics: tuple[Harmonic, ...]
    responses: Complex = field(init=False, repr=False)

    def __post_init__(self) -> None:
        require("plain", self.plain, ImpactSystem)
        require("drive", self.drive, Drive)
        if self.plain.further is not None:
            raise ValueError("several harmonics: they are carried to one contact, and the system has several")
        rows = [_response(self.plain, self.drive.omega, each) for each in self.harmonics]
        object.__setattr__(self, "responses", np.array(rows).reshape(len(rows), self.plain.size))

    @cached_property
    def system(self) -> ImpactSystem:
        """The system with two modes more for each harmonic."""
        own, contact = self.plain, np.zeros(2 * len(self.harmonics))
        contact[::2] = np.where(self._at_contact != 0, self.light, 0.0)
        outputs = {name: np.concatenate([row, self._output(row)]) for name, row in own.outputs.items()}
        derivatives = {
            name: replace(each, row=np.concatenate([each.row, self._output(each.row, each.base)]))
            for name, each in own.derivatives.items()
        }
        return with_oscillators(own, np.repeat(self.rates, 2), contact, outputs=outputs, derivatives=derivatives)

    def enter(self, state: State, time: float = 0.0) -> State:
        """``state`` of ``plain`` at ``time`` (s) as that of ``system``."""
        forced, rate = self._forced(time)
        turns = np.exp(1j * self.rates * time)[:, None]
        turned = np.stack([self._phasors, 1j * self._phasors], axis=1) * turns / self.light
        swing, pace = turned.imag.ravel(), (turned * 1j * self.rates[:, None]).imag.ravel()
        return State(
            np.concatenate([state.displacement - forced, swing]),
            np.concatenate([state.velocity - rate, pace]),
            state.resting,
        )

    def joined(self, state: State, time: float = 0.0) -> State:
        """``state`` of ``plain`` under the first harmonic alone as that of ``system``, with the others' response."""
        forced, rate = self._forced(time)
        return self.enter(State(state.displacement + forced, state.velocity + rate, state.resting), time)

    def leave(self, state: State, time: float = 0.0) -> State:
        """``state`` of ``system`` at ``time`` (s) as that of ``plain``."""
        forced, rate = self._forced(time)
        n = self.plain.size
        return State(state.displacement[:n] + forced, state.velocity[:n] + rate, state.resting)

    def in_own_modes(self, values: Array, times: Array) -> tuple[Array, Array]:
        """Displacements and velocities (m, n) of ``plain`` from those (m, 2, …) of ``system`` at ``times`` (m,)."""
        n = self.plain.size
        turns = np.exp(1j * times[:, None] * self.rates)
        forced, rate = (turns @ self.responses).imag, (turns @ (1j * self.rates[:, None] * self.responses)).imag
        return values[:, 0, :n] + forced, values[:, 1, :n] + rate

    def _forced(self, time: float) -> tuple[Array, Array]:
        """Steady responses (n,) of the modes to all harmonics, and their rates."""
        turned = self.responses * np.exp(1j * self.rates * time)[:, None]
        return turned.imag.sum(axis=0), (turned * 1j * self.rates[:, None]).imag.sum(axis=0)

    @cached_property
    def rates(self) -> Array:
        """Frequencies (m,) of the harmonics, rad/s."""
        return np.array([each.order * self.drive.omega for each in self.harmonics])

    @property
    def light(self) -> float:
        """Contact row of an oscillator."""
        return float(LIGHT * np.linalg.norm(self.plain.contact))

    @cached_property
    def _at_contact(self) -> Complex:
        """z (m,) of the contact."""
        return np.asarray(self.responses @ self.plain.contact)

    @cached_property
    def _phasors(self) -> Complex:
        """Those of the oscillators (m,): the contact's, or the largest mode's where the contact sees nothing of it."""
        largest = np.abs(self.responses).max(axis=1, initial=0.0)
        return np.where(self._at_contact != 0, self._at_contact, np.where(largest > 0, largest, 1.0))

    def _output(self, row: Array, base: float = 0.0) -> Array:
        """The oscillators' weights (2m,) in an output: z_o = (α + iβ) z is α of the first and β of the second.

        ``base``: share of the base's own displacement in it, of which each harmonic has its acceleration over −rate².
        """
        moved = np.array([each.acceleration * np.exp(1j * each.phase) for each in self.harmonics]) / self.rates**2
        share = (self.responses @ row + base * moved) / self._phasors
        return self.light * np.stack([share.real, share.imag], axis=1).ravel()


def with_oscillators(system: ImpactSystem, rates: Array, contact: Array, **own: Any) -> ImpactSystem:
    """System with further modes (m,) at ``rates`` rad/s that nothing damps or drives; ``own``: other fields anew."""
    rows = {"omega": rates, "contact": contact} | dict.fromkeys(("zeta", "load", "static"), np.zeros(len(rates)))
    longer: dict[str, Any] = {name: np.concatenate([getattr(system, name), row]) for name, row in rows.items()}
    if system.coupling is not None:
        longer["coupling"] = np.pad(system.coupling, (0, len(rates)))
    return replace(system, **longer, **own)


def further(shares: Shares, drive: Drive) -> tuple[Harmonic, ...]:
    """Harmonics of (order, share of the drive's Ω²B, phase in rad); ValueError for an order that comes twice."""
    shares = tuple(shares)
    orders = [order for order, _, _ in shares]
    if len(set(orders)) < len(orders):
        raise ValueError(f"harmonics: an order comes twice in {', '.join(map(str, orders))}")
    first = drive.omega**2 * drive.amplitude
    return tuple(Harmonic(order, share * first, phase) for order, share, phase in shares)


def _response(system: ImpactSystem, omega: float, harmonic: Harmonic) -> Complex:
    """H (n,) of a harmonic: (ω² − (jΩ)² + ijΩ D) H = load · acceleration · e^{i phase}."""
    rate = harmonic.order * omega
    force = system.load * harmonic.acceleration * np.exp(1j * harmonic.phase)
    if system.coupling is None and np.any((np.abs(_resistance(system, rate)) <= NEAR * rate**2) & (force != 0)):
        raise ValueError(f"harmonic: an undamped mode is at order {harmonic.order} of the drive: its motion grows")
    return solved(system, rate, force)


def _resistance(system: ImpactSystem, rate: float) -> Complex:
    return np.asarray((system.omega - rate) * (system.omega + rate) + 2j * system.zeta * system.omega * rate)


def solved(system: ImpactSystem, rate: float, force: Complex) -> Complex:
    """(ω² − ν² + iνD)⁻¹ of ``force`` (n,) at ν = ``rate``; 0 of an undamped mode that is there."""
    if system.coupling is not None:
        matrix = np.diag(system.omega**2 - rate**2) + 1j * rate * system.coupling
        return np.asarray(np.linalg.solve(matrix, force))
    resistance = _resistance(system, rate)
    usable = np.abs(resistance) > NEAR * rate**2
    return np.asarray(np.where(usable, force / np.where(usable, resistance, 1.0), 0.0))
