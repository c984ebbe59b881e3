"""Impacts that accumulate to rest: the end of the accumulation against exact sums, in bounded work."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from agreement import true_motion
from motions import EPSILON, NONE, one, state
from mpmath import mpf
from random_systems import Case

import vibeam

RESTITUTIONS = [0.01, 0.1, 0.5, 0.9, 0.99, 0.999]
FAINTEST = 1e-9  # of the speeds' scale, times 1 − R: further down nothing needs to be computed one by one


def assert_over(
    path: vibeam.Trajectory, exact: float, restitution: float, round_off: float = 1e-13, faint: float = 1.0
) -> None:
    """The first accumulation is over at ``exact`` to 1e-10 and within its own bound, in bounded work."""
    over, bound = path.chatters[0]
    assert abs(over - exact) <= 1e-10 * exact
    assert abs(over - exact) <= bound + round_off * exact
    assert bound <= 1e-9 * exact
    assert path.rests[0, 0] == pytest.approx(exact, rel=1e-10)
    before = path.impact_times < over
    assert before.sum() <= np.log(FAINTEST * faint * (1 - restitution)) / np.log(restitution) + 3
    assert path.at(path.rests[0].mean()) == pytest.approx(path.system.gap, abs=1e-13)


@pytest.mark.parametrize("restitution", RESTITUTIONS)
def test_a_ball(restitution: float) -> None:
    """Fall from h, then flights 2v/g, 2Rv/g …: T = √(2h/g) (1 + R)/(1 − R)."""
    system = one(0.0, load=0.0, static=9.81, restitution=restitution)
    with mpmath.workdps(30):
        R = mpf(restitution)
        exact = float(mpmath.sqrt(2 * mpf(1) / mpf(9.81)) * (1 + R) / (1 - R))
    path = vibeam.simulate(system, NONE, 1.5 * exact, state(-1.0, 0.0))
    assert_over(path, exact, restitution, round_off=1e-13 + 8 * EPSILON / (1 - restitution))
    assert path.state.resting
    np.testing.assert_array_equal(path.rests[:, 1], [1.5 * exact])


@pytest.mark.parametrize(
    ("restitution", "press"),
    [(each, press) for each in RESTITUTIONS[:-1] for press in (1e-3, 0.3, 100.0)] + [(RESTITUTIONS[-1], 100.0)],
)
def test_an_undamped_mode_pressed_on(restitution: float, press: float) -> None:
    """Flights are symmetric, 2/ω arctan(v/(ω a)) each, with a the press: their sum in 30 digits."""
    w, speed = 1.7, 1.0
    system = one(w, gap=-press, restitution=restitution)
    with mpmath.workdps(30):
        total, v, R = mpf(0), mpf(speed), mpf(restitution)
        while v > mpf(10) ** -14 * press:
            v *= R
            total += 2 / mpf(w) * mpmath.atan2(v, mpf(w) * mpf(press))
        total += 2 * v * R / (mpf(w) ** 2 * mpf(press) * (1 - R))
        exact = float(total)
    path = vibeam.simulate(system, NONE, 1.5 * exact, state(-press, speed))
    assert_over(path, exact, restitution, round_off=1e-13 + 8 * EPSILON / (1 - restitution), faint=min(press, 1.0))
    assert path.state.resting


DRIVEN = [(0.01, 1), (0.3, 1), (0.9, 1), (0.97, 1), (0.3, 3), (0.8, 3), (0.6, 8)]


def driven(restitution: float, modes: int, gap: float) -> Case:
    """Pressed on and shaken, thrown at the stop; with one mode, or others that each impact stirs."""
    rng = np.random.default_rng([modes, 5])
    omega = np.r_[1.0, 1.0 + np.sort(rng.uniform(1, 12, modes - 1))]
    contact = np.r_[1.0, rng.uniform(-0.5, 0.5, modes - 1)]
    system = vibeam.ImpactSystem.from_modes(
        omega, 0.03, contact, np.r_[1.0, rng.normal(size=modes - 1) / 3], gap=gap, restitution=restitution,
        static=np.r_[1.0, np.zeros(modes - 1)],
    )  # fmt: skip
    x = np.r_[gap - 0.02, np.zeros(modes - 1)]
    return Case(system, vibeam.Drive(0.6, 0.8), state(x, np.zeros(modes)))


@pytest.mark.parametrize(("restitution", "modes"), DRIVEN)
@pytest.mark.parametrize("gap", [-0.3, 0.0])
def test_driven(restitution: float, modes: int, gap: float) -> None:
    """Against arbitrary precision, which follows the accumulation to flights of 1e-10."""
    case = driven(restitution, modes, gap)
    motion = true_motion(case, 0.0)
    motion.run(count=1, until="rest", t_end=60.0)
    rest = next(event for event in motion.events if event.kind == "rest")
    motion.run(count=1, until="release", t_end=float(rest.time) + 30.0)
    release = [float(event.time) for event in motion.events if event.kind == "release"]
    path = vibeam.simulate(*case[:2], (release or [float(rest.time) + 1.0])[0], case.start)
    assert_over(path, float(rest.time), restitution)
    if release:
        assert path.rests[0, 1] == pytest.approx(release[0], rel=1e-9)
    found = path.modes_at(float(rest.time) * (1 + 1e-12))
    expected = np.array([rest.displacement, rest.velocity], dtype=float)
    np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max() + 1e-15)


@pytest.mark.parametrize("modes", [2, 10, 30])
def test_an_accumulation_with_many_modes(modes: int) -> None:
    """Zeno with modes that ring up to 1000 times as fast as the first one."""
    omega = np.geomspace(1.0, 30.0 if modes < 30 else 1000.0, modes)
    contact = 1.0 / omega**0.5 * (-1.0) ** np.arange(modes)
    system = vibeam.ImpactSystem.from_modes(
        omega, 0.2, contact, 0.0, gap=0.0, restitution=0.4, static=3.0 * contact
    )  # fmt: skip
    start = state(-1e-3 * contact / (contact @ contact), np.zeros(modes))
    motion = true_motion(Case(system, NONE, start), 0.0)
    motion.run(count=1, until="rest", t_end=5.0)
    rest = next(event for event in motion.events if event.kind == "rest")
    path = vibeam.simulate(system, NONE, 2 * float(rest.time), start)
    assert_over(path, float(rest.time), 0.4, round_off=1e-12)
