"""Time series as loggers, sound cards and universal files hold them: records in SI, or one message with the cure."""

from __future__ import annotations

import re
import struct
import wave
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import pyuff
from scipy.io import savemat, wavfile

import vibeam
from vibeam.extensions.identification.signal_kind import identify_signal

RATE = 1000.0
TIME = np.arange(40) / RATE
VALUES = np.sin(2 * np.pi * 60 * TIME) + 0.25
G = 9.80665


def read(path: Path, content: Any = None, **form: Any) -> vibeam.Record:
    if content is not None:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return vibeam.record_of_file(path, **form)


def table(head: str = "t [ms];acc [g]", mark: str = ".", rows: Any = None) -> str:
    rows = zip(TIME * 1e3, VALUES, strict=True) if rows is None else rows
    return (
        "\n".join([head, *(";".join(f"{each!r}" for each in map(float, row)).replace(".", mark) for row in rows)])
        + "\n"
    )


TEXTS: list[tuple[str, dict[str, Any]]] = [
    (table(), {}),
    (table(mark=","), {}),
    (table("Logger 7\nStart: noon\n\nt;acc\nms;g"), {}),
    (table("zeit [ms];kanal 1 [g]"), {"column": "kanal 1", "time": "zeit"}),
    (table("zeit [ms];kanal 1 [g]"), {"column": 2, "rate": RATE}),
    (table("t [ms];acc", rows=zip(TIME * 1e3, VALUES * G, strict=True)), {}),
    (table("t [ms];acc [V]"), {"unit": "g"}),
    (table("zeit [ms];kanal 1 [g]"), {}),
    (table("t [ms];kanal 1 [g]"), {}),
    (table("zeit [ms];kanal 1 [g]"), {"time": "zeit"}),
    (table("t [ms];acc", rows=zip(TIME * 1e3, VALUES * 2, strict=True)), {"unit": "g", "scale": 0.5}),
    ("".join(f"{value!r}\n" for value in VALUES.tolist()), {"column": 1, "rate": RATE, "unit": "g"}),
]


@pytest.mark.parametrize(("text", "form"), TEXTS)
def test_text_is_a_record_in_si(tmp_path: Path, text: str, form: dict[str, Any]) -> None:
    record = read(tmp_path / "a.csv", text, **form)
    assert record.spacing == pytest.approx(1 / RATE, rel=1e-12)
    assert record.at(record.times) == pytest.approx(G * VALUES, rel=1e-12)


def test_a_quick_table_is_the_one_read_cell_by_cell(tmp_path: Path) -> None:
    """A dash for a number that is missing in a column not asked for sends the whole table the long way."""
    rows = np.column_stack([TIME, VALUES]).tolist()
    quick = read(tmp_path / "a.csv", table("time;acc;note", rows=[(*row, 1.0) for row in rows]))
    slow = read(
        tmp_path / "b.csv", table("time;acc;note", rows=[(*row, 1.0) for row in rows]).replace(";1.0\n", ";-\n")
    )
    assert quick == slow


def wav_bytes(path: Path, width: int) -> None:
    """A WAV file of two channels, of whole numbers of ``width`` bytes, by Python's own writer."""
    shares = np.column_stack([np.zeros(40), VALUES / 2])
    whole = np.round(shares * (2 ** (8 * width - 1) - 1)).astype(np.int64) + (128 if width == 1 else 0)
    with wave.open(str(path), "wb") as file:
        file.setnchannels(2)
        file.setsampwidth(width)
        file.setframerate(int(RATE))
        file.writeframes(b"".join(int(each).to_bytes(width, "little", signed=width > 1) for each in whole.ravel()))


