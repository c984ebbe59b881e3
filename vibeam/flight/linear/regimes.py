"""From an ImpactSystem to the plan that the kernels run on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, inf, log2

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.drive import PANEL
from vibeam.flight.kernels.layout import (
    A11,
    ATTACHED_ROWS,
    BLOCK_ROWS,
    CONSTANT1,
    CONSTANT2,
    DRIVE_ROWS,
    LOAD1,
    LOAD2,
    MOTION,
    SIGNAL_ROWS,
)
from vibeam.flight.kernels.regimes.layout import (
    COEFFICIENT,
    COUPLED,
    CURVE,
    CURVED,
    DAMPING,
    EXPONENT,
    FAMILY,
    FORCE,
    GAP,
    LAW_ROWS,
    LINEAR,
    MOBILITY,
    OUTPUT,
    PLASTIC,
    SIDES,
    SIGNALS,
    STIFFNESS,
    TABLE,
    VELOCITY,
    VISCOUS,
    Regime,
    RegimeEngine,
)
from vibeam.flight.kernels.roots.levels import rates, regime
from vibeam.flight.linear.blocks import pair_constants, planes
from vibeam.flight.linear.eigenpairs import Linear
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.laws.compliant import HuntCrossley, LinearStop
from vibeam_models.laws.restitution import PlasticRestitution, TableRestitution, ViscousRestitution

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SignalRow:
    """A signal: at·η + rate·η' + constant + load Ω²B sin φ."""

    at: Array
    rate: Array
    constant: float = 0.0
    load: float = 0.0


def damper_of(system: ImpactSystem) -> Array:
    """The modal damping matrix (n, n)."""
    return np.diag(2 * system.zeta * system.omega) if system.coupling is None else system.coupling


def plan(system: ImpactSystem, slowest: float) -> RegimeEngine:
    """The arrays for drives of ``slowest`` rad/s and more."""
    top, n, sides = floor(log2(PANEL / slowest)), system.size, 1 if system.second_gap is None else 2
    contact = np.stack([system.contact, -system.contact])
    gaps = np.array([system.gap, inf if system.second_gap is None else system.second_gap])
    law, curve = law_of(system)
    law[SIDES], law[COUPLED] = sides, float(system.coupling is not None)
    at_stop = [_at_stop(system, side, contact, gaps, top) for side in range(sides)]
    nodes, weights = _runge_kutta()
    drive = np.zeros(DRIVE_ROWS)
    drive[MOTION] = inf
    return RegimeEngine(
        _regime(system, Linear(system.omega**2, damper_of(system), system.contact), 0.0, contact, gaps, top),
        at_stop[0], at_stop[-1], drive, law, curve, contact, gaps, system.omega**2,
        np.array(damper_of(system)), np.array(np.diag(damper_of(system))),
        np.array(system.load), np.array(system.static), nodes, weights, np.zeros((13, 2 * n)), np.zeros((3, 2 * n)),
    )  # fmt: skip


def law_of(system: ImpactSystem) -> tuple[Array, Array]:
    """The law's numbers, and the table R(v) where it is one."""
    numbers, law = np.zeros(LAW_ROWS), system.law
    numbers[COEFFICIENT], numbers[MOBILITY] = system.restitution, float(system.contact @ system.contact)
    curve = np.zeros((3, 0))
    if isinstance(law, TableRestitution):
        numbers[CURVE], curve = TABLE, np.array([law.speeds, law.coefficients, law.slopes()])
    elif isinstance(law, PlasticRestitution):
        numbers[CURVE] = PLASTIC
        numbers[COEFFICIENT], numbers[VELOCITY], numbers[EXPONENT] = law.coefficient, law.velocity, law.exponent
    elif isinstance(law, ViscousRestitution):
        numbers[CURVE], numbers[COEFFICIENT], numbers[EXPONENT] = VISCOUS, law.factor, law.exponent
    elif isinstance(law, LinearStop):
        numbers[FAMILY], numbers[STIFFNESS], numbers[DAMPING] = LINEAR, law.stiffness, law.damping
    elif isinstance(law, HuntCrossley):
        numbers[FAMILY], numbers[EXPONENT] = CURVED, law.exponent
        numbers[STIFFNESS], numbers[DAMPING] = law.stiffness, law.damping
    return numbers, curve


