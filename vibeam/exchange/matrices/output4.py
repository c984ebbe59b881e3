"""Matrices of Nastran's OUTPUT4 files (.op4): text and binary, full and sparse, BIGMAT, single and double precision.

A head has columns, rows (below 0: BIGMAT), form, type, name; then each column its number, its first row and its length
in words, with the numbers below; where the first row is 0 the column is sparse, in strings with heads of their own: one
word, 65536 (length + 1) + row, or of BIGMAT two, length + 1 and row (MSC Nastran Quick Reference Guide, OUTPUT4). One
more column ends a matrix."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.files import LARGEST_TEXT, FormatError, lines_of, read_by, shown, state_of, whole
from vibeam.exchange.matrices.declaration import chosen
from vibeam.exchange.matrices.entries import FileMatrix, assembled
from vibeam.exchange.matrices.nastran import alike
from vibeam.exchange.nastran import real_field, records

FORMS = {1: False, 2: False, 6: True}  # square, rectangular, symmetric
TYPES = {1: "f4", 2: "f8"}  # real: single, double
SMALL = 65536  # rows, from which on a matrix is BIGMAT
String = tuple[int, int, NDArray[Any]]  # column, first row, both from 1, and the numbers below


@dataclass(frozen=True)
class NastranMatrix:
    """Head of a matrix and its strings."""

    name: str
    columns: int
    rows: int
    form: int
    type: int
    strings: list[String]

    def made(self) -> FileMatrix:
        """The matrix itself; FormatError for one that is complex or of another form."""
        if self.type not in TYPES or self.form not in FORMS:
            raise FormatError(
                f"{self.name!r} has form {self.form} and type {self.type}: square (1), rectangular (2) or symmetric "
                "(6), and real (1 or 2) are read"
            )
        if any(column > self.columns for column, _, _ in self.strings):
            raise FormatError(f"{self.name!r} has entries beyond its {self.columns} columns")
        lengths = [len(numbers) for _, _, numbers in self.strings]
        firsts = np.array([row - 1 for _, row, _ in self.strings], dtype=np.int64)
        before = np.concatenate([[0], np.cumsum(lengths, dtype=np.int64)])
        rows = np.arange(before[-1]) + np.repeat(firsts - before[:-1], lengths)
        columns = np.repeat(np.array([column - 1 for column, _, _ in self.strings], dtype=np.int64), lengths)
        values = np.concatenate([np.zeros(0), *(numbers for _, _, numbers in self.strings)]).astype(float)
        if not np.isfinite(values).all():
            raise FormatError(f"{self.name!r} has an entry that is no finite number")
        there = values != 0
        return assembled(rows[there], columns[there], values[there], (self.rows, self.columns), FORMS[self.form])


def read_output4(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix by that name; with none, the only one that begins with K, M or B (damping)."""
    state_of(path, LARGEST_TEXT)
    with read_by(refusal=OSError):
        content = path.read_bytes()
    found = _text(content.decode("ascii", "replace")) if content[:8].strip().isdigit() else _binary(content)
    return one_of(found, name, wanted)


def one_of(matrices: Iterable[NastranMatrix], name: str, wanted: str) -> FileMatrix:
    """The matrix that is meant, as of ``read_output4``; the first one of its name."""
    found = {each.name: each for each in reversed(list(matrices))}
    return found[chosen(list(reversed(found)), name.upper(), alike(found, wanted))].made()


def _binary(content: bytes) -> Iterator[NastranMatrix]:
    order = "<" if content[1:4] == bytes(3) else ">"
    found = records(content, order)
    for head in found:
        if len(head) != 24:
            raise FormatError(f"has a head of {len(head)} bytes in place of 24: write it with words of 32 bits")
        columns, rows, form, kind = np.frombuffer(head, f"{order}i4", 4).tolist()
        matrix = NastranMatrix(head[16:].decode("ascii", "replace").strip().upper(), columns, abs(rows), form, kind, [])
        for record in found:
            words = np.frombuffer(record, f"{order}i4")
            if len(words) > 3 and words[0] > columns:
                break
            if len(words) < 3 or words[2] != len(words) - 3:
                raise FormatError(f"{matrix.name!r} has a column whose length is not that of its record")
            matrix.strings.extend(_column(words, order + TYPES.get(kind, "f4"), rows < 0 or rows >= SMALL))
        else:
            raise FormatError(f"{matrix.name!r} does not end: is it cut off?")
        yield matrix


