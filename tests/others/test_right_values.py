"""Values that hold where others are off, by means that share nothing with vibeam: mpmath, DOP853."""

from __future__ import annotations

from typing import Any

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.others.problem import Problem
from tests.others.problems import code_aster, rows_of_balls
from tests.others.problems_book import PROBLEMS


def row(problem: str) -> Problem:
    """The one row whose problem begins so."""
    (found,) = (each for each in PROBLEMS if each.problem.startswith(problem))
    return found


def test_ten_balls_by_dop853() -> None:
    """Hertz' forces between all ten: momentum is kept, and each velocity is right to 1e-10 m/s."""
    count, radius = 10, 0.01
    mass = 4 / 3 * np.pi * radius**3 * rows_of_balls.DENSITY
    stiff = 2 / 3 * rows_of_balls.STEEL / (1 - rows_of_balls.POISSON**2) * np.sqrt(radius / 2)

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        forces = stiff * np.maximum(y[: count - 1] - y[1:count], 0.0) ** 1.5
        return np.concatenate([y[count:], np.diff(-np.concatenate([[0.0], forces, [0.0]])) / mass])

    start = np.zeros(2 * count)
    start[count] = 1.0
    found = solve_ivp(rate, (0.0, 2e-3), start, method="DOP853", rtol=1e-12, atol=1e-16).y[count:, -1]
    assert found.sum() == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(found, row("Newton's cradle").expected, rtol=0, atol=1e-10)


def test_two_balls_in_thirty_digits() -> None:
    """Parabolas, and the law of impact in both contacts, one after the other."""
    with mp.workdps(30):
        times = [float(each) for each in two_balls(5)]
    np.testing.assert_allclose(times, row("two balls").expected, rtol=1e-15)


def two_balls(count: int) -> list[Any]:
    """Times at which the lower of two balls strikes the floor; ``upper`` is less a diameter."""
    loss, gravity = mp.mpf("0.95"), mp.mpf("9.81")
    time, lower, upper, low, up = mp.mpf(0), mp.mpf("0.1"), mp.mpf("0.101"), mp.mpf(0), mp.mpf(0)
    floor: list[Any] = []
    while len(floor) < count:
        to_floor = (low + mp.sqrt(low**2 + 2 * gravity * lower)) / gravity
        to_meet = (upper - lower) / (low - up) if low > up else mp.inf
        step = min(to_floor, to_meet)
        time, fall = time + step, gravity * step**2 / 2
        lower, upper, low, up = (
            lower + low * step - fall,
            upper + up * step - fall,
            low - gravity * step,
            up - gravity * step,
        )
        if to_floor <= to_meet:
            floor.append(time)
            lower, low = mp.mpf(0), -loss * low
        else:
            impulse = (1 + loss) * (low - up) / (1 + mp.mpf(1) / 2)
            upper, low, up = lower, low - impulse, up + impulse / 2
    return floor


def test_a_damped_surface_that_only_pushes_in_thirty_digits() -> None:
    """SDND108 B: m d'' = g − k d − c d′ until the force is 0, and a parabola."""
    with mp.workdps(30):
        gravity, stiff, damping = map(mp.mpf, (10, 100, 5))
        meets = (mp.sqrt(1 + 4 * gravity) - 1) / gravity
        speed, sigma, sag = 1 + gravity * meets, damping / 2, gravity / stiff
        turn = mp.sqrt(stiff - sigma**2)

        def depth(t: Any) -> Any:
            return sag + mp.exp(-sigma * t) * (
                -sag * mp.cos(turn * t) + (speed - sigma * sag) / turn * mp.sin(turn * t)
            )

        leaves = mp.findroot(lambda t: stiff * depth(t) + damping * mp.diff(depth, t), (0.30, 0.34), solver="anderson")
        places = [depth(leaves) + mp.diff(depth, leaves) * t + gravity * t**2 / 2
                  for t in (mp.mpf(1) - meets - leaves, mp.mpf("1.1") - meets - leaves)]  # fmt: skip
        found = [float(-2 - each) for each in places]
    assert float(meets + leaves) == pytest.approx(0.86570, abs=5e-6)
    np.testing.assert_allclose(found, row("SDND108: mass that falls on a damped").expected[1:], rtol=1e-11)


def test_what_the_formula_of_sdnd122_leaves_out() -> None:
    """With it the free frequency is that of two half turns, integrated by DOP853; without it 6.4e-4 lower."""
    energy = code_aster.ENERGIES[0]

    def rate(_: float, y: np.ndarray) -> list[float]:
        return [y[1], -10.0 * y[0] - 50.0 * max(y[0] - 0.01, 0.0)]

    def back(_: float, y: np.ndarray) -> float:
        return float(y[0] - 0.01)

    back.direction = 1.0  # type: ignore[attr-defined]
    start = [0.0, np.sqrt(2 * energy)]
    met = solve_ivp(
        rate, (0.0, 4.0), start, method="DOP853", rtol=1e-12, atol=1e-15, events=back, max_step=1e-3
    ).t_events[0]
    exact = code_aster.by_hand(energy)
    assert 1 / np.diff(met)[0] == pytest.approx(exact, rel=1e-9)
    assert code_aster.by_hand(energy, left_out=5.0) == pytest.approx(exact, rel=7e-4)
    assert code_aster.by_hand(energy, left_out=5.0) != pytest.approx(exact, rel=6e-4)
