"""Linear identification: exact data give the truth, noisy data intervals that hold it; what is not fixed is said."""

from __future__ import annotations

import importlib.util
import json
from dataclasses import replace
from math import nan, pi, sqrt
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import vibeam
from vibeam.casefile.read import parse
from vibeam.report.fit import identification_sheet
from vibeam.studies.identification.estimates import Estimate, Identification, in_words, spread_of

ROOT = Path(__file__).parents[3]
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


def test_a_value_near_0_has_an_interval_in_its_unit() -> None:
    """A gap may be below 0 or as good as 0; what no data fix has no value."""
    rows = tuple(Estimate(*each) for each in (
        ("a", -2e-4, -2.2e-4, -1.8e-4, "m"), ("b", -4e-12, -1e-5, 1e-5, "m"), ("c", nan, nan, nan, "1"),
    ))  # fmt: skip
    found = Identification(rows, "made up", 5, 0.01)
    told = identification_sheet(found).answer
    assert told.startswith("a -0.2 mm (± 10 %) and b 0 m (± 10 µm) describe the 5 measured modal frequencies (")
    assert told.endswith("rms residual 1 %), which do not fix c.")
    none = identification_sheet(replace(found, rows=rows[2:]))
    assert none.answer == "The 5 measured modal frequencies do not fix c."


def test_intervals_are_those_of_linear_regression() -> None:
    """a = p₁ f^p₂ in logarithms is a straight line: its textbook intervals, with known σ."""
    x = np.log(np.linspace(1, 5, 20))
    half = spread_of(np.stack([np.ones(20), x], axis=1) / 0.05, None, ("p1", "p2")).half
    centred = np.sum((x - x.mean()) ** 2)
    expected = 1.959964 * 0.05 * np.sqrt([1 / 20 + x.mean() ** 2 / centred, 1 / centred])
    np.testing.assert_allclose(half, expected, rtol=1e-6)


def test_directions_that_are_open_are_put_in_words() -> None:
    assert in_words(np.array([1.0, 1.0]), ("E", "ρ")) == "E and ρ enter as ρ / E only: the data cannot separate them"
    assert "ρ · E^2 only" in in_words(np.array([1.0, -2.0]), ("E", "ρ"))
    assert in_words(np.array([1e-4, -1.0]), ("E", "ρ")) == "the data say nothing of ρ"
    three = in_words(np.array([1.0, 2.0, -0.5]), ("a", "b", "c"))
    assert three == "the data cannot separate a, b, c: a +1 %, b +2 %, c -0.5 % together leave them as they are"
    spread = spread_of(np.array([[1.0, 0.5, -0.5], [2.0, 1.0, -1.0]]) * 100, None, ("t", "E", "ρ"))
    assert np.isinf(spread.half).all()
    assert len(spread.directions) == 2
    assert any("E and ρ enter as ρ / E only" in each for each in spread.directions)


BEAM = """units = "SI"
[beam]
length = "200 mm"
width = "20 mm"
thickness = "2 mm"
youngs_modulus = "200 GPa"
density = "7800 kg/m^3"
damping_ratio = 0.01
elements = 24
[stop]
position = "200 mm"
gap = "1 mm"
restitution = 0.7
[sensor]
position = "200 mm"
[drive]
amplitude = "0.1 mm"
[sweep]
frequency = ["40 Hz"]
settle = 5
hold = 1
[fidelity.beam]
reduction = "modal"
modes = 3
[show.modes]
kind = "modal"
"""
MODE = """[measured.{name}]
fidelity = "beam"
show = "modes"
quantity = "mode_frequency"
number = {number}
value = {value!r}
uncertainty = "0.1 %"
source = "Euler and Bernoulli"
"""
ROOTS = (1.8751040687119611, 4.694091132974174)  # of cos x cosh x = −1


def bare(thickness: float) -> vibeam.Case:
    """A cantilever whose measured frequencies are those of Euler and Bernoulli's, of another thickness."""
    wave = thickness / 0.2**2 * sqrt(200e9 / (12 * 7800)) / (2 * pi)
    modes = [MODE.format(name=f"m{n}", number=n, value=root**2 * wave) for n, root in enumerate(ROOTS, 1)]
    return parse(BEAM + "".join(modes))


def test_a_thickness_from_the_frequencies_of_a_cantilever() -> None:
    """f = β² t/(2π L²) √(E/12ρ): the thickness to the elements' error, its interval 1.96 · 0.1 %/√2 of it."""
    row = vibeam.identify_keys(bare(2.2e-3), ["beam.thickness"])["beam.thickness"]
    assert row.value == pytest.approx(2.2e-3, rel=2e-6)
    assert (row.high - row.low) / 2 / row.value == pytest.approx(1.96e-3 / sqrt(2), rel=2e-3)
    assert row.unit == "m"


def test_what_enters_as_a_ratio_only_is_said_and_not_guessed() -> None:
    """The frequencies of a bare cantilever are of t/L² √(E/ρ) only, and not of the width."""
    found = vibeam.identify_keys(bare(2.2e-3), ["beam.youngs_modulus", "beam.density", "beam.width"])
    assert not any(row.determined for row in found.rows)
    assert set(found.directions) == {
        "beam.youngs_modulus and beam.density enter as beam.density / beam.youngs_modulus only: "
        "the data cannot separate them",
        "the data say nothing of beam.width",
    }


def test_a_misfit_beyond_the_scatter_is_told() -> None:
    wrong = MODE.format(name="other", number=2, value=250.0)
    text = bare(2e-3).text + wrong
    assert any(
        "the intervals do not hold" in note for note in vibeam.identify_keys(parse(text), ["beam.thickness"]).notes
    )


@pytest.mark.parametrize(
    ("keys", "measured", "said"),
    [
        ([], (), "no key to identify"),
        (["beam.thickness", "beam.thickness"], (), "named twice"),
        (["beam.thicknes"], (), "beam.thicknes is not in the case"),
        (["fidelity.beam.reduction"], (), "is no number above 0"),
        (["beam.thickness"], ("m3",), r"no \[measured.m3\]"),
    ],
)
def test_what_cannot_be_identified_is_refused(keys: list[str], measured: tuple[str, ...], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        vibeam.identify_keys(bare(2e-3), keys, measured)


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
