"""Kinds of measured signals in files: found out where heads, units or numbers say it, else refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from vibeam.extensions.identification.signal_kind import identify_signal
from vibeam.extensions.identification.signals import read_signal

FREQUENCY, RATIO = 7.6, 0.02
Table = Sequence[np.ndarray]


def decay(cycles: float = 20, noise: float = 0.0, offset: float = 0.0, modes: int = 1) -> Table:
    """Time and displacement, 24 samples a cycle; further modes are 2.7 times higher and half as large each."""
    random, time = np.random.default_rng(0), np.arange(0, cycles, 1 / (24 * 2.7 ** (modes - 1))) / FREQUENCY
    x = noise * random.standard_normal(len(time)) + offset
    for k in range(modes):
        omega = 2 * np.pi * FREQUENCY * 2.7**k
        x = x + 0.5**k * np.exp(-RATIO * omega * time) * np.cos(omega * np.sqrt(1 - RATIO**2) * time + 0.4)
    return time, x


def spectrum(low: float = 0.0, high: float = 12.0, **more: Any) -> Table:
    """Lines of a Fourier transform, from ``low`` to ``high`` times the natural frequency."""
    time, x = decay(80, **more)
    lines = np.fft.rfftfreq(len(time), time[1])
    kept = (lines >= low * FREQUENCY) & (lines <= high * FREQUENCY)
    return lines[kept], time[1] * np.abs(np.fft.rfft(x))[kept]


def transfer(frequency: np.ndarray, power: int = 2) -> np.ndarray:
    r = frequency / FREQUENCY
    return np.asarray(r**power / (1 - r**2 + 2j * RATIO * r))


def response(grid: str = "even", noise: float = 0.0, **more: int) -> Table:
    """Frequencies in even, geometric or refined steps, and amplitudes with a noise in proportion to them."""
    f = FREQUENCY * {
        "even": np.linspace(0.85, 1.15, 41), "log": np.geomspace(0.5, 2, 41),
        "refined": np.unique(np.r_[np.linspace(0.8, 1.2, 21), np.linspace(0.97, 1.03, 21)]),
        "from 0": np.linspace(0, 3, 200), "short": np.linspace(0.96, 1.04, 7),
    }[grid]  # fmt: skip
    return f, np.abs(transfer(f, **more)) * (1 + noise * np.random.default_rng(1).standard_normal(len(f)))


def both_ways(columns: Table) -> Table:
    return [np.r_[each, each[::-1]] for each in columns]


def complex_parts(f: np.ndarray) -> Table:
    return f, transfer(f).real, transfer(f).imag


def time_and_noise() -> Table:
    return decay()[0], np.random.default_rng(2).standard_normal(480)


#: heads, columns, what it is, what it is taken as ("": refused)
SIGNALS: dict[str, tuple[str, Callable[[], Table], str]] = {
    "decay": ("t [s];x [mm]", decay, "decay"),
    "decay, noise": ("time;displacement", lambda: decay(noise=0.05), "decay"),
    "decay, offset": ("Time (s);Laser (V)", lambda: decay(offset=3.0), "decay"),
    "decay, two modes": ("Zeit [s];Weg [mm]", lambda: decay(modes=2), "decay"),
    "decay, no heads": ("", decay, "decay"),
    "decay, no heads, offset, noise": ("", lambda: decay(offset=3.0, noise=0.02), "decay"),
    "decay, no heads, three modes": ("", lambda: decay(modes=3), "decay"),
    "decay, columns exchanged": ("", lambda: decay()[::-1], "decay"),
    "decay, strange heads": ("Kanal A;Kanal B", decay, "decay"),
    "decay, short": ("t [s];x", lambda: decay(cycles=1.5), "decay"),
    "decay, short, no heads": ("", lambda: decay(cycles=0.8), ""),
    "decay, called a frequency": ("frequency;amplitude", decay, ""),
    "decay, heads exchanged": ("x;t", decay, ""),
    "spectrum, by name": ("f [Hz];FFT [mm]", spectrum, "spectrum"),
    "spectrum, by unit": ("frequency;magnitude [mm/Hz]", lambda: spectrum(0.5, 1.5), "spectrum"),
    "spectrum, two modes": ("f;spectrum", lambda: spectrum(modes=2), "spectrum"),
    "spectrum, not named": ("frequency;magnitude", spectrum, ""),
    "spectrum, no heads": ("", spectrum, ""),
    "spectrum, a part": ("frequency;amplitude", lambda: spectrum(0.6, 1.5), ""),
    "spectrum, called a time": ("time;value", spectrum, ""),
    "spectrum of power": ("f;PSD [mm^2/Hz]", lambda: (spectrum()[0], spectrum()[1] ** 2), "spectrum"),
    "response, by name": ("f [Hz];FRF", response, "response"),
    "response, by unit": ("f [Hz];amplitude [mm/V]", lambda: response(noise=0.03), "response"),
    "response, log axis": ("frequency;amplitude", lambda: response("log"), "response"),
    "response, log axis, no heads": ("", lambda: response("log", 0.03), "response"),
    "response, refined": ("frequency;amplitude", lambda: response("refined", 0.02), "response"),
    "response, downward": ("frequency;amplitude", lambda: [each[::-1] for each in response()], "response"),
    "response, up and down": ("frequency;amplitude", lambda: both_ways(response()), "response"),
    "response, parts": ("f;Re;Im", lambda: complex_parts(response("log")[0]), "response"),
    "response, even": ("frequency;amplitude", response, ""),
    "response, even, no heads": ("", lambda: response(noise=0.03), ""),
    "response, short": ("", lambda: response("short"), ""),
    "response, from 0": ("frequency;magnitude", lambda: response("from 0", power=0), ""),
    "response, real part": ("frequency;H", lambda: complex_parts(response()[0])[:2], ""),
    "noise": ("", time_and_noise, ""),
}  # fmt: skip


def written(path: Path, heads: str, columns: Table) -> Path:
    rows = [";".join(f"{each:.9g}" for each in row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join([*([heads] if heads else []), *rows]) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("name", SIGNALS)
def test_a_signal_is_what_it_is_or_refused(name: str, tmp_path: Path) -> None:
    """The kind that was made, with its frequency to 2 %; or a refusal that says how to go on."""
    heads, made, kind = SIGNALS[name]
    path = written(tmp_path / "signal.csv", heads, made())
    if kind:
        found = identify_signal(path)
        assert (found.of, found.rows[0].value) == (kind, pytest.approx(FREQUENCY, rel=0.02))
        assert found.why
        return
    with pytest.raises(ValueError, match=r"say (which it is, )?--of"):
        identify_signal(path)


def test_a_refusal_names_what_each_reading_would_give(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv", "frequency;amplitude", response())
    with pytest.raises(ValueError, match="may be a spectrum") as caught:
        identify_signal(path)
    told = str(caught.value)
    assert "or a response (7.6 Hz, damping ratio 0.02): 'frequency' is called a frequency" in told
    assert told.endswith("say --of spectrum or --of response")


def test_a_reading_that_is_asked_for_is_taken_and_contradicted(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv", "frequency;FFT", response())
    found = identify_signal(path, "response", drive="base displacement")
    assert (found.of, found.why) == ("response", "--of says so, though 'FFT' is called a spectrum")
    assert found["damping ratio"].value == pytest.approx(RATIO, rel=1e-6)


def test_a_drive_says_that_it_is_a_response(tmp_path: Path) -> None:
    """The gain over a level of 0.6; without --drive the note says what the other drive would give."""
    path = written(tmp_path / "a.csv", "frequency;amplitude", response(power=0))
    found = identify_signal(path, drive="force", level=0.5)
    assert (found.of, found["gain"].value) == ("response", pytest.approx(2.0, rel=1e-6))
    (told,) = (each for each in identify_signal(path, "response").notes if "assumed" in each)
    assert (
        told
        == "a base displacement is assumed to drive it; to a force it would be 7.6 Hz, damping ratio 0.02: say --drive"
    )


@pytest.mark.parametrize(
    ("value", "uncertainty", "known"),
    [("mm", "", 0.02), ("mm", "µm", 2e-5), ("mm", "%", 0.006), ("dB", "dB", 10**1.5e-1 * (10**1e-3 - 1))],
)
def test_an_uncertainty_is_in_the_unit_of_its_value(value: str, uncertainty: str, known: float, tmp_path: Path) -> None:
    """The number 0.02 beside the value 30; beside 3 dB an amplitude by its slope."""
    at = np.arange(1.0, 9.0)
    size = 3.0 if value == "dB" else 30.0
    columns = (at, 0 * at + size, 0 * at + 0.02)
    head = f"f [Hz];a [{value}];u" + f" [{uncertainty}]" * bool(uncertainty)
    found = read_signal(written(tmp_path / "a.csv", head, columns)).uncertainty
    np.testing.assert_allclose(found, known, rtol=2e-3)


def test_columns_are_told_by_their_heads(tmp_path: Path) -> None:
    """Time in ms among other columns; decibels; a file of MATLAB with a complex response."""
    time, x = decay()
    path = written(tmp_path / "a.csv", "index;t [ms];phase;x [mm];uncertainty", (time, 1e3 * time, x, x, 1 + 0 * x))
    np.testing.assert_allclose(read_signal(path).at, time, rtol=1e-8)
    f, a = response()
    found = identify_signal(written(tmp_path / "b.csv", "f;FRF [dB]", (f, 20 * np.log10(a))))
    assert found["damping ratio"].value == pytest.approx(RATIO, rel=1e-6)
    assert any("decibels" in note for note in found.notes)
    savemat(tmp_path / "c.mat", {"data": {"f": f, "H": transfer(f)}})
    found = identify_signal(tmp_path / "c.mat")
    assert (found.of, found["damping ratio"].value) == ("response", pytest.approx(RATIO, rel=1e-6))
    assert found.why.startswith("'f' is called a frequency, 'H' is called a response")


@pytest.mark.parametrize(
    ("unit", "kind"),
    [
        ("mm/V", "response"), ("m/s^2/N", "accelerance"), ("mm/mm", "relative transmissibility"),
        ("mm/Hz", "spectrum"), ("V/√Hz", "spectrum"), ("mm s", "spectrum"), ("mm·s", "spectrum"),
        ("mm^2/Hz", "spectrum"), ("m/s", ""), ("m/s²", ""), ("µm/min", ""), ("mm", ""),
    ],
)  # fmt: skip
def test_units_of_values_are_clues(unit: str, kind: str, tmp_path: Path) -> None:
    """A ratio is of a response, a value times s or per Hz of a Fourier transform, its square of neither."""
    path = written(tmp_path / "a.csv", f"f [Hz];a [{unit}]", response())
    if kind:
        assert identify_signal(path).of == kind
        return
    with pytest.raises(ValueError, match=r"may be a spectrum .* or a response"):
        identify_signal(path)


@pytest.mark.parametrize(("function", "over", "kind"), [(4, 18, "response"), (1, 17, "decay")])
def test_a_universal_file_says_what_it_is(function: int, over: int, kind: str, tmp_path: Path) -> None:
    """Functions of data set 58: a frequency response, complex; a record over time."""
    pyuff = pytest.importorskip("pyuff")
    x, y = {"response": (response()[0], transfer(response()[0])), "decay": decay(), "spectrum": spectrum(0.5, 1.5)}[
        kind
    ]
    data = {
        "type": 58, "func_type": function, "rsp_node": 2, "rsp_dir": 3, "ref_node": 1, "ref_dir": 3, "data": y, "x": x,
        "id1": "a", "ordinate_spec_data_type": 8, "orddenom_spec_data_type": 0, "abscissa_spec_data_type": over,
        "binary": 0, "z_axis_value": 0, "z_axis_axis_units_lab": "NONE", "z_axis_spec_data_type": 0,
    }  # fmt: skip
    pyuff.UFF(str(tmp_path / "a.uff")).write_sets(data, "add")
    found = identify_signal(tmp_path / "a.uff")
    assert (found.of, found["natural frequency"].value) == (kind, pytest.approx(FREQUENCY, rel=0.01))


@pytest.mark.parametrize(
    ("heads", "columns", "said"),
    [
        ("t;f;x", 3, "has 't' and 'f': say over which it is, --x HEAD"),
        ("t;base;tip", 3, "there are 't', 'base', 'tip'; name it: --y HEAD"),
        (
            "",
            3,
            "no column is known as (time or frequency|frequency or time): there are none; name them: --x HEAD --y HEAD",
        ),
        ("x [mm];y [mm]", 2, "the unit 'mm' is neither one of time nor one of frequency"),
        ("t [Hz];x", 2, "'t' is in Hz .of a spectrum or a response., but 't' is called a time .of a decay., but"),
    ],
)
def test_columns_that_cannot_be_told_are_refused(heads: str, columns: int, said: str, tmp_path: Path) -> None:
    time, x = decay()
    with pytest.raises(ValueError, match=said):
        identify_signal(written(tmp_path / "a.csv", heads, [time, x, x][:columns]))
