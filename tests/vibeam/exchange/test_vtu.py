"""VTU series of modes and motions, read back by a reader of the format itself, against closed forms."""

from __future__ import annotations

import base64
import zlib
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest
from scipy.optimize import brentq

import vibeam
from vibeam.casefile.read import parse
from vibeam.exchange.vtu import VtuPiece, write_series
from vibeam.report.figures import write_shown
from vibeam.studies.modes import mode_table, write_shapes

LENGTH, WIDE, THICK, YOUNG, DENSITY, ZETA = 0.3, 0.02, 0.002, 70e9, 2700.0, 0.05

CANTILEVER = """units = "SI"
[beam]
length = 0.3
width = 0.02
thickness = 0.002
youngs_modulus = 70e9
density = 2700
damping_ratio = 0.05
elements = 24
[stop]
gap = {gap}
restitution = 0.6
position = 0.3
[sensor]
position = 0.3
[drive]
amplitude = 1e-4
[sweep]
frequency = [15.0, 16.0]
settle = 120
hold = 4
[fidelity.one]
reduction = "modal"
modes = 1
[show.it]
kind = "vtu"
frequency = 16.0
"""

TYPES: Any = {"UInt32": np.uint32, "Float64": np.float64, "Int64": np.int64, "Int32": np.int32, "UInt8": np.uint8}


def read_vtu(path: Path) -> dict[str, Any]:
    """Points, connectivity and point data, by the format's own description: blocks of zlib with a header of sizes."""
    root = ElementTree.parse(path).getroot()
    header = np.dtype(TYPES[root.attrib.get("header_type", "UInt32")])
    assert root.attrib["compressor"] == "vtkZLibDataCompressor"
    found: dict[str, Any] = {}
    for each in root.iter("DataArray"):
        text = (each.text or "").strip()
        assert each.attrib["format"] == "binary"
        size = header.itemsize
        blocks = int(np.frombuffer(base64.b64decode(text[: 8 * size])[:size], header)[0])
        length = -(-(3 + blocks) * size // 3) * 4  # of the header in base64
        sizes = np.frombuffer(base64.b64decode(text[:length]), header)[3 : 3 + blocks]
        packed, ends = base64.b64decode(text[length:]), np.cumsum(sizes)
        rows = b"".join(zlib.decompress(packed[end - size : end]) for end, size in zip(ends, sizes, strict=True))
        values = np.frombuffer(rows, TYPES[each.attrib["type"]])
        many = int(each.attrib.get("NumberOfComponents", 1))
        found[each.attrib["Name"]] = values.reshape(-1, many) if many > 1 else values
    return found


def read_series(path: Path) -> list[tuple[float, str, Path]]:
    """Time, name and file of every data set."""
    root = ElementTree.parse(path).getroot()
    assert root.attrib["type"] == "Collection"
    sets = root.findall("./Collection/DataSet")
    return [(float(each.attrib["timestep"]), each.attrib["name"], path.parent / each.attrib["file"]) for each in sets]


def shape(number: int, x: Any) -> tuple[Any, Any, float]:
    """φ and φ′ of a cantilever, 1 at the tip, and βL: cosh cos = −1."""
    around = (number - 0.5) * np.pi
    root = brentq(lambda b: np.cos(b) + 1 / np.cosh(b), around - 0.5, around + 0.5, xtol=1e-14)
    s, b = (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root)), root / LENGTH
    deflection = np.cosh(b * x) - np.cos(b * x) - s * (np.sinh(b * x) - np.sin(b * x))
    slope = b * (np.sinh(b * x) + np.sin(b * x) - s * (np.cosh(b * x) - np.cos(b * x)))
    return deflection / 2, slope / 2, root


