"""Modes that the contact hardly touches: rows nearly orthogonal, a contact at a node."""

from __future__ import annotations

import numpy as np
import pytest
from motions import assert_lawful, judged, state

import vibeam

DRIVE = vibeam.Drive(1.9, 0.05)
WEAK = [1e-3, 1e-8, 1e-12, 1e-16, 1e-160, 5e-324]


@pytest.mark.parametrize("weak", WEAK)
def test_one_mode_among_three_nearly_at_its_node(weak: float) -> None:
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 3.3, 7.1], 0.04, [1.0, weak, 0.3], [1.0, 0.4, -0.2], gap=0.02, restitution=0.7
    )
    judged(system, DRIVE, state([-0.05, 0.01, 0.0], [0.02, 0.0, 0.01]), 20)


@pytest.mark.parametrize("weak", WEAK)
def test_a_mode_nearly_at_its_node_is_as_if_it_were_at_it(weak: float) -> None:
    """The motion of the others differs by no more than the weak row carries, and what sensitivity makes of it."""
    rows = ([1.0, 3.3, 7.1], 0.04, [1.0, weak, 0.3], [1.0, 0.4, -0.2])
    start = state([-0.05, 0.01, 0.0], [0.02, 0.0, 0.01])
    near = vibeam.ImpactSystem.from_modes(*rows, gap=0.02, restitution=0.7)
    node = vibeam.ImpactSystem.from_modes(*rows[:2], [1.0, 0.0, 0.3], rows[3], gap=0.02, restitution=0.7)
    here, there = vibeam.simulate(node, DRIVE, 20.0, start), vibeam.simulate(near, DRIVE, 20.0, start)
    assert len(there.impact_times) == len(here.impact_times) > 4
    np.testing.assert_allclose(there.impact_times, here.impact_times, rtol=1e-12 + 100 * weak)


@pytest.mark.parametrize("weak", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("gap", [0.0, 0.5, -0.5])
def test_all_modes_nearly_orthogonal(weak: float, gap: float) -> None:
    """Contact row and gap small together: the same motion whatever their scale (S → weak² S, impulse → 1/weak)."""
    contact = np.array([1.0, -0.6, 0.3])
    start = state([-0.8, 0.01, 0.0], [0.02, 0.0, 0.01])
    here, there = (
        vibeam.simulate(
            vibeam.ImpactSystem.from_modes(
                [1.0, 3.3, 7.1], 0.04, scale * contact, [1.0, 0.4, -0.2], gap=scale * gap, restitution=0.7
            ),
            vibeam.Drive(1.9, 0.4), 15.0, start,
        )
        for scale in (1.0, weak)
    )  # fmt: skip
    assert len(there.impact_times) == len(here.impact_times) > 2
    strong = here.impact_velocities > 1e-4
    np.testing.assert_allclose(there.impact_times[strong], here.impact_times[strong], rtol=1e-11)
    np.testing.assert_allclose(there.impact_velocities[strong], weak * here.impact_velocities[strong], rtol=1e-9)


def test_only_a_stiff_mode_is_touched() -> None:
    """All but the fastest of eight modes lie at their nodes: an impact is that one's alone."""
    omega = np.geomspace(1.0, 300.0, 8)
    contact = np.r_[np.zeros(7), 1.0]
    system = vibeam.ImpactSystem.from_modes(omega, 0.01, contact, 1.0, gap=1e-6, restitution=0.8)
    path = vibeam.simulate(system, vibeam.Drive(1.9, 0.5), 20.0, state(np.zeros(8), np.zeros(8)))
    alone = vibeam.ImpactSystem.from_modes(300.0, 0.01, 1.0, 1.0, gap=1e-6, restitution=0.8)
    single = vibeam.simulate(alone, vibeam.Drive(1.9, 0.5), 20.0, state(0.0, 0.0))
    assert_lawful(path)
    found, alone_found = (each.impact_times[each.impact_velocities > 1e-6] for each in (path, single))
    assert len(found) == len(alone_found) > 2
    np.testing.assert_allclose(found, alone_found, rtol=1e-10)


def test_opposite_rows_that_cancel() -> None:
    """Two modes alike on opposite rows: only their difference moves the contact."""
    system = vibeam.ImpactSystem.from_modes([2.0, 2.0], 0.01, [1.0, -1.0], [1.0, 1.0], gap=0.1, restitution=0.7)
    start = state([-0.3, 0.2], [0.0, 0.0])
    path = vibeam.simulate(system, vibeam.Drive(1.3, 0.7), 30.0, start)
    alone = vibeam.ImpactSystem.from_modes(2.0, 0.01, np.sqrt(2.0), 0.0, gap=0.1, restitution=0.7)
    single = vibeam.simulate(alone, vibeam.Drive(1.3, 0.7), 30.0, state(-0.5 / np.sqrt(2), 0.0))
    assert len(path.impact_times) == len(single.impact_times) > 5
    np.testing.assert_allclose(path.impact_times, single.impact_times, rtol=1e-12)
    both = path.at(np.linspace(0, 30, 301), "contact")
    np.testing.assert_allclose(both, single.at(np.linspace(0, 30, 301)), atol=1e-12)
