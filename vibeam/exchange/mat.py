"""MATLAB's files up to version 7, read by scipy after a look at what each variable says that it holds.

Layout: MathWorks, MAT-File Format, "Level 5 MAT-Files". Elements are (type, bytes, content), padded to 8 bytes; a
variable is an element of elements: flags, dimensions, name, content. Level 4 has no packed and no nested variables.
"""

from __future__ import annotations

import mmap
import struct
import warnings
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from math import prod
from pathlib import Path
from typing import Any, BinaryIO

from vibeam.exchange.files import BYTES, FormatError, require_coordinates, require_room, state_of

MATRIX, PACKED = 14, 15  # types of elements
PARTS = 4  # elements of an array: flags, dimensions, name, content
TYPES = (*range(1, 8), 9, *range(12, 19))
NESTED, SPARSE, NUMERIC = (1, 2, 3), 5, range(6, 16)  # classes: cells, structs and objects; sparse; full
TEXT, OBJECT = 4, 17  # classes of texts, and of objects of MATLAB's classdef
FILE_HEAD = 128  # bytes
LONGEST_HEAD = 1000  # bytes that hold the flags, dimensions and name of a variable
DEEPEST, MOST = 16, 100_000  # variables in variables
Content = bytes | mmap.mmap


@dataclass(frozen=True)
class Variable:
    """Variable at bytes of a file, not read yet; ``plain``: a full or sparse array, ``packed`` or not.

    ``object``: class of an object of MATLAB's own, which cannot be read.
    """

    path: Path
    name: str
    plain: bool
    start: int = 0
    end: int = 0
    packed: bool = False
    object: str = ""

    def read(self, **how: Any) -> Any:
        """Its value by ``loadmat`` with the options ``how``; FormatError for one that is damaged, or too large."""
        if not self.end:
            return self._loaded(self.path.open("rb"), how)
        with self.path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
            order = _order(content)
            if not self.packed:
                _check(content, self.start, self.end, order, [0])
                return self._loaded(file, how)
            body = _inflated(content[self.start : self.end], 2 * BYTES)
            _check(body, 0, len(body), order, [0])
            return self._loaded(BytesIO(content[:FILE_HEAD] + body), how)

    def _loaded(self, file: BinaryIO, how: dict[str, Any]) -> Any:
        from scipy.io import loadmat

        with file, warnings.catch_warnings():
            warnings.simplefilter("error")
            return loadmat(file, variable_names=[self.name], **how)[self.name]


def variables(path: Path) -> list[Variable]:
    """The variables of a file, the first of each name; FormatError where it is none, or damaged."""
    state_of(path)
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        if 0 in content[:4]:
            return _level_4(path)
        if content[126:128] not in (b"IM", b"MI"):
            raise FormatError("is no MATLAB file that can be read: it does not begin as one")
        found = list(_level_5(path, content))
    return list({each.name: each for each in reversed(found)}.values())[::-1]


def _level_4(path: Path) -> list[Variable]:
    from scipy.io import whosmat

    found = whosmat(path, appendmat=False)
    for _, shape, kind in found:
        if kind == "sparse":
            require_coordinates(*shape)
        else:
            require_room(shape)
    return [Variable(path, name, plain=True) for name, _, _ in found]


def _level_5(path: Path, content: mmap.mmap) -> Iterator[Variable]:
    at, order = FILE_HEAD, _order(content)
    while at < len(content):
        kind, start, end, _ = _tag(content, at, len(content), order)
        if kind not in (MATRIX, PACKED):
            raise FormatError(f"is damaged: there is no variable at byte {at}")
        head: Content = content[start - 8 : min(end, start + LONGEST_HEAD)]
        if kind == PACKED:
            head = _inflated(content[start : min(end, start + LONGEST_HEAD)], LONGEST_HEAD, whole=False)
        made, dimensions, name = _head(head, 8, len(head), order)
        if made == OBJECT:
            name, _, own = _words(head, order)
            yield Variable(path, name, plain=False, object=own)
            name = ""
        if name and made in (*NESTED, TEXT, SPARSE, *NUMERIC):
            if made in NUMERIC:
                require_room(dimensions, 1)
            place = (start, end) if kind == PACKED else (at, end)
            yield Variable(path, name, made == SPARSE or made in NUMERIC, *place, packed=kind == PACKED)
        at = end


