"""Largest Lyapunov exponents of a batch: multipliers in closed form, the Python of ``vibeam.lyapunov``, limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import vibeam
from vibeam.periodic.lyapunov import mean_exponents
from vibeam.periodic.stroboscopic import StroboscopicMap
from vibeam.system.state import State
from vibeam_models.laws.compliant import HuntCrossley, LinearStop
from vibeam_models.laws.mechanics import KernelNumbers, StopLaw

ONE = vibeam.ImpactSystem.from_modes([1.0], 0.015, contact=[1.0], load=[1.0], gap=0.0, restitution=0.72)
THREE = vibeam.ImpactSystem.from_modes(
    [1.0, 2.6, 7.1], [0.02, 0.05, 0.3], contact=[1.0, 0.6, -0.4], load=[1.0, 0.3, 0.1], gap=0.3, restitution=0.7
)
MEAN = 20


@pytest.mark.parametrize(
    ("system", "omega", "amplitude"),
    [(ONE, np.linspace(1.6, 2.3, 9), 0.05), (replace(THREE, gap=0.0), np.linspace(1.75, 2.2, 7), 1.0)],
    ids=["one mode", "three modes"],
)
def test_of_period_1_they_are_those_of_the_multipliers_in_closed_form(
    system: vibeam.ImpactSystem, omega: np.ndarray, amplitude: float
) -> None:
    found = vibeam.batch(system, omega, amplitude, settle=300, hold=20, lyapunov=MEAN)
    assert (found.period == 1).all()
    for i, rate in enumerate(omega):
        orbits = vibeam.orbits(system, vibeam.Drive(rate, amplitude))
        [orbit] = [each for each in orbits if each.stable and each.admissible]
        expected = np.log(np.abs(orbit.multipliers[0])) * rate / (2 * np.pi)
        assert found.lyapunov[i] == pytest.approx(expected, abs=1e-9)
    assert len(np.unique(found.lyapunov)) == len(omega)
    assert not found.lyapunov_error.any()


def test_a_motion_that_has_not_settled_has_the_exponent_of_its_cycle() -> None:
    """30 periods leave it 1e-4 from the cycle: by its own product the exponent would be as far off."""
    early, late = (vibeam.batch(ONE, [1.8, 2.1], 0.05, settle=settle, hold=20, lyapunov=MEAN) for settle in (30, 600))
    apart = np.abs(early.state - late.state).max()
    assert 1e-10 < apart < 1e-2
    assert np.allclose(early.lyapunov, late.lyapunov, rtol=0, atol=1e-11)


def test_of_chaos_they_are_the_same_finite_time_means_as_those_of_matrices() -> None:
    """In Python: tangent maps as matrices, QR after each segment. Over 70 periods round-off grows by 1e4 to 1e6."""
    weak = ((ONE, np.array([3.24, 3.25]), 0.0, 0.05), (THREE, np.array([3.1, 3.11, 3.15]), 0.05, 1.0))
    for base, omega, gap, amplitude in weak:
        system = replace(base, gap=gap, restitution=0.9)
        found = vibeam.batch(system, omega, amplitude, settle=100, hold=32, lyapunov=MEAN)
        assert (found.period == 0).all()
        assert (found.lyapunov > 0.02).all()
        for i, rate in enumerate(omega):
            n = system.size
            state = State(found.state[i, :n], found.state[i, n:], bool(found.resting[i]))
            one = mean_exponents(StroboscopicMap(system, vibeam.Drive(rate, amplitude)), state, MEAN, 1)
            assert found.lyapunov[i] == pytest.approx(one.largest, rel=1e-6)
            assert found.lyapunov_error[i] == pytest.approx(one.errors[0], rel=0.02)  # batches of a period more or less


def test_without_contact_it_is_the_damping_and_without_a_question_nothing() -> None:
    found = vibeam.batch(THREE, [0.5, 1.4], 1e-6, settle=10, hold=5, lyapunov=MEAN)
    assert (found.period == -1).all()
    assert np.allclose(found.lyapunov, -np.min(THREE.zeta * THREE.omega), rtol=1e-9)
    plain = vibeam.batch(THREE, [0.5, 1.4], 1e-6, settle=10, hold=5)
    assert np.isnan(plain.lyapunov).all()
    assert np.array_equal(plain.state, found.state)


@pytest.mark.parametrize(
    ("system", "omega", "amplitude"),
    [
        (replace(ONE, restitution=0.3, static=np.array([1.5])), 1.3, 2.0),
        (replace(THREE, gap=0.0, restitution=0.3, static=np.array([1.5, 0.0, 0.0])), 1.3, 2.0),
        (replace(ONE, restitution=0.0, gap=0.02), 1.2, 0.05),
        (replace(THREE, law=LinearStop(400.0)), 1.3, 1.0),
        (replace(THREE, law=HuntCrossley(400.0, 0.1)), 1.3, 1.0),
        (replace(THREE, second_gap=0.5), 1.3, 1.0),
        (replace(THREE, further=(vibeam.Contact([-0.8, 0.3, 0.5], 0.6, 0.85),)), 1.3, 1.0),
    ],
    ids=["rests", "rests of three modes", "plastic", "linear stop", "Hunt-Crossley", "two stops", "several"],
)
def test_what_the_compiled_code_leaves_alone_is_that_of_lyapunov(
    system: vibeam.ImpactSystem, omega: float, amplitude: float
) -> None:
    found = vibeam.batch(system, omega, amplitude, settle=60, hold=20, lyapunov=MEAN)
    n = system.size
    state = State(found.state[:n], found.state[n:], bool(found.resting))
    one = vibeam.lyapunov(system, vibeam.Drive(omega, amplitude), state, settle=0, periods=MEAN, count=1)
    assert not np.isnan(one.largest)
    assert float(found.lyapunov) == pytest.approx(one.largest, rel=1e-9)
    assert float(found.lyapunov_error) == pytest.approx(one.errors[0], rel=1e-9)


def test_a_point_that_failed_has_none_and_neighbours_and_threads_change_no_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vibeam.batches.batch.SHARED", 1)  # in tasks of eight points
    omega = np.concatenate([np.linspace(1.5, 2.3, 81), [2.9, 3.05, 3.1, 2.9]])
    start = np.zeros((85, 2)) - np.array([0.01, 0.0])
    start[7] = 0.5, 0.0
    found, again = (
        vibeam.batch(ONE, omega, 0.05, restitution=0.9, state=start, settle=60, hold=16, lyapunov=MEAN, threads=threads)
        for threads in (1, 3)
    )
    assert vibeam.Ended.of_code(found.ended[7]) is vibeam.Ended.PENETRATED
    assert np.flatnonzero(np.isnan(found.lyapunov)).tolist() == [7]
    assert np.array_equal(found.lyapunov, again.lyapunov, equal_nan=True)
    some = vibeam.batch(ONE, omega[::-7], 0.05, restitution=0.9, state=start[::-7], settle=60, hold=16, lyapunov=MEAN)
    assert np.array_equal(found.lyapunov[::-7], some.lyapunov, equal_nan=True)
    assert (found.lyapunov[81:] > 0).any()


class Unknown(StopLaw):
    """A law that flies, and whose R(v) v has no derivative."""

    name = "unknown"

    def at(self, velocity: float) -> float:
        return 0.7

    def kernel_numbers(self) -> KernelNumbers:
        return KernelNumbers("constant", {"coefficient": 0.7})


def test_systems_without_tangent_maps_and_short_means_are_refused() -> None:
    with pytest.raises(
        ValueError, match=r"lyapunov: 5 must be at least 20 .*; .*lyapunov: not known for the contact law"
    ):
        vibeam.batch(replace(THREE, law=Unknown()), 1.0, 1.0, lyapunov=5)
