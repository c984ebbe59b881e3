"""Signals in MATLAB's files, HDF5 and TDMS: values, units and clocks wherever such files say them."""

from __future__ import annotations

import struct
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from scipy.io import savemat

import vibeam
from vibeam.exchange.curves.columns import Columns, WantedColumn, read_columns
from vibeam.extensions.identification.signal_kind import identify_signal

RATE = 500.0
TIME = np.arange(60) / RATE
VALUES = np.sin(2 * np.pi * 30 * TIME) + 0.25
G = 9.80665


def objects(*items: dict[str, Any]) -> Any:
    """MATLAB's array of structures."""
    names = list(items[0])
    return np.array([tuple(each[name] for name in names) for each in items], dtype=[(name, object) for name in names])


RUN = {"t": TIME, "acc": VALUES, "unit": "g"}
SIMULINK = {"time": TIME, "signals": objects({"values": VALUES, "label": "a"}, {"values": 2 * VALUES, "label": "b"})}
MATLAB: list[tuple[dict[str, Any], dict[str, Any], float]] = [
    ({"t": TIME, "acc": VALUES}, {}, 1.0),
    ({"t": TIME[None], "acc": VALUES[:, None]}, {}, 1.0),
    ({"t": TIME, "acc": VALUES, "unit": "g"}, {}, G),
    ({"t": TIME, "acc": VALUES, "Units": "mm/s^2"}, {}, 1e-3),
    ({"t": TIME, "acc": VALUES, "acc_unit": "g", "unit": "V"}, {}, G),
    ({"run": RUN}, {}, G),
    ({"run": objects(RUN | {"acc": 3 * VALUES}, RUN)}, {"column": "run(2).acc", "time": "run(2).t"}, G),
    ({"run": RUN | {"acc": np.column_stack([TIME, VALUES]), "unit": np.array(["s", "g"], object)}},
     {"column": "run.acc:2"}, G),
    ({"acc": VALUES, "fs": RATE}, {}, 1.0),
    ({"acc": VALUES, "Fs": RATE, "units": "g"}, {}, G),
    ({"acc": VALUES, "dt": 1 / RATE}, {}, 1.0),
    ({"run": {"acc": VALUES, "unit": "g"}, "fs": RATE}, {}, G),
    ({"acc": VALUES, "fs": RATE, "dt": 1 / RATE}, {"rate": RATE}, 1.0),
    ({"out": {"time": TIME, "signals": {"values": VALUES, "label": "acc"}}},
     {"column": "out.signals.values", "time": "out.time"}, 1.0),
    ({"out": SIMULINK}, {"column": "out.signals(1).values"}, 1.0),
    ({"acc": VALUES.astype("f4"), "t": TIME}, {}, 1.0),
    ({"x0": VALUES, "t": TIME}, {"column": "x0"}, 1.0),
    ({"t": TIME, "acc": VALUES, "accUnit": "g"}, {}, G),
    ({"t": TIME, "acc": VALUES, "y_unit": "g"}, {}, G),
    ({"run": {"data": np.column_stack([1e3 * TIME, VALUES]), "units": np.array(["ms", "g"], object)}},
     {"column": "run.data:2", "time": "run.data:1"}, G),
    ({"acc": VALUES, "dt": 1e3 / RATE, "dt_unit": "ms"}, {}, 1.0),
]  # fmt: skip


def as_hdf5(place: str, value: Any, file: h5py.File, refs: h5py.Group) -> None:
    """One variable as MATLAB 7.3 keeps it: transposed, texts as codes, arrays of structures by references."""
    if isinstance(value, dict):
        for name, inner in value.items():
            as_hdf5(f"{place}/{name}", inner, file, refs)
    elif isinstance(value, str):
        file[place] = np.array([[ord(each)] for each in value], dtype="u2")
        file[place].attrs["MATLAB_class"] = np.bytes_("char")
    elif getattr(value, "dtype", np.dtype(float)).names or getattr(value, "dtype", np.dtype(float)).hasobject:
        fields = value.dtype.names or ("",)
        for field in fields:
            made = file.create_dataset(f"{place}/{field}" if field else place, (len(value), 1), dtype=h5py.ref_dtype)
            if not field:
                made.attrs["MATLAB_class"] = np.bytes_("cell")
            for number, each in enumerate(value):
                inside = f"#refs#/{len(refs)}"
                as_hdf5(inside, each[field] if field else each, file, refs)
                made[number, 0] = file[inside].ref
    else:
        file[place] = np.atleast_2d(value).T if np.ndim(value) == 2 else np.atleast_2d(value)


