"""Nastran's OUTPUT2 files (.op2): data blocks, and the matrices among them.

A file is keys, records of one word, and data: a key above 0 is the number of words in the record after it, one below 0
ends a logical record, 0 a data block. The first logical record of a block is its name, the second its trailer, the
third another name; each further one begins with 0 in a table, with 1 for a column of a matrix, whose strings follow:
first row, which is not counted, and numbers. Words have 32 bits, or 64 (MSC Nastran DMAP Programmer's Guide). Read here
and not by pyNastran, which asks for numpy below 2 and cannot be imported with 2.4 (1.4.1)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.files import LARGEST_TEXT, FormatError, read_by, state_of
from vibeam.exchange.matrices.entries import FileMatrix
from vibeam.exchange.matrices.output4 import TYPES, NastranMatrix, one_of
from vibeam.exchange.nastran import records


@dataclass(frozen=True)
class Words:
    """Words of a file: order of bytes, ``"<"`` or ``">"``, and bytes of each, 4 or 8."""

    order: str
    size: int

    def whole(self, record: bytes) -> NDArray[Any]:
        """Words as whole numbers."""
        return np.frombuffer(record, f"{self.order}i{self.size}")

    def real(self, record: bytes) -> NDArray[Any]:
        """Words as real numbers, of single precision where they have 32 bits."""
        return np.frombuffer(record, f"{self.order}f{self.size}")

    def text(self, record: bytes) -> str:
        """The name of up to eight letters in two words, of which each may hold four."""
        letters = record[:8] if record[4:8].strip() else record[:4] + record[self.size : self.size + 4]
        return letters.decode("ascii", "replace").strip().upper()


@dataclass(frozen=True)
class Block:
    """Data block: name, trailer, and its logical records from the fourth on, each as the records that it is made of."""

    words: Words
    name: str
    trailer: list[int]
    content: list[list[bytes]]

    def table(self) -> list[bytes]:
        """Logical records of a table, without the word that begins them."""
        return [b"".join(each[1:]) for each in self.content]

    def matrix(self) -> NastranMatrix | None:
        """Matrix that the block is, None of a table."""
        if not any(each and self.words.whole(each[0])[0] == 1 for each in self.content) or len(self.trailer) < 5:
            return None
        columns, rows, form, kind = self.trailer[1:5]
        real = self.words.order + (TYPES.get(kind, "f4") if self.words.size == 4 else "f8")
        strings = [
            (column, int(self.words.whole(each[: self.words.size])[0]), np.frombuffer(each[self.words.size :], real))
            for column, found in enumerate(self.content, 1)
            for each in found[1:]
        ]
        return NastranMatrix(self.name, columns, rows, form, kind, strings if kind in TYPES else [])


def blocks(path: Path) -> Iterator[Block]:
    """Data blocks of a file; FormatError where it is cut off."""
    state_of(path, LARGEST_TEXT)
    with read_by(refusal=OSError):
        content = path.read_bytes()
    order = "<" if content[1:4] == bytes(3) else ">"
    words = Words(order, max(content[0], content[3:4][0] if content[3:4] else 0))
    if words.size not in (4, 8):
        raise FormatError("begins with no key of OUTPUT2")
    found, logical, parts = records(content, order), list[list[bytes]](), list[bytes]()
    for record in found:
        if len(record) != words.size:
            raise FormatError(f"has a record of {len(record)} bytes in place of a key")
        key = int(words.whole(record)[0])
        if key > 0:
            parts.append(next(found, b""))
            string = len(parts) > 1 and words.whole(parts[0])[0] == 1  # whose first row is not counted
            if len(parts[-1]) != (key + string) * words.size:
                raise FormatError(f"has a record of {len(parts[-1])} bytes in place of {key} words: is it cut off?")
        elif key < 0:
            logical.append(parts)
            parts = []
        else:
            if len(logical) > 2 and all(logical[:2]):
                yield Block(words, words.text(logical[0][0]), words.whole(logical[1][0]).tolist(), logical[3:])
            logical, parts = [], []
    if logical:
        raise FormatError("ends within a data block: is it cut off?")


def read_output2(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix by that name; with none, the only one that begins with K, M or B (damping)."""
    return one_of(filter(None, (block.matrix() for block in blocks(path))), name, wanted)
