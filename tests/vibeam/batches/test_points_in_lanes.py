"""Points side by side in the processor's lanes: those that go alone, whoever their neighbours are."""

from __future__ import annotations

import signal
import threading
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import vibeam

ONE = vibeam.ImpactSystem.from_modes([1.0], 0.015, contact=[1.0], load=[1.0], gap=0.0, restitution=0.72)
BEAM = vibeam.ImpactSystem.from_modes(
    [47.7, 635.0, 1790.0], 0.017, contact=[2.1, -0.6, 0.4], load=[0.46, 0.2, 0.1], gap=1e-4, restitution=0.72,
    outputs={"sensor": [1.5, 0.4, -0.2]},
)  # fmt: skip
EIGHT = vibeam.ImpactSystem.from_modes(
    [47.7, 635.0, 1790.0, 3500.0, 5800.0, 8700.0, 12000.0, 16000.0], 0.02, gap=0.0, restitution=0.72,
    contact=[2.1, -0.6, 0.4, 0.3, -0.25, 0.2, 0.15, 0.1], load=[0.46, 0.2, 0.1, 0.08, 0.06, 0.05, 0.04, 0.03],
)  # fmt: skip
READ = ("amplitude", "reach", "maximum", "minimum", "impacts_per_period", "impact_velocity", "rest")


def in_lanes_and_alone(*points: Any, **settings: Any) -> list[vibeam.BatchResponse]:
    return [vibeam.batch(*points, **settings, lanes=lanes) for lanes in (True, False)]


def assert_close(found: vibeam.BatchResponse, other: vibeam.BatchResponse, share: float = 1e-9) -> None:
    assert np.array_equal(found.period, other.period)
    assert np.array_equal(found.ended, other.ended)
    for name in READ:
        assert np.allclose(getattr(found, name), getattr(other, name), rtol=share, atol=1e-15, equal_nan=True), name
    assert np.allclose(found.mode_energy, other.mode_energy, rtol=share)
    assert np.allclose(found.strobes, other.strobes, rtol=share, atol=share * np.abs(other.strobes).max())


@pytest.mark.parametrize(
    ("system", "omega", "amplitude"),
    [
        (ONE, np.linspace(1.6, 2.2, 21), 0.05),
        (replace(ONE, gap=0.02), np.linspace(1.1, 1.5, 9), 0.05),
        (replace(BEAM, gap=0.0), np.linspace(80.0, 110.0, 7), 1e-4),
        (EIGHT, np.linspace(90.0, 100.0, 3), 1e-4),
    ],
    ids=["one mode", "gap", "three modes", "eight modes"],
)
def test_lanes_give_what_points_alone_give(system: vibeam.ImpactSystem, omega: np.ndarray, amplitude: float) -> None:
    found, alone = in_lanes_and_alone(system, omega, amplitude, settle=300, hold=20, strobes=3)
    assert (found.impacts_per_period >= 1).all()
    assert_close(found, alone)


@pytest.mark.parametrize(
    ("changes", "omega"),
    [
        ({"gap": -0.08}, 0.9),
        ({"restitution": 0.0}, 1.2),
        ({"restitution": 0.2, "gap": -0.02}, 1.1),
        ({"restitution": 1.0, "gap": 0.1}, 1.3),
    ],
    ids=["pressed", "plastic", "chatter and rest", "elastic"],
)
def test_unusual_events_are_those_of_points_alone(changes: dict[str, float], omega: float) -> None:
    rates = omega * np.array([1.0, 1.001, 1.002])
    found, alone = in_lanes_and_alone(replace(ONE, **changes), rates, 0.05, settle=400, hold=10, strobes=1)
    assert_close(found, alone, 1e-8)


def test_motions_of_a_few_periods_are_those_of_points_alone_for_any_parameters() -> None:
    """Before chaos has told them apart: grazing, chatter and flights of many periods among them."""
    random = np.random.default_rng(3)
    omega, gap = random.uniform(0.3, 4.0, 400), random.uniform(-0.05, 0.12, 400)
    r, damping = random.uniform(0.1, 0.99, 400), random.choice([0.5, 1.0, 3.0], 400)
    start = np.stack([np.minimum(gap, 0.0) - random.uniform(0.001, 0.1, 400), random.normal(0.0, 0.1, 400)], axis=1)
    point = {"gap": gap, "restitution": r, "damping": damping, "state": start}
    found, alone = in_lanes_and_alone(ONE, omega, 0.05, **point, settle=3, hold=1)
    same = np.isclose(found.state, alone.state, rtol=1e-8, atol=1e-10).all(axis=1)
    assert np.count_nonzero(same) >= 396  # what grazes within round-off may go either way
    assert np.array_equal(found.impacts[same], alone.impacts[same])
    assert found.impacts.max() > 10


