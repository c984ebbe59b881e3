"""The flight solver where formulas degenerate: no stiffness, critical damping, resonance, pressed stop, R = 0, 1."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest
from exact_motion import exact_impacts, exact_motion, impacts_and_bar
from mpmath import mpf

import vibeam
from vibeam.flight.equilibrium import equilibrium
from vibeam.flight.solver import FlightSolver

NONE = vibeam.Drive(0.0, 0.0)
COMPLETE = vibeam.Ended.COMPLETE
TOO_LATE = 1000.0  # radians of the fastest mode: a bound on the time that the exact motion takes


def one(omega: float, zeta: float = 0.0, load: float = 1.0, **rest: Any) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(omega, zeta, 1.0, load, **rest)


def state(displacement: list[float], velocity: list[float], resting: bool = False) -> vibeam.State:
    return vibeam.State(np.array(displacement), np.array(velocity), resting)


def assert_finite(path: vibeam.Trajectory) -> None:
    """No NaN, no infinity, in anything that a motion tells."""
    times = np.linspace(path.t_start, path.t_end, 101)
    told = [path.impact_times, path.impact_velocities, path.chatters, path.rests, path.modes_at(times)]
    told += [path.at(times), path.velocity_at(times), path.state.displacement, path.state.velocity]
    assert all(np.all(np.isfinite(values)) for values in told)
    assert np.isfinite(path.t_end)


def assert_exact(
    system: vibeam.ImpactSystem, drive: vibeam.Drive, start: vibeam.State, count: int, digits_lost: float = 0.0
) -> vibeam.Trajectory:
    """The first ``count`` impacts are those of the arbitrary-precision motion, to what round-off grows to in it."""
    limit = TOO_LATE / max(system.omega.max(), 1.0)
    expected, bar = impacts_and_bar(system, drive, start, count=count, t_end=limit)
    assert len(expected) == count
    bar *= 10**digits_lost
    assert bar.max() < 1e-8
    path = vibeam.simulate(system, drive, expected[-1, 0] * (1 + 1e-9), start)
    assert len(path.impact_times) == count
    assert np.all(np.abs(path.impact_times - expected[:, 0]) <= bar * expected[:, 0])
    assert np.all(np.abs(path.impact_velocities - expected[:, 1]) <= bar * expected[:, 1].max())
    assert_finite(path)
    return path


def integral_form(
    omega: float, zeta: float, forcing: Callable[[mpf], mpf], x: float, v: float, t: float
) -> tuple[float, float]:
    """x and x' of x'' + 2ζωx' + ω²x = forcing by Duhamel's integral in 40 digits, for any ζ."""
    with mpmath.workdps(40):
        w, z = mpf(omega), mpf(zeta)
        root = mpmath.sqrt(mpmath.mpc(z * z - 1)) * w

        def impulse(s: mpf) -> mpf:
            return mpmath.re(mpmath.exp(-z * w * s) * (mpmath.sinh(root * s) / root if root else s))

        def slope(s: mpf) -> mpf:
            return mpmath.re(mpmath.exp(-z * w * s) * mpmath.cosh(root * s)) - z * w * impulse(s)

        end = mpf(t)
        parts = max(2, int(5 * t * max(omega, 1)))
        grid = [end * k / parts for k in range(parts + 1)]
        place = mpf(x) * (slope(end) + 2 * z * w * impulse(end)) + mpf(v) * impulse(end)
        speed = mpf(v) * slope(end) - mpf(x) * w * w * impulse(end)
        place += mpmath.quad(lambda s: impulse(end - s) * forcing(s), grid)
        speed += mpmath.quad(lambda s: slope(end - s) * forcing(s), grid)
        return float(place), float(speed)


# ------------------------------------------------------------------------------------------------ no stiffness


@pytest.fixture(scope="module")
def ball() -> vibeam.Trajectory:
    """h = 1 m, g = 9.81, e = 0.9."""
    system = one(0.0, load=0.0, static=9.81, restitution=0.9)
    return vibeam.simulate(system, NONE, 20.0, state([-1.0], [0.0]))


