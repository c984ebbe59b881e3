"""Damaged files of signals: read as they were, read as the bytes that were changed say, or refused; never a crash.

Where a byte of a head was changed, the values are the same, or there is a fault, or none says a unit any more: values
that are a power of ten, or g, times what they were have no unit, and a column without one is said.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.io import savemat

import vibeam
from vibeam.exchange.curves.columns import UNSAID

RATE = 1000.0
TIME = np.arange(24) / RATE
VALUES = np.sin(2 * np.pi * 60 * TIME) + 0.25
PEAK = 9.80665 * float(np.abs(VALUES).max())
FACTORS = (1e-9, 1e-6, 1e-3, 1e-2, 1e2, 1e3, 1e6, 9.80665, 1 / 9.80665, 0.0254, 1 / 0.0254, 0.3048, 1 / 0.3048)


def uff(path: Path) -> None:
    units = f"    -1\n   164\n{1:10}{'SI: m, N':20}{2:10}\n{1:25.17e}{1:25.17e}{1:25.17e}\n{273.15:25.17e}\n    -1\n"
    head = ["    -1", "    58", *("NONE",) * 5, f"{1:5}{0:10}{0:5}{0:10} {'NONE':10}{2:10}{3:4} {'NONE':10}{0:10}{0:4}",
            f"{4:10}{len(VALUES):10}{1:10}{0:13.5e}{1 / RATE:13.5e}{0:13.5e}"]  # fmt: skip
    axes = [(17, "s"), (12, "m/s^2"), (0, "NONE"), (0, "NONE")]
    lines = [f"{kind:10}{0:5}{0:5}{0:5} {'NONE':20} {label:20}" for kind, label in axes]
    cells = [f"{9.80665 * each:20.12e}" for each in VALUES]
    rows = ["".join(cells[place : place + 4]) for place in range(0, len(cells), 4)]
    path.write_text(units + "\n".join([*head, *lines, *rows, "    -1", ""]))


def uff_bytes(path: Path) -> None:
    """Data set 58b, little endian."""
    uff(path)
    units, head = path.read_bytes().split(b"    58\n")
    body = (9.80665 * VALUES).astype("<f8").tobytes()
    axes = b"\n".join(head.split(b"\n")[:11])
    mark = f"    58b     1     2          11{len(body):12}\n".encode()
    path.write_bytes(units + mark + axes + b"\n" + body + b"\n    -1\n")


def comma(path: Path) -> None:
    rows = "".join(f"{1000 * at:.9g},{value:.17g}\n" for at, value in zip(TIME, VALUES, strict=True))
    path.write_text("Logger 7,\n# made today\nt [ms],acc [g]\n" + rows)


def scope(path: Path) -> None:
    rows = "".join(f"{at:.9g}\t{value:.17g}\n" for at, value in zip(TIME, VALUES, strict=True))
    path.write_text("Horizontal Units\ts\nVertical Units\tg\nTIME\tCH1\n" + rows)


def labview(path: Path) -> None:
    said = "Separator Tab,Decimal_Separator .,Multi_Headings No,X_Columns No,***End_of_Header***,Channels 1,"
    said += f"Y_Unit_Label g,X_Dimension Time,X0 0.0,Delta_X {1 / RATE},***End_of_Header***,X_Value acc Comment"
    rows = [f"\t{value:.17g}" for value in VALUES]
    path.write_text("\n".join(["LabVIEW Measurement\t", *said.replace(" ", "\t").split(","), *rows, ""]))


def wav(path: Path) -> None:
    data = (9.80665 * VALUES).astype("<f4").tobytes()
    form = struct.pack("<HHIIHH", 3, 1, int(RATE), 4 * int(RATE), 4, 32)
    parts = b"WAVEfmt " + struct.pack("<I", 16) + form + b"data" + struct.pack("<I", len(data)) + data
    path.write_bytes(b"RIFF" + struct.pack("<I", len(parts)) + parts)


def mat(path: Path) -> None:
    savemat(path, {"run": {"acc": VALUES, "unit": "g", "fs": RATE}})


def packed(path: Path) -> None:
    savemat(path, {"acc": VALUES, "unit": "g", "fs": RATE}, do_compression=True)


def mat73(path: Path) -> None:
    """Variables as MATLAB 7.3 keeps them: columns as rows, texts as codes."""
    said = {"acc": VALUES, "fs": [RATE], "unit": np.array([ord("g")], "<u2")}
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in said.items():
            file[name] = np.atleast_2d(values)
            file[name].attrs["MATLAB_class"] = np.bytes_("char" if name == "unit" else "double")


def hdf5(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file["acc"] = VALUES
        file["acc"].attrs.update({"units": "g", "dt": 1 / RATE})


def tdms(path: Path) -> None:
    nptdms = pytest.importorskip("nptdms")
    said = {"wf_increment": 1 / RATE, "unit_string": "g", "wf_start_offset": 0.0}
    with nptdms.TdmsWriter(str(path)) as file:
        file.write_segment([nptdms.ChannelObject("rig", "acc", VALUES, said)])


KINDS = [
    (uff, "a.uff"), (uff_bytes, "b.uff"), (wav, "a.wav"), (mat, "a.mat"), (packed, "b.mat"), (mat73, "c.mat"),
    (hdf5, "a.h5"), (tdms, "a.tdms"), (comma, "a.csv"), (scope, "b.csv"), (labview, "a.lvm"),
]  # fmt: skip
COLUMN = {"b.csv": "CH1"}


def changed(raw: bytes, seed: int) -> bytes:
    """A file with bytes changed, put in, taken out or doubled, or cut off."""
    draw, found = np.random.default_rng(seed), bytearray(raw)
    for _ in range(int(draw.integers(1, 4))):
        at, length = int(draw.integers(len(found))), int(draw.integers(1, 9))
        way = draw.integers(6)
        if way == 0:
            found[at] = int(draw.integers(256))
        elif way == 1:
            found[at] ^= 1 << int(draw.integers(8))
        elif way == 2:
            del found[at : at + length]
        elif way == 3:
            found[at:at] = found[at : at + length]
        elif way == 4:
            found[at : at + 4] = draw.choice([b"\xff\xff\xff\xff", b"\x00\x00\x00\x00", b"\xff\xff\xff\x7f", b"    "])
        elif len(found) > 40:
            del found[max(at, 20) :]
    return bytes(found)


def tried(path: Path, raw: bytes, write: Callable[[Path], None], seed: int) -> str:
    """``same``, ``told``, or ``other``: numbers that the changed bytes themselves say, or that no unit explains."""
    path.write_bytes(changed(raw, seed))
    try:
        record = vibeam.record_of_file(path, column=COLUMN.get(path.name))
    except vibeam.CaseError:
        return "told"
    found = record.at(record.times)
    sound = 9.80665 * VALUES
    tolerance = 1e-5 * PEAK
    if len(found) == len(sound) and np.allclose(found, sound, atol=tolerance) and record.spacing is not None:
        return "same" if abs(record.spacing * RATE - 1) < 1e-6 else "other"
    scaled = len(found) == len(sound) and any(
        np.allclose(found, factor * sound, rtol=1e-6, atol=factor * tolerance) for factor in FACTORS
    )
    if scaled:
        assert record.taken.columns[0].origin == UNSAID, f"seed {seed}: {record.taken}"
    return "other"


def run(path: Path, write: Callable[[Path], None], seeds: range) -> set[str]:
    write(path)
    raw = path.read_bytes()
    return {tried(path, raw, write, seed) for seed in seeds}


@pytest.mark.parametrize(("write", "name"), KINDS)
def test_a_damaged_file_is_read_or_told(tmp_path: Path, write: Callable[[Path], None], name: str) -> None:
    assert run(tmp_path / name, write, range(100)) >= {"told"}


@pytest.mark.slow
@pytest.mark.parametrize(("write", "name"), KINDS)
def test_many_damaged_files_are_read_or_told(tmp_path: Path, write: Callable[[Path], None], name: str) -> None:
    resource = pytest.importorskip("resource")
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert run(tmp_path / name, write, range(100, 1600)) >= {"told"}
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 2 << 20  # KiB
