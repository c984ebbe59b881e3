"""LabVIEW's measurement files: read by both of their heads, or a fault with its line."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam

G, STEP = 9.80665, 0.00025
X, Y = [0.5, -1.25, 2.0, 0.75], [3.0, 1.0, -2.0, 0.5]


def content(
    columns: str = "Multi", mark: str = "\t", decimal: str = ".", segments: int = 1, unit: str = "g", **said: Any
) -> str:
    """A file of two channels, ax and ay; ``said``: other entries of the heads of its segments."""
    rows = {"LabVIEW Measurement": "", "Writer_Version": "2", "Reader_Version": "2",
            "Separator": "Tab" if mark == "\t" else "Comma", "Decimal_Separator": decimal, "Multi_Headings": "Yes",
            "X_Columns": columns, "Time_Pref": "Absolute", "Operator": "me", "Date": "2024/02/29"}  # fmt: skip
    pair = (lambda cell: ["", cell, "", cell]) if columns == "Multi" else lambda cell: ["", cell, cell]
    heads = ["X_Value", "ax", "X_Value", "ay"] if columns == "Multi" else ["X_Value", "ax", "ay"]
    text = [mark.join([name, *([value] if value else [])]) for name, value in rows.items()]
    text.append("***End_of_Header***" + mark)
    for segment in range(segments):
        begun = f"10:00:0{segment},5" if decimal == "," else f"10:00:0{segment}.5"
        entries = {"Samples": "4", "Date": "2024/02/29", "Time": begun, "Y_Unit_Label": unit, "X_Dimension": "Time",
                   "X0": "0.0000000000000000E+0", "Delta_X": f"{STEP}"} | said  # fmt: skip
        text += [mark, mark.join(["Channels", "2"])]
        for name, value in entries.items():
            if value is not None and (name == "Date" or name not in rows):
                text.append(mark.join([name, *pair(value)[1:]]).replace(".", decimal))
        text += ["***End_of_Header***" + mark, mark.join([*heads, "Comment"])]
        for row, (x, y) in enumerate(zip(X, Y, strict=True)):
            at = "" if columns == "No" else f"{row * STEP:.6f}"
            cells = [at, f"{x:.6f}", at, f"{y:.6f}"] if columns == "Multi" else [at, f"{x:.6f}", f"{y:.6f}"]
            text.append(mark.join(cells).replace(".", decimal) + (f"{mark}LOST IT" if row == 1 else ""))
    return "\n".join(text) + "\n"


def read(tmp_path: Path, text: str, name: str = "a.lvm", **form: Any) -> vibeam.Record:
    (tmp_path / name).write_text(text)
    return vibeam.record_of_file(tmp_path / name, **{"column": "ay"} | form)


@pytest.mark.parametrize("columns", ["No", "One", "Multi"])
@pytest.mark.parametrize(("mark", "decimal"), [("\t", "."), ("\t", ","), (",", ".")])
@pytest.mark.parametrize("name", ["a.lvm", "a.txt"])
def test_a_channel_is_a_record_in_si(tmp_path: Path, columns: str, mark: str, decimal: str, name: str) -> None:
    text = content(columns, mark, decimal)
    for form in ({}, {"column": 4 if columns == "Multi" else 3}, {"time": "X_Value"}, {"rate": 1 / STEP}):
        record = read(tmp_path, text, name, **form)
        assert record.spacing == pytest.approx(STEP, rel=1e-12)
        assert record.at(record.times) == pytest.approx([G * each for each in Y], rel=1e-12)
        place = 4 if columns == "Multi" else 3
        assert str(record.taken).startswith(f"taken: column {place} 'ay', g (from Y_Unit_Label)")


def test_numbers_are_those_without_a_decimal_separator_too(tmp_path: Path) -> None:
    record = read(tmp_path, content().replace("Decimal_Separator\t.\n", ""))
    assert record.peak == pytest.approx(3 * G)


def test_segments_lie_where_their_clock_has_them(tmp_path: Path) -> None:
    """Of 1 s each: the second begins 1 s after the first, by date and time; it goes on where X0 says so."""
    apart = read(tmp_path, content("No", segments=2, Delta_X="0.25"))
    assert apart.times == pytest.approx(np.arange(8) / 4)
    assert apart.at(apart.times) == pytest.approx(np.tile(Y, 2) * G)
    assert "2 segments" in str(apart.taken)
    late = content("No", segments=2, Delta_X="0.25").replace("10:00:01.5", "10:00:06.5")
    assert read(tmp_path, late).times[3:5].tolist() == [0.75, 6.0]
    assert "uneven steps of 0.25 to 5.25 s" in str(read(tmp_path, late).taken)
    same = content("No", segments=2).replace("10:00:01.5", "10:00:00.5")
    with pytest.raises(vibeam.CaseError, match="before the end of the one ahead: keep one segment"):
        read(tmp_path, same)


def test_digits_that_times_lost_are_those_of_the_step(tmp_path: Path) -> None:
    text = content("One", Delta_X="0.0002501")
    assert read(tmp_path, text).spacing == pytest.approx(0.0002501, rel=1e-12)
    uneven = content("One", Delta_X="1.0").replace("0.000750", "0.000950")
    assert read(tmp_path, uneven).times == pytest.approx([0, 0.00025, 0.0005, 0.00095])


def test_a_short_file_and_an_empty_channel_are_said(tmp_path: Path) -> None:
    assert "4 samples for the 9 that its head says" in str(read(tmp_path, content(Samples="9")).taken)
    text = content("One").replace("\t3.000000", "\t").replace("\t1.000000", "\t").replace("\t0.500000", "\t")
    with pytest.raises(vibeam.CaseError, match="has no number in the column 'ay'"):
        read(tmp_path, text.replace("\t-2.000000", "\t"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("Y_Unit_Label\tg\tg", "Y_Unit_Label\tg\tVolts", "the unit 'Volts' is not one of m/s^2"),
        ("Y_Unit_Label\tg\tg", "Y_Unit_Label\tg\tcounts", "the unit 'counts' is not known"),
        ("Y_Unit_Label", "Y_Unit_Lable", "is no row of numbers, and no entry of a head"),
        ("Delta_X", "Delta_Y", "is no row of numbers, and no entry of a head"),
        ("Separator\tTab", "Separator\tBar", "Separator is 'Bar', and must be one of Tab, Comma"),
        ("Separator\tTab", "Separator\tComma", ""),
        ("Decimal_Separator\t.", "Decimal_Separator\t,", "is not a number with the decimal sign ','"),
        ("X_Columns\tNo", "X_Columns\tTwo", "X_Columns is 'Two', and must be one of No, One, Multi"),
        ("Channels\t2", "Channels\t3", "has 2 heads of channels behind 'X_Value', and 3 Channels above"),
        ("X_Value\tax\tay", "X_Value\tax", "has 1 heads of channels"),
        ("\t2.000000\t-2.000000", "\t2.000000\t-2.0.0", "'-2.0.0' is not a number"),
        ("\t2.000000\t-2.000000", "\t2.000000", "cells for 4 columns"),
        ("\t2.000000\t-2.000000", "\t2.000000\t-2.000000\t7\t8", "cells for 4 columns"),
        ("\t2.000000\t-2.000000", "end", "'end' is no row of numbers, and no entry of a head"),
        ("Delta_X\t0.00025\t0.00025", "", "has no abscissa and no Delta_X above 0"),
        ("Delta_X\t0.00025\t0.00025", "Delta_X\t0.0\t0.0", "has no abscissa and no Delta_X above 0"),
        ("X_Dimension\tTime\tTime", "X_Dimension\tFrequency\tFrequency", "Hz"),
        ("***End_of_Header***", "***End***", "'***End***' is not at its place"),
    ],
)  # fmt: skip
def test_a_damaged_head_is_a_fault(tmp_path: Path, old: str, new: str, message: str) -> None:
    text = content("No")
    assert old in text
    with pytest.raises(vibeam.CaseError) as caught:
        read(tmp_path, text.replace(old, new, 1))
    assert message in str(caught.value)
