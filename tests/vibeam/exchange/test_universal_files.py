"""Data sets 58 and 58b as analysers write them: axes by type and by label, units, layouts, what is damaged."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff

import vibeam
from vibeam.exchange.curves.columns import Columns, WantedColumn, read_columns
from vibeam.exchange.files import FormatError
from vibeam.exchange.uff import read_modes

Y = np.array([0.5, -1.25, 3.0, 0.125, -2.0])
Z = Y * np.exp(0.7j * np.arange(5))
STEP = 0.25
AT = 2.0 + STEP * np.arange(5)
G = 9.80665
EITHER = {"frequency": WantedColumn(("time", "frequency")), "value": WantedColumn(("value",))}


def numbers(values: Any, width: int, digits: int, row: int) -> list[str]:
    cells = [f"{each:{width}.{digits}e}" for each in values]
    return ["".join(cells[place : place + row]) for place in range(0, len(cells), row)]


def table(values: Any, uneven: bool) -> Any:
    parts = [values.real, values.imag] if np.iscomplexobj(values) else [values]
    return np.column_stack([*([AT] if uneven else []), *parts]).ravel()


def data_set(
    over: int = 17, over_label: str = "s", kind: int = 12, label: str = "NONE", under: int = 0,
    under_label: str = "NONE", function: int = 1, form: int = 4, even: int = 1, lines: Any = None, count: int = 5,
    mark: str = "58", values: Any = Y, way: int = 3,
) -> str:  # fmt: skip
    """A data set 58 by its layout; ``lines``: its numbers in place of ``values``."""
    axes = [(over, over_label), (kind, label), (under, under_label), (0, "NONE")]
    head = [
        "    -1", f"    {mark}", "shaker", "NONE", "NONE", "NONE", "NONE",
        f"{function:5}{0:10}{0:5}{0:10} {'NONE':10}{2:10}{way:4} {'NONE':10}{1:10}{3:4}",
        f"{form:10}{count:10}{even:10}{AT[0] * even:13.5e}{STEP * even:13.5e}{0:13.5e}",
        *(f"{each:10}{0:5}{0:5}{0:5} {'axis':20} {text:20}" for each, text in axes),
    ]  # fmt: skip
    made = numbers(table(values, not even), 20, 12, 4) if lines is None else lines
    return "\n".join([*head, *made, "    -1", ""])


def units(code: int, length: float = 1.0, force: float = 1.0) -> str:
    made = f"{length:25.17e}{force:25.17e}{1:25.17e}\n{273.15:25.17e}".replace("e", "D")
    return f"    -1\n   164\n{code:10}{'words':20}{2:10}\n{made}\n    -1\n"


def read(path: Path, content: str | bytes, wanted: Any = EITHER) -> Columns:
    path.write_bytes(content if isinstance(content, bytes) else content.encode("latin1"))
    return read_columns(path, wanted)


TEXTS: list[tuple[str, dict[str, Any]]] = [
    ("as its layout says", {}),
    ("complex", {"form": 6, "values": Z}),
    ("complex, uneven: a line for each point",
     {"form": 6, "even": 0, "values": Z,
      "lines": [f"{a:13.5e}{z.real:20.12e}{z.imag:20.12e}" for a, z in zip(AT, Z, strict=True)]}),
    ("uneven, double",
     {"even": 0, "lines": [f"{a:13.5e}{y:20.12e}" for a, y in zip(AT, Y, strict=True)]}),
    ("uneven, the abscissa as wide as the values", {"even": 0, "lines": numbers(table(Y, True), 20, 12, 2)}),
    ("single", {"form": 2, "lines": numbers(Y, 13, 5, 6)}),
    ("single, uneven", {"form": 2, "even": 0, "lines": numbers(table(Y, True), 13, 5, 6)}),
    ("the last line filled up", {"form": 2, "lines": numbers([*Y, 0], 13, 5, 6)}),
    ("complex, uneven, the last line filled up",
     {"form": 5, "even": 0, "values": Z, "lines": numbers([*table(Z, True), 0, 0, 0], 13, 5, 6)}),
    ("three digits in the exponents", {"form": 2, "lines": [" ".join(f"{y:.5e}" for y in Y).replace("e+0", "E+00")]}),
    ("signs that touch", {"form": 2, "lines": ["".join(f"{y:+.5e}" for y in Y)]}),
    ("D exponents", {"form": 4, "lines": [each.replace("e", "D") for each in numbers(Y, 20, 12, 4)]}),
    ("blanks behind numbers", {"form": 2, "lines": [each.ljust(80) for each in numbers(Y, 13, 5, 2)]}),
]  # fmt: skip


@pytest.mark.parametrize(("case", "form"), TEXTS)
@pytest.mark.parametrize("change", [str, lambda text: text.replace("\n", "\r\n"), lambda text: text.replace("\n", "\r"),
                                    lambda text: text.replace("0e+00  2.50000e-01", "0D+00  2.50000D-01")])  # fmt: skip
def test_numbers_of_any_layout(tmp_path: Path, case: str, form: dict[str, Any], change: Any) -> None:
    found = read(tmp_path / "a.uff", change(data_set(**form)))
    values = form.get("values", Y)
    value = found.columns["value"]
    np.testing.assert_allclose(found.columns["frequency"].values, AT, rtol=1e-12)
    np.testing.assert_allclose(value.values, np.abs(values) if np.iscomplexobj(values) else values, rtol=1e-5)
    assert (value.complex_values is None) is not np.iscomplexobj(values)
    if value.complex_values is not None:
        np.testing.assert_allclose(value.complex_values, values, atol=1e-5)


@pytest.mark.parametrize("form", [2, 4, 5, 6])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("even", [0, 1])
@pytest.mark.parametrize("end", ["", "\n", "\r\n"])
def test_bytes_of_any_precision_and_order(tmp_path: Path, form: int, order: int, even: int, end: str) -> None:
    values = Z if form > 4 else Y
    kind = ("<" if order == 1 else ">") + ("f4" if form in (2, 5) else "f8")
    body = table(values, not even).astype(kind).tobytes()
    head = data_set(form=form, even=even, lines=[], mark=f"58b{order:6}     2          11{len(body):12}")
    start = head.rindex("    -1")
    raw = head[:start].encode() + body + f"{end}{head[start:]}".encode()
    found = read(tmp_path / "a.uff", raw).columns
    np.testing.assert_allclose(found["frequency"].values, AT, rtol=1e-7)
    np.testing.assert_allclose(found["value"].values, np.abs(values) if form > 4 else values, rtol=1e-6)
    with pytest.raises(FormatError, match="numbers of the format 1: export IEEE 754"):
        read(tmp_path / "a.uff", raw.replace(b"     2          11", b"     1          11"))
    with pytest.raises(FormatError, match="cut off"):
        read(tmp_path / "a.uff", raw[: -len(end) - 12])


@pytest.mark.parametrize("double", [True, False])
@pytest.mark.parametrize("values", [Y, Z])
@pytest.mark.parametrize("even", [0, 1])
def test_what_pyuff_writes(tmp_path: Path, double: bool, values: Any, even: int) -> None:
    data = pyuff.prepare_58(
        func_type=4, rsp_node=2, rsp_dir=-3, ref_node=1, ref_dir=1, data=values, x=AT, id1="a", binary=0,
        abscissa_spacing=even, abscissa_spec_data_type=18, ordinate_spec_data_type=12, orddenom_spec_data_type=13,
        ord_data_type=5 if np.iscomplexobj(values) else 2,
    )  # fmt: skip
    pyuff.UFF(str(tmp_path / "a.uff")).write_sets([data], "add", force_double=double)
    found = read_columns(tmp_path / "a.uff", EITHER)
    np.testing.assert_allclose(found.columns["frequency"].values, AT, rtol=1e-5)
    np.testing.assert_allclose(found.columns["value"].values, np.abs(values) if values is Z else values, rtol=1e-5)
    assert found.columns["value"].head == "frequency response 2-Z/1X"
    assert found.columns["value"].unit == "m/s^2/N"


@pytest.mark.parametrize(
    ("form", "over", "unit", "scale"),
    [
        ({"over": 17, "over_label": "s"}, "time", "s", 1.0),
        ({"over": 17, "over_label": "NONE"}, "time", "s", 1.0),
        ({"over": 17, "over_label": ""}, "time", "s", 1.0),
        ({"over": 17, "over_label": "ms"}, "time", "ms", 1e-3),
        ({"over": 0, "over_label": "Seconds"}, "time", "Seconds", 1.0),
        ({"over": 1, "over_label": "usec"}, "time", "usec", 1e-6),
        ({"over": 18, "over_label": "HZ"}, "frequency", "HZ", 1.0),
        ({"over": 18, "over_label": "kHz"}, "frequency", "kHz", 1e3),
        ({"over": 0, "over_label": "Hz"}, "frequency", "Hz", 1.0),
        ({"over": 1, "over_label": "rad/s"}, "frequency", "rad/s", 1 / (2 * np.pi)),
        ({"over": 19, "over_label": "rpm"}, "frequency", "rpm", 1 / 60),
        ({"over": 19, "over_label": "NONE"}, "frequency", "rpm", 1 / 60),
    ],
)  # fmt: skip
def test_abscissae_by_type_and_label(tmp_path: Path, form: dict[str, Any], over: str, unit: str, scale: float) -> None:
    at = read(tmp_path / "a.uff", data_set(**form)).columns["frequency"]
    assert (at.head, at.unit) == (over, unit)
    if over == "time":
        record = vibeam.record_of_file(tmp_path / "a.uff")
        assert record.duration == pytest.approx(4 * STEP * scale, rel=1e-12)
    else:
        form_of = vibeam.ReferenceForm(unit="m/s^2")
        found = vibeam.read_curve(tmp_path / "a.uff", "amplitude", form_of)
        np.testing.assert_allclose(found.frequency, AT * scale, rtol=1e-12)


@pytest.mark.parametrize(
    ("form", "kind", "unit", "origin"),
    [
        ({"kind": 8}, "time history", "m", "by its type 8"),
        ({"kind": 8, "label": "mm"}, "time history", "mm", "by its label"),
        ({"kind": 12, "label": "G"}, "time history", "G", "by its label"),
        ({"kind": 12, "label": "m/s\xb2"}, "time history", "m/s²", "by its label"),
        ({"kind": 0, "label": "ips"}, "time history", "ips", "by its label"),
        ({"kind": 0}, "time history", "", ""),
        ({"kind": 1, "label": "EU 3"}, "time history", "EU 3", "by its label"),
        ({"kind": 12, "under": 13, "function": 4}, "frequency response", "m/s^2/N", "by its type 12"),
        ({"kind": 11, "under": 13, "function": 4}, "frequency response", "m/s/N", "by its type 11"),
        ({"kind": 8, "under": 9, "function": 4, "label": "mm"}, "frequency response", "mm/N", "by its label"),
        ({"kind": 12, "under": 13, "function": 4, "label": "g", "under_label": "lbf"}, "frequency response", "g/lbf",
         "by its label"),
        ({"kind": 12, "under": 13, "function": 4, "label": "(m/s^2)/N"}, "frequency response", "(m/s^2)/N",
         "by its label"),
        ({"kind": 1, "function": 4, "label": "(1/N)*(m/s\xb2)"}, "frequency response", "(1/N)*(m/s²)", "by its label"),
        ({"kind": 12, "under": 12, "function": 5}, "transmissibility", "m/s^2/(m/s^2)", "by its type 12"),
        ({"kind": 12, "function": 9}, "power spectral density", "(m/s^2)^2/Hz", "by its type 12"),
        ({"kind": 12, "function": 9, "label": "g^2/Hz"}, "power spectral density", "g^2/Hz", "by its label"),
        ({"kind": 12, "function": 9, "label": "g"}, "power spectral density", "(g)^2/Hz", "by its label"),
        ({"kind": 0, "function": 9, "label": "g\xb2/Hz"}, "power spectral density", "g²/Hz", "by its label"),
        ({"kind": 8, "function": 10}, "energy spectral density", "(m)^2 s/Hz", "by its type 8"),
        ({"kind": 12, "function": 2}, "auto power spectrum", "", ""),
        ({"kind": 12, "function": 2, "label": "(m/s^2)^2"}, "auto power spectrum", "(m/s^2)^2", "by its label"),
        ({"kind": 12, "function": 12, "label": "m/s2"}, "spectrum", "m/s2", "by its label"),
        ({"kind": 12, "way": 5}, "time history", "", ""),
    ],
)  # fmt: skip
def test_ordinates_by_type_and_label(tmp_path: Path, form: dict[str, Any], kind: str, unit: str, origin: str) -> None:
    found = read(tmp_path / "a.uff", data_set(**form))
    value = found.columns["value"]
    assert (found.kind, value.unit, value.origin) == (kind, unit, origin)
    assert value.place == "data set 58 number 1"
    np.testing.assert_allclose(value.values, Y, rtol=1e-12)


FOOT, POUND = 1 / 0.3048, 1 / 4.4482216152605


@pytest.mark.parametrize(
    ("code", "length", "force", "metres", "newtons"),
    [
        (1, 1.0, 1.0, 1.0, 1.0),
        (2, FOOT, POUND, 0.3048, 4.4482216152605),
        (3, 1.0, 1 / G, 1.0, G),
        (4, FOOT, 7.2330138512, 0.3048, 1 / 7.2330138512),
        (5, 1e3, 1e3, 1e-3, 1e-3),
        (6, 1e2, 1e2, 1e-2, 1e-2),
        (7, FOOT * 12, POUND, 0.0254, 4.4482216152605),
        (8, 1e3, 1 / G, 1e-3, G),
        (9, 1.0, 1.0, 1.0, 1.0),
        (9, 1e6, 1e3, 1e-6, 1e-3),
        (10, 1e3, 1.0, 1e-3, 1.0),
    ],
)  # fmt: skip
def test_units_of_a_file_by_their_factors(
    tmp_path: Path, code: int, length: float, force: float, metres: float, newtons: float
) -> None:
    """Lengths by metres, forces by newtons, others by their powers of both; labels that agree, and that do not."""
    told = units(code, length, force)
    for form, scale in (
        ({"kind": 8}, metres),
        ({"kind": 11}, metres),
        ({"kind": 12}, metres),
        ({"kind": 13}, newtons),
        ({"kind": 15}, newtons / metres**2),
        ({"kind": 16}, newtons / metres),
        ({"kind": 12, "under": 13, "function": 4}, metres / newtons),
        ({"kind": 12, "under": 12, "function": 5}, 1.0),
        ({"kind": 12, "function": 9}, metres**2),
    ):
        for content in (told + data_set(**form), data_set(**form) + told):
            found = read(tmp_path / "a.uff", content)
            np.testing.assert_allclose(found.columns["value"].values, scale * Y, rtol=1e-9)
    found = read(tmp_path / "a.uff", told + data_set(label="mm/s^2"))
    agrees = metres == 1e-3
    assert (found.columns["value"].unit == "mm/s^2") is agrees
    if not agrees:
        with pytest.raises(vibeam.CaseError, match=r"mm/s\^2 by its label, .* by data set 164' is not known; say it"):
            vibeam.record_of_file(tmp_path / "a.uff")
    record = vibeam.record_of_file(tmp_path / "a.uff", unit="mm/s^2")
    assert record.peak == pytest.approx(3e-3, rel=1e-12)


def test_modes_are_in_the_units_of_their_file(tmp_path: Path) -> None:
    """Receptance φφ/m is a length over a force: 1 mm/mN is 1 m/N, 1 mm/N is 10⁻³."""
    shape = {"r1": np.zeros(1), "r2": np.zeros(1), "r3": np.array([0.5]), "node_nums": np.array([4])}
    data = shape | {
        "type": 55, "model_type": 1, "data_ch": 2, "spec_data_type": 8, "n_data_per_node": 3, "load_case": 1,
        "mode_n": 1, "data_type": 2, "analysis_type": 2, "freq": 12.0, "modal_m": 3.0, "modal_damp_vis": 0.01,
        "modal_damp_his": 0.0,
    }  # fmt: skip
    pyuff.UFF(str(tmp_path / "modes.uff")).write_sets([data], "overwrite")
    modes = (tmp_path / "modes.uff").read_text()
    for code, length, force, mass in ((1, 1, 1, 3.0), (5, 1e3, 1e3, 3.0), (9, 1e3, 1.0, 3e3), (10, 1e3, 1.0, 3e3)):
        (tmp_path / "rig.uff").write_text(units(code, length, force) + modes)
        found = read_modes(tmp_path / "rig.uff")
        assert (found.mass[0], found.frequency[0], found.shapes[4, 3][0]) == pytest.approx((mass, 12.0, 0.5))


WRONG: list[tuple[str, str]] = [
    (data_set(over_label="Hz"), "line 10: the abscissa is of type 17, and its label is 'Hz': correct one of both"),
    (data_set(over=18, over_label="ms"), "line 10: the abscissa is of type 18, and its label is 'ms'"),
    (data_set(over=18, over_label="mm"), "line 10: the abscissa is of type 18, and its label is 'mm'"),
    (data_set(over=0, over_label="mm"), "line 10: the abscissa, of type 0 with the label 'mm', is neither time nor"),
    (data_set(over=8, over_label="m"), "line 10: the abscissa is of type 8, and its label is 'm'"),
    (data_set(label="N"), "line 11: the ordinate is of type 12, m/s^2, and its label is 'N': correct one of both"),
    (data_set(label="V"), "line 11: the ordinate is of type 12, m/s^2, and its label is 'V'"),
    (data_set(kind=12, under=13, function=4, label="m/N"), "line 11: the ordinate is of type 12, m/s^2/N, and its"),
    (data_set(count=6), "line 9: has 5 numbers for 6 points of 1: is the data set cut off?"),
    (data_set(count=4), "line 9: has 5 numbers for 4 points of 1"),
    (data_set(count=-1), "line 9: -1 points of type 4 with the spacing 1 are none"),
    (data_set(form=3), "line 9: 5 points of type 3 with the spacing 1 are none"),
    (data_set(count=10**9), "has 1000000000 samples"),
    (data_set().replace("58", "58 ", 1)[:-8], "line 2: its data set 58 does not end: is the file cut off?"),
    (data_set(lines=["1.0 nan"], count=2), "line 14: 'nan' is no number"),
    (data_set(lines=["1.0 1e999"], count=2), "line 14: '1e999' is beyond the largest number"),
    (data_set(lines=["1.0", "1_0"], count=2), "line 15: '1_0' is no number"),
    (data_set().replace("        17", "        x7"), "line 10: 'x7' is no whole number"),
    (data_set().replace("  2.50000e-01", "  0.00000e+00"), "line 9: its steps are 0"),
    (data_set().replace("  2.50000e-01", "  x.50000e-01"), "line 9: 'x.50000e-01' is no number"),
    (units(1, 3.28083989501312334, 0.2248089) + data_set(), "line 3: the code 1 is not of the units of 0.3048 m"),
    (units(5) + data_set(), "the code 5 is not of the units of 1 m and 1 N that its factors say: correct one of both"),
    (units(9, 0.0) + data_set(), "line 3: its data set 164 says no units: a factor is missing, or not above 0"),
    (units(1) + units(5, 1e3, 1e3) + data_set(), "has data sets 164 of different units: keep those of one of them"),
    (units(1), "has 0 data sets 58, the curves of such a file: there is no number 1"),
    ("    -1\n    58\nshort\n    -1\n", "line 2: its data set 58 is cut off in its head"),
]  # fmt: skip


@pytest.mark.parametrize(("content", "message"), WRONG)
def test_what_is_damaged_or_contradicts_itself_is_refused(tmp_path: Path, content: str, message: str) -> None:
    with pytest.raises(FormatError) as caught:
        read(tmp_path / "a.uff", content)
    assert str(caught.value).startswith(message) or message in str(caught.value)


def test_one_of_several_by_number_or_name(tmp_path: Path) -> None:
    both = data_set() + data_set(values=2 * Y, way=1)
    for name in (2, "2X/1Z"):
        found = read(tmp_path / "a.uff", both, EITHER | {"value": WantedColumn((name,))})
        np.testing.assert_allclose(found.columns["value"].values, 2 * Y)
        assert found.columns["value"].place == "data set 58 number 2"
    with pytest.raises(FormatError, match="has 2 data sets 58, 1: 2Z/1Z, 2: 2X/1Z: say which by its number"):
        read(tmp_path / "a.uff", both)
    with pytest.raises(FormatError, match="has 2 data sets 58, the curves of such a file: there is no number 3"):
        read(tmp_path / "a.uff", both, EITHER | {"value": WantedColumn((3,))})


@pytest.mark.parametrize("function", [4, 6, 7, 9])
def test_what_is_no_time_history_is_no_record(tmp_path: Path, function: int) -> None:
    (tmp_path / "a.uff").write_text(data_set(function=function))
    with pytest.raises(vibeam.CaseError, match=r"a\.uff: has a .*: a record is a time history"):
        vibeam.record_of_file(tmp_path / "a.uff")
