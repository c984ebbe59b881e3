"""Data sets of universal files: where each lies, units (164), functions at nodal degrees of freedom (58 and 58b).

Functions are read here, since pyuff refuses D exponents, last lines that are filled up and abscissae as E20.12, and
takes files that are cut off as they are. Layout: https://www.ceas3.uc.edu/sdrluff.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from struct import Struct
from typing import Any

import numpy as np

from vibeam.exchange.files import FormatError, read_by, real, require_samples, whole
from vibeam.exchange.units import LENGTH, MASS, unit_size
from vibeam_models.arrays import Array

ROUNDED = 1e-3  # relative error of a factor of units
HEAD = 11  # lines of a function before its numbers
FILLED = 6  # numbers on a line
PRECISIONS = {2: "f4", 4: "f8", 5: "f4", 6: "f8"}  # by the type of the ordinates, of which 5 and 6 are complex
DIRECTIONS = {1: "X", 2: "Y", 3: "Z", 4: "RX", 5: "RY", 6: "RZ"}
FOOT, POUND, KILOGRAM = 0.3048, 4.4482216152605, 9.80665
#: units of length in m and of force in N by the code of data set 164; 9 are the user's own
CODES = {
    1: (1.0, 1.0), 2: (FOOT, POUND), 3: (1.0, KILOGRAM), 4: (FOOT, 0.138254954376), 5: (1e-3, 1e-3), 6: (1e-2, 1e-2),
    7: (FOOT / 12, POUND), 8: (1e-3, KILOGRAM), 10: (1e-3, 1.0),
}  # fmt: skip
_BEGIN = re.compile(rb"^ {4}-1[ \t\r]*\n *([0-9]+b?)([^\n]*)\n", re.MULTILINE)
_END = re.compile(rb" {4}-1[ \t\r]*$", re.MULTILINE)
_BEFORE_BYTES = re.compile(rb"(?:[^\n]*\n){%d}" % HEAD)
_TOUCHING = re.compile(r"(?<=[0-9.])([+-])")
_PLACES, _POINTS, _AXIS = Struct("5s25x11x10s4s11x10s4s"), Struct("10s10s10s13s13s13x"), Struct("10s37x20s")


@dataclass(frozen=True)
class DataSet:
    """Data set: its ``kind`` (``"58b"``), the ``line`` that says so, what else stands there, and the lines below."""

    kind: str
    line: int
    more: str
    content: bytes


def data_sets(path: Path) -> list[DataSet]:
    """Data sets of a file in its order; FormatError for one that does not end."""
    raw, at, line, found = path.read_bytes(), 0, 1, list[DataSet]()
    raw = raw if b"\n" in raw else raw.replace(b"\r", b"\n")
    while begin := _BEGIN.search(raw, at):
        kind, more, start = begin[1].decode(), begin[2].decode("latin1"), begin.end()
        line += raw.count(b"\n", at, start - 1)
        binary = _BEFORE_BYTES.match(raw, start) if kind == "58b" else None
        end = _END.search(raw, binary.end() + int(re.sub("[^0-9]", "", more[24:36]) or 0) if binary else start)
        while end and not binary and raw[end.start() - 1 : end.start()] != b"\n":
            end = _END.search(raw, end.end())
        if end is None:
            raise FormatError(f"its data set {kind} does not end: is the file cut off?", line)
        found.append(DataSet(kind, line, more, raw[start : end.start()]))
        at, line = end.end(), line + raw.count(b"\n", start - 1, end.end())
    return found


@dataclass(frozen=True)
class FileUnits:
    """Units of a file: that of ``length`` in m, of ``force`` in N; ``words``: both, if it says them."""

    length: float = 1.0
    force: float = 1.0
    words: str = ""

    def size(self, unit: str) -> float:
        """Size in SI of the file's unit of what has this SI ``unit``."""
        powers = (unit_size(unit) or (1, {}))[1]
        force = powers.get(MASS, 0.0)
        return float(self.length ** (powers.get(LENGTH, 0.0) - force) * self.force**force)


def units_of(sets: Sequence[DataSet]) -> FileUnits:
    """Units of a file by its data sets 164, SI without any; FormatError where they contradict each other."""
    found = {_units(each) for each in sets if each.kind == "164"}
    if len(found) > 1:
        raise FormatError("has data sets 164 of different units: keep those of one of them in it")
    return found.pop() if found else FileUnits()


def _units(one: DataSet) -> FileUnits:
    head, _, below = one.content.decode("latin1").partition("\n")
    with read_by("its data set 164 says no units", ValueError, one.line + 1):
        code = whole(head[:10].strip())
        factors = [_real(each) for each in below.split()[:2]]
        if len(factors) < 2 or min(factors) <= 0:
            raise FormatError("a factor is missing, or not above 0")
    length, force = (1 / each for each in factors)
    words = f"units of {length:g} m and {force:g} N"
    if not np.allclose((length, force), CODES.get(code, (length, force)), rtol=ROUNDED, atol=0):
        told = f"the code {code} is not of the {words} that its factors say"
        raise FormatError(f"{told}: correct one of both, or delete data set 164 if the file is in SI", one.line + 1)
    return FileUnits(length, force, words)


def _real(text: str) -> float:
    return real(text.replace("D", "E").replace("d", "e"), text)