def _at_stop(system: ImpactSystem, side: int, contact: Array, gaps: Array, top: int) -> Regime:
    law, spring, damper = system.law, system.omega**2, damper_of(system)
    if isinstance(law, LinearStop):
        pushed = Linear(spring, damper, contact[side], law.stiffness, law.damping)
        return _regime(system, pushed, law.stiffness * gaps[side], contact, gaps, top)
    if isinstance(law, HuntCrossley):  # integrated: nothing linear to know of it
        return _regime(system, Linear(spring, damper, contact[side]), 0.0, contact, gaps, top)
    return _regime(system, Linear(spring, damper, contact[side], inf), gaps[side], contact, gaps, top)


def _regime(system: ImpactSystem, linear: Linear, stop: float, contact: Array, gaps: Array, top: int) -> Regime:
    """``stop``: the constant force of the stop along its row, or, where it holds, the gap at which it does."""
    n, w, mobility = system.size, linear.contact, float(linear.contact @ linear.contact)
    found, scale = planes(linear), linear.scale
    held = w * (stop / mobility) if linear.held else np.zeros(n)
    constant = system.static - linear.spring * held if linear.held else system.static + w * stop
    load = system.load
    rows = [SignalRow(-contact[side], np.zeros(n), gaps[side]) for side in range(2)]
    rows += [_force(system, linear, contact[side], gaps[side]) for side in range(2)]
    if linear.held:
        constant, load = (force - w * (w @ force) / mobility for force in (constant, load))
    pushed = found.inverse[:, n:]
    blocks, (omega, sigma, disc) = found.blocks, pair_constants(found.blocks)
    m = len(omega)
    order = np.argsort(rates(omega, sigma), kind="stable")
    pick = np.stack([2 * order, 2 * order + 1], axis=1).ravel()
    columns, inverse = found.columns[:, pick], found.inverse[pick]
    filled = np.zeros((BLOCK_ROWS, m))
    filled[A11 : A11 + 4] = blocks[order].reshape(m, 4).T
    filled[[CONSTANT1, CONSTANT2]] = (pushed[pick] @ constant).reshape(m, 2).T
    filled[[LOAD1, LOAD2]] = (pushed[pick] @ load).reshape(m, 2).T
    sizes = np.concatenate([scale, np.ones(n)])
    outof = np.ascontiguousarray(columns / sizes[:, None])
    pairs, table, levels = regime(omega[order], sigma[order], disc[order], top)
    return Regime(
        pairs, table, levels, np.zeros(SIGNAL_ROWS), np.zeros((ATTACHED_ROWS, m)), filled,
        np.ascontiguousarray(inverse * sizes), outof, held, signals(rows, outof, held),
    )  # fmt: skip


def _force(system: ImpactSystem, linear: Linear, w: Array, gap: float) -> SignalRow:
    """The contact force of the stop at w·η = gap: of a linear stop, or of one that holds."""
    law = system.law
    if isinstance(law, LinearStop):
        return SignalRow(law.stiffness * w, law.damping * w, -law.stiffness * (gap if np.isfinite(gap) else 0.0))
    square = float(w @ w)
    row = SignalRow(-w * linear.spring / square, -w @ linear.damper / square)
    return SignalRow(row.at, row.rate, float(w @ system.static) / square, float(w @ system.load) / square)


def signals(rows: Sequence[SignalRow], outof: Array, held: Array) -> Array:
    """The rows as weights on a regime's y, constants and loads: (SIGNALS, 2m + 2)."""
    n, filled = len(held), np.zeros((SIGNALS, outof.shape[1] + 2))
    for place, row in zip((GAP, GAP + 1, FORCE, FORCE + 1, OUTPUT), rows, strict=False):
        filled[place, :-2] = row.at @ outof[:n] + row.rate @ outof[n:]
        filled[place, -2:] = row.constant + float(row.at @ held), row.load
    return filled


def _runge_kutta() -> tuple[Array, Array]:
    """Hairer, Nørsett and Wanner's coefficients of order 8(5, 3), as scipy publishes them."""
    from scipy.integrate import DOP853

    nodes = np.zeros((14, 12))
    nodes[:12], nodes[12], nodes[13] = DOP853.A[:12, :12], DOP853.B, DOP853.C[:12]
    return nodes, np.stack([DOP853.E3, DOP853.E5])