def _order(content: Content) -> str:
    return "<" if content[126:128] == b"IM" else ">"


def _inflated(packed: bytes, most: int, whole: bool = True) -> bytes:
    engine = zlib.decompressobj()
    found = engine.decompress(packed, most)
    if whole and engine.unconsumed_tail:
        raise FormatError(f"holds a packed variable of more than {most / 1e6:.0f} MB")
    return found


def _tag(content: Content, at: int, end: int, order: str) -> tuple[int, int, int, int]:
    """Type of the element at a byte, where its content begins and ends, where the next element begins."""
    if at + 8 > end:
        raise FormatError("is damaged: it is cut off")
    kind, size = struct.unpack_from(f"{order}II", content, at)
    start = at + 8
    if kind >> 16:  # four bytes at most lie in the tag itself
        kind, size, start = kind & 0xFFFF, kind >> 16, at + 4
    if start + size > end:
        raise FormatError("is damaged: it is cut off")
    return kind, start, start + size, at + 8 if start == at + 4 else start + size + -size % 8


def _head(content: Content, at: int, end: int, order: str) -> tuple[int, tuple[int, ...], str]:
    """Class, dimensions and name of the variable whose content begins at a byte."""
    _, start, _, at = _tag(content, at, end, order)
    made = struct.unpack_from(f"{order}I", content, start)[0] & 0xFF
    if made > NUMERIC[-1]:  # functions and classes of MATLAB's own have no dimensions
        return made, (), ""
    _, start, stop, at = _tag(content, at, end, order)
    dimensions = struct.unpack(f"{order}{(stop - start) // 4}i", content[start : stop - (stop - start) % 4])
    _, start, stop, _ = _tag(content, at, end, order)
    return made, dimensions, content[start:stop].decode("latin1")


def _words(head: Content, order: str) -> list[str]:
    """Name, system and class of an object, whose head has no dimensions."""
    found, at = list[str](), _tag(head, 8, len(head), order)[3]
    for _ in range(3):
        _, start, stop, at = _tag(head, at, len(head), order)
        found.append(head[start:stop].decode("latin1"))
    return found


def _check(content: Content, at: int, end: int, order: str, met: list[int], depth: int = 0) -> None:
    """FormatError for the variable at a byte where it, or one inside, says that it is more than is there."""
    _, start, end, _ = _tag(content, at, end, order)
    met[0] += 1
    if depth > DEEPEST or met[0] > MOST:
        raise FormatError(f"holds variables in variables, deeper than {DEEPEST} or more than {MOST}")
    if start == end:
        return
    made, dimensions, _ = _head(content, start, end, order)
    inside, parts, at = 0, 0, start
    while at < end:
        kind, _, _, behind = _tag(content, at, end, order)
        if kind not in TYPES:  # scipy would look it up beyond its table
            raise FormatError(f"is damaged: there is no type {kind} of elements")
        parts += 1
        if kind == MATRIX:
            inside += 1
            _check(content, at, end, order, met, depth + 1)
        at = behind
    if made not in NESTED and (inside or parts < PARTS):  # scipy would go on in the next variable
        raise FormatError(f"is damaged: a variable has {parts} elements")
    if made == SPARSE:
        require_coordinates(*dimensions)
    elif min(dimensions, default=1) < 0 or prod(dimensions) > (max(inside, 1) if made in NESTED else end - start):
        raise FormatError(f"is damaged: a variable says that it is {' × '.join(map(str, dimensions))}")
