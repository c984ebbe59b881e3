"""What no motion may break: energy, the stop itself, and the symmetries of the equations."""

from __future__ import annotations

from dataclasses import replace

import mpmath
import numpy as np
import pytest

import vibeam

EPSILON = np.finfo(float).eps
NONE = vibeam.Drive(0.0, 0.0)
PULL = vibeam.Drive(1.9, 0.05)


def three_modes(**change: object) -> vibeam.ImpactSystem:
    """Regular under PULL: what is nudged comes back."""
    given = {
        "omega": [1.0, 3.3, 7.1], "zeta": [0.05, 0.03, 0.04], "contact": [1.0, -0.6, 0.3], "load": [1.0, 0.4, -0.2],
        "gap": 0.02, "restitution": 0.7, "static": [0.005, 0.0, 0.01], "outputs": {"sensor": [0.3, 0.5, -0.2]},
    }  # fmt: skip
    return vibeam.ImpactSystem.from_modes(**{**given, **change})


def state(displacement: list[float], velocity: list[float]) -> vibeam.State:
    return vibeam.State(np.array(displacement), np.array(velocity))


START = state([-0.05, 0.01, 0.0], [0.02, 0.0, 0.01])


def same(a: np.ndarray, b: np.ndarray, bar: float = 1e-12) -> None:
    np.testing.assert_allclose(a, b, rtol=bar, atol=bar * np.abs(b).max(initial=0.0))


def same_motion(a: vibeam.Trajectory, b: vibeam.Trajectory, bar: float = 1e-12) -> None:
    assert len(a.impact_times) == len(b.impact_times) > 20
    same(a.impact_times, b.impact_times, bar)
    same(a.impact_velocities, b.impact_velocities, bar)


# ------------------------------------------------------------------------------------------------ energy


def energy(system: vibeam.ImpactSystem, modes: np.ndarray) -> np.ndarray:
    x, v = modes[..., 0, :], modes[..., 1, :]
    return np.sum(v**2 / 2 + (system.omega * x) ** 2 / 2 - system.static * x, axis=-1)


CONSERVATIVE = {
    "one mode": ([2.0], [1.0], 0.3, None, state([-1.0], [0.3])),
    "one mode, pressed": ([2.0], [1.0], -0.3, None, state([-1.0], [0.3])),
    "a ball": ([0.0], [1.0], 0.0, [9.81], state([-1.0], [0.0])),
    "three modes": (
        [1.0, np.sqrt(7.3), np.pi * 1.7], [1.0, -0.6, 0.4], 0.3, None, state([-1.0, 0.1, 0.05], [0.1, 0.7, -0.2]),
    ),
    "five modes under a load": (
        [1.0, np.sqrt(5.0), np.e * 1.3, np.pi * 2.1, 11.7], [1.0, -0.6, 0.4, 0.3, -0.2], 0.1,
        [0.2, 0.1, 0.0, 0.0, -0.3], state([-1.0, 0.1, 0.05, 0.0, 0.01], [0.1, 0.7, -0.2, 0.3, 0.2]),
    ),
}  # fmt: skip


def conserved(name: str, limit: int) -> tuple[vibeam.Trajectory, vibeam.State]:
    """A motion that loses nothing, up to its ``limit`` of impacts, and its start."""
    omega, contact, gap, static, start = CONSERVATIVE[name]
    system = vibeam.ImpactSystem.from_modes(omega, 0.0, contact, 0.0, gap=gap, restitution=1.0, static=static)
    path = vibeam.simulate(system, NONE, 1e6, start, max_impacts=limit)
    assert path.ended is vibeam.Ended.EVENT_LIMIT
    return path, start


@pytest.mark.parametrize("name", CONSERVATIVE)
def test_energy_is_kept_over_ten_thousand_impacts(name: str) -> None:
    """To 1e-12 with one mode; with more, Σ contact² is rounded once for all impacts: an ulp or two each, one way."""
    path, start = conserved(name, 10_000)
    system = path.system
    assert len(path.impact_times) >= 10_000
    times = np.concatenate([path.impact_times[:-1:10], np.linspace(0, path.impact_times[-2], 2000)])
    held = energy(system, path.modes_at(times))
    first = energy(system, np.array([start.displacement, start.velocity]))
    assert np.abs(held / first - 1).max() < (1e-12 if system.size == 1 else 2 * EPSILON * 10_000)


def test_all_of_a_motion_that_was_cut_short_can_be_looked_at() -> None:
    for limit in range(1, 2000, 7):
        path, _ = conserved("one mode", limit)
        assert path.impact_times[-1] <= path.t_end
        np.testing.assert_allclose(
            path.at(path.impact_times), path.system.gap, atol=1e-15 * path.t_end * path.impact_velocities.max()
        )