def test_a_bouncing_ball(ball: vibeam.Trajectory) -> None:
    hits = [0.4515236409857, 1.2642661947600, 1.9957344931569]
    np.testing.assert_allclose(ball.impact_times[:3], hits, rtol=1e-13)
    k = np.arange(len(ball.impact_times))
    fall, speed = np.sqrt(2 / 9.81), np.sqrt(2 * 9.81)
    np.testing.assert_allclose(ball.impact_times, fall * (1 + 18 * (1 - 0.9**k)), rtol=1e-12)
    np.testing.assert_allclose(ball.impact_velocities, speed * 0.9**k, rtol=1e-10, atol=1e-13 * speed)
    assert len(k) > 50


def test_a_bouncing_ball_comes_to_rest(ball: vibeam.Trajectory) -> None:
    over, remainder = ball.chatters[0]
    assert len(ball.chatters) == len(ball.rests) == 1
    assert over == pytest.approx(8.578949178729, abs=1e-9)
    assert over == pytest.approx(19 * np.sqrt(2 / 9.81), rel=1e-12)
    assert 0 <= remainder < 1e-9
    np.testing.assert_allclose(ball.rests[0], [over, 20.0], rtol=1e-15)
    assert ball.state.resting
    assert np.all(np.abs(ball.at(np.linspace(over, 20, 50))) < 1e-15)
    assert_finite(ball)


def test_a_free_mass_driven_drifts_as_its_closed_form() -> None:
    system, drive, F = one(0.0, load=0.7, gap=100.0), vibeam.Drive(3.0, 0.2), 0.7 * 9 * 0.2
    path = vibeam.simulate(system, drive, 40.0, state([-0.3], [0.1]))
    t = np.linspace(0, 40.0, 301)
    expected = -0.3 + (0.1 + F / 3) * t - F / 9 * np.sin(3 * t)
    np.testing.assert_allclose(path.at(t), expected, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(path.velocity_at(t), 0.1 + F / 3 * (1 - np.cos(3 * t)), rtol=1e-12, atol=1e-13)
    assert len(path.impact_times) == 0


def test_a_driven_ball_bounces_exactly() -> None:
    """A ball on a shaken table."""
    system, drive = one(0.0, static=9.81, restitution=0.5), vibeam.Drive(20.0, 0.03)
    assert_exact(system, drive, state([-0.2], [0.0]), 12)


def test_a_free_mass_beside_a_stiff_mode() -> None:
    system = vibeam.ImpactSystem.from_modes(
        [0.0, 25.0], [0.0, 0.02], [1.0, 0.7], [1.0, 0.3], static=[2.0, 0.0], restitution=0.8, gap=0.1
    )
    assert_exact(system, vibeam.Drive(5.0, 0.05), state([-0.5, 0.0], [0.0, 0.0]), 10)


# ------------------------------------------------------------------------------------------------ damping

DAMPING = [0.0, 1 - 1e-9, 1 - 1e-12, 1.0, 1 + 1e-12, 1 + 1e-9, 50.0]


@pytest.mark.parametrize("zeta", DAMPING)
def test_free_decay_at_every_damping(zeta: float) -> None:
    path = vibeam.simulate(one(2.0, zeta, gap=10.0), NONE, 8.0, state([-0.7], [1.3]))
    for t in (1e-9, 0.01, 0.5, 3.0, 8.0):
        x, v = integral_form(2.0, zeta, lambda s: mpf(0), -0.7, 1.3, t)
        assert path.at(t) == pytest.approx(x, rel=1e-12, abs=1e-15)
        assert path.velocity_at(t) == pytest.approx(v, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("zeta", DAMPING)
def test_driven_impacts_at_every_damping(zeta: float) -> None:
    """Drawn against the stop by a load, so that even ζ = 50 strikes."""
    system = one(2.0, zeta, static=1.0, gap=0.1, restitution=0.6)
    drive = vibeam.Drive(3.1, 0.9 if zeta < 10 else 12.0)
    assert_exact(system, drive, state([-0.4], [0.2]), 6)


def test_damping_regimes_side_by_side() -> None:
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 3.0, 5.0, 8.0], [0.02, 1.0, 1 + 1e-12, 50.0], [1.0, -0.5, 0.4, 0.6], [1.0, 0.5, 0.3, 0.2],
        gap=0.05, restitution=0.7, static=[0.3, 0.0, 0.0, 0.0],
    )  # fmt: skip
    assert_exact(system, vibeam.Drive(1.7, 0.4), state([-0.3, 0.0, 0.0, 0.0], [0.1, 0.0, 0.0, 0.0]), 8)


# ------------------------------------------------------------------------------------------------ resonance


