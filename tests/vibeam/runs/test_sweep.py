"""The sweep: others' numbers, what is read off a point against dense sampling, periods, states, errors."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
from apart import run_apart

import vibeam
from vibeam.runs.sweep import SweepPoints, SweepSettings, march, march_blocks
from vibeam.system.response import join

NOMINAL = vibeam.ImpactSystem.from_modes(1.0, 0.015, 1.0, 1.0, gap=0.0, restitution=0.9)
B = 0.5e-3
BEAM = vibeam.ImpactSystem.from_modes(
    [1.0, 3.3, 7.1], [0.05, 0.03, 0.04], [1.0, -0.6, 0.3], [1.0, 0.4, -0.2], gap=0.02, restitution=0.7,
    static=[0.005, 0.0, 0.01], outputs={"sensor": [0.3, 0.5, -0.2]},
)  # fmt: skip
PRESSED = replace(BEAM, gap=-0.02, restitution=0.5)
# a stiff mode rings on while the soft one rests
RINGING = vibeam.ImpactSystem.from_modes([1.0, 40.0], [0.05, 0.002], [1.0, 0.5], [1.0, 0.2], gap=-0.02, restitution=0.4)
COMPLETE = vibeam.Ended.COMPLETE.code
PRIVATE = {"cpu_seconds"}


def point(
    system: vibeam.ImpactSystem, omega: float, amplitude: float, **given: object
) -> tuple[vibeam.FrequencyResponse, vibeam.State]:
    """One steady point and the state after it."""
    ((response, state),) = march(system, omega, amplitude, **given)
    assert response.ended[0] == COMPLETE
    return response, state


def held(system: vibeam.ImpactSystem, omega: float, amplitude: float, settle: int, hold: int) -> vibeam.Trajectory:
    """The motion that a point holds, on its own: its time runs on from the settling."""
    _, state = next(march(system, omega, amplitude, settle=settle - 1, hold=1))
    return vibeam.simulate(system, vibeam.Drive(omega, amplitude), hold * 2 * np.pi / omega, state)


def assert_identical(a: vibeam.FrequencyResponse, b: vibeam.FrequencyResponse) -> None:
    for field in fields(vibeam.FrequencyResponse):
        if field.name not in PRIVATE:
            np.testing.assert_array_equal(getattr(a, field.name), getattr(b, field.name), err_msg=field.name)


# ------------------------------------------------------------------------------------------------ others' numbers


def green(omega: float, beta: float, gap: float, restitution: float, drive: float, load: float) -> tuple[float, float]:
    """Impact velocity and reach of the one-impact orbit of one mode by the periodic Green's function, p < 0.

    The response to the impulse train is e^{−βωs}(a cos ws + b sin ws) with period T and a unit jump of velocity.
    """
    w, period = omega * np.sqrt(1 - beta**2), 2 * np.pi / drive
    root = -beta * omega + 1j * w
    grown = np.exp(root * period)
    rows = [[np.real(z * (1 - grown)) for z in (1, -1j)], [np.real(z * root * (1 - grown)) for z in (1, -1j)]]
    a, b = np.linalg.solve(rows, [0.0, 1.0])
    pulse = a - 1j * b
    g0, g1 = pulse.real, (pulse * root).real
    H = load / (omega**2 - drive**2 + 2j * beta * omega * drive)
    kappa = restitution / (1 + restitution) - g1
    roots = np.roots([g0**2 + (kappa / drive) ** 2, -2 * gap * g0, gap**2 - abs(H) ** 2])
    p = float(roots.real.min())
    phase = np.angle(p * kappa / drive + 1j * (gap - p * g0)) - np.angle(H)
    s = np.linspace(0, period, 200_001)
    u = (H * np.exp(1j * (phase + drive * s))).imag + p * (pulse * np.exp(root * s)).real
    return -p / (1 + restitution), gap - u.min()


def test_reach_of_the_nominal_model() -> None:
    """Δ = 0, Ω = 2: Q = 1.753002e-2."""
    found, _ = point(NOMINAL, 2.0, B, settle=400, hold=20)
    assert found.reach[0] == pytest.approx(1.753002e-2, abs=5e-9)
    assert found.period[0] == 1
    assert found.impacts_per_period[0] == 1.0


@pytest.mark.parametrize("omega", [1.7, 1.9, 2.0, 2.1, 2.3])
def test_orbits_of_the_periodic_greens_function(omega: float) -> None:
    found, _ = point(NOMINAL, omega, B, settle=700, hold=20)
    velocity, reach = green(1.0, 0.015, 0.0, 0.9, omega, omega**2 * B)
    assert found.impact_velocity[0] == pytest.approx(velocity, rel=1e-9)
    assert found.reach[0] == pytest.approx(reach, rel=1e-8)
    np.testing.assert_allclose(found.impact_velocities[0], velocity, rtol=1e-9)


LOOSE = vibeam.ImpactSystem.from_modes(1.0, 0.02, 1.0, 1.0, gap=0.0, restitution=0.8)
DEMO = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, gap=1.0, restitution=0.8)


@pytest.mark.parametrize(("amplitude", "period"), [(0.0999, -1), (0.1001, None)])
def test_the_coco_demo_grazes_at_a_tenth(amplitude: float, period: int | None) -> None:
    found, _ = point(DEMO, 1.0, amplitude, settle=400, hold=20)
    if period is None:
        assert found.period[0] != -1
        assert found.impacts_per_period[0] > 0
    else:
        assert found.period[0] == period
        assert found.maximum[0] == pytest.approx(0.999, rel=1e-8)
        assert np.isnan(found.impact_velocity[0])
        assert np.all(np.isnan(found.impact_velocities[0]))
        assert found.impacts_per_period[0] == 0


# ------------------------------------------------------------------------------------------------ what is read off


@pytest.mark.parametrize("output", ["contact", "sensor"])
@pytest.mark.parametrize(("system", "omega"), [(BEAM, 1.9), (BEAM, 0.61), (PRESSED, 0.9), (BEAM, 5.3)])
def test_extremes_are_those_of_a_dense_sampling(system: vibeam.ImpactSystem, omega: float, output: str) -> None:
    settle, hold, amplitude = 40, 6, 0.08 / omega**2
    found, _ = point(system, omega, amplitude, settle=settle, hold=hold, output=output)
    path = held(system, omega, amplitude, settle, hold)
    times = np.unique(np.concatenate([np.linspace(0, path.t_end, 200_001), path.impact_times, path.rests.ravel()]))
    values, contact = path.at(times, output), path.at(times)
    bar = 1e-7 * np.ptp(values)  # of the sampling: half a step off the crest
    assert found.maximum[0] == pytest.approx(values.max(), abs=bar)
    assert found.minimum[0] == pytest.approx(values.min(), abs=bar)
    assert found.maximum[0] >= values.max() - 1e-9 * np.ptp(values)
    assert found.minimum[0] <= values.min() + 1e-9 * np.ptp(values)
    assert found.amplitude[0] == (found.maximum[0] - found.minimum[0]) / 2
    assert found.reach[0] == pytest.approx(system.gap - contact.min(), abs=1e-7 * np.ptp(contact))


@pytest.mark.parametrize(("system", "omega"), [(BEAM, 1.9), (BEAM, 0.61), (PRESSED, 0.9), (PRESSED, 0.5)])
def test_impacts_velocities_and_rest_are_those_of_the_motion(system: vibeam.ImpactSystem, omega: float) -> None:
    settle, hold, amplitude = 40, 6, 0.08 / omega**2
    found, _ = point(system, omega, amplitude, settle=settle, hold=hold)
    path = held(system, omega, amplitude, settle, hold)
    speeds = path.impact_velocities
    assert found.impacts_per_period[0] == len(speeds) / hold > 0
    assert found.impact_velocity[0] == pytest.approx(speeds.mean(), rel=1e-9)
    kept = np.concatenate([np.full(16, np.nan), speeds])[-16:]
    np.testing.assert_allclose(found.impact_velocities[0], kept, rtol=1e-7, atol=1e-12 * speeds.max())
    share = np.diff(path.rests).sum() / path.t_end
    assert found.rest[0] == pytest.approx(share, abs=1e-7)
    assert (found.rest[0] > 0.01) == (system is PRESSED)


@pytest.mark.parametrize(
    ("system", "omega"), [(NOMINAL, 2.0), (BEAM, 1.9), (PRESSED, 0.9), (BEAM, 0.11), (RINGING, 0.9)]
)
def test_mode_energy_is_that_of_a_dense_integration(system: vibeam.ImpactSystem, omega: float) -> None:
    settle, hold, amplitude = 40, 4, 0.03 / omega**2
    found, _ = point(system, omega, amplitude, settle=settle, hold=hold)
    path = held(system, omega, amplitude, settle, hold)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    cuts = np.concatenate([[0.0, path.t_end], path.impact_times, path.rests.ravel(), np.linspace(0, path.t_end, 200)])
    cuts = np.unique(cuts.clip(0, path.t_end))
    half = np.diff(cuts)[:, None] / 2
    poses = path.modes_at((cuts[:-1, None] + half * (1 + nodes)).ravel())
    energy = (poses[:, 1] ** 2 + (system.omega * poses[:, 0]) ** 2) / 2
    expected = (half * weights).ravel() @ energy / path.t_end
    np.testing.assert_allclose(found.mode_energy[0], expected, rtol=1e-3)


def test_mode_energy_of_a_mode_at_undamped_resonance_that_nothing_drives() -> None:
    system = vibeam.ImpactSystem.from_modes([1.0, 2.0], [0.02, 0.0], [1.0, 0.5], [1.0, 0.0], gap=0.05, restitution=0.7)
    found, _ = point(system, 2.0, 0.05, settle=30, hold=4)
    assert np.all(np.isfinite(found.mode_energy))


# ------------------------------------------------------------------------------------------------ periods


def test_a_period_of_one_and_of_none() -> None:
    found = vibeam.sweep(DEMO, omega=[1.0], amplitude=1.0, settle=300, hold=40)
    assert found.period[0] == 1
    assert vibeam.sweep(DEMO, omega=[1.0], amplitude=0.05, settle=300, hold=40).period[0] == -1


def unlike(path: vibeam.Trajectory, period: float, shift: int) -> float:
    """By how much of its size the motion differs from itself ``shift`` periods later."""
    times = np.linspace(0, 8 * period, 4001)
    values = path.at(times)
    return float(np.abs(path.at(times + shift * period) - values).max() / np.ptp(values))


@pytest.mark.parametrize(("omega", "period"), [(2.0, 1), (4.0, 2), (6.0, 3), (2.88, 0)])
def test_periods_and_chaos(omega: float, period: int) -> None:
    """What is called period k repeats after k and no fewer; chaos after none of 16."""
    found, state = point(LOOSE, omega, 0.1, settle=2000, hold=60)
    assert found.period[0] == period
    path = vibeam.simulate(LOOSE, vibeam.Drive(omega, 0.1), 26 * 2 * np.pi / omega, state)
    for shift in range(1, period or 17):
        assert unlike(path, 2 * np.pi / omega, shift) > 1e-3
    if period:
        assert unlike(path, 2 * np.pi / omega, period) < 1e-4
        # impacts do not fall on the begin of a period here: 24 periods hold a whole number of every cycle
        count = len(path.impact_times[path.impact_times < 24 * 2 * np.pi / omega])
        assert found.impacts_per_period[0] == pytest.approx(count / 24, abs=1e-12)


# ------------------------------------------------------------------------------------------------ modes carried along

CARRIED = """
import numpy as np
import vibeam