@pytest.mark.parametrize("width", [1, 2, 3, 4])
def test_whole_numbers_of_a_wav_file_are_shares_of_the_scale(tmp_path: Path, width: int) -> None:
    wav_bytes(tmp_path / "a.wav", width)
    record = read(tmp_path / "a.wav", column=2, scale=2 * 30.0, unit="m/s^2")
    assert record.spacing == pytest.approx(1 / RATE, rel=1e-12)
    assert record.at(record.times) == pytest.approx(30 * VALUES, abs=30 * 2.1 * 2.0 ** (1 - 8 * width))


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_floats_of_a_wav_file_are_values(tmp_path: Path, kind: Any) -> None:
    wavfile.write(tmp_path / "a.wav", int(RATE), VALUES.astype(kind))
    record = read(tmp_path / "a.wav", quantity="force")
    assert record.quantity == "force"
    assert record.at(record.times) == pytest.approx(VALUES, abs=1e-7)


SAMPLES = np.round(VALUES / 2 * 32767).astype("<i2")


def riff(
    data: bytes = SAMPLES.tobytes(), size: int | None = None, whole: int | None = None, before: bytes = b"",
    behind: bytes = b"", channels: int = 1, form: bytes = b"", kind: bytes = b"RIFF",
) -> bytes:  # fmt: skip
    """A WAV file by its layout; ``size``, ``whole``: what its head says in place of its sizes."""
    order = ">" if kind == b"RIFX" else "<"
    form = form or struct.pack(f"{order}HHIIHH", 1, channels, 1000, 2000 * channels, 2 * channels, 16)
    size = len(data) if size is None else size
    parts = b"WAVE" + before + b"fmt " + struct.pack(f"{order}I", len(form)) + form
    parts += b"data" + struct.pack(f"{order}I", size) + data + behind
    return kind + struct.pack(f"{order}I", len(parts) if whole is None else whole) + parts


LIST = b"LIST" + struct.pack("<I", 5) + b"INFOx\0"
GUID = b"\0\0\0\0\x10\0\x80\0\0\xaa\0\x38\x9b\x71"
EXTENSIBLE = struct.pack("<HHIIHHHHIH", 0xFFFE, 1, 1000, 2000, 2, 16, 22, 16, 4, 1) + GUID
DS64 = b"ds64" + struct.pack("<IQQQI", 28, 136, 2 * len(SAMPLES), len(SAMPLES), 0)


@pytest.mark.parametrize(
    "raw",
    [
        riff(),
        riff(size=0xFFFFFFFF, whole=0xFFFFFFFF),
        riff(size=0x7FFFFFFF, whole=0x7FFFFFFF),
        riff(whole=0),
        riff(whole=4),
        riff(before=LIST, behind=LIST),
        riff(behind=b"some text"),
        riff(form=EXTENSIBLE),
        riff(data=SAMPLES.astype(">i2").tobytes(), kind=b"RIFX"),
        riff(before=DS64, size=0xFFFFFFFF, whole=0xFFFFFFFF, behind=LIST, kind=b"RF64"),
    ],
)
def test_wav_files_as_recorders_and_pipes_leave_them(tmp_path: Path, raw: bytes) -> None:
    record = read(tmp_path / "a.wav", raw, scale=2.0)
    assert (len(record.times), record.spacing) == (40, pytest.approx(1 / RATE, rel=1e-12))
    assert record.at(record.times) == pytest.approx(VALUES, abs=1e-4)


CUT = [
    (riff()[:-20], "is cut off: its head says 80 bytes, and 60 are there: record it again"),
    (riff(np.repeat(SAMPLES, 2).tobytes(), channels=2)[:-20], "says 160 bytes, and 140 are there"),
    (riff(size=82), "its head says 82 bytes, and 80 are there"),
    (riff()[:46], "its head says 80 bytes, and 2 are there"),
    (riff(b""), "holds 0 samples, 1000 a second: record it again"),
    (riff(b"", size=0, whole=0), "holds 0 samples, 1000 a second: record it again"),
    (riff(form=struct.pack("<HHIIHH", 1, 1, 0, 0, 2, 16)), "holds 40 samples, 0 a second: record it again"),
    (riff(form=struct.pack("<HHIIHH", 7, 1, 1000, 1000, 1, 8)), "is no WAV file that can be read: Unknown wave file"),
    (riff(size=0), "holds 0 samples, 1000 a second: record it again"),
    (riff(size=0, whole=0), "holds 0 samples, 1000 a second: record it again"),
    (riff(size=0xFFFFFFFF, data=SAMPLES.tobytes() + b"\1"), "is no WAV file that can be read"),
    (riff()[:40], "is no WAV file that can be read"),
]


