"""Functions at nodal degrees of freedom as universal files have them: data set 58, of text or binary (58b).

Read here, since pyuff refuses D exponents, last lines that are filled up and abscissae as E20.12, and takes the numbers
of other machines, and files that are cut off, as they are. Layout: https://www.ceas3.uc.edu/sdrluff.
"""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass
from struct import Struct

import numpy as np

from vibeam.exchange.curves.data_sets import DataSet
from vibeam.exchange.files import FormatError, read_by, real, require_samples, shown, whole
from vibeam_models.arrays import Array

HEAD = 11  # lines
FILLED = 6  # numbers on a line
PRECISIONS = {2: "f4", 4: "f8", 5: "f4", 6: "f8"}  # by the type of the ordinates, of which 5 and 6 are complex
DIRECTIONS = {1: "X", 2: "Y", 3: "Z", 4: "RX", 5: "RY", 6: "RZ"}
_FUNCTION = Struct("5s25x11x10s4s11x10s4s")
_POINTS = Struct("10s10s10s13s13s13x")
_AXIS = Struct("10s5s5s5s22x20s")
_BINARY = Struct("6s6s24x")
_STRANGE = re.compile(rb"[^0-9eEdD.+\s-]")
_TOUCHING = re.compile(rb"(?<=[0-9.])([+-])")
_NUMBER = re.compile(rb"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


@dataclass(frozen=True)
class FunctionAxis:
    """Axis: its specific data ``type``, exponents of length, force and temperature, the label of its unit, the line."""

    type: int
    exponents: tuple[int, ...]
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


def function_of(one: DataSet) -> Function:
    """Function of a data set; FormatError, with the line, for one that is damaged or cut off."""
    *head, body = one.content.split(b"\n", HEAD)
    if len(head) < HEAD:
        raise FormatError("its data set 58 is cut off in its head", one.line)
    type_, *sides = (_whole(each, one.line + 6) for each in _fields(_FUNCTION, head[5]))
    called = "/".join(f"{node}{'-' * (way < 0)}{DIRECTIONS.get(abs(way), '')}" for node, way in (sides[:2], sides[2:]))
    at, value = _numbers(one, _fields(_POINTS, head[6]), body)
    first, second, third = (_axis(head[place], one.line + place + 1) for place in (7, 8, 9))
    return Function(type_, called, at, value, (first, second, third))


def _fields(form: Struct, line: bytes) -> list[str]:
    return [_text(each) for each in form.unpack(line[: form.size].ljust(form.size))]


def _text(raw: bytes) -> str:
    with suppress(UnicodeDecodeError):
        return raw.decode().strip()
    return raw.decode("latin1").strip()


def _whole(text: str, line: int) -> int:
    with read_by("", FormatError, line):
        return whole(text) if text else 0


def _axis(head: bytes, line: int) -> FunctionAxis:
    *numbers, label = _fields(_AXIS, head)
    type_, *exponents = (_whole(each, line) for each in numbers)
    return FunctionAxis(type_, tuple(exponents), "" if label.upper() in ("NONE", "-") else label, line)


def _numbers(one: DataSet, points: list[str], body: bytes) -> tuple[Array, Array]:
    """Abscissa and values, as many as the head says; FormatError for others, which zeros that fill a line are not."""
    line = one.line + 7
    form, count, even = (_whole(each, line) for each in points[:3])
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
        first, step = (real(field.upper().replace("D", "E"), field) for field in points[3:])
        if not step and count > 1:
            raise FormatError("its steps are 0")
    return np.asarray(first + step * np.arange(count), dtype=float), value


def _bytes(one: DataSet, body: bytes, precision: str) -> Array:
    """Numbers of bytes, little (1) or big endian (2), of IEEE's format (2); the count that is said counts by points."""
    order, made = (_whole(each, one.line) for each in _fields(_BINARY, one.more.encode("latin1")))
    if order not in (1, 2) or made != 2:
        raise FormatError(f"has bytes in the order {order} and numbers of the format {made}: export IEEE 754", one.line)
    kind = np.dtype(("<" if order == 1 else ">") + precision)
    return np.frombuffer(body[: len(body) // kind.itemsize * kind.itemsize], kind).astype(float)


def _lines(body: bytes, line: int) -> Array:
    """Numbers of lines of text, with E or D, of any width; a sign may touch the number before it."""
    plain = _TOUCHING.sub(rb" \1", body.replace(b"D", b"E").replace(b"d", b"e"))
    if not _STRANGE.search(plain):
        with suppress(ValueError):
            return np.array([float(each) for each in plain.split()])
    for number, text in enumerate(plain.split(b"\n"), line):
        for word in text.split():
            if not _NUMBER.fullmatch(word):
                raise FormatError(f"{shown(_text(word))} is no number", number)
    raise AssertionError("a word that is no number")