def test_numbers_depend_on_no_neighbour_and_no_thread() -> None:
    random = np.random.default_rng(5)
    omega, gap = random.uniform(1.5, 3.5, 600), random.uniform(-0.02, 0.08, 600)
    found = vibeam.batch(ONE, omega, 0.05, gap=gap, restitution=0.9, settle=60, hold=5, strobes=5, threads=1)
    assert np.count_nonzero(found.period == 0) > 50
    order = random.permutation(600)[:333]
    again = vibeam.batch(ONE, omega[order], 0.05, gap=gap[order], restitution=0.9, settle=60, hold=5, strobes=5)
    for name in (*READ, "period", "state", "strobes", "mode_energy", "impacts"):
        assert np.array_equal(getattr(found, name)[order], getattr(again, name), equal_nan=True), name


def test_motions_that_never_reach_the_stop_are_the_steady_response() -> None:
    omega = np.linspace(0.2, 3.0, 29)
    found = vibeam.batch(ONE, omega, 0.01, gap=10.0, settle=5000, hold=10)
    response = omega**2 * 0.01 / np.abs(1.0 - omega**2 + 2j * 0.015 * omega)
    assert (found.period == -1).all()
    assert np.allclose(found.amplitude, response, rtol=1e-10)
    assert np.isnan(found.impact_velocity).all()


def test_a_motion_that_repeats_to_the_bit_is_not_computed_again_and_again() -> None:
    omega = np.linspace(1.6, 2.2, 16)
    long = vibeam.batch(ONE, omega, 0.05, settle=10**8, hold=1000)
    short = vibeam.batch(ONE, omega, 0.05, settle=1000, hold=1000)
    assert np.allclose(long.state, short.state, rtol=0, atol=1e-13)
    assert np.allclose(long.impact_velocity, short.impact_velocity, rtol=1e-13)
    assert np.allclose(long.mode_energy, short.mode_energy, rtol=1e-12)
    assert (long.impacts == 10**8 + 1000 - (1000 + 1000) + short.impacts).all()


def test_an_interrupt_ends_a_batch() -> None:
    """All its periods would take hours: the limit of the test's time is what fails without it."""
    omega = np.linspace(2.8, 3.0, 8)  # chaotic, from R = 0.95 on
    vibeam.batch(ONE, omega, 0.05, settle=1, hold=1)
    main = threading.main_thread().ident
    assert main is not None
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in a shell's background
    try:
        threading.Timer(0.3, signal.pthread_kill, (main, signal.SIGINT)).start()
        with pytest.raises(KeyboardInterrupt):
            vibeam.batch(ONE, omega, 0.05, gap=0.05, restitution=0.95, settle=10**8, hold=1)
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize(
    ("system", "omega", "amplitude", "output"),
    [
        (replace(ONE, gap=0.02, restitution=0.9, outputs={"twice": [2.0]}), np.linspace(0.4, 3.3, 60), 0.05, "twice"),
        (replace(ONE, gap=-0.06, restitution=0.6), np.linspace(0.5, 2.5, 30), 0.05, "contact"),
        (BEAM, np.linspace(40.0, 140.0, 20), 1e-4, "sensor"),
        (EIGHT, np.linspace(60.0, 130.0, 4), 1e-4, "contact"),
    ],
    ids=["one mode", "rests", "three modes", "eight modes"],
)
@pytest.mark.parametrize("hold", [1, 17])
def test_motions_that_do_not_repeat_yet_are_read_off_as_alone(
    system: vibeam.ImpactSystem, omega: np.ndarray, amplitude: float, output: str, hold: int
) -> None:
    """From the first periods on, before chaos has told them apart: extremes and energies of every flight differ."""
    found, alone = in_lanes_and_alone(system, omega, amplitude, settle=1, hold=hold, output=output, strobes=1)
    assert np.array_equal(found.impacts, alone.impacts)
    assert np.count_nonzero(found.period == 0) > len(omega) // 4
    for name in READ:
        assert np.allclose(getattr(found, name), getattr(alone, name), rtol=1e-8, atol=1e-13, equal_nan=True), name
    assert np.allclose(found.mode_energy, alone.mode_energy, rtol=1e-8)
