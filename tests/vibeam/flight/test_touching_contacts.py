"""Bodies in a row that touch without a gap: their laws integrated by another program, and what is known of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vibeam
from vibeam.system.rows import Contact
from vibeam_models.laws.compliant import HuntCrossley, LinearStop
from vibeam_models.laws.mechanics import StopLaw

END = 5e-3  # s: all have parted by then
HERTZ, LINEAR = HuntCrossley(1e9), LinearStop(1e7)
Law = StopLaw | float


def row_of(masses: Sequence[float], laws: Sequence[Law]) -> vibeam.ImpactSystem:
    """Balls in a row, each touching the next one."""
    n = len(masses)
    rows = (np.eye(n)[:-1] - np.eye(n)[1:]) / np.sqrt(masses)
    of = [{"law": law} if isinstance(law, StopLaw) else {"restitution": law} for law in laws]
    further = tuple(Contact(row, 0.0, **each) for row, each in zip(rows[1:], of[1:], strict=True))
    first: dict[str, Any] = of[0]
    return vibeam.ImpactSystem.from_modes(np.zeros(n), 0.0, rows[0], np.zeros(n), further=further or None, **first)


def flown(masses: Sequence[float], laws: Sequence[Law], struck: Sequence[float]) -> tuple[vibeam.Outcome, Any]:
    """How the motion ends, and the velocities then."""
    root = np.sqrt(masses)
    start = vibeam.State(np.zeros(len(masses)), np.array(struck) * root)
    path = vibeam.simulate(row_of(masses, laws), vibeam.Drive(1.0, 0.0), END, start)
    return path.outcome, path.state.velocity / root


def integrated(masses: Sequence[float], laws: Sequence[StopLaw], struck: Sequence[float]) -> Any:
    """The velocities by scipy's integrator at 1e-13: m x'' of every ball is the sum of the forces of its contacts."""
    n = len(masses)

    def rate(_: float, state: Any) -> Any:
        place, speed = state[:n], state[n:]
        pushed = np.zeros(n)
        for i, law in enumerate(laws):
            deep, fast = max(place[i] - place[i + 1], 0.0), speed[i] - speed[i + 1]
            if isinstance(law, HuntCrossley):
                force = max(0.0, law.stiffness * deep**law.exponent * (1.0 + law.damping * fast))
            else:
                force = 1e7 * deep
            pushed[i] -= force
            pushed[i + 1] += force
        return np.concatenate([speed, pushed / np.array(masses)])

    start = np.concatenate([np.zeros(n), struck])
    return solve_ivp(rate, (0.0, END), start, method="DOP853", rtol=1e-13, atol=1e-18, max_step=1e-5).y[n:, -1]


ONE = [1.0, 0.0, 0.0, 0.0, 0.0]
CASES = {
    "two": ([1.0] * 2, [HERTZ], ONE[:2]),
    "three": ([1.0] * 3, [HERTZ] * 2, ONE[:3]),
    "four": ([1.0] * 4, [HERTZ] * 3, ONE[:4]),
    "five": ([1.0] * 5, [HERTZ] * 4, ONE),
    "struck from the other side": ([1.0] * 4, [HERTZ] * 3, [0.0, 0.0, 0.0, -1.0]),
    "two strike": ([1.0] * 5, [HERTZ] * 4, [1.0, 1.0, 0.0, 0.0, 0.0]),
    "struck in the middle": ([1.0] * 5, [HERTZ] * 4, [0.0, 0.0, 1.0, 0.0, 0.0]),
    "unequal": ([3.0, 1.0, 2.0, 0.5], [HERTZ] * 3, ONE[:4]),
    "heavier and heavier": ([1.0, 2.0, 3.0, 4.0, 5.0], [HERTZ] * 4, ONE),
    "lossy": ([1.0] * 5, [HuntCrossley(1e9, 0.3)] * 4, ONE),
    "square law": ([1.0] * 4, [HuntCrossley(1e12, 0.0, 2.0)] * 3, ONE[:4]),
    "linear, three": ([1.0] * 3, [LINEAR] * 2, ONE[:3]),
    "linear, four": ([1.0] * 4, [LINEAR] * 3, ONE[:4]),
    "linear, five": ([1.0] * 5, [LINEAR] * 4, ONE),
    "linear, unequal": ([5.0, 1.0, 3.0, 2.0, 4.0], [LINEAR] * 4, ONE),
    "Hertz and linear": ([1.0] * 5, [HERTZ, LINEAR, HERTZ, LINEAR], ONE),
    "linear and Hertz": ([1.0] * 5, [LINEAR, HERTZ, LINEAR, HERTZ], ONE),
}


@pytest.mark.parametrize("name", CASES)
def test_balls_that_touch_part_as_another_integrator_has_them(name: str) -> None:
    masses, laws, struck = CASES[name]
    outcome, found = flown(masses, laws, struck)
    assert outcome is vibeam.Outcome.MOVING
    np.testing.assert_allclose(found, integrated(masses, laws, struck), atol=2e-10)
    assert found @ masses == pytest.approx(np.array(struck) @ masses, abs=1e-12)


@pytest.mark.parametrize("law", [HERTZ, LINEAR])
def test_a_gap_of_round_off_changes_nothing(law: StopLaw) -> None:
    """1e-15 m of gap beside 1e-5 m of compression, and none at all."""
    masses, rows = [1.0] * 5, row_of([1.0] * 5, [law] * 4)
    first, further = rows.contact, rows.further
    open_ = vibeam.ImpactSystem.from_modes(
        np.zeros(5), 0.0, first, np.zeros(5), gap=1e-15, law=law,
        further=tuple(Contact(np.array(each.row), 1e-15, law=law) for each in further or ()),
    )  # fmt: skip
    apart = vibeam.simulate(open_, vibeam.Drive(1.0, 0.0), END, vibeam.State(np.zeros(5), np.array(ONE)))
    np.testing.assert_allclose(flown(masses, [law] * 4, ONE)[1], apart.state.velocity, atol=1e-7)


@pytest.mark.parametrize(
    ("laws", "expected"),
    [
        ([1.0] * 4, [0.0, 0.0, 0.0, 0.0, 1.0]),  # Newton's cradle
        ([1.0, 1.0, 1.0, HERTZ], [0.0, 0.0, 0.0, 0.0, 1.0]),  # the rigid ones pass it on in no time
        ([1.0, HERTZ, 1.0], [-1 / 3, 0.0, 2 / 3, 2 / 3]),  # the last two held together; what comes back is passed on
        ([1.0, LINEAR], [0.0, 0.0, 1.0]),
        ([LINEAR, 1.0], [-1 / 3, 2 / 3, 2 / 3]),
    ],
)
def test_rigid_contacts_among_them(laws: list[Law], expected: list[float]) -> None:
    outcome, found = flown([1.0] * len(expected), laws, ONE[: len(expected)])
    assert outcome in (vibeam.Outcome.MOVING, vibeam.Outcome.RESTING)
    np.testing.assert_allclose(found, expected, atol=1e-11)


def test_balls_at_rest_that_touch_stay_where_they_are() -> None:
    """No force, no motion: no contact is begun."""
    path = vibeam.simulate(row_of([1.0] * 5, [HERTZ] * 4), vibeam.Drive(1.0, 0.0), 1.0)
    assert path.outcome is vibeam.Outcome.SETTLED
    assert not path.state.velocity.any()
    assert not path.state.displacement.any()