@pytest.mark.parametrize("limit", [1, 2, 10, 256, 257, 1000])
def test_the_limit_is_the_number_of_impacts(limit: int) -> None:
    path, _ = conserved("one mode", limit)
    assert len(path.impact_times) == path.stats["impacts"] == limit


def test_energy_would_be_seen_to_go() -> None:
    system = vibeam.ImpactSystem.from_modes(2.0, 1e-12, 1.0, 0.0, gap=0.3)
    path = vibeam.simulate(system, NONE, 1e6, state([-1.0], [0.3]), max_impacts=10_000)
    held = energy(system, path.modes_at(path.impact_times[:-1]))
    assert abs(held[-1] / held[0] - 1) > 1e-9


def test_an_impact_takes_its_share_of_the_contact_energy() -> None:
    """½(1 − R²) v²/S, with S = Σ contact²."""
    system = three_modes(zeta=0.0, static=None)
    path = vibeam.simulate(system, NONE, 40.0, START)
    hits, speeds = path.impact_times, path.impact_velocities
    assert len(hits) > 5
    # energy is constant in flight: read it off half-way
    middle = (np.r_[0.0, hits[:-1]] + hits) / 2
    held = energy(system, path.modes_at(np.r_[middle, (hits[-1] + 40.0) / 2]))
    lost = (1 - system.restitution**2) * speeds**2 / (2 * system.contact @ system.contact)
    np.testing.assert_allclose(-np.diff(held), lost, rtol=1e-9, atol=1e-14 * held[0])


def test_energy_never_grows_with_damping_and_no_drive() -> None:
    system = three_modes(zeta=[0.001, 0.01, 1.5], restitution=0.95, static=None)
    path = vibeam.simulate(system, NONE, 200.0, START)
    held = energy(system, path.modes_at(np.linspace(0, 200.0, 4001)))
    assert np.diff(held).max() <= 1e-14 * held[0]


# ------------------------------------------------------------------------------------------------ the stop


@pytest.mark.parametrize("gap", [0.05, 0.0, -0.01])
@pytest.mark.parametrize("restitution", [0.0, 0.4, 0.9, 1.0])
def test_the_gap_is_never_negative(gap: float, restitution: float) -> None:
    system = three_modes(gap=gap, restitution=restitution)
    start = replace(START, displacement=np.array([-0.1, 0.01, 0.0]))
    path = vibeam.simulate(system, PULL, 60.0, start)
    assert path.ended is vibeam.Ended.COMPLETE
    assert len(path.impact_times) > 5
    hits = path.impact_times
    near = np.concatenate([hits * (1 + sign * 10.0**-k) for sign in (-1, 1) for k in (3, 6, 9)])
    times = np.concatenate([np.linspace(0, 60.0, 60_001), near[near < 60.0], hits])
    size = np.abs(path.modes_at(times)[:, 0, :] * system.contact).sum(axis=1).max()
    assert path.at(times).max() - gap <= 32 * EPSILON * size
    # just before an impact the contact point is under way to the stop, just after it is not
    fast = path.impact_velocities > 1e-6
    assert np.all(path.velocity_at(hits[fast] * (1 + 1e-13)) <= 1e-9)


def test_velocity_jumps_by_restitution_and_only_there() -> None:
    system = three_modes()
    path = vibeam.simulate(system, PULL, 60.0, START)
    hits, speeds = path.impact_times, path.impact_velocities
    step = 1e-9
    np.testing.assert_allclose(path.velocity_at(hits - step), speeds, atol=1e-6 * speeds.max())
    np.testing.assert_allclose(path.velocity_at(hits + step), -0.7 * speeds, atol=1e-6 * speeds.max())
    silent = np.linspace(0, 60.0, 4001)[1:-1]
    silent = silent[np.abs(silent[:, None] - hits).min(axis=1) > 1e-4]
    slope = (path.at(silent + 1e-5) - path.at(silent - 1e-5)) / 2e-5
    np.testing.assert_allclose(path.velocity_at(silent), slope, atol=1e-7)


# ------------------------------------------------------------------------------------------------ symmetries


