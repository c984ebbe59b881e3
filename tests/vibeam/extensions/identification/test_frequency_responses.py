"""Frequency responses of several modes: exact ones give the truth, noisy ones intervals that hold it.

Truths are the sum of modes in closed form, R s^p/(s² + 2ζωs + ω²), computed here.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

import vibeam
from vibeam.extensions.identification.signal_kind import identify_signal
from vibeam.report.fit import identification_sheet

Modes = Sequence[tuple[float, float, float]]  # Hz, damping ratio, residue in 1/kg
ONE: Modes = [(20.0, 0.02, 0.5)]
THREE: Modes = [(8.9, 0.013, 0.5), (55.0, 0.01, -0.3), (155.0, 0.02, 0.4)]
CLOSE: Modes = [(20.0, 0.01, 0.5), (20.6, 0.012, 0.35)]
POWERS = {"receptance": 0, "mobility": 1, "accelerance": 2}
BAND = {id(ONE): np.linspace(5, 40, 120), id(THREE): np.linspace(1, 250, 600), id(CLOSE): np.linspace(15, 26, 150)}


def response(modes: Modes, of: str = "receptance", upper: float = 0.0, lower: float = 0.0) -> np.ndarray:
    """Response over the band of the modes, with residual terms of what lies above and below."""
    s = 2j * np.pi * BAND[id(modes)]
    one = [r / (s**2 + 2 * z * (2 * np.pi * f) * s + (2 * np.pi * f) ** 2) for f, z, r in modes]
    return np.asarray(s ** POWERS[of] * (np.sum(one, axis=0) + upper + lower / s**2))


def values(found: vibeam.Identification, name: str) -> list[float]:
    return [row.value for row in found.rows if row.name.startswith(name)]


@pytest.mark.parametrize("of", POWERS)
@pytest.mark.parametrize(
    ("modes", "upper", "lower", "moduli"),
    [
        (ONE, 0, 0, True),
        (THREE, 3e-7, 0, False),
        (THREE, 3e-7, 0, True),
        (THREE, 1e-7, 0.2, False),
        (CLOSE, 0, 0, True),
    ],
)
def test_exact_responses_give_every_parameter(of: str, modes: Modes, upper: float, lower: float, moduli: bool) -> None:
    exact = response(modes, of, upper, lower)
    found = vibeam.identify_frequency_response(BAND[id(modes)], np.abs(exact) if moduli else exact, of=of)
    for at, name in enumerate(("natural frequency", "damping ratio", "residue")):
        np.testing.assert_allclose(values(found, name), [mode[at] for mode in modes], rtol=1e-6)
    np.testing.assert_allclose(values(found, "modal mass"), [1 / abs(mode[2]) for mode in modes], rtol=1e-6)


def test_a_base_that_moves_gives_participations() -> None:
    """Relative motion −s²/(s² + 2ζωs + ω²); absolute 1 more."""
    s = 2j * np.pi * np.linspace(5, 40, 120)
    relative = -1.4 * s**2 / (s**2 + 0.1 * 40 * np.pi * s + (40 * np.pi) ** 2)
    for of, exact in (("relative transmissibility", relative), ("transmissibility", 1 + relative)):
        for shown in (exact, np.abs(exact)):
            found = vibeam.identify_frequency_response(s.imag / 2 / np.pi, shown, of=of)
            assert [row.value for row in found.rows] == pytest.approx([20.0, 0.05, 1.4], rel=1e-6)


Noise = Callable[[np.ndarray, np.random.Generator], np.ndarray]


def of_both(exact: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """1 % of the largest, of real and imaginary part."""
    size = 0.01 * np.abs(exact).max()
    return exact + size * (random.standard_normal(len(exact)) + 1j * random.standard_normal(len(exact)))


def in_proportion(exact: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """1 % of the modulus at each frequency, of real and imaginary part."""
    return exact + 0.01 * np.abs(exact) * (random.standard_normal(len(exact)) + 1j * random.standard_normal(len(exact)))


def of_gain(exact: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """1 %, one factor for both parts."""
    return exact * (1 + 0.01 * random.standard_normal(len(exact)))


def of_modulus(exact: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """1 % of each modulus, without phase."""
    return np.asarray(np.abs(of_gain(exact, random)))


def of_modulus_evenly(exact: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """1 % of the largest modulus at all frequencies, without phase."""
    return np.abs(np.abs(exact) + 0.01 * np.abs(exact).max() * random.standard_normal(len(exact)))


NOISES = (of_both, in_proportion, of_gain, of_modulus, of_modulus_evenly)


def held(modes: Modes, of: str, noise: Noise, seeds: range) -> list[int]:
    """In how many sets the interval of each parameter holds the truth; a set with other modes holds none."""
    counts = np.zeros(3 * len(modes), dtype=int)
    for seed in seeds:
        shown = noise(response(modes, of), np.random.default_rng(seed))
        found = vibeam.identify_frequency_response(BAND[id(modes)], shown, of=of)
        rows = [row for row in found.rows if not row.name.startswith("modal mass")]
        if len(rows) == len(counts):
            truths = [value for mode in modes for value in mode]
            counts += [row.low <= truth <= row.high for row, truth in zip(rows, truths, strict=True)]
    return counts.tolist()


@pytest.mark.parametrize("noise", [of_both, of_gain, of_modulus])
def test_intervals_hold_in_a_few_sets(noise: Noise) -> None:
    """At least 15 of 20: fewer have a probability of 0.03 % where 95 % hold."""
    assert min(held(ONE, "accelerance", noise, range(20))) >= 15


@pytest.mark.slow
@pytest.mark.parametrize("noise", NOISES)
@pytest.mark.parametrize(("modes", "of"), [(ONE, "accelerance"), (CLOSE, "mobility")])
def test_intervals_hold_in_a_hundred_sets(modes: Modes, of: str, noise: Noise) -> None:
    found = held(modes, of, noise, range(100))
    assert min(found) >= 90
    assert np.mean(found) >= 93


def written(path: Path, head: str, *columns: np.ndarray) -> Path:
    np.savetxt(path, np.stack(columns, axis=1), delimiter=",", header=head, comments="", fmt="%.12g")
    return path


@pytest.mark.parametrize(
    ("of", "unit", "size"),
    [("receptance", "mm/N", 1e-3), ("mobility", "m/s/N", 1.0), ("accelerance", "g/N", 9.80665)],
)  # fmt: skip
def test_the_unit_says_the_form(of: str, unit: str, size: float, tmp_path: Path) -> None:
    exact = response(THREE, of) / size
    found = identify_signal(written(tmp_path / "a.csv", f"f [Hz],H [{unit}]", BAND[id(THREE)], np.abs(exact)))
    assert found.of == of
    assert f"{unit} is of " in found.why
    np.testing.assert_allclose(values(found, "residue"), [mode[2] for mode in THREE], rtol=1e-6)


def test_parts_modulus_and_phase_and_decibels_are_one(tmp_path: Path) -> None:
    f, exact = BAND[id(THREE)], response(THREE, "mobility")
    size, turn = 1e3 * np.abs(exact), np.angle(exact)
    for name, head, columns in (
        ("parts", "f [Hz],Real [mm/s/N],Imag [mm/s/N]", (1e3 * exact.real, 1e3 * exact.imag)),
        ("degrees", "f [Hz],Mobility [mm/s/N],Phase [deg]", (size, np.degrees(turn))),
        ("decibels", "f [Hz],Mobility [dB re 1 mm/s/N],Phase [rad]", (20 * np.log10(size), turn)),
        ("reference", "f [Hz],Mobility [dB re 1e-6 m/s/N],Phase [rad]", (20 * np.log10(1e3 * size), turn)),
        ("other sign", "f [Hz],Mobility [mm/s/N],Phase [deg]", (size, -np.degrees(turn))),
    ):
        found = identify_signal(written(tmp_path / f"{name}.csv", head, f, *columns))
        assert (found.of, "real and imaginary parts" in found.method) == ("mobility", True)
        np.testing.assert_allclose(values(found, "residue"), [mode[2] for mode in THREE], rtol=1e-6, err_msg=name)
        assert any("other sign" in note for note in found.notes) == (name == "other sign")


def test_what_contradicts_a_form_is_refused(tmp_path: Path) -> None:
    f, exact = BAND[id(ONE)], np.abs(response(ONE))
    path = written(tmp_path / "a.csv", "f [Hz],H [m/N]", f, exact)
    with pytest.raises(ValueError, match="'H' is no accelerance: the unit 'm/N' is not one of m/s\\^2/N"):
        identify_signal(path, "accelerance")
    path = written(tmp_path / "b.csv", "f [Hz],Z [N/m]", f, 1 / exact)
    with pytest.raises(ValueError, match="N/m is of the reciprocal of a response: take the reciprocal"):
        identify_signal(path)
    path = written(tmp_path / "c.csv", "f [Hz],H", f, exact)
    found = identify_signal(path, "receptance")
    assert "'H' has no unit: it is taken in m/N" in found.notes
    assert found["residue"].value == pytest.approx(0.5, rel=1e-6)


@pytest.mark.parametrize("of", ["transmissibility", "relative transmissibility"])
def test_a_ratio_of_equal_units_is_absolute_or_relative(of: str, tmp_path: Path) -> None:
    s = 2j * np.pi * np.linspace(5, 40, 120)
    relative = -(s**2) / (s**2 + 0.1 * 40 * np.pi * s + (40 * np.pi) ** 2)
    size = np.abs(relative + (of == "transmissibility"))
    found = identify_signal(written(tmp_path / "a.csv", "f [Hz],T [g/g]", s.imag / 2 / np.pi, size))
    assert found.of == of
    assert [row.value for row in found.rows] == pytest.approx([20.0, 0.05, 1.0], rel=1e-6)


@pytest.mark.parametrize("of", [None, "spectrum"])
def test_the_root_of_a_power_spectrum_is_fitted(of: str | None, tmp_path: Path) -> None:
    r = np.linspace(0.5, 1.5, 401)
    power = 0.0016 / ((1 - r**2) ** 2 + (0.04 * r) ** 2)
    for head, shown in (
        ("PSD [g^2/Hz]", power),
        ("P [G^2/Hz]", power),
        ("P [m^2/s^3]", power),
        ("S [(m/s^2)^2/Hz]", power),
        ("spectrum [m/s^2/Hz]", np.sqrt(power)),
    ):
        found = identify_signal(written(tmp_path / "a.csv", f"f [Hz],{head}", 20 * r, shown), of)
        assert (found.of, found["damping ratio"].value) == ("spectrum", pytest.approx(0.02, rel=1e-6))


SHAPES = np.array([[0.7, 0.5, 0.4], [0.9, -0.6, 0.5], [0.3, 0.8, -0.4]])  # of places by modes


def test_several_responses_give_a_table_of_modes(tmp_path: Path) -> None:
    """Residues are φ(output) φ(input), of an input at the first place; the table is read as that of a case."""
    f, random, columns, heads = BAND[id(THREE)], np.random.default_rng(0), [], []
    for place, row in enumerate(SHAPES, 1):
        modes = [(mode[0], mode[1], one * other) for mode, one, other in zip(THREE, row, SHAPES[0], strict=True)]
        BAND[id(modes)] = f
        shown = in_proportion(response(modes, "accelerance"), random)
        columns += [shown.real, shown.imag]
        heads += [f"Re H{place} [m/s^2/N]", f"Im H{place} [m/s^2/N]"]
    found = identify_signal(written(tmp_path / "a.csv", ",".join(["f [Hz]", *heads]), f, *columns))
    table = tomllib.loads(found.shapes)["modes"]
    np.testing.assert_allclose(
        [float(each.removesuffix(" Hz")) for each in table["frequency"]], [8.9, 55, 155], rtol=1e-3
    )
    np.testing.assert_allclose(table["force"], SHAPES[0], rtol=5e-3)
    np.testing.assert_allclose(list(table["outputs"].values()), SHAPES, rtol=5e-3)
    assert found.shapes in identification_sheet(found).tables[0].caption


def test_the_modes_of_each_order_are_drawn() -> None:
    random = np.random.default_rng(0)
    found = vibeam.identify_frequency_response(
        BAND[id(THREE)], in_proportion(response(THREE, "accelerance"), random), of="accelerance"
    )
    assert [len(each) for each in found.orders] == [1, 2, 3]
    draw = identification_sheet(found).draw
    assert draw is not None
    axes = draw().axes
    assert [axes[0].get_yscale(), axes[1].get_ylabel()] == ["log", "modes in the fit"]
    assert len(axes[1].lines[0].get_xdata()) == 6


def test_what_is_no_response_is_refused() -> None:
    f, exact = BAND[id(ONE)], response(ONE)
    for at, values_, said in (
        (f, exact[:-1], "must be of one shape"), (f, exact * np.nan, "must be a finite number"),
        (f, 0 * exact, "no response"), (f[:3], exact[:3], "too few"),
    ):  # fmt: skip
        with pytest.raises(ValueError, match=said):
            vibeam.identify_frequency_response(at, values_, of="receptance")
    with pytest.raises(ValueError, match="'recptance' is none of these"):
        vibeam.identify_frequency_response(f, exact, of="recptance")
