"""Filters against their transfer functions, the chain element by element."""

from __future__ import annotations

import numpy as np
import pytest
from observed import OMEGA, SIZE, rectified_sine, settled
from scipy import signal

import vibeam
from vibeam.observe.measuring_chain import filtered
from vibeam_models.laws.compliant import LinearStop

observe = vibeam.observe
FILTERS = [
    observe.LowPass("bessel", 4, 500.0),
    observe.LowPass("bessel", 9, 500.0),
    observe.LowPass("butterworth", 3, 500.0),
    observe.LowPass("butterworth", 8, 500.0),
    observe.LowPass("elliptic", 5, 500.0, 0.1, 60.0),
    observe.LowPass("elliptic", 6, 500.0, 0.5, 60.0),
]
names = [f"{one.family}{one.order}" for one in FILTERS]


@pytest.mark.parametrize("low_pass", FILTERS, ids=names)
def test_a_sine_comes_out_with_gain_and_phase_of_the_transfer_function(low_pass: observe.LowPass) -> None:
    step, f = 3e-6, 300.0
    t = np.arange(60_000) * step
    out = filtered(low_pass, np.sin(2 * np.pi * f * t), step)
    gain = low_pass.response(f)
    expected = np.abs(gain) * np.sin(2 * np.pi * f * t + np.angle(gain))
    late = t > 0.17
    np.testing.assert_allclose(out[late], expected[late], atol=5e-6)


@pytest.mark.parametrize("low_pass", FILTERS, ids=names)
def test_a_ramp_lags_by_the_group_delay(low_pass: observe.LowPass) -> None:
    t = np.arange(4000) * 2e-5
    out = filtered(low_pass, t, 2e-5)
    assert t[-1] - out[-1] == pytest.approx(low_pass.delay(), rel=1e-7)  # straight input: no error of its own
    phase = np.angle(low_pass.response([1e-3, 2e-3]))
    assert low_pass.delay() == pytest.approx(-np.diff(np.unwrap(phase))[0] / (2 * np.pi * 1e-3), rel=1e-5)


def test_the_first_order_filter_answers_a_ramp_as_the_textbook_says() -> None:
    low_pass, t = observe.LowPass("butterworth", 1, 500.0), np.arange(100) * 5e-5
    tau = 1 / (2 * np.pi * 500)
    np.testing.assert_allclose(filtered(low_pass, t, 5e-5), t - tau * (1 - np.exp(-t / tau)), atol=1e-15)


@pytest.mark.parametrize("low_pass", FILTERS, ids=names)
def test_cutoff_and_unit_gain(low_pass: observe.LowPass) -> None:
    assert abs(low_pass.response(0.0)) == pytest.approx(1.0, rel=1e-12)
    if low_pass.family != "elliptic":
        assert abs(low_pass.response(500.0)) == pytest.approx(np.sqrt(0.5), rel=1e-9)
    else:
        high = np.abs(low_pass.response(np.linspace(2000, 50_000, 500)))
        assert high.max() / np.abs(low_pass.response(np.linspace(0, 500, 500))).max() < 1.2e-3


def test_a_constant_passes_unchanged_from_the_first_sample() -> None:
    for low_pass in FILTERS:
        np.testing.assert_allclose(filtered(low_pass, np.full(50, 0.3), 1e-4), 0.3, rtol=1e-12)


def test_the_filter_agrees_with_scipys_own_simulation() -> None:
    low_pass = FILTERS[5]
    t = np.arange(800) * 1e-5
    x = np.abs(np.sin(700 * t)) + np.where(t > 3e-3, 0.5, 0.0)
    zeros, poles, _ = low_pass.zpk()
    scale = 1000.0  # in ms, or the polynomials overflow the accuracy
    gain = (np.prod(-poles / scale) / np.prod(-zeros / scale)).real
    system = signal.ZerosPolesGain(zeros / scale, poles / scale, gain).to_ss()
    expected = signal.lsim(system, x, t * scale)[1]
    np.testing.assert_allclose(filtered(low_pass, x, 1e-5) - x[0], expected - x[0], atol=1e-9)


