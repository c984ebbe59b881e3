"""Shock spectra without stop: closed forms, the ramp-invariant filter of ISO 18431-4, DOP853; equipment on a motion."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

import vibeam
from vibeam.observe.oscillators import Pieces, extremes, phi
from vibeam_models.arrays import Array

Record = vibeam.Record
PEAK, LENGTH = 500.0, 0.011
FREQUENCIES = np.geomspace(3.0, 2000.0, 97)
OMEGA = 2 * np.pi * FREQUENCIES


def spectrum(record: vibeam.Record, damping: float = 0.0, rates: Array = FREQUENCIES) -> vibeam.ShockSpectrum:
    return vibeam.shock_spectrum(record, rates, damping)


def test_half_sine_is_the_closed_form() -> None:
    """By hand: until the end A r/(r − 1) sin(2πm/(r + 1)), r = ω/p, p = π/T; after it 2A r |cos(πr/2)|/|1 − r²|."""
    found = spectrum(Record.half_sine(PEAK, LENGTH))
    r = OMEGA * LENGTH / np.pi
    turns = 2 * np.pi * np.arange(1, 200)[:, None] / (r + 1)
    inner = np.where(turns <= np.pi, np.abs(r / (r - 1) * np.sin(turns)), 0.0).max(axis=0)
    end = np.abs(r / (r * r - 1) * np.sin(np.pi * r))
    np.testing.assert_allclose(found.of(part="primary"), PEAK * np.maximum(inner, end), rtol=1e-11)
    residual = PEAK * 2 * r * np.abs(np.cos(np.pi * r / 2) / (1 - r * r))
    np.testing.assert_allclose(found.of(part="residual"), residual, rtol=1e-9, atol=1e-10 * PEAK)
    assert spectrum(Record.half_sine(PEAK, LENGTH), rates=np.linspace(60, 90, 301)).of().max() == pytest.approx(
        1.7683 * PEAK, rel=1e-4
    )  # 1.77 at fT = 0.81 of the books (Harris, ch. 23)


def test_saw_tooth_and_trapezoid_are_the_closed_forms_after_their_end() -> None:
    tooth, wt = spectrum(Record.saw_tooth(PEAK, LENGTH)), OMEGA * LENGTH
    closed = PEAK * np.sqrt(1 - 2 * np.sin(wt) / wt + (2 * np.sin(wt / 2) / wt) ** 2)
    np.testing.assert_allclose(tooth.of(part="residual"), closed, rtol=1e-11)
    rise = 0.002
    blunt = spectrum(Record.trapezoid(PEAK, LENGTH, rise=rise))
    closed = 4 * PEAK / (OMEGA * rise) * np.abs(np.sin(OMEGA * rise / 2) * np.sin(OMEGA * (LENGTH - rise) / 2))
    np.testing.assert_allclose(blunt.of(part="residual"), closed, atol=1e-11 * PEAK)


def test_a_step_is_doubled() -> None:
    found = spectrum(Record.step(PEAK, 1.0))
    np.testing.assert_allclose(found.of(), 2 * PEAK, rtol=1e-12)
    np.testing.assert_allclose(found.of("pseudo_velocity", "primary"), 2 * PEAK / OMEGA, rtol=1e-12)
    np.testing.assert_allclose(found.of("displacement", "negative"), 2 * PEAK / OMEGA**2, rtol=1e-12)


def test_damped_step_overshoots_as_its_closed_form() -> None:
    zeta = 0.05
    found = vibeam.shock_spectrum(Record.step(PEAK, 1.0), FREQUENCIES, zeta)
    overshoot = 1 + np.exp(-zeta * np.pi / np.sqrt(1 - zeta**2))
    np.testing.assert_allclose(found.of("displacement"), overshoot * PEAK / OMEGA**2, rtol=1e-12)


def smallwood(values: Array, rate: float, frequency: float, zeta: float) -> Array:
    """Absolute acceleration by the ramp-invariant filter of ISO 18431-4:2007, eq. 4 to 9."""
    omega = 2 * np.pi * frequency
    a, b = omega * zeta / rate, omega / rate * np.sqrt(1 - zeta**2)
    decay, turn = np.exp(-a), np.exp(-a) * np.sin(b) / b
    return np.asarray(
        lfilter(
            [1 - turn, 2 * (turn - decay * np.cos(b)), decay**2 - turn], [1, -2 * decay * np.cos(b), decay**2], values
        )
    )


def test_ramp_invariant_filter_has_the_same_samples_and_smaller_peaks() -> None:
    """ISO 18431-4 has the values at samples; between them 10 samples a period hide up to 1 − cos 18° = 4.9 %."""
    rate, values = 5000.0, np.random.default_rng(3).normal(size=2000)
    values[0] = 0.0  # the filter begins with a ramp from 0
    record = Record.sampled(values, rate=rate)
    rates = np.array([20.0, 100.0, 500.0, 1200.0])
    exact = vibeam.shock_spectrum(record, rates, 0.05).of(part="primary")
    sampled = np.array([np.abs(smallwood(values, rate, each, 0.05)).max() for each in rates])
    assert (sampled <= exact * (1 + 1e-10)).all()
    fine = np.interp(np.arange(0, 1999 * 64 + 1) / 64, np.arange(2000), values)  # the same ramps, sampled 64 times
    finer = np.array([np.abs(smallwood(fine, 64 * rate, each, 0.05)).max() for each in rates])
    np.testing.assert_allclose(exact, finer, rtol=1e-3)
    assert (finer <= exact * (1 + 1e-8)).all()
    assert sampled[2] < 0.999 * exact[2]


def test_extremes_of_a_random_record_are_those_of_a_second_program() -> None:
    """DOP853 at 1e-12 with roots of the slope, over cubics of unequal lengths."""
    rng = np.random.default_rng(5)
    times = np.concatenate([[0.0], np.cumsum(rng.uniform(1e-3, 9e-3, 30))])
    record = Record.sampled(rng.normal(size=31), times=times, interpolation="cubic")
    for frequency, zeta in ((4.0, 0.0), (60.0, 0.02), (300.0, 0.3)):
        omega = 2 * np.pi * frequency
        found = vibeam.shock_spectrum(record, [frequency], zeta)

        def flow(t: float, x: Array, omega: float = omega, zeta: float = zeta) -> list[float]:
            return [
                x[1],
                -2 * zeta * omega * x[1] - omega**2 * x[0] - float(record.at(min(t, record.end * (1 - 1e-16)))),
            ]

        state, lows, highs = [0.0, 0.0], [0.0], [0.0]
        for begin, end in pairwise(times):
            made = solve_ivp(flow, (begin, end), state, "DOP853", np.linspace(begin, end, 4001), rtol=1e-12, atol=1e-18)
            rate = -2 * zeta * omega * made.y[1] - omega**2 * made.y[0]
            for values, kept in ((rate, highs), (made.y[0], lows)):
                kept.extend([values.max(), -values.min()])
            state = list(made.y[:, -1])
        assert found.of("acceleration", "primary")[0] == pytest.approx(max(highs), rel=3e-6)
        assert found.of("displacement", "primary")[0] == pytest.approx(max(lows), rel=3e-6)


def test_phi_functions_are_those_of_arbitrary_precision() -> None:
    mp = pytest.importorskip("mpmath")
    x = np.array([1e-9 + 1e-3j, 0.5j, 1.49j, 1.51j, -3 + 2j, 10j, -0.01 + 1e-8j, 100j, -1e-5])
    with mp.workdps(50):
        for k, row in enumerate(phi(x.astype(complex)), 1):
            for each, value in zip(x, row, strict=True):
                exact = mp.mpc(each)
                told = (mp.exp(exact) - sum(exact**i / mp.factorial(i) for i in range(k))) / exact**k
                assert abs(complex(told) - value) <= 2e-15 * abs(value)


def test_one_piece_and_many_are_the_same_spectrum() -> None:
    rates = np.array([7.0, 1234.5])
    one = extremes(Pieces(np.array([0.0, 1.0]), np.array([[1.0, -2.0, 0.0, 0.5]])), rates, 0.01)
    at = np.linspace(0.0, 1.0, 301)[:-1]
    rows = np.stack([1 - 2 * at + 0.5 * at**3, -2 + 1.5 * at**2, 1.5 * at, 0.5 + 0 * at], axis=1)
    many = extremes(Pieces(np.linspace(0.0, 1.0, 301), rows), rates, 0.01)
    np.testing.assert_allclose(many, one, rtol=1e-10, atol=1e-12 * np.abs(one[0]).max())


def test_what_is_wrong_is_said_at_once() -> None:
    with pytest.raises(ValueError, match=r"frequencies: must be .* above 0") as told:
        vibeam.shock_spectrum(Record.step(1.0, 1.0).scaled(), [0.0, 3.0], 1.5)
    assert "damping: 1.5 must be below 1" in str(told.value)
    found = vibeam.shock_spectrum(Record.step(1.0, 1.0), [3.0])
    with pytest.raises(ValueError, match=r"quantity: 'speed' must be one of acceleration(.|\n)*part: 'all'"):
        found.of("speed", "all")


def carried() -> vibeam.Trajectory:
    system = vibeam.ImpactSystem.from_modes(
        [50.0, 310.0], 0.01, [1.0, 1.5], [1.0, 0.4], gap=1e-4, restitution=0.7, outputs={"sensor": [0.8, -0.5]}
    )
    return vibeam.simulate(system, vibeam.Drive(60.0, 2e-4), 0.6)


def test_equipment_on_a_motion_with_impacts_is_that_of_a_second_program() -> None:
    """Beam and oscillator by DOP853 from impact to impact; an impact changes the velocity by the impulse on the row."""
    path, frequency, zeta = carried(), 20.0, 0.05
    assert len(path.impact_times) > 50
    found = vibeam.shock_spectrum(path, [frequency], zeta)
    system, omega = path.system, 2 * np.pi * frequency
    row = system.output("sensor")

    def shaken(t: float) -> float:
        return float(60.0**2 * 2e-4 * np.sin(60.0 * t))

    events = np.unique(np.concatenate([path.impact_times, path.rests.ravel()]))
    marks = np.concatenate([[0.0], events[(events > 0) & (events < 0.6)], [0.6]])
    state, peaks = np.zeros(2), [0.0]
    for begin, end in pairwise(marks):
        held = bool(np.any((path.rests[:, 0] <= begin) & (begin < path.rests[:, 1])))
        start = path.modes_at(begin)

        def flow(t: float, x: Array, held: bool = held) -> Array:
            pose, speed = x[:2], x[2:4]
            free = system.load * shaken(t) - 2 * system.zeta * system.omega * speed - system.omega**2 * pose
            if held:
                free = free - system.contact * (system.contact @ free) / (system.contact @ system.contact)
            base = row @ free - shaken(t)
            return np.concatenate([speed, free, [x[5], -2 * zeta * omega * x[5] - omega**2 * x[4] - base]])

        begun = np.concatenate([start.ravel(), state])
        made = solve_ivp(flow, (begin, end), begun, "DOP853", np.linspace(begin, end, 400), rtol=1e-11, atol=1e-14)
        rate = -2 * zeta * omega * made.y[5] - omega**2 * made.y[4]
        peaks.append(np.abs(rate).max())
        state = made.y[4:6, -1].copy()
        state[1] -= row @ (path.modes_at(end)[1] - made.y[2:4, -1])  # the base's velocity jumps, the equipment's not
    assert found.of("acceleration")[0] == pytest.approx(max(peaks), rel=1e-5)


def test_a_motion_has_no_residual_spectrum() -> None:
    found = vibeam.shock_spectrum(carried(), [20.0])
    with pytest.raises(ValueError, match="a motion goes on after its last computed time"):
        found.of(part="residual")
    with pytest.raises(ValueError, match=r"device: goes with a record(.|\n)*damping: goes without a device"):
        vibeam.shock_spectrum(carried(), [20.0], 0.1, device=device(1.0))


def device(gap: float, restitution: float = 0.5, **more: object) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(
        1.0, 0.0, -1.0, 1.0, gap=gap, restitution=restitution, outputs={"tip": [1.0]}, **more
    )


def test_device_that_misses_its_stop_is_the_oscillator() -> None:
    record, rates = Record.half_sine(PEAK, LENGTH), np.array([20.0, 70.0, 300.0])
    held, free = (
        vibeam.shock_spectrum(record, rates, **each)
        for each in ({"device": device(1.0), "output": "tip"}, {"damping": 0.0})
    )
    assert held.impacts.tolist() == [0, 0, 0]
    for quantity in ("acceleration", "displacement", "pseudo_velocity"):
        for part in ("primary", "residual", "positive", "negative"):
            np.testing.assert_allclose(held.of(quantity, part), free.of(quantity, part), rtol=1e-9, atol=1e-9 * PEAK)


def test_device_that_strikes_under_a_step_is_the_closed_form() -> None:
    """By hand, z'' + ω²z = −a, a stop at z = −d: v² = 2ad − ω²d², rebound with Rv about z₀ = −a/ω²."""
    a, d, share = 10.0, 1e-3, 0.5
    rate = 10.0
    omega = 2 * np.pi * rate
    speed = np.sqrt(2 * a * d - (omega * d) ** 2)
    middle = -a / omega**2
    turn = middle + np.hypot(d + middle, share * speed / omega)
    assert turn < 0
    found = vibeam.shock_spectrum(Record.step(a, 0.03), [rate], device=device(d, share), output="tip")
    assert found.impact_velocity[0] == pytest.approx(speed, rel=1e-12)
    assert found.of("displacement", "negative")[0] == pytest.approx(d, rel=1e-12)
    assert found.displacement[0, 1, 0] == 0.0  # it never comes beyond its place at rest while the step lasts
    assert found.of("acceleration", "primary")[0] == pytest.approx(omega**2 * d, rel=1e-12)


def test_device_of_two_modes_is_the_motion_itself_at_its_own_frequency() -> None:
    system = vibeam.ImpactSystem.from_modes(
        [60.0, 350.0], 0.01, [1.0, 1.5], [1.0, 0.4], gap=1e-4, second_gap=2e-4, restitution=0.7,
        outputs={"sensor": [0.8, -0.5]},
    )  # fmt: skip
    record = Record.half_sine(20.0, LENGTH)
    found = vibeam.shock_spectrum(record, [60.0 / (2 * np.pi)], device=system)
    path = vibeam.simulate(system, record, LENGTH + 2 * 2 * np.pi / 60.0)
    seen = path.at(np.linspace(0.0, path.t_end, 200_001), "sensor")
    assert found.impacts[0] == len(path.impact_times) > 3
    assert found.of("displacement")[0] == pytest.approx(np.abs(seen).max(), rel=1e-6)
    assert found.impact_velocity[0] == path.impact_velocities.max()
