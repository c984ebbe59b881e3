"""MATLAB's files up to version 7, read by scipy after a look at what each variable says that it holds.

Layout: MathWorks, MAT-File Format, "Level 5 MAT-Files". Elements are (type, bytes, content), padded to 8 bytes; a
variable is an element of elements: flags, dimensions, name, content. Level 4 has no packed and no nested variables.
"""

from __future__ import annotations

import struct
import warnings
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from itertools import islice
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.files import BYTES, FormatError, read_by, require_room, state_of

MATRIX, PACKED = 14, 15  # types of elements
PARTS = 4  # elements of an array: flags, dimensions, name, content
TYPES = {*range(1, 8), 9, *range(12, 19)}
NESTED, SPARSE, NUMERIC = (1, 2, 3), 5, range(6, 16)  # classes: cells, structs and objects; sparse; full
OBJECT = 17  # class of objects of MATLAB's classdef
FILE_HEAD = 128  # bytes
DEEPEST = 16  # variables in variables
Content = bytes | memoryview


@dataclass(frozen=True, eq=False)
class Variable:
    """Variable of a file, not read yet; ``plain``: a full or sparse array.

    ``object``: an object of a class of MATLAB's own, which cannot be read; ``source``: content of a file that has it.
    """

    name: str
    plain: bool
    object: bool
    source: bytes

    def read(self, **how: Any) -> Any:
        """Its value by ``loadmat`` with the options ``how``."""
        from scipy.io import loadmat

        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return loadmat(BytesIO(self.source), appendmat=False, variable_names=[self.name], **how)[self.name]


def variables(path: Path) -> list[Variable]:
    """The variables of a file; FormatError where it is none, damaged, or too large."""
    from scipy.io import whosmat

    state_of(path, 2 * BYTES)
    raw = path.read_bytes()
    with read_by("is no MATLAB file that can be read"):
        if 0 in raw[:4]:  # level 4; of a file scipy would take memory for a name as long as its head says
            return [Variable(name, True, False, raw) for name, _, _ in whosmat(BytesIO(raw), appendmat=False)]
        if raw[126:128] not in (b"IM", b"MI"):
            raise FormatError("is no MATLAB file that can be read: it does not begin as one")
        return list(_level_5(raw, "<" if raw[126:128] == b"IM" else ">"))


def _level_5(raw: bytes, order: str) -> Iterator[Variable]:
    room = 2 * BYTES
    for kind, at, start, end in _elements(raw, FILE_HEAD, order):
        if kind not in (MATRIX, PACKED):
            raise FormatError(f"is damaged: there is no variable at byte {at}")
        body = raw[at:end] if kind == MATRIX else zlib.decompressobj().decompress(raw[start:end], room + 1)
        room -= len(body)
        if room < 0:
            raise FormatError(f"holds more than {2 * BYTES / 1e6:.0f} MB: keep fewer variables in one file")
        _, _, start, end = next(_elements(body, 0, order))
        made, dimensions, name = _head(body, start, order)
        if made in NUMERIC:
            require_room(dimensions, 1)
        if made <= NUMERIC[-1]:
            _check(memoryview(body)[:end], start, order)
        if name:
            yield Variable(name, made in (SPARSE, *NUMERIC), made > NUMERIC[-1], raw[:FILE_HEAD] + body)


def _elements(content: Content, at: int, order: str) -> Iterator[tuple[int, int, int, int]]:
    """Type and place of each element from a byte on, where its content begins and ends."""
    while at < len(content):
        if at + 8 > len(content):
            raise FormatError("is damaged: it is cut off")
        kind, size = struct.unpack_from(f"{order}II", content, at)
        start = at + 8
        if kind >> 16:  # four bytes at most lie in the tag itself
            kind, size, start = kind & 0xFFFF, kind >> 16, at + 4
        if start + size > len(content):
            raise FormatError("is damaged: it is cut off")
        yield kind, at, start, start + size
        at = at + 8 if start == at + 4 else start + size + (-size % 8 if kind != PACKED else 0)


def _head(content: Content, at: int, order: str) -> tuple[int, tuple[int, ...], str]:
    """Class, dimensions and name of the variable whose content begins at a byte; objects have no dimensions."""
    parts = [bytes(content[start:stop]) for _, _, start, stop in islice(_elements(content, at, order), 3)]
    if len(parts) < 3 or len(parts[0]) < 4:
        raise FormatError("is damaged: a variable has no head")
    made = struct.unpack_from(f"{order}I", parts[0])[0] & 0xFF
    if made == OBJECT:
        return made, (), parts[1].decode("latin1")
    return made, tuple(np.frombuffer(parts[1][: len(parts[1]) & ~3], f"{order}i4").tolist()), parts[2].decode("latin1")


def _check(content: memoryview, start: int, order: str, depth: int = 0) -> None:
    """FormatError for the variable whose content ends here where it, or one inside, says more than is there."""
    if depth > DEEPEST:
        raise FormatError(f"holds variables in variables, deeper than {DEEPEST}")
    if start == len(content):
        return
    made, dimensions, _ = _head(content, start, order)
    parts = list(_elements(content, start, order))
    inside = [content[first:last] for kind, _, first, last in parts if kind == MATRIX]
    for each in inside:
        _check(each, 0, order, depth + 1)
    if strange := {kind for kind, *_ in parts} - TYPES:  # scipy would look it up beyond its table
        raise FormatError(f"is damaged: there is no type {min(strange)} of elements")
    if made not in NESTED and (inside or len(parts) < PARTS):  # scipy would go on in the next variable
        raise FormatError(f"is damaged: a variable has {len(parts)} elements")
    most = max(len(inside), 1) if made in NESTED else len(content)
    if made != SPARSE and (min(dimensions, default=1) < 0 or prod(dimensions) > most):
        raise FormatError(f"is damaged: a variable says that it is {' × '.join(map(str, dimensions))}")