def test_a_chain_without_elements_is_the_motion_itself() -> None:
    path = settled("beam", 15.3)[1]
    found = observe.measure(path, observe.Chain(5000.0, velocity="exact"))
    assert np.array_equal(found.displacement, path.at(found.time, "sensor"))
    assert np.array_equal(found.velocity, path.velocity_at(found.time, "sensor"))
    assert found.rate == pytest.approx(5000.0)
    assert len(found.after(path.t_start + 0.1).time) == len(found.time) - 500


def test_central_differences_are_what_they_say() -> None:
    path = rectified_sine()
    found = observe.measure(path, observe.Chain(2000.0))
    inner = (found.displacement[2:] - found.displacement[:-2]) * 1000.0
    np.testing.assert_allclose(found.velocity[1:-1], inner, rtol=0, atol=1e-12 * SIZE * OMEGA)
    clear = (found.time > 0.1) & (found.time < 0.9)
    sag = np.sin(OMEGA / 2000) / (OMEGA / 2000)  # of the difference quotient of a sine
    np.testing.assert_allclose(
        found.velocity[clear], -SIZE * OMEGA * sag * np.cos(OMEGA * found.time[clear]), rtol=1e-9
    )


def test_noise_and_quantum_are_added_as_said() -> None:
    path = rectified_sine(200)
    bare = observe.measure(path, observe.Chain(100.0)).displacement
    chain = observe.Chain(100.0, noise=1e-5, seed=4)
    noisy = observe.measure(path, chain).displacement
    assert np.array_equal(noisy, observe.measure(path, chain).displacement)
    assert not np.array_equal(noisy, observe.measure(path, observe.Chain(100.0, noise=1e-5, seed=5)).displacement)
    assert np.std(noisy - bare) == pytest.approx(1e-5, rel=0.03)
    stepped = observe.measure(path, observe.Chain(100.0, quantum=1e-5)).displacement
    np.testing.assert_allclose(stepped / 1e-5, np.round(bare / 1e-5), atol=1e-9)
    assert np.std(stepped - bare) == pytest.approx(1e-5 / np.sqrt(12), rel=0.03)


def test_the_filters_oversampling_is_enough() -> None:
    path = settled("beam", 15.3)[1]
    low_pass = observe.LowPass("elliptic", 6, 500.0, 0.1, 60.0)
    coarse, fine = (
        observe.measure(path, observe.Chain(5000.0, low_pass, oversampling=n)).displacement for n in (16, 128)
    )
    assert np.abs(coarse - fine).max() < 1e-4 * np.ptp(fine)


def test_faults_of_a_chain_come_all_at_once() -> None:
    with pytest.raises(ValueError, match=r"rate: -1.*noise and seed.*velocity: 'guess'"):
        observe.Chain(-1.0, noise=1.0, velocity="guess")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"family: 'rc'.*order: 0.*cutoff"):
        observe.LowPass("rc", 0, -1.0)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="an elliptic filter needs both"):
        observe.LowPass("elliptic", 4, 500.0)
    with pytest.raises(ValueError, match="a bessel filter has none"):
        observe.LowPass("bessel", 4, 500.0, ripple=1.0)
    with pytest.raises(ValueError, match="shorter than three samples"):
        observe.measure(rectified_sine(), observe.Chain(0.1))


def test_a_stop_that_yields_has_no_restitution_to_read() -> None:
    system = vibeam.ImpactSystem.from_modes(1.0, 0.02, 1.0, 1.0, gap=0.0, law=LinearStop(1e4, 0.0))
    path = vibeam.simulate(system, vibeam.Drive(1.9, 1.0), 5.0)
    with pytest.raises(ValueError, match="no instant of impact"):
        vibeam.observe.true_restitution(path)
