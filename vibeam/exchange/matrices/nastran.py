"""Nastran's direct input matrices: DMIG cards in bulk data or a punch file.

A header "DMIG, NAME, 0, IFO, TIN, TOUT, …" and columns "DMIG, NAME, GJ, CJ, , G1, C1, A1, B1, G2, …" (MSC Nastran Quick
Reference Guide, DMIG). Of a symmetric matrix (IFO 6) an entry off the diagonal is there once.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from vibeam.exchange.files import FormatError, read_by, text_of, whole
from vibeam.exchange.matrices.declaration import chosen
from vibeam.exchange.matrices.entries import FileMatrix, Label, labelled
from vibeam.exchange.nastran import cards, real_field

SQUARE, SYMMETRIC = 1, 6  # IFO
REAL = (1, 2)  # TIN: single, double precision
ALIKE = {"M": ("M",), "K": ("K",), "C": ("B",)}  # first letters of what Nastran calls mass, stiffness and damping
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
    return _matrix(found[chosen(list(found), name.upper(), alike(found, wanted))])


def alike(names: Iterable[str], wanted: str) -> str:
    """The only one of the names of Nastran that begins as what is ``wanted`` does; empty where it is not one."""
    found = [each for each in names if each.startswith(ALIKE.get(wanted, ()))]
    return found[0] if len(found) == 1 else ""


def _matrix(found: list[Card]) -> FileMatrix:
    header = [card for card in found if card[1][1] == "0"]
    if len(header) != 1:
        raise FormatError(f"a DMIG matrix needs one header, here there are {len(header)}", found[0][0])
    number, fields = header[0]
    with read_by("", line=number):
        form, kind = map(whole, fields[2:4])
    if form not in (SQUARE, SYMMETRIC):
        raise FormatError(f"IFO {form} is a rectangular matrix: square (1) or symmetric (6) is needed", number)
    if kind not in REAL:
        raise FormatError(f"TIN {kind} is complex: real numbers (1 or 2) are needed", number)
    entries: list[tuple[Label, Label, float]] = []
    for line, card in found:
        with read_by("", line=line):
            entries.extend(_column(card) if card[1] != "0" else ())
    if not entries:
        raise FormatError("the matrix has no columns", number)
    rows, columns, values = map(np.array, zip(*entries, strict=True))
    return labelled(rows, columns, values, form == SYMMETRIC)


def _column(card: list[str]) -> Iterator[tuple[Label, Label, float]]:
    for start in range(4, len(card), 4):
        node, direction, value, _ = card[start : start + 4]
        if node:
            yield _label(node, direction), _label(card[1], card[2]), real_field(value)


def _label(node: str, direction: str) -> Label:
    """Node and direction; of a scalar point, which has one alone, that is 1."""
    return whole(node), max(whole(direction or "0"), 1)
