"""Linear identification: exact data give the truth, noisy data intervals that hold it; what is not fixed is said."""

from __future__ import annotations

import importlib.util
import json
from math import pi, sqrt
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import vibeam

ROOT = Path(__file__).parents[4]
RESULTS = ROOT / "tests" / "benchmarks" / "results" / "identification.json"
FREQUENCY, RATIO = 7.6, 0.017
OMEGA = 2 * pi * FREQUENCY


def program() -> ModuleType:
    path = ROOT / "tests" / "benchmarks" / "identification.py"
    spec = importlib.util.spec_from_file_location("identification_coverage", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def decay(time: np.ndarray, ratio: float = RATIO) -> np.ndarray:
    return np.asarray(np.exp(-ratio * OMEGA * time) * np.cos(OMEGA * sqrt(1 - ratio**2) * time + 0.4))


@pytest.mark.parametrize("ratio", [1e-4, 0.017, 0.2])
@pytest.mark.parametrize("even", [True, False])
def test_an_exact_decay_gives_frequency_and_damping(ratio: float, even: bool) -> None:
    time = np.linspace(0.0, 3.0, 900)
    if not even:
        time = np.sort(np.random.default_rng(1).uniform(0.0, 3.0, 900))
    found = vibeam.identify_decay(time + 5.0, 1e-3 * decay(time, ratio) - 2e-4)
    assert found["natural frequency"].value == pytest.approx(FREQUENCY, rel=1e-8)
    assert found["damping ratio"].value == pytest.approx(ratio, rel=1e-6)
    assert found.residual < 1e-7


def test_an_exact_spectrum_gives_frequency_and_damping() -> None:
    """|X| of the Laplace transform at iω of a decay from x₀ = 1 mm and v₀ = 20 mm/s."""
    f = np.linspace(6.5, 9.0, 40)
    s = 2j * pi * f
    transform = (s * 1e-3 + 20e-3 + 2 * RATIO * OMEGA * 1e-3) / (s**2 + 2 * RATIO * OMEGA * s + OMEGA**2)
    found = vibeam.identify_spectrum(f, np.abs(transform))
    assert found["natural frequency"].value == pytest.approx(FREQUENCY, rel=1e-7)
    assert found["damping ratio"].value == pytest.approx(RATIO, rel=1e-5)
    assert found.notes == ()


def test_a_spectrum_of_a_record_that_is_cut_tells_of_leakage() -> None:
    time = np.arange(0, 1.0, 1 / 200)
    lines = np.fft.rfftfreq(4 * len(time), 1 / 200)
    f = np.fft.rfftfreq(len(time), 1 / 200)
    (note,) = [each for each in vibeam.identify_spectrum(f, np.abs(np.fft.rfft(decay(time)))).notes if "record" in each]
    assert "damping is too high by leakage; take the decay itself" in note
    assert len(lines) > len(f)


@pytest.mark.parametrize(("drive", "power"), [("base displacement", 2), ("base acceleration", 0), ("force", 0)])
def test_an_exact_response_gives_the_gain_too(drive: str, power: int) -> None:
    f = np.linspace(6.0, 9.0, 25)
    r = f / FREQUENCY
    amplitude = 0.6 * 1.5e-3 * r**power / np.hypot(1 - r**2, 2 * RATIO * r)
    found = vibeam.identify_response(f[::-1], amplitude[::-1], drive=drive, level=0.6)
    for name, value in (("natural frequency", FREQUENCY), ("damping ratio", RATIO), ("gain", 1.5e-3)):
        assert found[name].value == pytest.approx(value, rel=1e-7)


def test_the_resonance_is_not_seen_far_below_it() -> None:
    """Over a force far below resonance a = g u/(1 − r²) ≈ g u: the damping cannot be had, and no number is given."""
    f = np.linspace(0.5, 2.0, 30)
    r = f / FREQUENCY
    amplitude = 1 / np.hypot(1 - r**2, 2 * RATIO * r) * (1 + 1e-3 * np.random.default_rng(0).standard_normal(30))
    found = vibeam.identify_response(f, amplitude, drive="force", uncertainty=1e-3)
    assert not found["damping ratio"].determined
    assert any("damping ratio" in each for each in found.directions)


def test_noise_that_is_not_white_is_told() -> None:
    time = np.linspace(0, 3, 900)
    slow = np.convolve(np.random.default_rng(3).standard_normal(929), np.ones(30) / 30, "valid")
    assert any(
        "intervals are too narrow" in note for note in vibeam.identify_decay(time, decay(time) + 0.1 * slow).notes
    )


def test_what_is_no_signal_is_refused() -> None:
    time = np.linspace(0, 3, 900)
    for t, x, said in (
        (time, decay(time)[:-1], "must be of one shape"), (time[:9], decay(time[:9]), "too short"),
        (time[::-1], decay(time), "must ascend"), (time, decay(time) * np.nan, "finite"), (time, 0 * time, "constant"),
    ):  # fmt: skip
        with pytest.raises(ValueError, match=said):
            vibeam.identify_decay(t, x)
    for f, a, said in (([1, 2, 3], [1, 2, 3], "too few"), ([1, 2, 3, 4], [0, 0, 0, 0], "no response")):
        with pytest.raises(ValueError, match=said):
            vibeam.identify_response(f, a)
    with pytest.raises(ValueError, match="drive: 'voltage' is none of base displacement"):
        vibeam.identify_response([1, 2, 3, 4], [1, 2, 3, 4], drive="voltage")


def test_intervals_cover_the_truth_in_a_few_sets() -> None:
    """Of 25 sets at least 19 of the 95 % intervals hold the truth (binomial: 99.9 %), in the quick scenarios."""
    own = program()
    for name in ("response, noise unknown", "response, noise known", "response to a force"):
        assert min(own.covered(name, range(25)).values()) >= 19


def test_the_committed_coverage_is_within_its_bounds() -> None:
    found = json.loads(RESULTS.read_text(encoding="utf-8"))
    assert found["sets"] == 100
    assert set(found["covered"]) == set(program().SCENARIOS)
    for counts in found["covered"].values():
        assert all(91 <= each <= 100 for each in counts.values())


@pytest.mark.slow
def test_the_committed_coverage_is_what_the_program_finds() -> None:
    own, found = program(), json.loads(RESULTS.read_text(encoding="utf-8"))
    for name, counts in found["covered"].items():
        again = own.covered(name, range(100))
        assert all(abs(again[each] - counts[each]) <= 1 for each in counts)
