"""How a regime's signal rises from its start: the leading order, and the derivative of that order."""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.modal_flow import ROUND_OFF
from vibeam.flight.kernels.roots.signal import derivatives, signal_of


@kernel
def leading_order(regime: Regime, value: float, rate: float, size: float) -> tuple[int, float]:
    """Order and size of the first derivative by which the signal just shown rises from 0: (0, 0) where it is above it
    already, (−1, 0) where it falls.
    """
    if value > ROUND_OFF * size:
        return 0, 0.0
    if rate > 0.0 and value >= -ROUND_OFF * size:
        return 1, rate
    if rate < 0.0 or value < -ROUND_OFF * size:
        return -1, 0.0
    return curve_of(regime)


@kernel
def curve_of(regime: Regime) -> tuple[int, float]:
    """The same for a signal known to start at 0 without slope: by its second and third derivative."""
    derivatives(signal_of(regime), regime.pairs.shape[1], layout.WHOLE, 3)
    if regime.signal[layout.WHOLE + 2] > 0.0:
        return 2, float(regime.signal[layout.WHOLE + 2])
    if regime.signal[layout.WHOLE + 2] == 0.0 and regime.signal[layout.WHOLE + 3] > 0.0:
        return 3, float(regime.signal[layout.WHOLE + 3])
    return -1, 0.0
