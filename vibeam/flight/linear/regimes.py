"""From an ImpactSystem to the plan that the kernels run on."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.linear.block_regime import SignalRow, free_regime, held_regime, rates, with_signals
from vibeam.flight.linear.eigenpairs import LinearSystem
from vibeam.flight.linear.packing import top_level, yields
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam_models.laws.mechanics import Spring, StopLaw

FORMULAS = {  # by ``KernelNumbers.formula``: family and curve of the kernels
    "constant": (regime_layout.IMPULSIVE, regime_layout.CONSTANT),
    "table": (regime_layout.IMPULSIVE, regime_layout.TABLE),
    "plastic": (regime_layout.IMPULSIVE, regime_layout.PLASTIC),
    "viscous": (regime_layout.IMPULSIVE, regime_layout.VISCOUS),
    "linear": (regime_layout.LINEAR, regime_layout.CONSTANT),
    "hunt-crossley": (regime_layout.CURVED, regime_layout.CONSTANT),
}
NUMBERS = {
    "stiffness": regime_layout.STIFFNESS,
    "damping": regime_layout.DAMPING,
    "exponent": regime_layout.EXPONENT,
    "coefficient": regime_layout.COEFFICIENT,
    "velocity": regime_layout.VELOCITY,
}


def damper_of(system: ImpactSystem) -> Array:
    """The modal damping matrix (n, n)."""
    return np.diag(2 * system.zeta * system.omega) if system.coupling is None else system.coupling


def fastest_rate(system: ImpactSystem) -> float:
    """The highest rate (rad/s) that panels must resolve."""
    return float(np.max(rates(system.omega, system.zeta * system.omega)))


def plan(system: ImpactSystem, slowest: float) -> RegimeEngine:
    """The arrays for drives of ``slowest`` rad/s and more."""
    top, n, sides = top_level(slowest, fastest_rate(system)), system.size, 1 if system.second_gap is None else 2
    contact = np.stack([system.contact, -system.contact])
    gaps = np.array([system.gap, inf if system.second_gap is None else system.second_gap])
    law, curve = numbers_of(system.contact_law, system.restitution, system.mobility)
    law[regime_layout.SIDES], law[regime_layout.COUPLED] = sides, float(system.coupling is not None)
    at_stop = [_at_stop(system, side, contact, gaps, top) for side in range(sides)]
    nodes, weights = runge_kutta(law[regime_layout.FAMILY] == regime_layout.CURVED)
    drive = np.zeros(layout.DRIVE_ROWS)
    drive[layout.MOTION] = inf
    return RegimeEngine(
        _free(system, LinearSystem(system.omega**2, damper_of(system), system.contact), contact, gaps, top),
        at_stop[0], at_stop[-1], drive, law, curve, contact,
        np.stack([yields(system.omega, row) for row in contact]), gaps, np.array(system.omega), system.omega**2,
        np.array(damper_of(system)), np.array(np.diag(damper_of(system))),
        np.array(system.load), np.array(system.static), nodes, weights, np.zeros((13, 2 * n)), np.zeros((3, 2 * n)),
    )  # fmt: skip


def numbers_of(law: StopLaw, restitution: float, mobility: float) -> tuple[Array, Array]:
    """The law's numbers, and the table R(v) where it is one; ValueError where the kernels have no formula of it."""
    found, numbers = law.kernel_numbers(), np.zeros(regime_layout.LAW_ROWS)
    numbers[regime_layout.COEFFICIENT] = restitution
    numbers[regime_layout.MOBILITY] = mobility
    numbers[regime_layout.FAMILY], numbers[regime_layout.CURVE] = FORMULAS[found.formula]
    for name, value in found.values.items():
        numbers[NUMBERS[name]] = value
    return numbers, np.zeros((3, 0)) if found.table is None else found.table


def _at_stop(system: ImpactSystem, side: int, contact: Array, gaps: Array, top: int) -> Regime:
    """The regime of a contact with one stop: held by it, or pushed by a linear one."""
    law, linear = system.contact_law, LinearSystem(system.omega**2, damper_of(system), contact[side])
    if law.spring is not None:
        linear = replace(linear, stiffness=law.spring.stiffness, damping=law.spring.damping)
        pushed = system.static + contact[side] * (law.spring.stiffness * gaps[side])
        found = free_regime(linear, pushed, system.load, top)
        return with_signals(found, [*_gaps(contact, gaps, found.held), *_forces(law.spring, contact, gaps)])
    if law.integrated:  # integrated: nothing linear to know of it
        return _free(system, linear, contact, gaps, top)
    found, force = held_regime(replace(linear, stiffness=inf), system.static, system.load, gaps[side], top)
    return with_signals(found, [*_gaps(contact, gaps, found.held), force, force])


def _free(system: ImpactSystem, linear: LinearSystem, contact: Array, gaps: Array, top: int) -> Regime:
    """The regime of free flight; beside the gaps the forces with which linear stops would push where they are."""
    found = free_regime(linear, system.static, system.load, top)
    spring = system.contact_law.spring
    forces = [] if spring is None else _forces(spring, contact, gaps)
    return with_signals(found, [*_gaps(contact, gaps, found.held), *forces])


def _forces(law: Spring, contact: Array, gaps: Array) -> list[SignalRow]:
    """The forces of both linear stops as signals."""
    return [
        SignalRow(law.stiffness * w, law.damping * w, -law.stiffness * (gap if np.isfinite(gap) else 0.0))
        for w, gap in zip(contact, gaps, strict=True)
    ]


def _gaps(contact: Array, gaps: Array, held: Array) -> list[SignalRow]:
    """The gaps to both stops as signals."""
    still = np.zeros(len(held))
    return [SignalRow(-w, still, gap - float(w @ held)) for w, gap in zip(contact, gaps, strict=True)]


def runge_kutta(curved: bool) -> tuple[Array, Array]:
    """Hairer, Nørsett and Wanner's coefficients of order 8(5, 3), as scipy publishes them; 0 where none is read."""
    nodes, weights = np.zeros((14, 12)), np.zeros((2, 13))
    if curved:
        from scipy.integrate import DOP853

        nodes[:12], nodes[12], nodes[13] = DOP853.A[:12, :12], DOP853.B, DOP853.C[:12]
        weights[:] = DOP853.E3, DOP853.E5
    return nodes, weights
