"""Measured curves as instruments and spreadsheets write them: read, or one message with file, line and cure."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from vibeam.exchange.curves.record import ReferenceForm
from vibeam.exchange.curves.reference import read_curve
from vibeam.exchange.faults import CaseError
from vibeam.exchange.units import factor

F, X, U = [14.0, 14.5, 15.0], [1.25e-4, 2.5e-4, 1e-3], [1e-6, 2e-6, 3e-6]
MAPPED = ReferenceForm(columns={"frequency": "f", "amplitude": "x"}, unit="m")


def curve(tmp_path: Path, content: str | bytes, name: str = "a.csv", **form: Any) -> Any:
    file = tmp_path / name
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_curve(file, "amplitude", ReferenceForm(**({"columns": MAPPED.columns, "unit": "m"} | form)))


@pytest.mark.parametrize(
    "text",
    [
        "f [Hz],x [mm]\n14,0.125\n14.5,0.25\n15,1\n",
        "f [Hz];x [mm]\n14;0,125\n14,5;0,25\n15;1,0\n",
        "f [Hz]\tx [mm]\n14,0\t1,25e-1\n14,5\t2,5E-1\n15\t1\n",
        "f (Hz) | x (um)\n14|125\n14.5|250\n15|1000\n",
        "f / Hz, x / mm\r\n14,.125\r\n14.5,.25\r\n15,1.\r\n",
        '"f, Hz";"x, mm";\n"14";"0,125";\n"14,5";"0,25";\n"15";"1";\n',
        "Instrument: laser\nDate: 1 May\n\nf [Hz];x [mm];phase\n14;0.125;1\n14.5;0.25;2\n15;1;\n",
        "f;x\nHz;mm\n14;0.125\n14.5;0.25\n15;1\n",
        "f\tx\n[Hz]\t[mm]\n14\t0.125\n14.5\t0.25\n15\t1\n",
        "# f [Hz]   x [mm]\n# made today\n14   0.125\n14.5 0.25\n\n15  1.0D0\n",
        "\ufefff [Hz],x [mm]\r\r\n14,0.125\r\r\n14.5,0.25\r\r\n15,1\r\r\n",
        "f [kHz];x [nm]\n0,014;125.000,0\n0,0145;250.000,0\n0,015;1.000.000,0\n",
        "f [kHz];x [nm]\n0.014;125 000\n0.0145;250 000\n0.015;1\u202f000\u00a0000\n",
        "f [rad/s];x [mm]\n87.96459430051421;0.125\n91.10618695410399;0.25\n94.24777960769379;1\n",
        "x [mm],f [Hz],more\n0.125,14,\n0.25,14.5,\n1,15,\n,,\n",
        "f [Hz],x [mm]\r14,0.125\r14.5,0.25\r15,1\r",
    ],
)  # fmt: skip
def test_a_table_of_text_is_read_in_si(tmp_path: Path, text: str) -> None:
    found = curve(tmp_path, text)
    np.testing.assert_allclose(found.frequency, F, rtol=1e-14)
    np.testing.assert_allclose(found.value, X, rtol=1e-14)
    assert found.direction == (None, None, None)
    assert np.isnan(found.uncertainty).all()


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_heads_in_any_alphabet_and_encoding(tmp_path: Path, encoding: str) -> None:
    text = "Größe µ; f [Hz]; Auslenkung ½ [µm]\n0;14;125\n0;14,5;250\n0;15;1000,0\n"
    found = curve(
        tmp_path, text.encode(encoding), columns={"frequency": "f", "amplitude": "Auslenkung ½"}
    )  # fmt: skip
    np.testing.assert_allclose(found.value, X)


def test_columns_by_number_without_heads(tmp_path: Path) -> None:
    found = curve(tmp_path, "sweep 1\n0 14 0.125\n0 14.5 0.25\n0 15 1\n", columns={"frequency": 2, "amplitude": 3},
                  units={"amplitude": "mm"})  # fmt: skip
    np.testing.assert_allclose(found.value, X)


def test_usual_heads_need_no_mapping(tmp_path: Path) -> None:
    found = curve(tmp_path, "Frequency (Hz),Amplitude (mm),Uncertainty (um),Direction\n14,0.125,1,up\n15,1,3,Down\n",
                  columns={})  # fmt: skip
    assert found.direction == ("up", "down")
    np.testing.assert_allclose(found.uncertainty, [1e-6, 3e-6])


def test_scale_offset_window_and_uncertainty(tmp_path: Path) -> None:
    """Volts of a laser of 2 mm/V, doubled by no one: x = 2e-3 · V + 1e-5, and 1 % of it beside."""
    found = curve(tmp_path, "f [Hz];x [V]\n14;0,0625\n14,5;0,125\n15;0,5\n", scale=2.0, scale_unit="mm/V")
    np.testing.assert_allclose(found.value, X)
    assert curve(tmp_path, "f;x\n14;1\n15;2\n", scale_unit="mm/V").value.tolist() == [1e-3, 2e-3]
    shifted = curve(tmp_path, "f;x\n14;1\n15;2\n16;3\n", scale=0.5, offset=1.0, window=(14.5, 16), uncertainty=0.01,
                    relative=True)  # fmt: skip
    np.testing.assert_allclose(shifted.value, [2.0, 2.5])
    np.testing.assert_allclose(shifted.uncertainty, [0.02, 0.025])
    with_column = curve(tmp_path, "f;x [mm];u [%]\n14;2;1\n15;4;\n", scale=0.5, uncertainty=7.0,
                        columns=MAPPED.columns | {"uncertainty": "u"})  # fmt: skip
    np.testing.assert_allclose(with_column.uncertainty, [1e-5, 7.0])


def test_units_are_those_of_the_quantity() -> None:
    assert factor("mm", "m") == 1e-3
    assert factor("rpm", "Hz") == pytest.approx(1 / 60, rel=1e-15)
    assert factor("g", "m/s^2") == 9.80665
    assert factor("mV", "m", ["2", "mm/V"][1]) == pytest.approx(1e-6, rel=1e-15)
    for unit, wanted in (("kg", "m"), ("V", "m"), ("1/s", "Hz"), ("furlong", "m"), ("mm", "1")):
        with pytest.raises(ValueError, match=unit):
            factor(unit, wanted)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("f,x\n14,1\n15,2,3\n", ":3: 3 cells for 2 columns: decimal commas between commas? Export with semicolons"),
        ("f;x\n14;1,234\n", ":2: '1,234' may be 1234 or 1.234: say decimal"),
        ("f;x\n14,5;1,5\n15.5;2.5\n", ":3: '14,5' and '15.5' have different decimal signs"),
        ("f;x\n14;1.5E+00-2.5E+00\n", ":2: '1.5E+00-2.5E+00' is not a number: two numbers without a blank"),
        ("f;x\n14;1.5 mm\n", ":2: '1.5 mm' is not a number: write the unit into the head"),
        ("f;x\n14;1\nend of file\n", ":3: 1 cell for 2 columns, 'end of file': complete the line, delete it, or"),
        ("f;x\n14;1\nend;\n", ":3: 'end' is not a number: delete the line, or begin it with #"),
        ("f x u\n14 1 2\n15\n", ":3: 1 cell for 3 columns, '15': complete the line, delete it, or begin it with #"),
        ("f;x\n;1\n", ":2: the frequency is missing"),
        ("f;x\n-3;1\n", ":2: the frequency -3 Hz is not above 0"),
        ("f;x\n14;1e999\n", ":2: '1e999' is not a finite number"),
        ("f;x\n", "has no line of numbers below its heads"),
        ("f;y\n1;2\n", ":1: has no column 'x': there are 'f', 'y'; say which in the case: columns"),
        ("f;x;x\n1;2;3\n", "has 2 columns 'x': say which by its number"),
        ("f;x [CH 1]\n1;2\n", "column 'x': the unit 'CH 1' is not known; say it in the case: units = { amplitude"),
        ("f;x [kg]\n1;2\n", "column 'x': the unit 'kg' is not one of m"),
        (b"PK\x03\x04rest", "is a workbook, not text: save the sheet as CSV"),
        (b"f;x\n1;2\0\n", "it is not UTF-8 text"),
    ],
)
def test_a_file_that_is_no_curve_says_where_and_what_to_do(
    tmp_path: Path, text: str | bytes, message: str
) -> None:  # fmt: skip
    with pytest.raises(CaseError) as caught:
        curve(tmp_path, text)
    assert len(caught.value.faults) == 1
    assert message in str(caught.value)


def test_ambiguous_signs_can_be_said(tmp_path: Path) -> None:
    assert curve(tmp_path, "f;x\n14;1,234\n", decimal=",").value.tolist() == [1.234]
    assert curve(tmp_path, "f;x\n14;1,234\n", decimal=".").value.tolist() == [1234.0]
    assert curve(tmp_path, "f;x\n14,250;1.234,5\n").frequency.tolist() == [14.25]


def matlab(path: Path) -> None:
    savemat(path, {"data": {"f": np.array(F), "x": 1e3 * np.array(X)}, "other": 1.0})


def matlab_73(path: Path) -> None:
    with h5py.File(path, "w", userblock_size=512) as file:
        file["data/f"] = np.array(F)[None]
        file["data/x"] = np.rec.fromarrays([0.6e3 * np.array(X), 0.8e3 * np.array(X)], names="real,imag")[None]


def hdf5(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file["data/f"] = np.array(F)
        file["data/x"] = np.stack([np.zeros(3), 1e3 * np.array(X)], axis=1)
        file["data/x"].attrs["units"] = "mm"


@pytest.mark.parametrize(
    ("write", "name", "column"),
    [(matlab, "a.mat", "data.x"), (matlab_73, "b.mat", "x"), (hdf5, "c.h5", "data/x:2")],
)
def test_arrays_of_matlab_and_hdf5(
    tmp_path: Path, write: Callable[[Path], None], name: str, column: str
) -> None:  # fmt: skip
    """Structs, complex values (their moduli: 0.6, 0.8 and 1 are a right triangle), columns of an array, units."""
    write(tmp_path / name)
    form = ReferenceForm(columns={"frequency": "f", "amplitude": column}, unit="m", units={"amplitude": "mm"})
    found = read_curve(tmp_path / name, "amplitude", form)
    np.testing.assert_allclose(found.frequency, F)
    np.testing.assert_allclose(found.value, X, rtol=1e-14)


def test_arrays_that_do_not_fit(tmp_path: Path) -> None:
    hdf5(tmp_path / "a.h5")
    (tmp_path / "b.mat").write_bytes(b"MATLAB 5.0 MAT-file, cut off")
    for name, column, message in (
        ("a.h5", "y", "has no column 'y': there are 'data/f', 'data/x'"),
        ("a.h5", "x", "'data/x' has the shape (3, 2): say which column, \"data/x:2\""),
        ("a.h5", "x:3", "'data/x' has the shape (3, 2): it has no column 3"),
        ("b.mat", "x", "is no MATLAB file that can be read"),
    ):
        with pytest.raises(CaseError) as caught:
            read_curve(tmp_path / name, "amplitude", ReferenceForm(columns={"frequency": "f", "amplitude": column}))
        assert message in str(caught.value)


def universal(path: Path, values: Any = X, kind: int = 18, count: int = 1) -> None:
    pyuff = pytest.importorskip("pyuff")
    data = {
        "type": 58, "func_type": 1, "rsp_node": 2, "rsp_dir": 3, "ref_node": 1, "ref_dir": 3, "data": np.array(values),
        "x": np.array(F), "id1": "FRF", "ordinate_spec_data_type": 8, "ordinate_axis_units_lab": "mm",
        "abscissa_spec_data_type": kind, "abscissa_axis_units_lab": "Hz" if kind == 18 else "s", "binary": 0,
        "orddenom_spec_data_type": 0, "z_axis_value": 0, "z_axis_axis_units_lab": "NONE", "z_axis_spec_data_type": 0,
    }  # fmt: skip
    writer = pyuff.UFF(str(path))
    for _ in range(count):
        writer.write_sets(data, "add")


def test_a_universal_file_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    universal(path, 1e3 * np.array(X) * np.exp(0.3j))
    found = read_curve(path, "amplitude", ReferenceForm(unit="m"))
    np.testing.assert_allclose(found.value, X, rtol=1e-5)
    np.testing.assert_allclose(found.frequency, F)


def damaged(path: Path, change: Callable[[bytes], bytes]) -> Path:
    path.write_bytes(change(path.read_bytes()))
    return path


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda raw: raw.replace(b"\n", b"\r\n"), ""),
        (lambda raw: raw.replace(b"FRF", b"Gr\xf6\xdfe"), ""),
        (lambda raw: raw.replace(b"  1.25", b"  1.2x"), "a.uff:14: '1.2x"),
        (lambda raw: raw.replace(b"e+01   2.5", b"e+012.5"), "a.uff:14: '1.45000e+012.5"),
        (lambda raw: raw[: len(raw) * 3 // 4], "a.uff:2: its data set 58 does not end: is the file cut off?"),
        (lambda raw: b"no such thing\n", "a.uff: has 0 data sets 58, the curves of such a file"),
        (lambda raw: b"", "a.uff: is empty"),
    ],
)
def test_a_damaged_universal_file_is_read_or_refused(tmp_path: Path, change: Any, message: str) -> None:
    universal(tmp_path / "a.uff", 1e3 * np.array(X))
    path = damaged(tmp_path / "a.uff", change)
    if not message:
        np.testing.assert_allclose(read_curve(path, "amplitude", ReferenceForm(unit="m")).value, X, rtol=1e-5)
        return
    with pytest.raises(CaseError) as caught:
        read_curve(path, "amplitude", ReferenceForm(unit="m"))
    assert len(caught.value.faults) == 1
    assert message in str(caught.value)


def test_which_curve_of_a_universal_file(tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    universal(path, 1e3 * np.array(X), count=2)
    with pytest.raises(CaseError, match=r"has 2 data sets 58, 1: 2Z/1Z, 2: 2Z/1Z: say which by its number"):
        read_curve(path, "amplitude", ReferenceForm(unit="m"))
    assert len(read_curve(path, "amplitude", ReferenceForm(unit="m", columns={"amplitude": 2})).points) == 3
    universal(tmp_path / "b.uff", kind=17)
    with pytest.raises(CaseError, match="not over frequency"):
        read_curve(tmp_path / "b.uff", "amplitude", ReferenceForm(unit="m"))


SEEDS = (
    "f [Hz];x [mm];u\n14,5;0,125;1\n15,5;0,25;\n", "frequency_hz,direction,amplitude\n14,up,1e-3\n15,down,2e-3\n",
    "# c\nf x\nHz mm\n14 1\n15 2\n", 'f,x\n14,"1,234.5"\n',
)  # fmt: skip
PIECES = ";,\t\"\n\r\0-e+.[](é\ufeff #%\x85\u2028'"


def test_whatever_a_file_holds_it_is_read_or_told(tmp_path: Path) -> None:
    """Characters put in, taken out, other encodings, files cut off: a curve, or faults; never another exception."""
    outcomes = set()
    for number in range(200):
        draw = np.random.default_rng(number)
        text = SEEDS[number % len(SEEDS)]
        for _ in range(draw.integers(6)):
            at = int(draw.integers(len(text)))
            text = (
                text[:at] + PIECES[draw.integers(len(PIECES))] * int(draw.integers(2)) + text[at + draw.integers(2) :]
            )
        raw = text.encode(["utf-8", "utf-16", "cp1252"][draw.integers(3)], "replace")
        for columns in ({}, MAPPED.columns, {"frequency": 1, "amplitude": 2}):
            try:
                curve(tmp_path, raw[: draw.integers(len(raw) // 2, len(raw) + 1)], columns=columns)
                outcomes.add("read")
            except CaseError:
                outcomes.add("told")
    assert outcomes == {"read", "told"}


def test_other_programs_import_readers_by_these_names() -> None:
    from vibeam.exchange.curves import columns, read, record
    from vibeam.exchange.matrices.declaration import read_matrix
    from vibeam.exchange.meshes.read import read_mesh
    from vibeam.exchange.uff import read_modes

    assert read.read_columns is columns.read_columns
    assert record.factor("g", "m/s^2") == 9.80665
    assert all(map(callable, (read_matrix, read_mesh, read_modes)))
