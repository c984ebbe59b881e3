"""Heads of oscilloscopes, loggers, phones and printers: units wherever they stand, and what was taken, in a line."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam

G = 9.80665
ROWS = [(0.0, 0.1), (1.0, 0.5), (2.0, -1.0), (3.0, 0.5), (4.0, 0.1)]  # ms and g


def table(*above: str, mark: str = ",", start: float = 0.0) -> str:
    return "\n".join([*above, *(f"{start + at:g}{mark}{value:g}" for at, value in ROWS)]) + "\n"


def read(tmp_path: Path, text: str, name: str = "a.csv", **form: Any) -> vibeam.Record:
    (tmp_path / name).write_text(text, encoding="utf-8")
    return vibeam.record_of_file(tmp_path / name, **form)


BY_NUMBER = {"column": 2, "time": 1}
IN_MS_AND_G = [
    (table("t,a", "ms,g"), BY_NUMBER),
    (table("t,a", "ms,g"), {}),
    (table("t,a", "[ms],[g]"), BY_NUMBER),
    (table("Time,Channel A", "(ms),(g)", ""), {"column": "Channel A"}),  # PicoScope
    (table("Time,Channel A", "(ms),(g)", ""), BY_NUMBER),
    (table("t,a", "# ms,g"), BY_NUMBER),
    (table("# t,a", "# ms,g"), BY_NUMBER),
    (table("ms,g", "t,a"), {}),
    (table("ms,g"), BY_NUMBER),
    (table("t,a", "# made today", "ms,g"), BY_NUMBER),
    (table("made today, by me, and her", "t,a", "ms,g"), BY_NUMBER),
    (table("# time in ms", "t,acc [g]"), {}),
    (table("# time in ms, acceleration in g"), BY_NUMBER),
    (table("# time in ms", "# acceleration: g"), BY_NUMBER),
    (table("time/ms,acc/g"), {}),
    (table("time in ms,(g) ch1"), BY_NUMBER),
    (table("t_ms,acc_g"), {}),
    (table("t ms,acc g"), {}),
    (table("t [ms],acceleration [g] raw"), {}),
    (table("t [ms],acceleration raw, g".replace("raw, g", "raw / g")), {}),
    (table("t (msec),Acc (G)"), {}),
    (table("Units: ms, g", "t,a"), {}),
    (table("# units = ms;g", "t,a"), BY_NUMBER),
    (table("Horizontal Units,ms", "Vertical Units,g", "TIME,CH1"), {"column": "CH1"}),  # Tektronix
    (table('"Horizontal Units","ms"', '"Vertical Units","g"', "TIME,CH1"), BY_NUMBER),
    (table("X Units: ms", "Y Units: g", "x,y"), BY_NUMBER),
    (table("t;a", "ms;g", mark=";"), BY_NUMBER),
    (table("t\ta", "ms\tg", mark="\t"), BY_NUMBER),
    (table("t a", "ms g", mark=" "), BY_NUMBER),
    (table("t,a", "ms;g"), BY_NUMBER),
    (table("Zeit [ms];Beschleunigung [g]", mark=";"), {}),
    (table("#Digilent WaveForms Oscilloscope Acquisition", "#Device: X", "", "Time (ms),Channel 1 (g)"), BY_NUMBER),
    (table('"Time (ms)","Acceleration x (g)"'), {"column": "Acceleration x"}),  # phyphox
    (table("x-axis,1", "ms,g"), BY_NUMBER),  # Keysight
    (table("x-axis,1", "ms,g"), {"column": "1"}),
    (table("Time(ms),CH1(g)"), {"column": "CH1"}),  # Rigol
    (table("t/ms,a/g"), BY_NUMBER),  # as DIN 1313 has it, and no tonne
    (table("Time<ms>,Acc<g>"), BY_NUMBER),
    (table("t|ms,a|g"), BY_NUMBER),
    (table("in ms,C1 in g"), BY_NUMBER),  # Rohde & Schwarz
    (table("ACCELERATION IN UNITS OF G", "# time given in ms", "t,acc"), BY_NUMBER),
]


@pytest.mark.parametrize(("text", "form"), IN_MS_AND_G)
def test_a_unit_is_read_wherever_it_stands(tmp_path: Path, text: str, form: dict[str, Any]) -> None:
    record = read(tmp_path, text, **form)
    assert record.spacing == pytest.approx(1e-3, rel=1e-12)
    assert record.at(record.times) == pytest.approx([G * value for _, value in ROWS], rel=1e-12)
    value, clock = record.taken.columns
    assert (value.place, value.unit.casefold(), clock.unit) in {("column 2", "g", "ms"), ("column 2", "g", "msec")}


@pytest.mark.parametrize(
    ("text", "form", "message"),
    [
        (table("x-axis,1", "second,Volt"), BY_NUMBER, "the unit 'Volt' is not one of m/s^2"),
        (table("t,a", "ms,V"), BY_NUMBER, "the unit 'V' is not one of m/s^2"),
        (table("t,a", "mm,g"), BY_NUMBER, "the unit 'mm' is not one of s"),
        (table("t,a", "ms,counts"), BY_NUMBER, "the unit 'counts' is not known"),
        (table("t,a", "(ms),(LSB)"), BY_NUMBER, "the unit 'LSB' is not known"),
        (table("t [s],a [g]", "ms,g"), {}, "the unit 's or ms' is not known"),
        (table("t,a [m/s^2]", "ms,g"), {}, "the unit 'm/s^2 or g' is not known"),
        (table("Vertical Units: V", "t,a"), {}, "the unit 'V' is not one of m/s^2"),
        (table("# acceleration in V", "t,a"), {}, "the unit 'V' is not one of m/s^2"),
        (table("t,a", "ms,g,N"), BY_NUMBER, ":2: 3 cells above 2 columns of numbers"),
        (table("t,a", "made by me"), {}, ":2: 1 cell for 2 columns"),
        (table("t,a", "off,on"), {}, ":2: 'off' is not a number"),
        (table("X,CH1", "Sequence,Volt"), {"column": "CH1", "time": "X"}, "the unit 'Volt' is not one of"),
        (table("X,CH1", "Sequence,g"), {"column": "CH1", "time": "X"}, "the unit 'Sequence' is not known; say"),
        (table("t [ms],a [g"), BY_NUMBER, "the unit 'a [g' is not known"),
        (table("t [ms],a (g]"), {}, "the unit 'a (g]' is not known"),
        (table("t,a", "ms,(g"), BY_NUMBER, "the unit '(g' is not known"),
        (table("f [Hz],a [g]"), {"time": "f"}, "is in Hz: a record goes over time"),
    ],
)  # fmt: skip
def test_a_unit_that_does_not_suit_is_a_fault(
    tmp_path: Path, text: str, form: dict[str, Any], message: str
) -> None:  # fmt: skip
    with pytest.raises(vibeam.CaseError) as caught:
        read(tmp_path, text, **form)
    assert message in str(caught.value)


def test_settings_beside_the_numbers_are_read_too(tmp_path: Path) -> None:
    """Older Tektronix files have them in the first columns of the rows of numbers."""
    beside = ["Record Length,5,,", "Horizontal Units,ms,,", "Vertical Units,g,,", ",,,", ",,,"]
    text = "\n".join(f"{left}{at:g},{value:g}" for left, (at, value) in zip(beside, ROWS, strict=True))
    record = read(tmp_path, text, column=5, time=4)
    assert (record.duration, record.peak) == (pytest.approx(4e-3), pytest.approx(G))


def test_the_line_says_what_was_taken_and_what_was_not_said(tmp_path: Path) -> None:
    said = read(tmp_path, table("t,a", "ms,g"), **BY_NUMBER).taken
    row = "(from the row below the heads)"
    assert str(said) == f"taken: column 2 'a', g {row}, column 1 't', ms {row}, 1 000 Hz from 0 s"
    plain = str(read(tmp_path, table("t,a")).taken)
    assert plain.count("no unit in the file: taken so") == 2
    assert "g (as said, not V)" in str(read(tmp_path, table("t,a [V]"), unit="g").taken)
    assert "its head says rms values" in str(read(tmp_path, table("t [ms],Acc (g rms)")).taken)


def test_a_start_and_a_stretch_by_the_clock_of_the_file(tmp_path: Path) -> None:
    text = table("t [s],a [g]", start=9000.0)
    assert read(tmp_path, text).start == 9000.0
    first = read(tmp_path, text, start="first sample")
    assert (first.start, first.duration) == (0.0, 4.0)
    assert str(first.taken).endswith("1 Hz from 9 000 s, which is taken as 0")
    assert read(tmp_path, text, start=9001.0).start == -1.0
    cut = read(tmp_path, text, since=9001.0, until=9003.0, start="first sample")
    assert cut.at([0.0, 1.0, 2.0]) == pytest.approx([0.5 * G, -G, 0.5 * G])
    assert "2 of 5 samples left out by from and to" in str(cut.taken)
    assert read(tmp_path, text, rate=1.0, since=9001.0).start == 9001.0  # the first time is the file's own
    assert read(tmp_path, text, column=2, rate=1.0, time=1, start="first sample").start == 0.0
    for wrong, message in (({"since": 1, "until": 2}, "from 1 s to 2 s: its clock goes from 9000 to 9004 s"),
                           ({"since": 3, "until": 2}, "has no sample from 3 s to 2 s"),
                           ({"start": "last"}, "start: 'last' must be")):  # fmt: skip
        with pytest.raises(vibeam.CaseError) as caught:
            read(tmp_path, text, **wrong)
        assert message in str(caught.value)


def test_uneven_times_stay_and_are_said(tmp_path: Path) -> None:
    record = read(tmp_path, "t [s],a [g]\n0,0\n1,1\n1.5,2\n4,0\n5,1\n9,3\n")
    assert record.times.tolist() == [0, 1, 1.5, 4, 5, 9]
    assert str(record.taken).endswith("6 points from 0 to 9 s; uneven steps of 0.5 to 4 s")


@pytest.mark.parametrize(("how", "cure"), [("rms", 1.41421), ("pk-pk", 0.5), ("p-p", 0.5), ("RMS", 1.41421)])
@pytest.mark.parametrize("head", ["x [mm {}]", "x (mm) {}", "x {} [mm]", "x_mm_{}"])
def test_amplitudes_are_neither_rms_nor_peak_to_peak(tmp_path: Path, head: str, how: str, cure: float) -> None:
    file, columns = tmp_path / "a.csv", {"frequency": 1, "amplitude": 2}
    file.write_text(f"f [Hz],{head.format(how)}\n14,1\n15,2\n")
    with pytest.raises(vibeam.CaseError, match=f"values, and amplitude .*: say scale = {cure}"):
        vibeam.read_curve(file, "amplitude", vibeam.ReferenceForm(columns=columns, unit="m"))
    curve = vibeam.read_curve(file, "amplitude", vibeam.ReferenceForm(columns=columns, unit="m", scale=cure))
    np.testing.assert_allclose(curve.value, [1e-3 * cure, 2e-3 * cure])


def test_a_row_of_units_of_a_curve_counts_by_number(tmp_path: Path) -> None:
    file, form = tmp_path / "a.csv", vibeam.ReferenceForm(columns={"frequency": 1, "amplitude": 2}, unit="m")
    file.write_text("f,u\nkHz,um\n0.010,100\n0.011,150\n")
    curve = vibeam.read_curve(file, "amplitude", form)
    np.testing.assert_allclose([curve.frequency, curve.value], [[10, 11], [1e-4, 1.5e-4]])
    assert str(curve.taken).startswith("taken: response curve: column 2 'u', um (from the row below the heads)")