def test_undamped_resonance_grows_as_its_closed_form_and_then_strikes() -> None:
    """q = (F/2ω²)(sin ωt − ωt cos ωt) until the first contact."""
    w, B, gap = 1.7, 0.01, 0.12
    system, drive, start = one(w, gap=gap, restitution=0.8), vibeam.Drive(w, B), state([0.0], [0.0])
    path = assert_exact(system, drive, start, 12)
    t = np.linspace(0, path.impact_times[0], 400)
    expected = B / 2 * (np.sin(w * t) - w * t * np.cos(w * t))
    assert expected.max() == pytest.approx(gap, rel=1e-12)
    assert path.impact_times[0] > 4 * 2 * np.pi / w
    np.testing.assert_allclose(path.at(t), expected, rtol=1e-12, atol=1e-14 * gap)


@pytest.mark.parametrize("off", [1e-9, -1e-9, 1e-12, 1e-6, 4e-4, 6e-4, 1e-3])
@pytest.mark.parametrize("zeta", [0.0, 1e-9, 4e-4])
def test_near_resonance(off: float, zeta: float) -> None:
    """Where the steady response is a thousand times the motion, taking it out costs up to three digits of sixteen."""
    w = 1.7
    system, drive = one(w, zeta, gap=0.12, restitution=0.8), vibeam.Drive(w * (1 + off), 0.01)
    path = assert_exact(system, drive, state([0.0], [0.0]), 8, digits_lost=1)
    t = path.impact_times[0] * 0.9
    motion = exact_motion(system, drive, state([0.0], [0.0]))
    motion.run(t_end=t)
    assert path.at(t) == pytest.approx(float(motion.state().displacement[0]), rel=1e-11)
    assert path.velocity_at(t) == pytest.approx(float(motion.state().velocity[0]), rel=1e-11)


def test_resonance_of_one_mode_among_three() -> None:
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 2.3, 6.1], [0.05, 0.0, 0.03], [1.0, 0.5, -0.4], [1.0, 0.2, 0.3], gap=0.15, restitution=0.7
    )
    assert_exact(system, vibeam.Drive(2.3, 0.02), state([-0.1, 0.0, 0.0], [0.0, 0.0, 0.0]), 8)


def test_resonance_without_a_load_is_none() -> None:
    system = one(2.0, load=0.0, gap=0.1, restitution=0.9)
    here, there = (vibeam.simulate(system, vibeam.Drive(2.0, B), 30.0, state([-0.5], [0.0])) for B in (0.0, 1.0))
    assert len(here.impact_times) > 5
    np.testing.assert_array_equal(here.impact_times, there.impact_times)


@pytest.mark.parametrize(("ratio", "count"), [(1e-4, 4), (1e-2, 4), (1e2, 4), (1e3, 2)])
def test_a_drive_far_from_all_modes(ratio: float, count: int) -> None:
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 2.3], [0.05, 0.3], [1.0, 0.4], [1.0, 0.5], gap=0.05, restitution=0.9, static=[0.2, 0.0]
    )
    drive = vibeam.Drive(ratio, 0.02 / ratio**2 if ratio < 1 else 0.5 / ratio)
    assert_exact(system, drive, state([-0.6, 0.1], [0.0, 0.3]), count)


@pytest.mark.parametrize("ratio", [1e-4, 1e4])
def test_a_drive_far_from_the_mode_in_closed_form(ratio: float) -> None:
    drive = vibeam.Drive(ratio, 0.02 / ratio**2)
    path = vibeam.simulate(one(1.0, 0.05, gap=10.0), drive, 2.0, state([-0.6], [0.1]))
    F = mpf(drive.omega) ** 2 * mpf(drive.amplitude)
    with mpmath.workdps(30):
        w, z, W, t = mpf(1), mpf(0.05), mpf(ratio), mpf(2)
        response = F / (w * w - W * W + 2j * z * w * W)
        x, v = mpf(-0.6) - mpmath.im(response), mpf(0.1) - W * mpmath.re(response)
        own = w * mpmath.sqrt(1 - z * z)
        free = mpmath.exp(-z * w * t) * (x * mpmath.cos(own * t) + (v + z * w * x) / own * mpmath.sin(own * t))
        expected = float(free + mpmath.im(response * mpmath.expj(W * t)))
    assert path.at(2.0) == pytest.approx(expected, rel=1e-12)


