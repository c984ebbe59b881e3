"""Harmonics, quadrature, participation: closed forms, invariants, and an orbit's own balance of impulses."""

from __future__ import annotations

import numpy as np
import pytest
from observed import OMEGA, SIZE, rectified_sine, resting, settled

import vibeam
from vibeam.observe.motion import integral

observe = vibeam.observe


def test_a_rectified_sine_has_its_fourier_series() -> None:
    found = observe.harmonic_amplitudes(rectified_sine(), periods=2, subdivision=2)
    k = found.order
    expected = np.zeros(len(k))  # −|sin ωt| = −2/π + 4/π Σ cos(2kωt)/(4k² − 1)
    expected[::2] = 4 * SIZE / np.pi / (4 * k[::2] ** 2 - 1)
    expected[0] /= 2
    np.testing.assert_allclose(found.amplitude, expected, rtol=0, atol=1e-13 * SIZE)
    np.testing.assert_allclose(found.frequency, k * 2 * OMEGA / (2 * np.pi))
    with pytest.raises(KeyError, match=r"no order 9"):
        found.of(9)


def test_subharmonics_are_told_from_harmonics() -> None:
    path = rectified_sine(8)
    slow = vibeam.simulate(path.system, vibeam.Drive(4 * OMEGA, 0.0), path.t_end, vibeam.State(
        np.array([0.0, 0.0]), np.array([-OMEGA * SIZE, 0.0])
    ))  # fmt: skip
    found = observe.harmonic_amplitudes(slow, periods=4, highest=2, subdivision=2)
    assert abs(found.of(0.5)) == pytest.approx(
        4 * SIZE / (3 * np.pi), rel=1e-12
    )  # the first of 2 OMEGA is ½ of 4 OMEGA
    assert abs(found.of(1)) == pytest.approx(4 * SIZE / (15 * np.pi), rel=1e-12)


@pytest.mark.parametrize(("damping", "frequency"), [("constant", 14.5), ("constant", 15.3), ("stiffness", 15.3)])
def test_a_beams_harmonics_are_what_drive_and_impulse_train_make(damping: str, frequency: float) -> None:
    orbit, path = settled("beam", frequency, beam__damping=damping)
    own, omega, row = path.system, path.drive.omega, path.system.output("sensor")
    found = observe.harmonic_amplitudes(path, periods=1)
    k = found.order[:, None]
    force = 2 / orbit.span * own.contact * orbit.impulse * np.exp(-1j * k * orbit.phase)
    force = force + (k == 1) * -1j * own.load * omega**2 * path.drive.amplitude
    force[0] /= 2
    expected = (force / (own.omega**2 - (k * omega) ** 2 + 2j * own.zeta * own.omega * k * omega)) @ row
    size = np.abs(expected).max()
    np.testing.assert_allclose(found.amplitude / size, expected / size, rtol=0, atol=2e-11)


def test_faults_of_harmonics_are_told() -> None:
    path = rectified_sine()
    with pytest.raises(ValueError, match="no multiple of the subdivision 3"):
        observe.harmonic_amplitudes(path, periods=4, subdivision=3)
    with pytest.raises(ValueError, match="lasts 4 drive periods, 5 are asked for"):
        observe.harmonic_amplitudes(path, periods=5)
    with pytest.raises(KeyError, match="no output 'nose'"):
        observe.harmonic_amplitudes(path, "nose")


@pytest.mark.parametrize("which", ["rest", "beam", "overdamped"])
def test_quadrature_keeps_the_fundamental_theorem_across_impacts_and_rests(which: str) -> None:
    if which == "rest":
        path, output = resting(), "contact"
        assert len(path.rests) > 20
    else:
        path, output = (
            settled("beam", 15.3, beam__damping="stiffness" if which == "overdamped" else "constant")[1],
            "tip",
        )
    begin = path.t_start + 0.37 * (path.t_end - path.t_start)
    end = path.t_start + 0.91 * (path.t_end - path.t_start)

    def products(t: np.ndarray) -> np.ndarray:
        x, v = path.at(t, output), path.velocity_at(t, output)
        return np.stack([np.ones_like(t), v, 2 * x * v, np.abs(v), np.abs(2 * x * v)], axis=1)

    found = integral(path, begin, end, products)
    ends = path.at([begin, end], output)
    assert found[0] == pytest.approx(end - begin, rel=1e-13)
    assert found[1] == pytest.approx(ends[1] - ends[0], abs=2e-10 * found[3])
    assert found[2] == pytest.approx(ends[1] ** 2 - ends[0] ** 2, abs=2e-10 * found[4])
    speeds = integral(path, begin, end, lambda t: np.stack([v := path.modes_at(t)[:, 1], np.abs(v)], axis=1))
    rise = np.diff(path.modes_at([begin, end])[:, 0], axis=0)[0]  # of every mode, the fastest ones too
    assert np.max(np.abs(speeds[0] - rise) / speeds[1]) < 1e-9


def test_participation_of_two_separate_modes() -> None:
    found = observe.modal_participation(rectified_sine(), "both", periods=3)
    np.testing.assert_allclose(found.energy, [(OMEGA * SIZE) ** 2 / 2, (4 * OMEGA * SIZE) ** 2 / 2], rtol=1e-12)
    np.testing.assert_allclose(found.energy_share, [1 / 17, 16 / 17], rtol=1e-12)
    spread = np.array([0.5 - 4 / np.pi**2, 9 * 0.5]) * SIZE**2
    np.testing.assert_allclose(found.displacement, np.sqrt(spread), rtol=1e-12)
    np.testing.assert_allclose(found.displacement_share, spread / spread.sum(), rtol=1e-12)
    np.testing.assert_allclose(found.velocity_share, [1 / 145, 144 / 145], rtol=1e-12)
    np.testing.assert_allclose(found.impulse_share, [1.0, 0.0])


def test_participation_of_a_beam_is_that_of_very_many_samples() -> None:
    orbit, path = settled("beam", 15.3)
    found = observe.modal_participation(path, periods=1)
    count = 200_000
    values = path.modes_at(path.t_end - orbit.span * (np.arange(count) + 0.5) / count)  # from impact to impact
    energy = np.mean(values[:, 1] ** 2 + path.system.omega**2 * values[:, 0] ** 2, axis=0) / 2
    np.testing.assert_allclose(found.energy, energy, rtol=2e-8)
    spread = np.abs(path.system.output("sensor")) * np.std(values[:, 0], axis=0)
    np.testing.assert_allclose(found.displacement, spread, rtol=1e-6)
    np.testing.assert_allclose(found.energy[:2], orbit.watched().mode_energy[0, :2], rtol=1e-6)
    assert found.impulse_share.sum() == pytest.approx(1.0)
