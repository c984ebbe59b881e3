"""One drive: the phasor tables of the regimes and the steady response of their blocks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import carried_rate, coarsest_level, exact_period, rest_response
from vibeam.flight.kernels.layout import AMPLITUDE, COARSEST, MOTION, PERIOD, PERIOD_REST, STRENGTH, W
from vibeam.flight.kernels.regimes.layout import Regime, RegimeEngine
from vibeam.flight.kernels.roots.levels import tabulate_drive

Array = NDArray[np.float64]


@kernel
def set_drive(plan: RegimeEngine, omega: float, amplitude: float) -> None:
    """Put the plan under b = amplitude · sin(omega t)."""
    drive = plan.drive
    drive[W], drive[STRENGTH], drive[AMPLITUDE] = omega, omega * omega * amplitude, amplitude
    drive[PERIOD], drive[PERIOD_REST] = exact_period(omega)
    respond(plan.free, omega, drive)
    respond(plan.upper, omega, drive)
    respond(plan.lower, omega, drive)
    rate = omega
    for regime in (plan.free, plan.upper, plan.lower):
        rate = max(rate, carried_rate(regime.pairs, regime.blocks))
    drive[COARSEST] = coarsest_level(plan.free.pairs, plan.free.levels, rate)


@kernel
def respond(regime: Regime, omega: float, drive: Array) -> None:
    """The same for one regime."""
    tabulate_drive(omega, regime.levels)
    rest_response(regime.pairs, regime.blocks, regime.outof, omega, drive[STRENGTH], drive[MOTION])