@pytest.mark.parametrize(("content", "form", "scale"), MATLAB)
@pytest.mark.parametrize("version", [5, 7.3])
def test_variables_of_matlab(
    tmp_path: Path, version: float, content: dict[str, Any], form: dict[str, Any], scale: float
) -> None:
    path = tmp_path / "a.mat"
    if version == 5:
        savemat(path, content)
    else:
        with h5py.File(path, "w", userblock_size=512) as file:
            refs = file.create_group("#refs#")
            for name, value in content.items():
                as_hdf5(name, value, file, refs)
        form = {key: str(each).replace(".", "/") if key != "rate" else each for key, each in form.items()}
    record = vibeam.record_of_file(path, **form)
    assert record.spacing == pytest.approx(1 / RATE, rel=1e-9)
    assert record.at(record.times) == pytest.approx(scale * VALUES, rel=1e-6)


def table(path: Path, values: Any = VALUES, above: dict[str, Any] | None = None, **attributes: Any) -> None:
    with h5py.File(path, "w") as file:
        file["run/acc"] = values
        file["run"].attrs.update(above or {})
        file["run/acc"].attrs.update(attributes)


@pytest.mark.parametrize(
    ("attributes", "above", "scale", "start"),
    [
        ({"units": "g", "dt": 1 / RATE}, {}, G, 0.0),
        ({"unit": "g", "fs": RATE}, {}, G, 0.0),
        ({"Units": b"mm/s^2", "sampling_rate": int(RATE)}, {}, 1e-3, 0.0),
        ({"Unit": np.array(["g"], dtype=object), "SampleRate": np.array([RATE])}, {}, G, 0.0),
        ({"units": "g"}, {"fs": RATE, "t0": 2.0}, G, 2.0),
        ({"dt": 1 / RATE, "t0": -0.5}, {}, 1.0, -0.5),
        ({"fs": RATE}, {"units": "g"}, G, 0.0),
        ({"engineering_units": np.array([b"g"]), "fs": RATE}, {}, G, 0.0),
    ],
)
def test_attributes_of_hdf5(
    tmp_path: Path, attributes: dict[str, Any], above: dict[str, Any], scale: float, start: float
) -> None:
    table(tmp_path / "a.h5", above=above, **attributes)
    record = vibeam.record_of_file(tmp_path / "a.h5")
    assert record.start == pytest.approx(start)
    assert record.spacing == pytest.approx(1 / RATE, rel=1e-9)
    assert record.at(record.times) == pytest.approx(scale * VALUES, rel=1e-12)


def test_units_of_the_columns_of_a_dataset(tmp_path: Path) -> None:
    table(tmp_path / "a.h5", np.column_stack([VALUES, VALUES]), units=["V", "g"], fs=RATE)
    record = vibeam.record_of_file(tmp_path / "a.h5", column="acc:2")
    assert record.at(record.times) == pytest.approx(G * VALUES, rel=1e-12)


def tdms(path: Path, channels: dict[str, tuple[Any, dict[str, Any]]]) -> Path:
    nptdms = pytest.importorskip("nptdms")
    made = [
        nptdms.ChannelObject(*name.split("/"), values, properties) for name, (values, properties) in channels.items()
    ]
    with nptdms.TdmsWriter(str(path)) as file:
        file.write_segment(made)
    return path


WAVEFORM = {"wf_increment": 1 / RATE, "wf_start_offset": 0.25, "wf_start_time": np.datetime64("2024-03-01T10:00:00")}


