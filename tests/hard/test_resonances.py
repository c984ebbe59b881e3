"""Drives at, beside, far above and far below the modes, undamped, impact by impact in arbitrary precision.

One mode in closed form is in ``tests/vibeam/flight/test_flight_special.py``.
"""

from __future__ import annotations

import numpy as np
import pytest
from motions import judged, state

import vibeam

OMEGA = np.array([1.0, 2.3, 6.1])


def system(gap: float, restitution: float = 0.7) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(
        OMEGA, 0.0, [1.0, 0.5, -0.4], [1.0, 0.2, 0.3], gap=gap, restitution=restitution
    )


@pytest.mark.parametrize("gap", [0.1, 0.0, -0.1])
@pytest.mark.parametrize("mode", [0, 1, 2])
def test_each_undamped_mode_at_its_resonance(mode: int, gap: float) -> None:
    judged(system(gap), vibeam.Drive(OMEGA[mode], 0.05), state([-0.2, 0.0, 0.0], np.zeros(3)), 24)


@pytest.mark.parametrize("steps", [-1, 1, 100])
def test_some_last_digits_beside_a_resonance(steps: int) -> None:
    omega = OMEGA[1] + steps * np.spacing(OMEGA[1])
    judged(system(0.1), vibeam.Drive(omega, 0.05), state([-0.2, 0.0, 0.0], np.zeros(3)), 24)


def test_two_modes_at_one_resonance() -> None:
    """Alike, the one undamped, the other hardly damped."""
    both = vibeam.ImpactSystem.from_modes([2.0, 2.0, 5.0], [0.0, 1e-9, 0.02], [1.0, 0.3, 0.2], 1.0, gap=0.1)
    judged(both, vibeam.Drive(2.0, 0.02), state([-0.2, 0.1, 0.0], np.zeros(3)), 12)


@pytest.mark.parametrize(
    ("ratio", "amplitude"), [(1e-6, 1e10), (1e-3, 2e5), (3e2, 1e-3), pytest.param(1e3, 1e-4, marks=pytest.mark.slow)]
)
def test_drives_far_below_and_far_above(ratio: float, amplitude: float) -> None:
    judged(system(-0.05, 0.9), vibeam.Drive(ratio, amplitude), state([-0.6, 0.1, 0.0], [0.0, 0.3, 0.0]), 8, least=4)