@pytest.mark.parametrize("share", [1e-6, 0.1, 0.37, 0.5, 0.811, 1 - 1e-6])
def test_splitting_the_time_changes_nothing(share: float) -> None:
    system, end = three_modes(), 80.0
    whole = vibeam.simulate(system, PULL, end, START)
    first = vibeam.simulate(system, PULL, share * end, START)
    second = vibeam.simulate(system, PULL, end, first.state, t_start=share * end)
    assert first.t_end == second.t_start == share * end
    times = np.concatenate([first.impact_times, second.impact_times])
    speeds = np.concatenate([first.impact_velocities, second.impact_velocities])
    assert len(times) == len(whole.impact_times) > 20
    same(times, whole.impact_times)
    same(speeds, whole.impact_velocities)
    same(second.state.displacement, whole.state.displacement)
    same(second.state.velocity, whole.state.velocity)
    late = np.linspace(share * end, end, 500)
    size = np.abs(whole.at(late, "sensor")).max()
    np.testing.assert_allclose(second.at(late, "sensor"), whole.at(late, "sensor"), atol=1e-12 * size)


def test_splitting_during_a_rest() -> None:
    system = three_modes(gap=-0.02, restitution=0.5)
    whole = vibeam.simulate(system, PULL, 30.0, START)
    begin, end = whole.rests[np.argmax(np.diff(whole.rests))]
    assert end - begin > 0.1
    middle = (begin + end) / 2
    first = vibeam.simulate(system, PULL, middle, START)
    assert first.state.resting
    second = vibeam.simulate(system, PULL, 30.0, first.state, t_start=middle)
    assert second.rests[0, 0] == middle
    assert second.rests[0, 1] == pytest.approx(end, rel=1e-13)
    late = whole.impact_times[whole.impact_times > middle]
    same(second.impact_times, late, 1e-11)


@pytest.mark.parametrize("periods", [1, 7, 1000, 100_000])
def test_a_shift_by_whole_periods_changes_nothing(periods: int) -> None:
    """As far as the shifted times, in doubles, are whole periods later."""
    system, end = three_modes(), 80.0
    shift = periods * 2 * np.pi / PULL.omega
    here = vibeam.simulate(system, PULL, end, START)
    there = vibeam.simulate(system, PULL, end + shift, START, t_start=shift)
    bar = 1e-12 + 8 * EPSILON * shift
    assert len(here.impact_times) == len(there.impact_times) > 20
    np.testing.assert_allclose(there.impact_times - shift, here.impact_times, atol=bar)
    same(there.impact_velocities, here.impact_velocities, 10 * bar)


@pytest.mark.parametrize("periods", [100, 100_000])
def test_the_drives_phase_stays_exact(periods: int) -> None:
    """The steady motion after very many periods, to the last digits of the double that the time is."""
    system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, gap=1.0)
    drive, late = vibeam.Drive(1.9, 0.05), periods * 2 * np.pi / 1.9 + np.linspace(0, 3, 7)
    response = drive.omega**2 * 0.05 / (1 - drive.omega**2 + 2j * 0.05 * drive.omega)
    path = vibeam.simulate(system, drive, late[-1], state([response.imag], [drive.omega * response.real]))
    assert len(path.impact_times) == 0
    with mpmath.workdps(30):
        turns = [mpmath.expj(mpmath.mpf(drive.omega) * mpmath.mpf(t)) for t in late]
        expected = [float(mpmath.im(mpmath.mpmathify(response) * turn)) for turn in turns]
    np.testing.assert_allclose(path.at(late), expected, atol=1e-13 * abs(response))


@pytest.mark.parametrize(("length", "time"), [(2.0**-20, 2.0**7), (1.0, 2.0**-9), (1e-3, 3.7), (1e6, 1e-4)])
def test_units(length: float, time: float) -> None:
    """All lengths × length and all times × time: the same motion, to the bit for powers of two."""
    system, end = three_modes(), 80.0
    here = vibeam.simulate(system, PULL, end, START)
    other = replace(system, omega=system.omega / time, static=system.static * length / time**2, gap=system.gap * length)
    start = vibeam.State(START.displacement * length, START.velocity * length / time)
    drive = vibeam.Drive(PULL.omega / time, PULL.amplitude * length)
    there = vibeam.simulate(other, drive, end * time, start)
    bar = 0.0 if np.log2(length) % 1 == np.log2(time) % 1 == 0 else 1e-12
    assert len(here.impact_times) == len(there.impact_times) > 20
    same(there.impact_times / time, here.impact_times, bar)
    same(there.impact_velocities * time / length, here.impact_velocities, bar)


