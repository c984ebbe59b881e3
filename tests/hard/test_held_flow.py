"""What a rest makes of a change of its begin: the suite's estimate against two motions in arbitrary precision."""

from __future__ import annotations

import numpy as np
import pytest
from agreement import follow, true_motion
from motions import state
from random_systems import Case, random_case
from sensitivity import held_flow

import vibeam


@pytest.mark.parametrize("omega", [[1.0, 3.3, 7.1], [0.0, 3.3, 70.0]])
def test_two_rests_that_begin_a_little_apart(omega: list[float]) -> None:
    contact = np.array([1.0, -0.6, 0.3])
    system = vibeam.ImpactSystem.from_modes(
        omega, [0.05, 1.0, 4.7], contact, [1.0, 0.4, -0.2], gap=0.0, restitution=0.5, static=[50.0, 0.0, 0.0]
    )
    along = np.eye(3) - np.outer(contact, contact) / (contact @ contact)
    moved = along @ np.array([[1.0, 2.0, -0.5], [0.3, -1.0, 0.7]]).T * 1e-3
    ends = []
    for change in (np.zeros((3, 2)), moved):
        motion = true_motion(Case(system, vibeam.Drive(1.9, 0.05), state(*change.T, True)), 0.0)
        motion.run(t_end=0.7)
        assert motion.resting
        after = motion.state()
        ends.append(np.array([*after.displacement, *after.velocity], dtype=float))
    expected = held_flow(system, 0.7) @ moved.T.ravel()
    np.testing.assert_allclose(ends[1] - ends[0], expected, rtol=1e-9, atol=1e-12 * np.abs(expected).max())


def test_a_long_rest_among_fast_and_overdamped_modes_is_within_the_estimate() -> None:
    """Without the rest's share the first impact after it was 51 times as late as one last digit explains."""
    tally = follow(random_case(7, 79, size=8), 100, 8)
    assert tally.releases >= 3
    assert not tally.faults
    assert tally.worst_blur < 32
