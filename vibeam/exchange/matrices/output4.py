"""Matrices of Nastran's OUTPUT4 files (.op4): text and binary, full and sparse, BIGMAT, single and double precision.

A head has columns, rows (below 0: BIGMAT), form, type, name; then each column its number, its first row and its length
in words, with the numbers below; where the first row is 0 it is sparse, in strings with heads of their own: one word,
65536 (length + 1) + row, or of BIGMAT two, length + 1 and row (MSC Nastran Quick Reference Guide, OUTPUT4). One more
column ends a matrix. In text a full column may count numbers for words, and pyNastran (1.4.1) counts other ones."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.files import LARGEST_TEXT, FormatError, lines_of, read_by, require_room, shown, state_of, whole
from vibeam.exchange.matrices.declaration import chosen
from vibeam.exchange.matrices.entries import FileMatrix, assembled
from vibeam.exchange.matrices.nastran import alike
from vibeam.exchange.nastran import real_field, records

FORMS = {1: False, 2: False, 6: True}  # square, rectangular, symmetric
TYPES = {1: "f4", 2: "f8"}  # real: single, double
SMALL = 65536  # rows, from which on a matrix is BIGMAT
String = tuple[int, int, NDArray[Any]]  # column, first row, both from 1, and the numbers below
_HEAD = re.compile(r"(.{8})(.{8})(.{8})(.{8})(.{8})\(?(?:1P,?)?[0-9]*[ED]([0-9]{1,2})\.[0-9]+.*", re.IGNORECASE)


@dataclass(frozen=True)
class NastranMatrix:
    """Head of a matrix, and its strings."""

    name: str
    columns: int
    rows: int
    form: int
    type: int
    strings: list[String]

    def made(self) -> FileMatrix:
        """The matrix itself; FormatError for one that is complex or of another form."""
        if self.type not in TYPES or self.form not in FORMS:
            read = "square (1), rectangular (2) or symmetric (6), and real (1, 2), are read"
            raise FormatError(f"{self.name!r} has form {self.form} and type {self.type}: {read}")
        lengths = [len(numbers) for _, _, numbers in self.strings]
        require_room((5 * sum(lengths) // 2,))  # of entries with their places, and those of the other half
        columns = np.repeat([column for column, _, _ in self.strings], lengths).astype(np.int64)
        parts = (np.arange(row, row + len(numbers)) for _, row, numbers in self.strings)
        rows = np.concatenate([np.zeros(0, np.int64), *parts])
        values = np.concatenate([np.zeros(0), *(numbers for _, _, numbers in self.strings)])
        there = values != 0
        shape = self.rows, self.columns
        return assembled(rows[there] - 1, columns[there] - 1, values[there], shape, FORMS[self.form])


def read_output4(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix by that name; with none, the only one that begins with K, M or B (damping)."""
    content = content_of(path)
    found = _text(content.decode("ascii", "replace")) if content[:8].strip().isdigit() else _binary(content)
    return one_of(found, name, wanted)


def content_of(path: Path) -> bytes:
    """The bytes of a file."""
    state_of(path, LARGEST_TEXT)
    with read_by(refusal=OSError):
        return path.read_bytes()


def one_of(matrices: Iterable[NastranMatrix], name: str, wanted: str) -> FileMatrix:
    """The matrix that is meant, as of ``read_output4``."""
    found: dict[str, NastranMatrix] = {}
    for each in matrices:
        if found.setdefault(each.name, each) is not each:
            raise FormatError(f"holds two matrices {each.name!r}: write each to a file of its own")
    return found[chosen(list(found), name.upper(), alike(found, wanted))].made()


def _binary(content: bytes) -> Iterator[NastranMatrix]:
    order = "<" if content[1:4] == bytes(3) else ">"
    found = records(content, order)
    for head in found:
        if len(head) != 24:
            raise FormatError(f"has a head of {len(head)} bytes in place of 24: write it with words of 32 bits")
        columns, rows, form, kind = np.frombuffer(head, f"{order}i4", 4).tolist()
        strings: list[String] = []
        for record in found:
            words = np.frombuffer(record, f"{order}i4")
            if len(words) > 3 and words[0] > columns:
                break
            if len(words) < 3 or words[2] != len(words) - 3:
                raise FormatError("has a column whose length is not that of its record")
            strings.extend(_column(words, order + TYPES.get(kind, "f4"), rows < 0 or rows >= SMALL))
        else:
            raise FormatError("has a matrix that does not end: is it cut off?")
        name = head[16:].decode("ascii", "replace").strip().upper()
        yield NastranMatrix(name, columns, abs(rows), form, kind, strings)


def _column(words: NDArray[np.int32], kind: str, big: bool) -> Iterator[String]:
    column, row, at = int(words[0]), int(words[1]), 3
    if row:
        yield column, row, words[at:].view(kind)
        return
    while at < len(words):
        head = words[at : at + 1 + big].tolist()
        length, row = (head[0], head[-1]) if big else divmod(head[0], SMALL)
        at += big + length
        if length < 2 or at > len(words):
            raise FormatError(f"column {column} has a string that does not lie in it")
        yield column, row, words[at - length + 1 : at].view(kind)


def _text(content: str) -> Iterator[NastranMatrix]:
    found = _groups(content)
    for number, line, below in found:
        said = _HEAD.fullmatch(line)
        if said is None or below:
            raise FormatError(f"{shown(line)} is no head of a matrix", number)
        with read_by("", line=number):
            columns, rows, form, kind = (whole(said[part].strip()) for part in range(1, 5))
        strings, (column, row, length), heads, count = list[String](), (0, 0, 0), 0, 0
        for number, line, below in found:
            with read_by("", line=number):
                words, numbers = [whole(word) for word in line.split()], _fields(below, int(said[6]))
                if len(words) == 3:
                    known = (count, kind * count, kind * count + heads, kind * count + 1)
                    if kind in TYPES and length not in known:
                        raise FormatError(f"has {count} numbers above it in place of {length} words: is it cut off?")
                    (column, row, length), heads, count = words, 0, 0
                elif len(words) in (1, 2):
                    row, heads = words[-1] % SMALL if len(words) == 1 else words[-1], heads + len(words)
                else:
                    raise FormatError(f"{shown(line)} is no head of a column or string")
            if column > columns:
                break
            count += len(numbers)
            strings.append((column, row, numbers))
        else:
            raise FormatError("has a matrix that does not end: is it cut off?")
        yield NastranMatrix(said[5].strip().upper(), columns, abs(rows), form, kind, strings)


def _groups(content: str) -> Iterator[tuple[int, str, list[str]]]:
    """Lines of heads and whole numbers, each with the lines of real numbers below it."""
    group: tuple[int, str, list[str]] = 0, "", []
    for number, line in lines_of(content):
        line = line.rstrip()
        if "." in line and not _HEAD.fullmatch(line):
            group[2].append(line)
            continue
        if group != (0, "", []):
            yield group
        group = number, line, []
    yield group


def _fields(lines: list[str], width: int) -> NDArray[np.float64]:
    texts = (line[at : at + width] for line in lines for at in range(0, len(line), max(width, 1)))
    return np.array([real_field(text.strip().upper()) for text in texts], dtype=float)