system = vibeam.ImpactSystem.from_modes({omega}, 0.0, 1.0, 1.0, gap=0.0, restitution=0.5, static={static})
state = vibeam.State(np.array([-0.1]), np.array([0.0]))
found = vibeam.sweep(system, omega=[1.0], amplitude=0.1, settle=5, hold=4, state=state)
assert found.ended[0] == vibeam.Ended.COMPLETE.code
before = vibeam.simulate(system, vibeam.Drive(1.0, 0.1), 10 * np.pi, state).state
path = vibeam.simulate(system, vibeam.Drive(1.0, 0.1), 8 * np.pi, before)
values = path.at(np.concatenate([np.linspace(0, 8 * np.pi, 100_001), path.impact_times]))
assert abs(found.minimum[0] - values.min()) < 1e-8 * np.ptp(values) + 1e-12
assert abs(found.maximum[0] - values.max()) < 1e-8 * np.ptp(values) + 1e-12
"""


@pytest.mark.parametrize("static", [0.0, 0.5])
@pytest.mark.parametrize("omega", [0.0, 1.0])
def test_a_point_of_a_mode_without_a_steady_response(omega: float, static: float) -> None:
    """A free mass, and an undamped one at its resonance, at a neutral stop."""
    run_apart(CARRIED.format(omega=omega, static=static))


# ------------------------------------------------------------------------------------------------ state and order


def test_the_state_is_handed_on_from_point_to_point() -> None:
    both, _ = next(march(BEAM, [1.8, 1.9], 0.02, settle=7, hold=3, block=2))
    first, state = next(march(BEAM, 1.8, 0.02, settle=7, hold=3, slowest=1.8))
    second, _ = next(march(BEAM, 1.9, 0.02, settle=7, hold=3, slowest=1.8, state=state))
    assert_identical(both, join([first, second]))
    fresh, _ = next(march(BEAM, 1.9, 0.02, settle=7, hold=3, slowest=1.8))
    assert fresh.minimum[0] != second.minimum[0]


def test_two_sweeps_with_the_state_handed_on_are_one() -> None:
    grid = np.linspace(1.5, 2.2, 8)
    whole = vibeam.sweep(BEAM, omega=grid, amplitude=0.02, settle=60, hold=8)
    parts = list(march(BEAM, grid[:4], 0.02, settle=60, hold=8, block=4))
    rest = vibeam.sweep(BEAM, omega=grid[4:], amplitude=0.02, settle=60, hold=8, state=parts[-1][1])
    for name in ("amplitude", "reach", "impact_velocity", "mode_energy"):
        np.testing.assert_allclose(getattr(rest, name), getattr(whole, name)[4:], rtol=1e-9)
    np.testing.assert_array_equal(rest.period, whole.period[4:])


@pytest.mark.parametrize("system", [NOMINAL, BEAM, PRESSED])
def test_the_size_of_a_block_changes_not_one_bit(system: vibeam.ImpactSystem) -> None:
    grid = np.linspace(0.7, 2.6, 12)
    marched = [join([r for r, _ in march(system, grid, 0.05, settle=20, hold=6, block=b)]) for b in (1, 5, 12)]
    assert_identical(marched[0], marched[1])
    assert_identical(marched[0], marched[2])
    assert_identical(marched[0], vibeam.sweep(system, omega=grid, amplitude=0.05, settle=20, hold=6))


def test_what_is_left_of_a_sweep_changes_not_one_bit() -> None:
    """Stopped half-way and resumed, with the whole sweep's lowest frequency told."""
    grid = np.linspace(0.7, 2.6, 12)[::-1]
    whole = join([r for r, _ in march(BEAM, grid, 0.05, settle=20, hold=6)])
    first = list(march(BEAM, grid[:5], 0.05, settle=20, hold=6, slowest=0.7))
    second = list(march(BEAM, grid[5:], 0.05, settle=20, hold=6, slowest=0.7, state=first[-1][1]))
    assert_identical(whole, join([r for r, _ in first + second]))


