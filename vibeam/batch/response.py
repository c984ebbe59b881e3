"""Result of a batch: arrays over its points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam.system.ended import Ended
from vibeam_models.arguments import counted

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BatchResponse:
    """Steady points of ``vibeam.batch``, each array of the batch's shape, and one axis more where it says so.

    SI units; every quantity is that of ``FrequencyResponse``. A failed point is NaN, its reason in ``ended``, its
    ``state`` the equilibrium from which a sweep goes on.
    """

    amplitude: Array  #: ½(max − min) of the output over the hold
    reach: Array  #: gap − min of the contact displacement, m
    maximum: Array  #: max of the output
    minimum: Array  #: min of the output
    impacts_per_period: Array  #: impacts a drive period, over the hold
    impact_velocity: Array  #: mean contact velocity just before impact, m/s (NaN where there is none)
    period: NDArray[np.int64]  #: drive periods after which the motion repeats (1…16), 0 none, −1 no contact
    rest: Array  #: share of the time at rest on the stop, 0…1
    mode_energy: Array  #: (…, n) time-mean energy of each mode over the hold, J
    ended: NDArray[np.int64]  #: code of ``Ended``
    impacts: NDArray[np.int64]  #: impacts computed, settling included
    cpu_seconds: Array  #: CPU time of the point, s
    state: Array  #: (…, 2n) modal displacements, then velocities, at the end of the hold
    resting: NDArray[np.bool_]  #: whether that state is in lasting contact with the stop
    strobes: Array  #: (…, k) the output at the end of the last k periods held, the latest last
    lyapunov: Array  #: largest Lyapunov exponent, 1/s, −∞ where every direction is lost (NaN where not asked for)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch."""
        return self.ended.shape

    def __repr__(self) -> str:
        failed = int(np.count_nonzero(self.ended != Ended.COMPLETE.code))
        size, modes = counted(self.ended.size, "point"), counted(self.mode_energy.shape[-1], "mode")
        return f"BatchResponse({size} {self.shape}, {modes}{f', {failed} not complete' if failed else ''})"