def test_no_drive_has_many_spellings() -> None:
    system = vibeam.ImpactSystem.from_modes([1.0, 3.3], 0.01, [1.0, 0.6], [1.0, 0.5], gap=0.1, restitution=0.9)
    start = state([-0.8, 0.1], [0.0, 0.0])
    drives = [vibeam.Drive(0.0, 0.0), vibeam.Drive(0.0, 5.0), vibeam.Drive(2.0, 0.0), vibeam.Drive(3.3, 0.0)]
    first, *others = [vibeam.simulate(system, drive, 60.0, start) for drive in drives]
    assert len(first.impact_times) > 8
    for path in others:
        np.testing.assert_allclose(path.impact_times, first.impact_times, rtol=1e-12)
        np.testing.assert_allclose(path.impact_velocities, first.impact_velocities, rtol=1e-11)
        assert_finite(path)


@pytest.mark.parametrize("numbers", [(2, 1), (2.0, 1), (2, 1.0)])
def test_whole_numbers_are_numbers(numbers: tuple[float, float], monkeypatch: pytest.MonkeyPatch) -> None:
    """A drive given in whole numbers must not have the kernels compiled for them."""
    seen = []

    def spy(engine: object, omega: object, amplitude: object, *rest: object) -> None:
        seen.extend([type(omega), type(amplitude)])
        raise InterruptedError

    monkeypatch.setattr(FlightSolver, "_move", staticmethod(spy))
    with pytest.raises(InterruptedError):
        vibeam.simulate(one(1.0), vibeam.Drive(*numbers), 10)
    with pytest.raises(InterruptedError):
        vibeam.sweep(one(1.0), omega=[numbers[0]], amplitude=numbers[1])
    assert all(issubclass(kind, float) for kind in seen), seen


# ------------------------------------------------------------------------------------------------ pressed stops


def test_pressed_and_undriven_it_stays_for_ever() -> None:
    path = vibeam.simulate(one(1.5, 0.02, gap=-0.3, restitution=0.7), NONE, 1e4)
    assert path.ended is COMPLETE
    assert path.state.resting
    assert len(path.impact_times) == 0
    np.testing.assert_array_equal(path.rests, [[0.0, 1e4]])
    np.testing.assert_allclose(path.at(np.linspace(0, 1e4, 11)), -0.3, rtol=1e-15)


def test_pressed_and_driven_weakly_it_stays() -> None:
    """Ω²B = 0.999 ω²|gap|."""
    w, gap, W = 1.5, -0.3, 2.2
    drive = vibeam.Drive(W, 0.999 * w**2 * abs(gap) / W**2)
    path = vibeam.simulate(one(w, 0.02, gap=gap, restitution=0.7), drive, 500.0)
    assert path.state.resting
    assert len(path.impact_times) == 0
    np.testing.assert_array_equal(path.rests, [[0.0, 500.0]])


@pytest.mark.parametrize("excess", [1 + 1e-9, 1.001, 1.5, 20.0])
def test_pressed_and_driven_strongly_it_leaves_when_the_force_vanishes(excess: float) -> None:
    """sin Ωt = −ω²|gap|/Ω²B, past half a period."""
    w, gap, W = 1.5, -0.3, 2.2
    drive = vibeam.Drive(W, excess * w**2 * abs(gap) / W**2)
    share = w**2 * abs(gap) / (W**2 * drive.amplitude)
    release = (np.pi + np.arcsin(share)) / W
    path = vibeam.simulate(one(w, 0.02, gap=gap, restitution=0.7), drive, 3.0)
    # near the force's turning point its zero is as blurred as the root of round-off
    assert path.rests[0] == pytest.approx([0.0, release], abs=1e-13 / np.sqrt(1 - share**2))
    assert path.at(release + 0.01) < gap or excess < 1.001
    assert_finite(path)


def test_a_pressed_beam_rests_by_default_at_its_static_equilibrium() -> None:
    system = vibeam.ImpactSystem.from_modes([1.0, 4.0], 0.01, [1.0, 0.7], [1.0, 0.2], gap=-0.1, static=[0.3, 0.5])
    path = vibeam.simulate(system, NONE, 1000.0)
    assert path.state.resting
    assert len(path.impact_times) == 0
    times = np.linspace(0, 1000.0, 37)
    np.testing.assert_allclose(path.at(times), -0.1, rtol=1e-13)
    np.testing.assert_allclose(path.velocity_at(times), 0, atol=1e-14)
    x = path.modes_at(500.0)[0]
    force = (system.static - system.omega**2 * x) / system.contact  # all modes feel one and the same contact force
    assert force[0] == pytest.approx(force[1], rel=1e-12)
    assert force[0] > 0


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


