"""Nastran's direct input matrices: DMIG cards in bulk data or a punch file.

A header "DMIG, NAME, 0, IFO, TIN, TOUT, …" and columns "DMIG, NAME, GJ, CJ, , G1, C1, A1, B1, G2, …" (MSC Nastran Quick
Reference Guide, DMIG). Of a symmetric matrix (IFO 6) an entry off the diagonal is there once.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from math import isfinite
from pathlib import Path

import numpy as np

from vibeam.exchange.files import FormatError, text_of
from vibeam.exchange.matrices.declaration import chosen
from vibeam.exchange.matrices.entries import FileMatrix, Label, labelled
from vibeam.exchange.matrices.text import shown
from vibeam.exchange.nastran import cards

SQUARE, SYMMETRIC = 1, 6  # IFO
REAL = (1, 2)  # TIN: single, double precision
ALIKE = {"M": ("M",), "K": ("K",), "C": ("B",)}  # first letters of what Nastran calls mass, stiffness and damping
_WHOLE = re.compile(r"[+-]?[0-9]{1,15}")
_REAL = re.compile(r"([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?:[ED]?([+-][0-9]+)|[ED]([0-9]+))?")  # 1.5+3 is 1.5E+3
Card = tuple[int, list[str]]  # line, fields after the first: name, GJ, CJ, a blank one, groups of four


def read_nastran(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix by that name; with none, the only one that begins with K, M or B (damping)."""
    found: dict[str, list[Card]] = {}
    for number, called, fields in cards(text_of(path).upper()):
        if called != "DMIG":
            continue
        if not (fields[0] and fields[1]):
            raise FormatError("a DMIG card without a name or a column", number)
        found.setdefault(fields[0], []).append((number, fields))
    alike = [each for each in found if each.startswith(ALIKE.get(wanted, ()))]
    return _matrix(found[chosen(list(found), name.upper(), alike[0] if len(alike) == 1 else "")])


def _matrix(found: list[Card]) -> FileMatrix:
    header = [card for card in found if card[1][1] == "0"]
    if len(header) != 1:
        raise FormatError(f"a DMIG matrix needs one header, here there are {len(header)}", found[0][0])
    number, fields = header[0]
    form, kind = (_whole(number, field) for field in fields[2:4])
    if form not in (SQUARE, SYMMETRIC):
        raise FormatError(f"IFO {form} is a rectangular matrix: square (1) or symmetric (6) is needed", number)
    if kind not in REAL:
        raise FormatError(f"TIN {kind} is complex: real numbers (1 or 2) are needed", number)
    rows: list[Label] = []
    columns: list[Label] = []
    values: list[float] = []
    for line, card in found:
        if card[1] != "0":
            for row, value in _column(line, card):
                rows.append(row)
                columns.append(_label(line, card[1], card[2]))
                values.append(value)
    if not values:
        raise FormatError("the matrix has no columns", number)
    places = np.array([rows, columns], dtype=np.int64)
    return labelled(places[0], places[1], np.array(values))


def _column(line: int, card: list[str]) -> Iterator[tuple[Label, float]]:
    for start in range(4, len(card), 4):
        node, direction, value, _ = card[start : start + 4]
        if node:
            yield _label(line, node, direction), _real(line, value)


def _label(line: int, node: str, direction: str) -> Label:
    """Node and direction; of a scalar point, which has one alone, that is 1."""
    return _whole(line, node), max(_whole(line, direction or "0"), 1)


def _whole(line: int, field: str) -> int:
    if not _WHOLE.fullmatch(field):
        raise FormatError(f"{shown(field)} is no whole number", line)
    return int(field)


def _real(line: int, field: str) -> float:
    found = _REAL.fullmatch(field.upper())
    if not found:
        raise FormatError(f"{shown(field)} is no number", line)
    value = float(f"{found[1]}E{found[2] or found[3] or 0}")
    if not isfinite(value):
        raise FormatError(f"{shown(field)} is beyond the largest number", line)
    return value
