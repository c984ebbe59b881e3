"""Plain systems through both engines: the same impacts at the same times, the same readings."""

from __future__ import annotations

import numpy as np
import pytest

import vibeam
from vibeam.flight.event_driven import EventDrivenSolver
from vibeam.flight.kernels import layout
from vibeam.flight.solver import FlightSolver, RegimeSolver
from vibeam.system.state import State

TURNS = 6


def plain(seed: int) -> tuple[vibeam.ImpactSystem, vibeam.Drive]:
    """One, two or three modes at random, the start on the stop, off it or pressed against it."""
    random, n = np.random.default_rng(seed), 1 + seed % 3
    omega = 48 * np.cumprod(np.concatenate([[1.0], random.uniform(2, 6, n - 1)]))
    contact, load = random.uniform(0.3, 2, n) * random.choice([1, -1], n), random.uniform(0.1, 0.5, n)
    system = vibeam.ImpactSystem.from_modes(
        omega, random.uniform(0.002, 0.05), contact, load, gap=(0.0, 0.0, 1e-4, -1e-4)[seed // 3 % 4],
        restitution=float(random.choice([0.0, 0.3, 0.6, 0.8])),
    )  # fmt: skip
    return system, vibeam.Drive(random.uniform(60, 140), 10 ** random.uniform(-4.5, -3))


def impacts(solver: EventDrivenSolver, drive: vibeam.Drive, turns: int) -> tuple[np.ndarray, np.ndarray]:
    """Times, in drive periods, and velocities of the impacts from equilibrium."""
    period = 2 * np.pi / drive.omega
    trace = solver.simulate(drive, None, 0.0, turns * period, 10**5)[3].trace
    struck = trace[np.isin(trace[:, layout.END], (layout.IMPACT, layout.CHATTER, layout.STUCK))]
    return (struck[:, layout.START] + struck[:, layout.DURATION]) / period, struck[:, layout.BEFORE]


@pytest.mark.parametrize("seed", range(24))
def test_the_impacts_are_the_same(seed: int) -> None:
    system, drive = plain(seed)
    (first, before), (second, after) = (
        impacts(made(system, drive.omega), drive, TURNS) for made in (FlightSolver, RegimeSolver)
    )
    assert len(first) == len(second)
    np.testing.assert_allclose(second, first, atol=1e-9)
    np.testing.assert_allclose(after, before, atol=1e-7 * np.max(before, initial=0.0))


def beam() -> vibeam.ImpactSystem:
    """Two modes of a beam that touches its stop at rest."""
    return vibeam.ImpactSystem.from_modes(
        [47.73307211979106, 635.0706480710485], 0.017, [2.1238579795879406, 0.30991833180957423],
        [0.462867542714578, 0.09066548216204676], gap=0.0, restitution=0.72,
    )  # fmt: skip


@pytest.mark.parametrize("reading", [layout.OUTPUT_ALONE, layout.REACH_TOO, None])
def test_the_steady_points_are_the_same(reading: int | None) -> None:
    """From equilibrium on the stop; hundreds of periods settled, copies of a period that repeats not read again."""
    grid, more = 2 * np.pi * np.linspace(14, 17, 5), {} if reading is None else {"reading": reading}
    first, second = (
        made(beam(), grid[0]).steady(grid, 8.660311939459456e-05, None, 200, 20, "contact", **more)[0]
        for made in (FlightSolver, RegimeSolver)
    )
    np.testing.assert_array_equal(second.impacts, first.impacts)
    np.testing.assert_array_equal(second.period, first.period)
    for name in ("amplitude", "reach", "impact_velocity", "rest", "mode_energy"):
        np.testing.assert_allclose(getattr(second, name), getattr(first, name), rtol=1e-10, err_msg=name)


@pytest.mark.parametrize("made", [FlightSolver, RegimeSolver])
def test_a_start_on_the_stop_makes_no_impacts_of_round_off(made: type[EventDrivenSolver]) -> None:
    """At rest on the stop the contact has no velocity, whatever the cancelling parts of the signal's slope come to."""
    times, speeds = impacts(made(beam(), 2 * np.pi * 14), vibeam.Drive(2 * np.pi * 14, 8.660311939459456e-05), 100)  # type: ignore[call-arg]
    assert times[0] > 0.1
    assert speeds.min() > 1e-6 * speeds.max()


@pytest.mark.parametrize("reading", [layout.OUTPUT_ALONE, layout.REACH_TOO])
def test_what_is_read_lightly_is_read_well_and_the_rest_not_at_all(reading: int) -> None:
    flight, grid, base = FlightSolver(beam(), 80.0), 2 * np.pi * np.linspace(14, 17, 3), 8.660311939459456e-05
    full, end = flight.steady(grid, base, None, 20, 10, "contact")
    states: list[State] = []
    light, after = flight.steady(grid, base, None, 20, 10, "contact", reading, states)
    np.testing.assert_array_equal(after.velocity, end.velocity)
    np.testing.assert_array_equal(light.impact_velocity, full.impact_velocity)
    assert len(states) == 3
    assert light.amplitude == pytest.approx(full.amplitude, rel=3e-6)
    assert np.isnan(light.mode_energy).all()
    assert np.isnan(light.reach).all() == (reading == layout.OUTPUT_ALONE)
    if reading == layout.REACH_TOO:
        assert light.reach == pytest.approx(full.reach, rel=3e-6)
