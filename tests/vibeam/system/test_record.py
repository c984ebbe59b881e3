"""Records: values, exact integrals, drift, orders of interpolation, shapes against their formulas, and their faults."""

from __future__ import annotations

import contextlib
import re
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam import Record
from vibeam.system.record_samples import ERRORS

RNG = np.random.default_rng(5)
OMEGA, DURATION = 40.0, 2.0


def some(quantity: str = "acceleration", pieces: int = 30) -> Record:
    """Record of random cubics of random lengths, with jumps."""
    times = 0.3 + np.concatenate([[0.0], np.cumsum(RNG.uniform(0.01, 0.05, pieces))])
    return Record(times, RNG.normal(size=(pieces, 4)) * [1.0, 20.0, 400.0, 8000.0], quantity)


def quadrature(record: Record, t: float, power: int = 0) -> float:
    """∫ (t − s)ᵖ u(s) ds up to t by Gauss's rule in each piece, exact for these degrees."""
    knots = np.concatenate([record.times[record.times < t], [t]])
    x, w = np.polynomial.legendre.leggauss(4)
    half = np.diff(knots)[:, None] / 2
    s = knots[:-1, None] + half * (1 + x)
    return float(np.sum(half * w * (t - s) ** power * record.at(s)))


@pytest.mark.parametrize("t", [0.31, 0.5, 0.77])
def test_velocity_and_displacement_are_the_integrals(t: float) -> None:
    record = some()
    assert record.velocity_at(t) == pytest.approx(quadrature(record, t), abs=1e-14 * record.peak)
    assert record.displacement_at(t) == pytest.approx(quadrature(record, t, 1), abs=1e-14 * record.peak)


def test_outside_of_its_span_there_is_no_load_and_the_base_coasts() -> None:
    record = Record([1.0, 2.0], [[3.0, 0.0, 0.0, 0.0]], initial=(0.5, 0.1))
    assert record.at([0.999, 1.0, 2.0, 2.001]).tolist() == [0.0, 3.0, 3.0, 0.0]
    assert record.velocity_at([0.0, 4.0]).tolist() == [0.5, 3.5]
    assert record.displacement_at([0.0, 4.0]) == pytest.approx([-0.4, 0.1 + 0.5 + 1.5 + 2 * 3.5])


def test_the_peak_is_that_of_a_dense_grid() -> None:
    for _ in range(5):
        record = some(pieces=4)
        t = np.linspace(record.start, record.end, 200_001)
        low, high = record.bounds
        u = record.at(t)
        assert low <= u.min()
        assert high >= u.max()
        assert [low, high] == pytest.approx([u.min(), u.max()], abs=1e-4 * record.peak)


@pytest.mark.parametrize("remove", ["mean", "velocity", "displacement"])
def test_drift_is_taken_off(remove: str) -> None:
    record = some().without(remove)
    t, w = np.polynomial.legendre.leggauss(5)
    half = np.diff(record.times)[:, None] / 2
    s = record.times[:-1, None] + half * (1 + t)
    v = record.velocity_at(s)
    velocity, displacement = record.drift
    size = float(np.abs(v).max())
    if remove == "velocity":  # neither mean nor trend: orthogonal to 1 and t
        assert abs(float(np.sum(half * w * v))) < 1e-13 * size
        assert abs(float(np.sum(half * w * v * s))) < 1e-13 * size
    else:
        assert abs(velocity) < 1e-13 * size
    if remove == "displacement":
        assert abs(displacement) < 1e-13 * size


def sines(h: float) -> dict[str, Record]:
    """A sine acceleration sampled every h seconds: as it is, and as the motion of its base."""
    t = np.arange(round(DURATION / h) + 1) * h
    rate, motion = 1 / h, {"velocity": -np.cos(OMEGA * t) / OMEGA, "displacement": -np.sin(OMEGA * t) / OMEGA**2}
    known = {each: Record.sampled(np.sin(OMEGA * t), rate=rate, interpolation=each) for each in ("linear", "cubic")}
    return known | {each: Record.sampled(values, rate=rate, quantity=each) for each, values in motion.items()}


@pytest.mark.parametrize("kind", ERRORS)
def test_samples_of_a_sine_converge_at_the_order_and_to_the_constant_that_is_said(kind: str) -> None:
    constant, power = ERRORS[kind]
    t = np.linspace(0.5, 1.5, 40_001)  # away from the ends, where a spline knows less
    for points in (20, 40):
        h = 2 * np.pi / OMEGA / points
        off = np.abs(sines(h)[kind].at(t) - np.sin(OMEGA * t)).max()
        assert off * constant / (OMEGA * h) ** power == pytest.approx(1.0, abs=0.03)


def test_a_displacement_is_met_at_its_samples() -> None:
    values = RNG.normal(size=50)
    record = Record.sampled(values, rate=100.0, quantity="displacement")
    assert record.displacement_at(record.times) == pytest.approx(values, abs=1e-12)
    speeds = Record.sampled(values, rate=100.0, quantity="velocity")
    assert speeds.velocity_at(speeds.times) == pytest.approx(values, abs=1e-12)


