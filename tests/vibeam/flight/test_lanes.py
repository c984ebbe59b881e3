"""Numbers side by side: their functions against arbitrary precision, their flights against those one by one."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from numba import njit

import vibeam
from vibeam.flight.kernels.compiler import OPTIONS
from vibeam.flight.kernels.lanes.elementary import exponential, sine_cosine
from vibeam.flight.kernels.lanes.simd import eight, load, one, store, width
from vibeam.flight.kernels.layout import REDUCED
from vibeam_models.arrays import Array

DRIVE = vibeam.Drive(1.9, 0.8)


@njit(**OPTIONS)
def evaluate(x: Array, out: Array, many: bool) -> None:
    """Sine, cosine and e^−x of x, to the three rows of out."""
    if many:
        rows(x, out, eight())
    else:
        rows(x, out, one())


@njit(**OPTIONS)
def rows(x: Array, out: Array, like: Any) -> None:
    n = len(x)
    for i in range(0, n, width(like)):
        sine, cosine = sine_cosine(load(x, i, like))
        store(out, i, sine)
        store(out, n + i, cosine)
        store(out, 2 * n + i, exponential(load(x, i, like) * -1.0))


@pytest.fixture(scope="module")
def arguments() -> Array:
    rng = np.random.default_rng(3)
    quarters = np.arange(1, 41) * np.pi / 2
    return np.concatenate(
        [rng.uniform(0, 10, 400), rng.uniform(0, REDUCED, 400), 10 ** rng.uniform(-12, 0, 400), quarters]
    )


@pytest.mark.parametrize("many", [False, True])
def test_functions_are_good_to_two_last_digits(arguments: Array, many: bool) -> None:
    out = np.zeros(3 * len(arguments))
    evaluate(arguments, out, many)
    for row, function in enumerate((mpmath.sin, mpmath.cos, lambda t: mpmath.exp(-t))):
        with mpmath.workdps(40):
            true = [function(mpmath.mpf(float(x))) for x in arguments]
            found = out[row * len(arguments) :][: len(arguments)]
            off = [abs(f - t) / np.spacing(abs(float(t))) for f, t, x in zip(found, true, arguments, strict=True)
                   if row < 2 or x < 700]  # fmt: skip
        assert max(off) < 2


def test_what_has_decayed_is_next_to_nothing() -> None:
    out, x = np.zeros(24), np.array([700.0, 708.0, 709.0, 800.0, 1e4, 1e100, 0.0, 1.0])
    evaluate(np.minimum(x, REDUCED), out, True)
    assert np.all(out[16:22] <= 1e-303)
    assert np.all(out[16:22] > 0)
    assert out[22] == 1.0


SYSTEMS = {
    "one mode": ([1.0], 0.02),
    "two": ([1.0, 6.3], 0.02),
    "five, some overdamped": ([1.0, 2.6, 7.1, 11.0, 17.3], [0.02, 1.0, 0.05, 1.7, 0.1]),
    "eight": (np.arange(1, 9) ** 2.0, 0.01),
    "nine": (np.arange(1, 10) ** 2.0, 0.01),
    "twenty, the fast ones soon silent": (np.arange(1, 21) ** 2.0, 0.02 * np.arange(1, 21) ** 2.0),
}


def built(name: str) -> vibeam.ImpactSystem:
    omega, zeta = SYSTEMS[name]
    n = len(omega)
    return vibeam.ImpactSystem.from_modes(
        omega, zeta, (-1.0) ** np.arange(n) / np.arange(1, n + 1), 1 / np.arange(1, n + 1), gap=0.1, restitution=0.7
    )


@pytest.mark.parametrize("name", SYSTEMS)
def test_flights_side_by_side_are_those_one_by_one(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The engine that does everything, and the one for plain flights before it; chaos parts them slowly."""
    both = vibeam.simulate(built(name), DRIVE, 40.0)
    with monkeypatch.context() as patch:
        patch.setattr("vibeam.flight.linear.packing.lay_out", lambda *_: (np.zeros(0), np.zeros(0)))
        alone = vibeam.simulate(built(name), DRIVE, 40.0)  # another object: a system is packed once
    assert len(both.impact_times) == len(alone.impact_times) >= 12
    assert both.stats["evaluations"] != 0
    allowed = 64 * np.maximum(alone.errors.time, 1e-15 * alone.impact_times)
    assert np.all(np.abs(both.impact_times - alone.impact_times) <= allowed)
    allowed = 64 * np.maximum(alone.errors.velocity, 1e-14 * alone.impact_velocities)
    assert np.all(np.abs(both.impact_velocities - alone.impact_velocities) <= allowed)


def test_plain_flights_are_flown_side_by_side(monkeypatch: pytest.MonkeyPatch) -> None:
    """Or else the comparison above would compare nothing: without blocks the digits are others."""
    ends = []
    for laid_out in (True, False):
        with monkeypatch.context() as patch:
            if not laid_out:
                patch.setattr("vibeam.flight.linear.packing.lay_out", lambda *_: (np.zeros(0), np.zeros(0)))
            ends.append(vibeam.simulate(built("eight"), DRIVE, 40.0).state.displacement)
    assert np.any(ends[0] != ends[1])


def test_extremes_are_those_of_the_closed_form() -> None:
    """Free decay from rest turns at −x₀ e^{−σπ/ω_d}; a driven mode swings by its steady response."""
    system = vibeam.ImpactSystem.from_modes([1.0], [0.1], 1.0, 1.0, gap=5.0, restitution=0.5)
    turn = np.sqrt(1 - 0.01)
    found = vibeam.sweep(
        system, omega=[0.1], amplitude=0.0, settle=0, hold=1, state=vibeam.State(np.ones(1), np.zeros(1))
    )
    assert found.maximum[0] == 1.0
    assert found.minimum[0] == pytest.approx(-np.exp(-0.1 * np.pi / turn), rel=1e-13)
    driven = vibeam.sweep(system, omega=[1.3], amplitude=0.2, settle=300, hold=2)
    steady = 1.3**2 * 0.2 / abs(complex(1 - 1.3**2, 2 * 0.1 * 1.3))
    assert driven.amplitude[0] == pytest.approx(steady, rel=1e-12)