def test_both_ways_is_up_and_then_down() -> None:
    grid = np.linspace(1.4, 2.6, 9)
    both = vibeam.sweep(NOMINAL, omega=grid[::-1], amplitude=B, direction="both", settle=30, hold=5)
    np.testing.assert_allclose(both.up.omega, grid, rtol=1e-15)
    np.testing.assert_allclose(both.down.omega, grid[::-1], rtol=1e-15)
    parts = list(march(NOMINAL, grid, B, settle=30, hold=5))
    assert_identical(both.up, join([r for r, _ in parts]))
    back = list(march(NOMINAL, grid[::-1], B, settle=30, hold=5, state=parts[-1][1]))
    assert_identical(both.down, join([r for r, _ in back]))
    down = vibeam.sweep(NOMINAL, omega=grid, amplitude=B, direction="down", settle=30, hold=5)
    np.testing.assert_allclose(down.omega, grid[::-1], rtol=1e-15)
    assert len(down) == 9


def test_settling_and_holding_are_whole_periods_of_one_motion() -> None:
    """A point's state is that of ``simulate`` after settle + hold periods."""
    _, state = point(BEAM, 1.9, 0.02, settle=9, hold=4)
    path = vibeam.simulate(BEAM, vibeam.Drive(1.9, 0.02), 13 * 2 * np.pi / 1.9)
    np.testing.assert_allclose(state.displacement, path.state.displacement, rtol=1e-9)
    np.testing.assert_allclose(state.velocity, path.state.velocity, rtol=1e-9)


