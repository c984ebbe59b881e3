"""Equilibria on a stop: the contact lies on it, however far beyond it the free one would be."""

from __future__ import annotations

import numpy as np
import pytest

import vibeam
from vibeam.flight.equilibrium import equilibrium


@pytest.mark.parametrize("gap", [6.7e-8, -3e-9, 1e-3])
@pytest.mark.parametrize("push", [1.0, 1e5, 1e9])
def test_a_strong_static_force_leaves_the_contact_on_the_stop(gap: float, push: float) -> None:
    system = vibeam.ImpactSystem.from_modes(
        [12.7, 80.0], 0.01, [6.2, -0.7], 1.0, gap=gap, restitution=0.5, static=[0.1 * push, -0.3 * push]
    )
    start = equilibrium(system)
    assert start.resting
    assert abs(system.contact @ start.displacement - gap) <= 1e-14 * (abs(gap) + np.abs(start.displacement).max())


def test_and_no_motion_from_there_lies_beyond_it() -> None:
    system = vibeam.ImpactSystem.from_modes(12.7, 0.0, 6.2, 0.7, gap=6.7e-8, restitution=0.1, static=1.6)
    path = vibeam.simulate(system, vibeam.Drive(7.2, 1e-8), 1.0)
    assert np.max(path.at(np.linspace(0.0, 1.0, 50)) - system.gap) <= 1e-15 * system.gap