def _column(words: NDArray[np.int32], kind: str, big: bool) -> Iterator[String]:
    column, row, at = int(words[0]), int(words[1]), 3
    if row:
        yield column, row, words[at:].view(kind)
        return
    while at < len(words):
        head = words[at : at + 1 + big].tolist()
        length, row = (head[0], head[-1]) if big else divmod(head[0], SMALL)
        at += 1 + big
        if length < 2 or len(head) < 1 + big or at + length - 1 > len(words):
            raise FormatError(f"column {column} has a string that does not lie in it")
        yield column, row, words[at : at + length - 1].view(kind)
        at += length - 1


_HEAD = re.compile(r"(.{8})(.{8})(.{8})(.{8})(.{8})\(?(?:1P,?)?[0-9]*[ED]([0-9]{1,2})\.[0-9]+.*", re.IGNORECASE)


def _text(content: str) -> Iterator[NastranMatrix]:
    groups = _groups(content)
    for number, line, below in groups:
        said = _HEAD.fullmatch(line)
        if said is None or below:
            raise FormatError(f"{shown(line)} is no head of a matrix", number)
        with read_by("", line=number):
            columns, rows, form, kind = (whole(said[part].strip()) for part in range(1, 5))
        matrix = NastranMatrix(said[5].strip().upper(), columns, abs(rows), form, kind, [])
        column, lengths = 0, list[tuple[int, int, int, int]]()
        for number, line, below in groups:
            with read_by("", line=number):
                words = [whole(word) for word in line.split()]
                column = words[0] if len(words) == 3 else column
                if column > columns:
                    break
                if len(words) == 3 and not words[1] and not below:
                    continue
                length, row = _string(words, rows < 0 or rows >= SMALL)
                numbers = _fields(below, int(said[6]))
                lengths.append((number, column, length, len(numbers)))
                matrix.strings.append((column, row, numbers))
        else:
            raise FormatError(f"{matrix.name!r} does not end: is it cut off?")
        if kind in TYPES and lengths:
            _require_lengths(np.array(lengths).T, kind)
        yield matrix


def _require_lengths(found: NDArray[np.int64], words: int) -> None:
    """FormatError where lengths are not those of the numbers below them, of so many words each: (4, strings).

    Full columns may count numbers in place of words, and pyNastran (1.4.1) says of each string how long its column is.
    """
    lines, columns, said, counts = found
    place = np.unique(columns, return_inverse=True)[1]
    totals = np.bincount(place, counts)[place]
    if not any((said == each).all() for each in (words * counts, counts, words * totals)):
        first = int(np.flatnonzero(said != words * counts)[0])
        raise FormatError(f"has {counts[first]} numbers below it in place of {said[first]} words", int(lines[first]))


def _groups(content: str) -> Iterator[tuple[int, str, list[str]]]:
    """Lines of heads and whole numbers, each with the lines of real numbers below it."""
    group: tuple[int, str, list[str]] = 0, "", []
    for number, line in lines_of(content):
        line = line.rstrip()
        if "." in line and not _HEAD.fullmatch(line):
            group[2].append(line)
            continue
        if group[1]:
            yield group
        elif group[2]:
            break
        group = number, line, []
    yield group


def _string(words: list[int], big: bool) -> tuple[int, int]:
    """Length in words and first row of what stands below a line of whole numbers."""
    if len(words) == 3:
        return words[2], words[1]
    if len(words) != 1 + big:
        raise FormatError(f"{len(words)} whole numbers are no head of a column or string")
    length, row = words if big else divmod(words[0], SMALL)
    return length - 1, row


def _fields(lines: list[str], width: int) -> NDArray[np.float64]:
    texts = (line[at : at + width] for line in lines for at in range(0, len(line), width))
    return np.array([real_field(text.strip().upper()) for text in texts], dtype=float)
