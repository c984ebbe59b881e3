"""One drive: the phasor tables of the regimes and the steady response of their blocks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import carried_rate, coarsest_level, exact_period, steady_response
from vibeam.flight.kernels.layout import AMPLITUDE, COARSEST, PERIOD, PERIOD_REST, STRENGTH, W
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.kernels.roots.levels import tabulate_drive

Array = NDArray[np.float64]


@kernel
def set_drive(plan: RegimeEngine, omega: float, amplitude: float) -> None:
    """Put the plan under b = amplitude · sin(omega t)."""
    drive = plan.drive
    drive[W], drive[STRENGTH], drive[AMPLITUDE] = omega, omega * omega * amplitude, amplitude
    drive[PERIOD], drive[PERIOD_REST] = exact_period(omega)
    rate = omega
    for regime in (plan.free, plan.upper, plan.lower):
        tabulate_drive(omega, regime.levels)
        steady_response(regime, drive)
        rate = max(rate, carried_rate(regime.pairs, regime.blocks))
    drive[COARSEST] = coarsest_level(plan.free.pairs, plan.free.levels, rate)
