"""From an ImpactSystem and its drive to the arrays that compiled tangent maps run on."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import inf
from threading import local

import numpy as np

from vibeam.flight.kernels.tangents import layout
from vibeam.flight.kernels.tangents.layout import Collocation, Flow, TangentPlan, Workspace
from vibeam.flight.linear.block_regime import sorted_planes
from vibeam.flight.linear.eigenpairs import LinearSystem
from vibeam.flight.linear.regimes import FORMULAS, damper_of
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array

NODES = 10  # of a panel of integrated contact


class _Last(local):
    """The plan that a thread made last, and what for: Newton's steps ask for it again and again."""

    made: tuple[ImpactSystem, Drive, bool, TangentPlan] | None = None


_LAST = _Last()


def plan_of(system: ImpactSystem, drive: Drive, touched: bool) -> TangentPlan:
    """The calling thread's arrays; ``touched``: with the regimes of a motion that rests on a hard stop or is pushed by
    a linear one.
    """
    last = _LAST.made
    if last is not None and last[0] is system and last[2] >= touched:
        touched, plan = last[2], last[3] if last[1] == drive else last[3]._replace(law=_law(system, drive))
    else:
        plan = tangent_plan(system, drive, touched)
    _LAST.made = system, drive, touched, plan
    return plan


def tangent_plan(system: ImpactSystem, drive: Drive, touched: bool) -> TangentPlan:
    """The arrays."""
    n, contact = system.size, np.stack([system.contact, -system.contact])
    free = LinearSystem(system.omega**2, damper_of(system), system.contact)
    none = Flow(np.zeros((layout.BLOCK_ROWS, 0)), np.zeros((0, 2 * n)), np.zeros((2 * n, 0)))
    upper = _flow(_at_stop(system, free, contact[0])) if touched else none
    lower = _flow(_at_stop(system, free, contact[1])) if touched and system.second_gap is not None else upper
    gaps = np.array([system.gap, inf if system.second_gap is None else system.second_gap])
    return TangentPlan(
        _modes(system) if system.coupling is None else _flow(free), upper, lower,
        _law(system, drive), contact, gaps, np.array(free.damper), np.array(free.spring), np.array(system.load),
        np.array(system.static), rule(), _workspace(n),
    )  # fmt: skip


def _modes(system: ImpactSystem) -> Flow:
    """Modes by themselves."""
    omega, sigma, n = system.omega, system.zeta * system.omega, system.size
    disc = omega**2 * (system.zeta - 1) * (system.zeta + 1)
    blocks = np.array([np.zeros(n), np.ones(n), -(omega**2), -2 * sigma, sigma, omega, disc])
    return Flow(blocks, np.zeros((0, 2 * n)), np.zeros((2 * n, 0)))


def _at_stop(system: ImpactSystem, free: LinearSystem, row: Array) -> LinearSystem:
    spring = system.contact_law.spring
    if spring is None:
        return replace(free, contact=row, stiffness=inf)
    return replace(free, contact=row, stiffness=spring.stiffness, damping=spring.damping)


def _flow(linear: LinearSystem) -> Flow:
    """A regime in 2×2 blocks."""
    found = sorted_planes(linear)
    rows = [*found.blocks.reshape(-1, 4).T, found.sigma, found.omega, found.disc]
    return Flow(np.array(rows), np.ascontiguousarray(found.into), np.ascontiguousarray(found.outof))


def _law(system: ImpactSystem, drive: Drive) -> Array:
    known, numbers = system.contact_law.kernel_numbers(), np.zeros(layout.LAW_ROWS)
    numbers[layout.FAMILY] = FORMULAS[known.formula][0]
    for name, place in (("stiffness", layout.STIFFNESS), ("damping", layout.DAMPING), ("exponent", layout.EXPONENT)):
        numbers[place] = known.values.get(name, 0.0)
    numbers[layout.MOBILITY], numbers[layout.W] = system.mobility, drive.omega
    numbers[layout.STRENGTH] = drive.omega**2 * drive.amplitude
    return numbers


def _workspace(n: int) -> Workspace:
    return Workspace(
        np.zeros((2 * n, 2 * n)), np.zeros((2, 2 * n)), np.zeros((2, 2 * n)), np.zeros((layout.WEIGHT_ROWS, 2 * n)),
        np.zeros((layout.GAIN_ROWS, n)), np.zeros((layout.POWER_ROWS, NODES, n)), np.zeros((2, n)),
        np.zeros((layout.VECTOR_ROWS, NODES)), np.zeros((3, NODES, NODES)), np.zeros((2, NODES, 2 * n)),
        np.zeros(layout.PEAK_ROWS),
    )  # fmt: skip


@cache
def rule(count: int = NODES) -> Collocation:
    """Gauss' nodes and weights in (0, 1), integrals up to each node, last coefficients in Legendre's polynomials."""
    from numpy.polynomial import legendre

    nodes, weights = legendre.leggauss(count)
    values = legendre.legvander(nodes, count)  # P_0 … P_N at the nodes
    coefficients = (np.arange(count) + 0.5)[:, None] * values[:, :count].T * weights
    degree = np.arange(1, count)
    integrals = np.empty((count, count))  # of P_k from −1 to each node: (P_{k+1} − P_{k−1})/(2k + 1)
    integrals[:, 0] = nodes + 1
    integrals[:, 1:] = (values[:, 2:] - values[:, : count - 1]) / (2 * degree + 1)
    return Collocation((nodes + 1) / 2, weights / 2, integrals @ coefficients / 2, coefficients[-2:].copy())