@pytest.mark.parametrize(
    ("channels", "form", "scale", "start"),
    [
        ({"rig/acc": (VALUES, WAVEFORM | {"unit_string": "g"})}, {}, G, 0.25),
        ({"rig/acc": (VALUES, WAVEFORM | {"NI_UnitDescription": "g"})}, {}, G, 0.25),
        ({"rig/tip": (VALUES, WAVEFORM), "rig/base": (2 * VALUES, WAVEFORM)}, {"column": "tip"}, 1.0, 0.25),
        ({"one/tip": (2 * VALUES, WAVEFORM), "two/tip": (VALUES, WAVEFORM)}, {"column": "two/tip"}, 1.0, 0.25),
        ({"rig/Time": (1e3 * TIME, {"unit_string": "ms"}), "rig/acc": (VALUES, {})}, {}, 1.0, 0.0),
        ({"rig/tip": (VALUES, WAVEFORM)}, {}, 1.0, 0.25),
        ({"rig/acc": (VALUES, {})}, {"rate": RATE}, 1.0, 0.0),
        ({"rig/acc": (np.round(1000 * VALUES).astype("i2"), WAVEFORM)}, {"scale": 1e-3}, 1.0, 0.25),
    ],
)  # fmt: skip
def test_channels_of_tdms(
    tmp_path: Path, channels: dict[str, Any], form: dict[str, Any], scale: float, start: float
) -> None:
    record = vibeam.record_of_file(tdms(tmp_path / "a.tdms", channels), **form)
    assert (record.start, record.spacing) == (pytest.approx(start), pytest.approx(1 / RATE, rel=1e-9))
    assert record.at(record.times) == pytest.approx(scale * VALUES, rel=1e-12, abs=1e-3 if "scale" in form else 0)


def test_a_tdms_file_that_was_cut_off_is_refused(tmp_path: Path) -> None:
    path = tdms(tmp_path / "a.tdms", {"rig/acc": (VALUES, WAVEFORM)})
    path.write_bytes(path.read_bytes()[:-80])
    with pytest.raises(vibeam.CaseError, match="is cut off: of its last segment 50 of 60 samples are there"):
        vibeam.record_of_file(path)


def test_a_decay_with_a_clock_is_fitted(tmp_path: Path) -> None:
    time = np.arange(4000) / 1000
    decay = np.exp(-0.02 * 2 * np.pi * 20 * time) * np.cos(2 * np.pi * 20 * np.sqrt(1 - 0.02**2) * time)
    savemat(tmp_path / "a.mat", {"acc": decay, "fs": 1000.0})
    table(tmp_path / "a.h5", decay, dt=1e-3)
    tdms(tmp_path / "a.tdms", {"rig/acc": (decay, {"wf_increment": 1e-3, "unit_string": "g"})})
    for name in ("a.mat", "a.h5", "a.tdms"):
        found = identify_signal(tmp_path / name)
        assert (found.of, found["natural frequency"].value) == ("decay", pytest.approx(20, rel=1e-6))


def value_of(path: Path, name: str = "acc") -> Columns:
    return read_columns(path, {"frequency": WantedColumn(("time", "t"), needed=False), "value": WantedColumn((name,))})


def test_where_columns_are_and_their_units_from(tmp_path: Path) -> None:
    savemat(tmp_path / "a.mat", {"run": RUN | {"z": VALUES * 1j}, "fs": RATE})
    table(tmp_path / "a.h5", units="g", dt=1 / RATE)
    tdms(tmp_path / "a.tdms", {"rig/acc": (VALUES, WAVEFORM | {"unit_string": "g"})})
    for name, place, origin in (
        ("a.mat", "variable", "from run.unit"),
        ("a.h5", "dataset", "from run/acc@units"),
        ("a.tdms", "channel", "from rig/acc@unit_string"),
    ):
        value = value_of(tmp_path / name).columns["value"]
        assert (value.unit, value.place, value.origin) == ("g", place, origin)
    complex_ = value_of(tmp_path / "a.mat", "z").columns["value"]
    assert complex_.complex_values is not None
    np.testing.assert_array_equal(complex_.complex_values, VALUES * 1j)
    np.testing.assert_array_equal(complex_.values, np.abs(VALUES))


def element(kind: int, content: bytes) -> bytes:
    return struct.pack("<II", kind, len(content)) + content + bytes(-len(content) % 8)


