"""ζ = 0, 1, 1 ± 1e-12, 50 and no stiffness at all, side by side in many modes, flying and at rest on the stop.

One mode at each damping, free and driven, is in ``tests/vibeam/flight/test_flight_special.py``.
"""

from __future__ import annotations

import numpy as np
import pytest
from motions import judged, state

import vibeam

DAMPING = [0.0, 1 - 1e-12, 1.0, 1 + 1e-12, 50.0]


@pytest.mark.parametrize("zeta", DAMPING)
@pytest.mark.parametrize("gap", [0.05, -0.3])
def test_four_modes_all_alike_in_damping(zeta: float, gap: float) -> None:
    """Also through rests (gap < 0), where the held motion is none of the modes'."""
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 1.7, 3.1, 5.3], zeta, [1.0, -0.5, 0.4, 0.3], [1.0, 0.4, -0.3, 0.2], gap=gap, restitution=0.6,
        static=[1.0, 0.0, 0.1, 0.0],
    )  # fmt: skip
    drive = vibeam.Drive(1.3, 2.0 if zeta < 10 else 60.0)
    judged(system, drive, state([-0.8, 0.0, 0.0, 0.0], np.zeros(4)), 20)


@pytest.mark.parametrize("seed", range(4))
def test_all_dampings_side_by_side(seed: int) -> None:
    rng = np.random.default_rng(seed)
    zeta = rng.permutation([*DAMPING, 0.02])
    omega = np.r_[0.0, 1.6 ** np.arange(6)]
    contact = np.r_[0.5, rng.uniform(0.3, 1.0, 6) * rng.choice([-1, 1], 6)]
    system = vibeam.ImpactSystem.from_modes(
        omega, np.r_[0.0, zeta], contact, rng.normal(size=7), gap=rng.choice([-0.05, 0.05]), restitution=0.7,
        static=np.r_[0.6, np.zeros(6)],
    )  # fmt: skip
    judged(system, vibeam.Drive(1.9, 0.3), state(-0.2 * contact / (contact @ contact), np.zeros(7)), 20)