def test_an_open_gap_starts_in_the_static_equilibrium() -> None:
    system = vibeam.ImpactSystem.from_modes([1.0, 4.0], 0.01, [1.0, 0.7], [1.0, 0.2], gap=1.0, static=[0.3, 0.5])
    path = vibeam.simulate(system, NONE, 100.0)
    np.testing.assert_allclose(path.at(np.linspace(0, 100, 9)), 0.3 + 0.7 * 0.5 / 16, rtol=1e-13)
    assert not path.state.resting


# ------------------------------------------------------------------------------------------------ R = 0 and R = 1


def test_no_restitution_on_a_pressed_stop_is_one_impact_and_rest() -> None:
    path = vibeam.simulate(one(2.0, gap=-0.1, restitution=0.0), NONE, 50.0, state([-0.6], [0.0]))
    when = np.arccos(1 / 6) / 2
    assert path.impact_times == pytest.approx([when], rel=1e-13)
    assert path.impact_velocities == pytest.approx([0.6 * 2 * np.sqrt(1 - 1 / 36)], rel=1e-13)
    assert path.rests == pytest.approx(np.array([[when, 50.0]]), rel=1e-13)
    assert path.state.resting
    assert path.state.velocity[0] == 0
    assert path.state.displacement[0] == pytest.approx(-0.1, rel=1e-15)


def test_no_restitution_on_an_open_stop_leaves_from_standstill() -> None:
    """One impact; then it swings from the stop and back, and touches no more."""
    path = vibeam.simulate(one(2.0, 0.01, gap=0.1, restitution=0.0), NONE, 50.0, state([-0.6], [0.0]))
    assert len(path.impact_times) == 1
    assert len(path.rests) == 0
    t = np.linspace(0, 3.0, 40)
    w = 2 * np.sqrt(1 - 1e-4)
    expected = 0.1 * np.exp(-0.02 * t) * (np.cos(w * t) + 0.02 / w * np.sin(w * t))
    np.testing.assert_allclose(path.at(path.impact_times[0] + t), expected, atol=1e-14)


def test_no_restitution_driven_strikes_rests_and_leaves_again() -> None:
    system, drive, start = one(1.0, 0.05, gap=-0.2, restitution=0.0), vibeam.Drive(0.9, 1.1), state([-0.9], [0.0])
    path = assert_exact(system, drive, start, 6)
    motion = exact_motion(system, drive, start)
    motion.run(t_end=path.impact_times[-1])
    released = [float(event.time) for event in motion.events if event.kind == "release"]
    assert len(released) >= 3
    found = path.rests[np.diff(path.rests)[:, 0] > 1e-9, 1]
    np.testing.assert_allclose(found[: len(released)], released, rtol=1e-11)


def test_full_restitution_on_a_pressed_stop_ends_at_the_limit() -> None:
    system = one(1.0, gap=-0.5, restitution=1.0)
    path = vibeam.simulate(system, NONE, 1e9, state([-0.5], [-1e-3]), max_impacts=5000)
    assert path.ended is vibeam.Ended.EVENT_LIMIT
    assert len(path.chatters) == 0
    np.testing.assert_allclose(path.impact_velocities, 1e-3, rtol=1e-9)
    np.testing.assert_allclose(np.diff(path.impact_times), 2 * np.arctan(2e-3), rtol=1e-9)


def test_bounces_of_full_restitution_too_small_to_see_are_held_and_said_so() -> None:
    """Bounces of v²/2a = 1e-12 m on a pressed stop go on for ever; held, they leave out ½v²/S of energy."""
    system = one(1.0, gap=-0.5, restitution=1.0)
    path = vibeam.simulate(system, NONE, 1e9, state([-0.5], [-1e-6]), max_impacts=5000)
    assert path.ended is vibeam.Ended.COMPLETE
    assert path.left_out.shape[0] == 1
    assert path.left_out[0, 1:] == pytest.approx(0.5e-12, rel=1e-6, abs=0)