# ------------------------------------------------------------------------------------------------ failures


def test_a_point_that_fails_is_nan_with_its_reason_and_the_next_goes_on() -> None:
    """The state handed in lies beyond the stop: the second point starts from equilibrium."""
    beyond = vibeam.State(np.array([5.0]), np.array([0.0]))
    grid = [1.9, 2.0]
    found = vibeam.sweep(NOMINAL, omega=grid, amplitude=B, settle=200, hold=20, state=beyond)
    alone = join([r for r, _ in march(NOMINAL, grid[1:], B, settle=200, hold=20, slowest=1.9)])
    assert found.ended.tolist() == [vibeam.Ended.PENETRATED.code, COMPLETE]
    for name in ("amplitude", "reach", "maximum", "minimum", "impacts_per_period", "impact_velocity", "rest"):
        assert np.isnan(getattr(found, name)[0]), name
    assert np.all(np.isnan(found.mode_energy[0]))
    assert np.all(np.isnan(found.impact_velocities[0]))
    assert found.period[0] == 0
    np.testing.assert_allclose(found.frequency, np.array(grid) / (2 * np.pi), rtol=1e-15)
    for name in ("amplitude", "reach", "maximum", "minimum", "impacts_per_period", "impact_velocity", "rest", "period"):
        assert getattr(found, name)[1] == getattr(alone, name)[0], name