@pytest.mark.parametrize(("raw", "message"), CUT)
def test_wav_files_that_are_cut_off_or_empty_are_refused(tmp_path: Path, raw: bytes, message: str) -> None:
    with pytest.raises(vibeam.CaseError, match=message) as caught:
        read(tmp_path / "a.wav", raw, scale=1.0)
    assert len(caught.value.faults) == 1


def test_a_decay_in_a_wav_file_is_fitted(tmp_path: Path) -> None:
    time = np.arange(4000) / 1000
    decay = np.exp(-0.02 * 2 * np.pi * 20 * time) * np.cos(2 * np.pi * 20 * np.sqrt(1 - 0.02**2) * time)
    (tmp_path / "a.wav").write_bytes(riff(np.round(32767 * decay).astype("<i2").tobytes()))
    found = identify_signal(tmp_path / "a.wav")
    assert (found.of, found["natural frequency"].value) == ("decay", pytest.approx(20, rel=1e-3))


def test_variables_and_datasets_are_records(tmp_path: Path) -> None:
    savemat(tmp_path / "a.mat", {"t": TIME, "acc": VALUES, "both": np.column_stack([TIME, VALUES])})
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["run/acc"] = VALUES * 1e3
        file["run/acc"].attrs["units"] = "mm/s^2"
        file["run/time"] = TIME
    for record in (
        read(tmp_path / "a.mat"),
        read(tmp_path / "a.mat", column="both:2", time="both:1"),
        read(tmp_path / "a.mat", column="acc", rate=RATE),
        read(tmp_path / "a.h5"),
        read(tmp_path / "a.h5", column="run/acc", rate=RATE),
    ):
        assert record.at(record.times) == pytest.approx(VALUES, rel=1e-12)
        assert record.spacing == pytest.approx(1 / RATE, rel=1e-12)


def universal(path: Path, over: int = 17, label: str = "g") -> Path:
    data = pyuff.prepare_58(
        func_type=1, rsp_node=3, rsp_dir=3, ref_node=0, ref_dir=0, data=VALUES, x=TIME, id1="a", binary=0,
        abscissa_spacing=1, abscissa_spec_data_type=over, ordinate_spec_data_type=12, ordinate_axis_units_lab=label,
        orddenom_spec_data_type=0,
    )  # fmt: skip
    pyuff.UFF(str(path)).write_sets([data], "overwrite")
    return path


def test_a_time_response_of_a_universal_file_is_a_record(tmp_path: Path) -> None:
    record = read(universal(tmp_path / "a.uff"))
    assert record.spacing == pytest.approx(1 / RATE, rel=1e-6)
    assert record.at(record.times) == pytest.approx(G * VALUES, rel=1e-5)  # six digits are written