def hann_burst(t: Any) -> Any:
    return (0.5 - 0.5 * np.cos(2 * np.pi * t * 40 / 5)) * np.sin(2 * np.pi * 40 * t)


SHAPES = {
    "half-sine": (Record.half_sine(1.0, 0.011), lambda t: np.sin(np.pi * t / 0.011)),
    "terminal": (Record.saw_tooth(1.0, 0.01), lambda t: t / 0.01),
    "initial": (Record.saw_tooth(1.0, 0.01, kind="initial"), lambda t: 1 - t / 0.01),
    "trapezoid": (Record.trapezoid(1.0, 0.01, rise=0.002), lambda t: np.clip(np.minimum(t, 0.01 - t) / 0.002, 0, 1)),
    "sine": (Record.sine(1.0, 20.0, 0.3, phase=0.4), lambda t: np.sin(2 * np.pi * 20 * t + 0.4)),
    "tone burst": (Record.tone_burst(1.0, 40.0, 5), hann_burst),
    "sine beat": (Record.sine_beat(1.0, 40.0, 5), lambda t: np.sin(80 * np.pi * t) * np.sin(8 * np.pi * t)),
    "chirp": (
        Record.chirp(1.0, 5.0, 30.0, 0.5, error=1e-12),
        lambda t: np.sin(2 * np.pi * (5 * t + 25 * t**2)),
    ),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_a_shape_is_its_formula_to_its_bound(shape: str) -> None:
    record, formula = SHAPES[shape]
    t = np.linspace(record.start, record.end, 100_003)
    assert np.abs(record.at(t) - formula(t)).max() <= 1e-12 + 1e-15


def test_a_bound_is_not_far_from_what_it_bounds() -> None:
    record = Record.half_sine(1.0, 1.0, error=1e-6)
    t = np.linspace(0, 1, 100_001)
    assert 3e-7 < np.abs(record.at(t) - np.sin(np.pi * t)).max() < 1e-6


def test_a_chirp_may_have_a_peak_that_goes_with_its_frequency() -> None:
    record = Record.chirp(lambda f: -0.01 * f**2, 15.0, 10.0, 4.0)
    t = np.linspace(0, 4, 100_003)
    f = 15 - 1.25 * t
    assert np.abs(record.at(t) + 0.01 * f**2 * np.sin(2 * np.pi * (15 * t - 0.625 * t**2))).max() < 2.25e-9


def test_beats_follow_each_other() -> None:
    beats = Record.sine_beat(2.0, 10.0, 5, beats=3, pause=0.25, start=1.0)
    one = Record.sine_beat(2.0, 10.0, 5)
    t = np.linspace(0.01, 0.49, 30)
    assert beats.end == pytest.approx(1.0 + 3 * 0.5 + 2 * 0.25)
    for k in range(3):
        assert beats.at(1.0 + 0.75 * k + t) == pytest.approx(one.at(t), abs=1e-12)
    assert np.abs(beats.at(1.5 + np.linspace(0.01, 0.24, 9))).max() == 0.0
    assert Record.sine_beat(2.0, 10.0, 5, beats=3).duration == pytest.approx(1.5)


def test_records_are_scaled_shifted_joined_and_added() -> None:
    record = some()
    t = np.linspace(0.0, 2.0, 501)
    assert record.scaled(level=-2.0, speed=3.0).at(0.3 + t / 3) == pytest.approx(-2 * record.at(0.3 + t), abs=1e-12)
    assert record.shifted(0.7).at(t + 0.7) == pytest.approx(record.at(t), abs=1e-9)
    other = some()
    assert (record + other.shifted(0.1)).at(t) == pytest.approx(record.at(t) + other.at(t - 0.1), abs=1e-9)
    joined = record.then(other)
    late = joined.end - 1e-6 - np.linspace(0, other.duration - 1e-5, 40)
    assert joined.at(late) == pytest.approx(other.at(late - record.end + other.start), abs=1e-9)
    drift = record.scaled(level=0.5, speed=2.0).drift
    assert drift == pytest.approx((record.drift[0] / 4, record.drift[1] / 8))


def test_a_record_is_known_by_its_load() -> None:
    assert some().digest != some().digest
    assert SHAPES["half-sine"][0].digest == Record.half_sine(1.0, 0.011).digest
    force = Record.step(1.0, 1.0, quantity="force")
    assert (force.sign, Record.step(1.0, 1.0).sign) == (1.0, -1.0)
    assert Record.sampled(np.zeros(1000), rate=51200.0).spacing == pytest.approx(1 / 51200)
    assert some().spacing is None


MISSING = {"times": [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 12], "values": [0] * 11}
PAIR: dict[str, Any] = {"rate": 10, "values": [1.0, 0.0]}
WRONG: list[tuple[dict[str, Any], str]] = [
    ({"times": [0, 1, 1, 2], "values": [0, 1, 2, 3]}, "times: 1 repeated, index 2 (1 s): delete one of both"),
    ({"times": [0, 2, 1, 3], "values": [0, 1, 2, 3]}, "times: 1 before the one ahead of it, index 2 (1 s): sort them"),
    (MISSING, "times: 1 gap before index 10 (12 s), 2 samples missing: fill them, or cut the record there"),
    ({"rate": 10, "values": [0, np.nan, 1, np.inf]}, "values: 2 samples no finite number, index 1, index 3: cut"),
    ({"rate": 10, "values": [1.0]}, "values: 1 sample, at least 2 make a record"),
    (PAIR | {"quantity": "velocity"}, "values: 2 samples, at least 4 make a record"),
    ({"values": [1.0, 2.0]}, "rate, times: one of both says when samples are"),
    (PAIR | {"rate": 0}, "rate: 0 must be in [1e-12, 1e+12]"),
    (PAIR | {"values": [1e9, 0.0]}, "record: an acceleration of 1.02e+08 g, more than 10⁶ g"),
    (PAIR | {"interpolation": "spline"}, "interpolation of acceleration: 'spline' must be linear or cubic"),
    (PAIR | {"quantity": "strain"}, "quantity: 'strain' must be one of acceleration, force, moment, velocity, disp"),
    (PAIR | {"quantity": "force", "remove": "velocity"}, "remove = 'velocity' goes with an acceleration alone"),
]


@pytest.mark.parametrize(("given", "message"), WRONG)
def test_wrong_samples_are_refused_with_index_and_cure(given: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        Record.sampled(**given)


def test_uneven_times_are_no_gaps() -> None:
    times = np.cumsum(RNG.uniform(0.01, 0.1, 40))
    assert len(Record.sampled(np.zeros(40), times=times).times) == 40


def test_too_coarse_says_the_rate_that_the_bound_needs() -> None:
    for kind, record in sines(0.02).items():
        needed = vibeam.too_coarse(record, OMEGA, error=0.01)
        constant, power = ERRORS[kind]
        assert needed is None or (OMEGA / needed) ** power / constant == pytest.approx(0.01)
        assert (needed is None) == ((OMEGA * 0.02) ** power / constant <= 0.01)
    assert vibeam.too_coarse(Record.trapezoid(1.0, 1.0, rise=0.1), 1e6) is None


HOSTILE = [None, "x", np.nan, np.inf, -1.0, True, [], object(), 1e300, 1e-300, 10**400, (1,), {}, np.array([1.0]), 1j]
MAKERS: dict[str, tuple[Any, dict[str, Any]]] = {
    "record": (Record, {"times": [0, 1.0], "coefficients": [[0, 1, 2, 3.0]], "quantity": "force", "initial": (0, 0)}),
    "half-sine": (Record.half_sine, {"peak": 1.0, "duration": 1.0, "start": 0.0, "error": 1e-6}),
    "saw-tooth": (Record.saw_tooth, {"peak": 1.0, "duration": 1.0, "kind": "initial"}),
    "trapezoid": (Record.trapezoid, {"peak": 1.0, "duration": 1.0, "rise": 0.1, "fall": 0.2}),
    "sine": (Record.sine, {"peak": 1.0, "frequency": 2.0, "duration": 1.0, "phase": 0.1, "error": 1e-6}),
    "chirp": (Record.chirp, {"peak": 1.0, "first": 2.0, "last": 5.0, "duration": 1.0, "error": 1e-6}),
    "burst": (Record.tone_burst, {"peak": 1.0, "frequency": 2.0, "cycles": 3, "window": "hann", "error": 1e-6}),
    "beat": (Record.sine_beat, {"peak": 1.0, "frequency": 2.0, "cycles": 3, "beats": 2, "pause": 0.1, "error": 1e-6}),
    "sampled": (Record.sampled, {"values": [0, 1, 2, 1.0], "rate": 10.0, "interpolation": "cubic", "remove": "mean"}),
    "timed": (Record.sampled, {"values": [0, 1, 2, 1.0], "times": [0, 1, 2, 3.0], "quantity": "force"}),
    "random": (Record.random, {"density": [(1, 1), (9, 1.0)], "duration": 1.0, "seed": 1, "rate": 99.0}),
    "scaled": (SHAPES["sine"][0].scaled, {"level": 1.0, "speed": 2.0}),
    "shifted": (SHAPES["sine"][0].shifted, {"by": 1.0}),
    "then": (SHAPES["sine"][0].then, {"rest": SHAPES["sine"][0]}),
    "too coarse": (vibeam.too_coarse, {"record": SHAPES["sine"][0], "highest_rate": 1.0, "error": 0.1}),
}  # fmt: skip


@pytest.mark.parametrize("maker", MAKERS)
def test_a_wrong_argument_is_a_value_error_or_none_at_all(maker: str) -> None:
    """Anything else than a ValueError, a warning of overflow too, ends the test."""
    make, good = MAKERS[maker]
    make(**good)
    for name in good:
        for wrong in HOSTILE:
            with contextlib.suppress(ValueError):
                make(**good | {name: wrong})
        with pytest.raises(ValueError, match=": "):
            make(**good | {name: object()})