@pytest.mark.parametrize("wrong", [
    {"omega": []}, {"omega": [0.0]}, {"omega": [-1.0]}, {"omega": [np.nan]}, {"omega": [[1.0, 2.0]]}, {"settle": -1},
    {"hold": 0}, {"amplitude": np.nan}, {"direction": "sideways"}, {"solver": "fligth"},
])  # fmt: skip
def test_a_sweep_that_makes_no_sense_is_refused(wrong: dict[str, object]) -> None:
    word = {"settle": "settle", "hold": "hold", "solver": "solver"}.get(next(iter(wrong)), next(iter(wrong)))
    with pytest.raises(ValueError, match=word):
        vibeam.sweep(NOMINAL, **{"omega": [1.0], "amplitude": B, **wrong})


def test_an_unknown_output_and_a_block_of_none_are_refused() -> None:
    with pytest.raises(KeyError, match="sensor"):
        vibeam.sweep(BEAM, omega=[1.0], amplitude=B, output="senser")
    with pytest.raises(ValueError, match="block"):
        next(march(BEAM, [1.0], B, block=0))
    with pytest.raises(ValueError, match="state"):
        vibeam.sweep(BEAM, omega=[1.0], amplitude=B, state=vibeam.State(np.zeros(2), np.zeros(2)))


def test_blocks_by_time_are_the_points_one_by_one() -> None:
    grid, amplitude = np.linspace(1.7, 2.3, 23), np.linspace(0.01, 0.03, 23)
    one_by_one = list(march(BEAM, grid, amplitude, settle=20, hold=4))
    blocks = list(march_blocks(BEAM, SweepPoints.of(grid, amplitude), SweepSettings(20, 4)))
    assert len(blocks) < len(grid)
    states = [state for _, states in blocks for state in states]
    for index, (response, state) in enumerate(one_by_one):
        block = join([response for response, _ in blocks])
        assert block.amplitude[index] == response.amplitude[0]
        assert np.array_equal(states[index].displacement, state.displacement)
        assert np.array_equal(states[index].velocity, state.velocity)


def test_a_solver_without_blocks_gets_one_point_at_a_time() -> None:
    blocks = list(march_blocks(BEAM, SweepPoints.of([1.8, 1.9], 0.02), SweepSettings(2, 1, "moreau")))
    assert [(len(response), len(states)) for response, states in blocks] == [(1, 1), (1, 1)]