@dataclass(frozen=True)
class FunctionAxis:
    """Axis: its specific data ``type``, the label of its unit, the line."""

    type: int
    label: str
    line: int


@dataclass(frozen=True, eq=False)
class Function:
    """Function: its ``type``, name ``2Z/1Z``, abscissa and values (n,), the axes of both and of the denominator."""

    type: int
    called: str
    at: Array
    value: Array
    axes: tuple[FunctionAxis, FunctionAxis, FunctionAxis]


def chosen(sets: Sequence[DataSet], name: str | int) -> tuple[int, Function]:
    """The function that is wanted of several, by its number from 1 or its name ``2Z/1Z``, and its number."""
    curves = [each for each in sets if each.kind in ("58", "58b")]
    number = name if isinstance(name, int) else 1
    if not isinstance(name, int) and len(curves) > 1:
        called = [_function(each).called for each in curves]
        number = called.index(name) + 1 if called.count(name) == 1 else 0
        if not number:
            told = ", ".join(f"{place}: {each}" for place, each in enumerate(called[:8], 1))
            cure = "say which by its number, columns = { value = 1 }"
            raise FormatError(f"has {len(curves)} data sets 58, {told}: {cure}")
    if not 0 < number <= len(curves):
        raise FormatError(f"has {len(curves)} data sets 58, the curves of such a file: there is no number {number}")
    return number, _function(curves[number - 1])


def _function(one: DataSet) -> Function:
    """Function of a data set; FormatError, with the line, for one that is damaged or cut off."""
    *head, body = one.content.split(b"\n", HEAD)
    if len(head) < HEAD:
        raise FormatError("its data set 58 is cut off in its head", one.line)
    type_, *sides = _fields(_PLACES, head[5], one.line + 6)
    called = "/".join(f"{node}{'-' * (way < 0)}{DIRECTIONS.get(abs(way), '')}" for node, way in (sides[:2], sides[2:]))
    at, value = _numbers(one, _fields(_POINTS, head[6], one.line + 7, 3), body)
    first, second, third = (_axis(head[row], one.line + row + 1) for row in (7, 8, 9))
    return Function(type_, called, at, value, (first, second, third))


def _fields(form: Struct, row: bytes, line: int, count: int = 5) -> list[Any]:
    """Fields of a row of the head, the first ``count`` of them whole numbers, empty ones 0."""
    texts = [_text(each) for each in form.unpack(row[: form.size].ljust(form.size))]
    with read_by("", FormatError, line):
        return [whole(each or "0") for each in texts[:count]] + texts[count:]


def _text(raw: bytes) -> str:
    try:
        return raw.decode().strip()
    except UnicodeDecodeError:
        return raw.decode("latin1").strip()


def _axis(row: bytes, line: int) -> FunctionAxis:
    type_, label = _fields(_AXIS, row, line, 1)
    return FunctionAxis(type_, "" if label.upper() in ("NONE", "-") else label, line)


def _numbers(one: DataSet, points: list[Any], body: bytes) -> tuple[Array, Array]:
    """Abscissa and values, as many as the head says; FormatError for others, which zeros that fill a line are not."""
    line, (form, count, even, *steps) = one.line + 7, points
    if form not in PRECISIONS or even not in (0, 1) or count < 1:
        raise FormatError(f"{count} points of type {form} with the spacing {even} are none of data set 58", line)
    require_samples((count,))
    wide = (form > 4) + (2 - even)
    flat = _bytes(one, body, PRECISIONS[form]) if one.kind == "58b" else _lines(body, one.line + HEAD + 1)
    more = flat[count * wide :]
    if len(flat) < count * wide or len(more) >= FILLED or more.any():
        raise FormatError(f"has {len(flat)} numbers for {count} points of {wide}: is the data set cut off?", line)
    table = flat[: count * wide].reshape(count, wide)
    if not np.isfinite(table).all():
        raise FormatError("has entries that are no finite numbers", line)
    value: Array = table[:, -2] + 1j * table[:, -1] if form > 4 else table[:, -1]
    if not even:
        return table[:, 0], value
    with read_by("", FormatError, line):
        first, step = map(_real, steps)
        if not step and count > 1:
            raise FormatError("its steps are 0")
    return np.asarray(first + step * np.arange(count), dtype=float), value


def _bytes(one: DataSet, body: bytes, precision: str) -> Array:
    """Numbers of bytes, little (1) or big endian (2), of IEEE's format (2)."""
    order, made = _fields(Struct("6s6s"), one.more.encode("latin1"), one.line)
    if order not in (1, 2) or made != 2:
        raise FormatError(f"has bytes in the order {order} and numbers of the format {made}: export IEEE 754", one.line)
    kind = np.dtype(("<" if order == 1 else ">") + precision)
    return np.frombuffer(body[: len(body) // kind.itemsize * kind.itemsize], kind).astype(float)


def _lines(body: bytes, line: int) -> Array:
    """Numbers of lines of text, with E or D, of any width; a sign may touch the number before it."""
    found = list[float]()
    for number, text in enumerate(body.decode("latin1").split("\n"), line):
        with read_by("", FormatError, number):
            found += map(_real, _TOUCHING.sub(r" \1", text).split())
    return np.array(found)
