"""Matrices of Harwell–Boeing and Rutherford–Boeing files: assembled and real, of a symmetric one one half.

Four lines of head (a fifth for right-hand sides, which are no part of the matrix), then pointers, rows and values in
fields as wide as the head says (Duff, Grimes & Lewis, Users' Guide for the Harwell–Boeing Sparse Matrix Collection,
1992). Read here and not by scipy.io.hb_read, which refuses all symmetric ones, exponents with D and numbers that touch,
and takes what is left of a last number that is cut off (1.17)."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.files import FormatError, Line, read_by, require_coordinates, shown, text_of, whole
from vibeam.exchange.matrices.entries import FileMatrix, assembled, compressed
from vibeam.exchange.matrices.text import require_no_name, table

SYMMETRIC = {"RSA": True, "ISA": True, "RUA": False, "IUA": False}
_FORMAT = re.compile(r"\((?:1P,?)?([0-9]*)([IED])([0-9]{1,2})(?:\.[0-9]+(?:E[0-9]+)?)?\)")


def read_harwell_boeing(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix of a file."""
    require_no_name(name)
    lines = text_of(path).upper().splitlines()
    if len(lines) < 5:
        raise FormatError("has no head of four lines with numbers below: is it cut off?")
    with read_by("", line=2):
        *counts, aside = (whole(lines[1][at : at + 14].strip() or "0") for at in range(14, 70, 14))
    kind = lines[2][:3]
    with read_by("", line=3):
        if kind not in SYMMETRIC:
            raise FormatError(f"its matrix is {shown(kind)}: one of {', '.join(SYMMETRIC)} is read, real and assembled")
        rows, columns, count = (whole(lines[2][at : at + 14].strip()) for at in (14, 28, 42))
        require_coordinates(rows, columns)
    forms = [lines[3][start:end].strip() for start, end in pairwise((0, 16, 32, 52))]
    first = 4 + (aside > 0)
    parts = []
    for form, size, length in zip(forms, (columns + 1, count, count), counts, strict=True):
        parts.append(_numbers(list(enumerate(lines[first : first + length], first + 1)), form, size))
        first += length
    starts, indices = (part.astype(np.int64) - 1 for part in parts[:2])
    entries = compressed(parts[2], indices, starts, (rows, columns)).tocoo()
    return assembled(entries.row, entries.col, entries.data, (rows, columns), SYMMETRIC[kind])


def _numbers(lines: list[Line], form: str, size: int) -> NDArray[np.float64]:
    """As many numbers as ``size`` says, of lines in a form of Fortran's."""
    said = _FORMAT.fullmatch(form)
    if said is None:
        raise FormatError(f"{shown(form)} is no form of numbers that is read, (16I5) or (4E20.12)", 4)
    found = table(lambda: _fields(lines, said, size), 1).ravel()
    if len(found) != size or (said[2] == "I" and (found % 1).any()):
        raise FormatError(f"has {len(found)} numbers {form}, and its head says {size}: is it cut off?")
    return found


def _fields(lines: list[Line], form: re.Match[str], size: int) -> Iterator[Line]:
    """Fields one by one: between blanks (scipy writes them wider than it says), those that touch by their width."""
    repeat, width, point = int(form[1] or 1), max(int(form[3]), 1), "." if form[2] != "I" else ""
    first, left = 0, size
    for number, line in lines:
        text, count = line.rstrip(), max(min(repeat, left), 1)
        fields = text.split()
        if len(fields) < count:
            fields = [text[at : at + width].strip() for at in range(0, len(text), width)]
        first = first or len(text)
        if len(fields) != count or len(text) * min(repeat, size) != first * count:
            raise FormatError(f"{shown(text)} has not {count} numbers of one width: is it cut off?", number)
        left -= count
        for field in fields:
            if point not in field:
                raise FormatError(f"{shown(field)} has no decimal point", number)
            yield number, field.replace("D", "E")