def timeseries_5(path: Path) -> None:
    """An object of MATLAB's class timeseries, as version 5 to 7 keep it: flags, name, system, class, numbers."""
    words = [element(6, struct.pack("<II", 17, 0)), *(element(1, each) for each in (b"ts", b"MCOS", b"timeseries"))]
    savemat(path, {"t": TIME, "acc": VALUES})
    path.write_bytes(path.read_bytes() + element(14, b"".join(words)))


def timeseries_73(path: Path) -> None:
    with h5py.File(path, "w", userblock_size=512) as file:
        file["ts"] = np.zeros((1, 6), dtype="u4")
        file["ts"].attrs.update({"MATLAB_class": np.bytes_("timeseries"), "MATLAB_object_decode": np.int32(3)})
        file["acc"], file["t"] = VALUES[None], TIME[None]


@pytest.mark.parametrize("write", [timeseries_5, timeseries_73])
def test_objects_of_matlab_are_named(tmp_path: Path, write: Callable[[Path], None]) -> None:
    write(tmp_path / "a.mat")
    assert vibeam.record_of_file(tmp_path / "a.mat").spacing == pytest.approx(1 / RATE)
    with pytest.raises(
        vibeam.CaseError, match=r"'ts' is an object of a class of MATLAB's: save its numbers .*ts\.Time and"
    ):
        vibeam.record_of_file(tmp_path / "a.mat", column="ts")
    with pytest.raises(vibeam.CaseError, match=r"has no column 'other': there are .*'ts'"):
        vibeam.record_of_file(tmp_path / "a.mat", column="other")


WRONG: list[tuple[dict[str, Any], dict[str, Any], str]] = [
    ({"acc": VALUES}, {}, "has no column 'time': there are 'acc'; say column and time by head"),
    ({"acc": VALUES, "unit": "g"}, {}, "'acc' has no times, and neither a rate nor a step is said of it: say the rate"),
    ({"acc": VALUES, "fs": RATE, "dt": 1.0}, {}, "'acc' has 500 samples a second and steps of 1 s: delete one of both"),
    ({"acc": VALUES, "fs": RATE}, {"column": "time"}, "has no column 'time': there are 'acc', 'time'"),
    ({"acc": VALUES, "fs": 0.0}, {}, "the number from fs cannot be used: 0.0"),
    ({"acc": VALUES, "fs": "fast"}, {}, "the number from fs cannot be used: could not convert"),
    ({"acc": VALUES, "fs": RATE}, {"rate": 2 * RATE}, "rate is 1000 Hz, and column 'time' has 500 samples a second"),
    ({"t": TIME, "acc": VALUES, "unit": "N"}, {}, r"the unit 'N' is not one of m/s\^2; say it: unit"),
    ({"t": TIME, "acc": VALUES, "unit": np.array(["s", "g"], object)}, {}, "the unit 's, g' is not known; say it"),
    ({"run": objects(RUN, RUN)}, {"time": "run(1).t"}, r"has several 'acc': run\(1\).acc, run\(2\).acc; say the whole"),
    ({"t": TIME, "acc": VALUES, "unit": "g", "units": "V"}, {}, "the unit 'g or V' is not known; say it"),
    ({"t": TIME, "acc": VALUES * 1j}, {}, "column 'acc' is complex: a record is real"),
    ({"acc": VALUES, "dt": 1.0, "x_unit": "Hz"}, {}, "column 'time' is in Hz: a record goes over time"),
    ({"t": TIME[1:], "acc": VALUES}, {}, "its columns are of different lengths: 't' has 59, 'acc' has 60"),
]  # fmt: skip


@pytest.mark.parametrize(("content", "form", "message"), WRONG)
def test_what_is_missing_or_contradicts_itself_is_refused(
    tmp_path: Path, content: dict[str, Any], form: dict[str, Any], message: str
) -> None:
    savemat(tmp_path / "a.mat", content)
    with pytest.raises(vibeam.CaseError, match=message) as caught:
        vibeam.record_of_file(tmp_path / "a.mat", **form)
    assert len(caught.value.faults) == 1


def test_without_nptdms_the_message_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "nptdms", None)
    (tmp_path / "a.tdms").write_bytes(b"TDSm")
    with pytest.raises(vibeam.CaseError, match=r"npTDMS reads it, and is not installed: pip install 'vibeam\[lab\]'"):
        vibeam.record_of_file(tmp_path / "a.tdms")