@pytest.mark.parametrize("k", [3.7, np.array([1.0, -1.0, -1.0])])
def test_scale_and_sign_of_a_mode_shape_are_free(k: float | np.ndarray) -> None:
    """η → kη with contact/k, load·k, static·k leaves Σ contact² … and so the motion only where the mass follows."""
    system = three_modes()
    other = replace(
        system, contact=system.contact / k, load=system.load * k, static=system.static * k,
        outputs={"sensor": system.outputs["sensor"] / k},
    )  # fmt: skip
    start = vibeam.State(START.displacement * k, START.velocity * k)
    here, there = (vibeam.simulate(s, PULL, 80.0, x) for s, x in ((system, START), (other, start)))
    same_motion(there, here)
    times = np.linspace(0, 80.0, 200)
    same(there.at(times, "sensor"), here.at(times, "sensor"), 1e-11)


@pytest.mark.parametrize("order", [(2, 0, 1), (2, 1, 0), (1, 0, 2)])
def test_the_order_of_the_modes(order: tuple[int, ...]) -> None:
    system, turn = three_modes(), np.array(order)
    rows = {name: getattr(system, name)[turn] for name in ("omega", "zeta", "contact", "load", "static")}
    other = replace(system, **rows, outputs={"sensor": system.outputs["sensor"][turn]})
    start = vibeam.State(START.displacement[turn], START.velocity[turn])
    here, there = vibeam.simulate(system, PULL, 80.0, START), vibeam.simulate(other, PULL, 80.0, start)
    same_motion(there, here)
    same(there.state.displacement, here.state.displacement[turn], 1e-11)
    same(there.modes_at(33.3), here.modes_at(33.3)[:, turn], 1e-11)


# ------------------------------------------------------------------------------------------------ silent modes


def with_mode(omega: float, zeta: float, load: float, x: float, v: float) -> tuple[vibeam.ImpactSystem, vibeam.State]:
    """Three modes and one that the contact does not touch."""
    base = three_modes()
    rows = {
        "omega": omega, "zeta": zeta, "contact": 0.0, "load": load, "static": 0.0,
    }  # fmt: skip
    wide = {name: np.append(getattr(base, name), value) for name, value in rows.items()}
    system = replace(base, **wide, outputs={"silent": np.array([0.0, 0.0, 0.0, 1.0])})
    return system, vibeam.State(np.append(START.displacement, x), np.append(START.velocity, v))


@pytest.mark.parametrize(("omega", "zeta"), [(0.2, 0.01), (2.4, 1.0), (400.0, 3.0), (0.0, 0.0)])
def test_a_mode_that_nothing_touches_changes_nothing(omega: float, zeta: float) -> None:
    system, start = with_mode(omega, zeta, 0.0, 0.0, 0.0)
    here, there = vibeam.simulate(three_modes(), PULL, 80.0, START), vibeam.simulate(system, PULL, 80.0, start)
    same_motion(there, here)
    assert np.all(there.at(np.linspace(0, 80, 300), "silent") == 0)


def test_a_driven_mode_that_the_stop_does_not_feel() -> None:
    """Its own closed form through all impacts, and theirs as if it were not there."""
    omega, zeta, load, x, v = 2.3, 0.02, 0.8, 0.03, -0.1
    system, start = with_mode(omega, zeta, load, x, v)
    here, there = vibeam.simulate(three_modes(), PULL, 80.0, START), vibeam.simulate(system, PULL, 80.0, start)
    same_motion(there, here)
    times = np.linspace(0, 80, 801)
    response = load * PULL.omega**2 * PULL.amplitude / (omega**2 - PULL.omega**2 + 2j * zeta * omega * PULL.omega)
    own = omega * np.sqrt(1 - zeta**2)
    x, v = x - response.imag, v - PULL.omega * response.real
    free = np.exp(-zeta * omega * times) * (
        x * np.cos(own * times) + (v + zeta * omega * x) / own * np.sin(own * times)
    )
    expected = free + (response * np.exp(1j * PULL.omega * times)).imag
    np.testing.assert_allclose(there.at(times, "silent"), expected, atol=2e-13 * np.abs(expected).max())


def test_a_driven_mode_that_the_stop_does_not_feel_goes_on_through_a_rest() -> None:
    system, start = with_mode(2.3, 0.02, 0.8, 0.03, -0.1)
    system = replace(system, gap=-0.02, restitution=0.5)
    path = vibeam.simulate(system, PULL, 30.0, start)
    assert np.diff(path.rests).max() > 0.1
    alone = vibeam.ImpactSystem.from_modes(2.3, 0.02, 1.0, 0.8, gap=1.0)
    free = vibeam.simulate(alone, PULL, 30.0, state([0.03], [-0.1]))
    assert len(free.impact_times) == 0
    times = np.linspace(0, 30, 601)
    np.testing.assert_allclose(path.at(times, "silent"), free.at(times), atol=1e-12)
