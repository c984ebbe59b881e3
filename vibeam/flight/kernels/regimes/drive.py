"""One drive: the phasor tables of the regimes and the steady response of their blocks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import carried_rate, coarsest_level, exact_period, steady_response
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.kernels.roots.levels import tabulate_drive

Array = NDArray[np.float64]


@kernel
def set_drive(engine: RegimeEngine, omega: float, amplitude: float) -> None:
    """Put the plan under b = amplitude · sin(omega t)."""
    drive = engine.drive
    drive[layout.W], drive[layout.STRENGTH], drive[layout.AMPLITUDE] = omega, omega * omega * amplitude, amplitude
    drive[layout.PERIOD], drive[layout.PERIOD_REST] = exact_period(omega)
    rate = omega
    for regime in (engine.free, engine.upper, engine.lower):
        tabulate_drive(omega, regime.levels)
        steady_response(regime, drive)
        rate = max(rate, carried_rate(regime.pairs, regime.blocks))
    drive[layout.COARSEST] = coarsest_level(engine.free.pairs, engine.free.levels, rate)
