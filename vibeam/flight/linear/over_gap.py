"""A system's plan as a function of the gap to its first stop: linear in it, at the same blocks and tables.

Propagators, bases and eigenvalues know no gap; it enters the constants of the blocks, what is held and the constants of
the signals, each in proportion. So a program without an eigensolver moves a plan to another gap: the browser does.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.linear.packing import slowest_rate
from vibeam.flight.linear.regimes import fastest_rate, plan
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array


@dataclass(frozen=True)
class RegimeOverGap:
    """A regime at the system's own gap, and what a metre more adds to its constants."""

    regime: Regime
    constants: Array  # (2, m) of the blocks
    held: Array  # (n,)
    signals: Array  # (SIGNALS,) constants

    @classmethod
    def between(cls, own: Regime, unit: Regime) -> RegimeOverGap:
        """The regime of a system, and the same one at a gap of 1 m without load and static force."""
        constants, signals = unit.blocks[[layout.CONSTANT1, layout.CONSTANT2]], unit.signals[:, -2]
        return cls(own, constants, unit.held, np.where(np.isfinite(signals), signals, 0.0))  # a stop that is not there


@dataclass(frozen=True)
class PlanOverGap:
    """A plan, and its regimes over the gap: in free motion, at the first stop and at the second (None: there is none).

    ``integrated``: the contact is, by the Runge–Kutta coefficients of the plan.
    """

    plan: RegimeEngine
    free: RegimeOverGap
    upper: RegimeOverGap
    lower: RegimeOverGap | None
    fastest: float  # rad/s, the rate that the shortest panels resolve
    integrated: bool

    @classmethod
    def of(cls, system: ImpactSystem) -> PlanOverGap:
        """The plan of ``system``; ValueError where modes coincide so closely that it has none.

        Its panels are those of no drive in particular: ``pairs`` know none, tables and levels are made for one.
        """
        nothing, second = np.zeros(system.size), system.second_gap is not None
        slowest = slowest_rate(system, 0.0, 0.0)
        unit = replace(system, static=nothing, load=nothing, gap=1.0, second_gap=0.0 if second else None)
        own, more = plan(system, slowest), plan(unit, slowest)
        free, upper = RegimeOverGap.between(own.free, more.free), RegimeOverGap.between(own.upper, more.upper)
        lower = RegimeOverGap.between(own.lower, more.lower) if second else None
        return cls(own, free, upper, lower, fastest_rate(system), system.contact_law.integrated)