def test_mode_shapes_are_those_of_a_cantilever(tmp_path: Path) -> None:
    write_shapes(mode_table(parse(CANTILEVER.format(gap=1.0)).scene, 3), tmp_path / "a.pvd")
    steps = read_series(tmp_path / "a.pvd")
    assert [(time, name) for time, name, _ in steps] == [(1, "beam"), (2, "beam"), (3, "beam")]
    for number, (_, _, file) in enumerate(steps, 1):
        found = read_vtu(file)
        x = found["Points"][:, 0]
        assert (x[0], x[-1], len(x)) == (0, LENGTH, 97)
        assert np.array_equal(found["connectivity"].reshape(-1, 2)[:, 1], np.arange(1, 97))
        deflection, slope, root = shape(number, x)
        sign = np.sign(found["displacement"][-1, 2])  # of a mode is free
        assert np.allclose(sign * found["displacement"][:, 2], deflection * np.sign(deflection[-1]), atol=2e-5)
        assert np.allclose(-sign * found["rotation"][:, 1], slope * np.sign(deflection[-1]), atol=5e-4 * root / LENGTH)
        assert not found["displacement"][:, :2].any()
        omega = (root / LENGTH) ** 2 * np.sqrt(YOUNG * THICK**2 / 12 / DENSITY)
        assert found["frequency"][0] == pytest.approx(omega / 2 / np.pi, rel=1e-5)
        assert np.all(found["thickness"] == THICK)


def test_a_motion_without_impacts_is_the_forced_response_of_the_first_mode(tmp_path: Path) -> None:
    """w = φ₁ Γ Im[Ω²B e^{iΩt}/(ω² − Ω² + 2iζωΩ)] with Γ = ∫φ₁/∫φ₁², and its rate, at each frame."""
    result = vibeam.run(parse(CANTILEVER.format(gap=1.0)))
    (file,) = write_shown(result, tmp_path / "a.h5")
    assert file == tmp_path / "a_it.pvd"
    x, dx = np.linspace(0, LENGTH, 20001, retstep=True)
    mode, _, root = shape(1, x)
    share = np.trapezoid(mode, dx=dx) / np.trapezoid(mode**2, dx=dx)
    own, drive = (root / LENGTH) ** 2 * np.sqrt(YOUNG * THICK**2 / 12 / DENSITY), 2 * np.pi * 16
    steps = [(time, path) for time, name, path in read_series(file) if name == "beam"]
    assert len(steps) == 36
    for index, (time, path) in enumerate(steps):
        assert time == pytest.approx(index / 36 / 16)
        found = read_vtu(path)
        deflection, slope, _ = shape(1, found["Points"][:, 0])
        turned = drive**2 * 1e-4 * np.exp(1j * drive * time) / (own**2 - drive**2 + 2j * ZETA * own * drive)
        size = share * abs(turned)
        assert np.allclose(found["displacement"][:, 2], deflection * share * turned.imag, atol=2e-4 * size)
        assert np.allclose(-found["rotation"][:, 1], slope * share * turned.imag, atol=2e-4 * size * root / LENGTH)
        rate = deflection * share * (1j * drive * turned).imag
        assert np.allclose(found["velocity"][:, 2], rate, atol=2e-4 * size * drive)


def test_a_stop_stands_where_the_beam_touches_it(tmp_path: Path) -> None:
    case = parse(CANTILEVER.format(gap=2e-4), set={"show.it.frames": 100})
    (file,) = write_shown(vibeam.run(case), tmp_path / "a.h5")
    steps = read_series(file)
    beams, stops = ([read_vtu(path) for _, name, path in steps if name == wanted] for wanted in ("beam", "stop"))
    tips = np.array([found["displacement"][-1, 2] for found in beams])
    assert {tuple(found["displacement"][0]) for found in stops} == {(0, 0, 2e-4)}
    assert tips.max() <= 2e-4
    struck = [index for index, found in enumerate(stops) if found["impact"][0]]
    assert len(struck) == 1  # period 1
    speed = stops[struck[0]]["impact"][0]
    assert 2e-4 - tips[struck[0]] <= speed / 16 / 100  # it is not further away than it goes in one frame
    after = beams[(struck[0] + 1) % 100]["velocity"][-1, 2]
    assert after < 0 < speed  # it goes back


def test_a_piece_that_stays_is_one_file_and_the_collection_is_xml(tmp_path: Path) -> None:
    still = VtuPiece(np.zeros((1, 3)), {"a b": np.ones(1)})
    path = tmp_path / "folder é" / "x.pvd"
    path.parent.mkdir()
    write_series([(0.0, {'stop <1> "x"': still}), (0.5, {'stop <1> "x"': still})], path, "note -> it")
    (first, second) = read_series(path)
    assert first[1] == 'stop <1> "x"'
    assert (first[0], second[0], first[2]) == (0.0, 0.5, second[2])
    assert meshio.read(first[2]).cells[0].type == "vertex"
    assert read_vtu(first[2])["a b"] == [1.0]