def test_full_restitution_on_a_shaken_pressed_stop_ends_at_the_limit() -> None:
    system, drive = one(1.0, gap=-0.5, restitution=1.0), vibeam.Drive(0.8, 0.2)
    path = vibeam.simulate(system, drive, 1e9, state([-0.5], [-1e-3]), max_impacts=5000)
    assert path.ended is vibeam.Ended.EVENT_LIMIT
    assert path.at(np.linspace(0, path.t_end, 5001)).max() <= -0.5 + 1e-14


# ------------------------------------------------------------------------------------------------ many modes


def forty_modes(**rest: Any) -> vibeam.ImpactSystem:
    rng = np.random.default_rng(40)
    ratios = np.geomspace(1.0, 1e4, 40)
    return vibeam.ImpactSystem.from_modes(
        ratios, rng.uniform(0.001, 0.1, 40), rng.normal(size=40) / ratios**0.6, rng.normal(size=40), **rest
    )


def test_forty_modes_over_four_decades() -> None:
    """Energy falls, from flight to flight and at impacts, and the gap stays open."""
    system = forty_modes(gap=0.05, restitution=0.8)
    start = vibeam.State(-0.3 * system.contact / system.omega**2, np.zeros(40))
    path = vibeam.simulate(system, NONE, 20.0, start)
    assert path.ended is COMPLETE
    assert len(path.impact_times) > 5
    times = np.unique(np.concatenate([np.linspace(0, 20, 4001), path.impact_times, path.impact_times[:-1] + 1e-5]))
    modes = path.modes_at(times)
    energy = np.sum(modes[:, 1] ** 2 + (system.omega * modes[:, 0]) ** 2, axis=1) / 2
    assert np.diff(energy).max() <= 1e-13 * energy[0]
    assert energy[-1] < 0.9 * energy[0]
    assert path.at(times).max() <= 0.05 + 1e-14
    assert_finite(path)


def test_forty_modes_strike_when_they_should() -> None:
    """All 40 modes are thrown at the stop, and pressed against it."""
    system = forty_modes(gap=0.002, restitution=0.8)
    system = replace(system, static=30 * system.contact)
    start = vibeam.State(np.zeros(40), 0.5 * system.contact / (system.contact @ system.contact))
    expected, bar = impacts_and_bar(system, vibeam.Drive(1.9, 0.02), start, count=6, t_end=0.1)
    path = vibeam.simulate(system, vibeam.Drive(1.9, 0.02), expected[-1, 0] * (1 + 1e-9), start)
    assert len(path.impact_times) == len(expected) == 6
    assert bar.max() < 1e-8
    assert np.all(np.abs(path.impact_times - expected[:, 0]) <= bar * expected[:, 0])
    assert np.all(np.abs(path.impact_velocities - expected[:, 1]) <= bar * expected[:, 1].max())


# ------------------------------------------------------------------------------------------------ starts


def test_on_the_stop_moving_away() -> None:
    """No impact at the start, the next one half a period later."""
    path = vibeam.simulate(one(2.0, gap=0.0, restitution=0.8), NONE, 3.0, state([0.0], [-1.0]))
    assert path.impact_times == pytest.approx([np.pi / 2], rel=1e-14)
    assert path.impact_velocities == pytest.approx([1.0], rel=1e-14)


@pytest.mark.parametrize("gap", [0.3, 0.0, -0.3])
def test_on_the_stop_moving_in(gap: float) -> None:
    """The impact is at once."""
    path = vibeam.simulate(one(2.0, gap=gap, restitution=0.8), NONE, 0.2, state([gap], [1.0]))
    assert path.impact_times[0] == 0.0
    assert path.impact_velocities[0] == 1.0
    assert path.velocity_at(1e-9) == pytest.approx(-0.8, abs=1e-8)
    assert path.at(0.05) < gap


def test_on_an_open_stop_standing_still_it_swings_away() -> None:
    path = vibeam.simulate(one(2.0, 0.01, gap=0.3, restitution=0.8), NONE, 20.0, state([0.3], [0.0]))
    assert len(path.impact_times) == len(path.rests) == 0
    w = 2 * np.sqrt(1 - 1e-4)
    t = np.linspace(0, 20, 81)
    expected = 0.3 * np.exp(-0.02 * t) * (np.cos(w * t) + 0.02 / w * np.sin(w * t))
    np.testing.assert_allclose(path.at(t), expected, atol=1e-14)