SHORT = "time;acc\n0;1\n0.1;2\n0.2;1\n"
THREE = "time;kanal;b\n0;1;5\n0.1;2;5\n"
REPEATED = "time,acc\n0,0\n# a comment\n0.1,1\n0.1,2\n0.3,x\n"
LOST = table("time;acc", rows=zip(np.round(np.arange(40) / 51200, 6), VALUES, strict=True))
WRONG: list[tuple[str, dict[str, Any], str]] = [
    ("time;acc\n0;0\n0.1;1\n0.1;2\n0.3;3\n", {}, "a.csv: times: 1 repeated, line 4 (0.1 s): delete one of both"),
    ("time;acc\n0;0\n0.2;1\n0.1;2\n", {}, "a.csv: times: 1 before the one ahead of it, line 4 (0.1 s): sort them"),
    ("time;acc\n0;0\n0.1;\n0.2;2\n", {}, "a.csv: values: 1 sample no finite number, line 3: cut the record there"),
    ("time;acc\n0;0\n0.1;1\n;2\n", {}, "a.csv: times: 1 no finite number, line 4: fill them, or say the rate"),
    (table("time;acc", rows=[row for row in zip(TIME, VALUES, strict=True) if not 0.02 <= row[0] <= 0.022]), {},
     "a.csv: times: 1 gap before line 22 (0.023 s), 3 samples missing: fill them, or cut the record there"),
    (REPEATED, {}, "a.csv:6: 'x' is not a number"),
    (THREE, {}, "a.csv:1: has no column 'acceleration': there are 'time', 'kanal', 'b'; say column and time by head"),
    (THREE, {"column": 7}, "a.csv:1: has no column number 7: there are 'time', 'kanal', 'b'; say column"),
    ("1\n2\n3\n", {"column": 1}, "; say column and time by head or number from 1, or the rate"),
    ("time;acc\n0;1\n", {}, "a.csv: values: 1 sample, at least 2 make a record"),
    (SHORT, {"quantity": "velocity", "column": "acc"}, "a.csv: values: 3 samples, at least 4 make a record"),
    (SHORT, {"unit": "mm"}, "a.csv: column 'acc': the unit 'mm' is not one of m/s^2; say it: unit = \"…\""),
    (SHORT, {"unit": "g", "scale": 1e6}, "a.csv: an acceleration of 2e+06 g, more than 10⁶ g"),
    (SHORT, {"column": 0, "unit": 3, "scale": "x"}, "column: 0 must be a head, or a number from 1; unit: 3 must be"),
    (SHORT, {"quantity": "strain"}, "a.csv: quantity: 'strain' must be one of acceleration, force, moment"),
    (LOST, {}, "of one, by digits that were lost: say rate = 51181.1 Hz, or what it was before"),
    (SHORT, {"rate": 20.0}, "a.csv: rate is 20 Hz, and column 'time' has 10 samples a second: take rate out"),
    (SHORT, {"column": "time"}, "a.csv: column 'time' is that of the times: name that of the samples"),
    ("", {}, "a.csv: is empty"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "form", "message"), WRONG)
def test_what_is_no_record_is_refused_with_its_line(
    tmp_path: Path, text: str, form: dict[str, Any], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(vibeam.CaseError, match=re.escape(message)):
        read(tmp_path / "a.csv", text, **form)


def test_all_faults_of_a_file_are_said_at_once(tmp_path: Path) -> None:
    with pytest.raises(vibeam.CaseError) as caught:
        read(tmp_path / "a.csv", "time;acc\n0;0\n0.1;\n0.1;2\n0.05;3\n")
    assert len(caught.value.faults) == 3


def test_wav_files_that_are_none_are_refused(tmp_path: Path) -> None:
    wav_bytes(tmp_path / "a.wav", 2)
    for form, message in (
        ({"scale": 1.0}, "has 2 channels: say which, column = 1 … 2"),
        ({"column": 3, "scale": 1.0}, "has 2 channels: say which, column = 1 … 2"),
        ({"column": 1}, "holds shares of its full scale: say scale, the value of the full scale"),
    ):
        with pytest.raises(vibeam.CaseError, match=message):
            read(tmp_path / "a.wav", **form)
    with pytest.raises(vibeam.CaseError, match="is no WAV file that can be read"):
        read(tmp_path / "b.wav", b"RIFF" + bytes(100))


def test_a_file_outside_is_not_quoted(tmp_path: Path) -> None:
    with pytest.raises(vibeam.CaseError) as caught:
        read(tmp_path / "a.csv", "secret;words\n1;2\n", quote=False)
    assert "secret" not in str(caught.value)


def test_a_spectrum_is_no_record(tmp_path: Path) -> None:
    with pytest.raises(vibeam.CaseError, match="a record goes over time"):
        read(universal(tmp_path / "a.uff", over=18), rate=RATE)
