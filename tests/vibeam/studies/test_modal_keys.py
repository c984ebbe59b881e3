"""Keys from modal frequencies: a cantilever's thickness, intervals, what is not fixed is said."""

from __future__ import annotations

from dataclasses import replace
from math import nan, pi, sqrt

import numpy as np
import pytest

import vibeam
from vibeam.casefile.read import parse
from vibeam.report.fit import identification_sheet
from vibeam.studies.fit.linear_estimates import Estimate, Identification, in_words, spread_of


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