@pytest.mark.parametrize("resting", [False, True])
@pytest.mark.parametrize("gap", [0.0, -0.3])
def test_on_a_pressed_stop_standing_still_it_rests(gap: float, resting: bool) -> None:
    path = vibeam.simulate(one(2.0, gap=gap, restitution=0.8), NONE, 20.0, state([gap], [0.0], resting))
    assert len(path.impact_times) == 0
    assert path.state.resting
    np.testing.assert_array_equal(path.rests, [[0.0, 20.0]])


def test_said_to_rest_but_drawn_away_it_leaves() -> None:
    path = vibeam.simulate(one(2.0, gap=0.3, restitution=0.8), NONE, 5.0, state([0.3], [0.0], True))
    np.testing.assert_allclose(path.at(np.linspace(0, 3, 20)), 0.3 * np.cos(2 * np.linspace(0, 3, 20)), atol=1e-14)


@pytest.mark.parametrize("resting", [False, True])
@pytest.mark.parametrize("push", [1.0, -1.0])
def test_a_neutral_stop_under_a_drive_that_starts_from_zero(push: float, resting: bool) -> None:
    """At t = 0 force and velocity vanish: the drive's first rise decides."""
    system, drive = one(1.0, 0.03, load=push, gap=0.0, restitution=0.6), vibeam.Drive(2.3, 0.1)
    expected = exact_impacts(system, drive, state([0.0], [0.0], resting=True), count=5, t_end=100.0)
    path = vibeam.simulate(system, drive, expected[-1, 0] + 1e-6, state([0.0], [0.0], resting))
    np.testing.assert_allclose(path.impact_times, expected[:, 0], rtol=1e-11)
    np.testing.assert_allclose(path.impact_velocities, expected[:, 1], rtol=1e-11)
    released = np.pi / 2.3 if push > 0 else 0.0
    assert len(path.rests) == (push > 0)
    assert np.all(np.abs(path.rests - [[0.0, released]]) < 1e-13)


@pytest.mark.parametrize("beyond", [1e-9, 1e-3, 5.0])
@pytest.mark.parametrize("velocity", [-1.0, 0.0, 1.0])
def test_a_start_beyond_the_stop_is_refused(beyond: float, velocity: float) -> None:
    start = state([0.3 + beyond], [velocity])
    path = vibeam.simulate(one(2.0, 0.01, gap=0.3), vibeam.Drive(1.0, 0.1), 20.0, start)
    assert path.ended is vibeam.Ended.PENETRATED
    assert path.t_end == 0.0
    assert len(path.impact_times) == 0
    assert path.state.displacement == start.displacement
    assert path.state.velocity == start.velocity
    assert path.at(0.0) == start.displacement[0]
    assert_finite(path)


@pytest.mark.parametrize("beyond", [1e-16, -1e-16])
def test_round_off_at_the_stop_is_no_penetration(beyond: float) -> None:
    for velocity in (-1.0, 0.0, 1.0):
        path = vibeam.simulate(one(2.0, 0.01, gap=0.3), NONE, 5.0, state([0.3 * (1 + 3 * beyond)], [velocity]))
        assert path.ended is COMPLETE


def test_no_time_at_all() -> None:
    path = vibeam.simulate(one(2.0, gap=0.3), vibeam.Drive(1.0, 0.1), 4.0, state([0.1], [0.7]), t_start=4.0)
    assert path.ended is COMPLETE
    assert path.t_end == 4.0
    assert len(path.impact_times) == len(path.rests) == 0
    assert (path.state.displacement, path.state.velocity) == ([0.1], [0.7])
    assert path.at(4.0) == 0.1
    assert path.velocity_at(4.0) == 0.7


def test_growth_beyond_all_bounds_is_said() -> None:
    path = vibeam.simulate(one(2.0, gap=0.3), NONE, 20.0, state([-1e308], [-1e308]))
    assert path.ended is vibeam.Ended.NOT_FINITE


# ------------------------------------------------------------------------------------------------ errors


def test_times_outside_the_motion_and_unknown_outputs_are_refused() -> None:
    path = vibeam.simulate(one(1.0, outputs={"sensor": 0.5}), NONE, 10.0, t_start=5.0)
    for t in (4.999, 10.001, [6.0, np.nan]):
        with pytest.raises(ValueError, match="t:"):
            path.at(t)
    with pytest.raises(KeyError, match="sensor"):
        path.at(6.0, "senser")
    assert path.at(np.full((2, 3), 6.0), "sensor").shape == (2, 3)
