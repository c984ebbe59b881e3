"""Matrices in the text of Abaqus and CalculiX.

Of Abaqus, from *MATRIX GENERATE and *MATRIX OUTPUT, a line is "row node, its degree of freedom, column node, its degree
of freedom, value" (FORMAT=MATRIX INPUT, LABELS) or "row, column, value" (FORMAT=COORDINATE). Above it may stand *MATRIX
INPUT: of a symmetric matrix, which one is without TYPE, one half may stand for both (Abaqus Keywords Reference Guide).
Internal nodes have negative numbers. A degree of freedom that a boundary
condition holds has 1e36 on the diagonal of the stiffness.

CalculiX (*FREQUENCY, SOLVER=MATRIXSTORAGE) writes "row column value" of one half to .sti and .mas, and "node.direction"
of every row to a file .dof beside them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from vibeam.exchange.files import FormatError, Line, lines_of, read_by, real, shown, text_of, whole
from vibeam.exchange.matrices.declaration import chosen
from vibeam.exchange.matrices.entries import FileMatrix, Labels, assembled, labelled
from vibeam.exchange.matrices.text import EXACT, Rows, entries_of, require_no_name

HELD = 1e35  # on the diagonal
MOST = 100  # keywords of a deck
PARAMETERS = {"NAME": "", "TYPE": "SYMMETRIC", "SCALE FACTOR": "1"}  # of *MATRIX INPUT, with what stands for none
SYMMETRIC = {"SYMMETRIC": True, "UNSYMMETRIC": False}
_KEYWORD = re.compile(r"^[ \t]*\*(?!\*)[^\r\n]*(?:(?<=,)[ \t]*\r?\n[^\r\n]*)*", re.MULTILINE)  # goes on below a comma


def read_abaqus(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix by that name, or the only one."""
    (_, _, loose), *sections = _sections(text_of(path))
    if not sections:
        require_no_name(name)
        return _matrix(loose, None)
    for number, line in loose():
        raise FormatError(f"{shown(line)} stands above the first keyword", number)
    found = dict[str, tuple[int, dict[str, str], Rows]]()
    for number, keyword, rows in sections:
        with read_by("", line=number):
            said = _parameters(keyword)
            if found.setdefault(said["NAME"].upper(), (number, said, rows))[0] != number:
                raise FormatError(f"{shown(keyword)}: two matrices have one NAME")
    return _declared(*found[chosen(list(found), name.upper(), wanted)])


def _sections(text: str) -> Iterator[tuple[int, str, Rows]]:
    """Line of each keyword, the keyword with its parameters, and the rows below; first those above all keywords."""
    number, keyword, at, above = 1, "", 0, 0  # ``above``: lines before the one on which a keyword ends
    for count, found in enumerate(_KEYWORD.finditer(text)):
        yield number, keyword, partial(_rows, text[at : found.start()], above)
        number = above + text.count("\n", at, found.start()) + 1
        keyword, at, above = found[0], found.end(), number + found[0].count("\n") - 1
        if count >= MOST:
            raise FormatError(f"has more than {MOST} keywords: keep those of its matrices", number)
    yield number, keyword, partial(_rows, text[at:], above)


def _rows(text: str, above: int) -> Iterator[Line]:
    """Lines that are no comment; ``above``: lines of the file before these."""
    for number, line in lines_of(text):
        if not line.lstrip().startswith("**"):
            yield above + number, line.replace(",", " ")


def _parameters(keyword: str) -> dict[str, str]:
    """Parameters of *MATRIX INPUT by names in capitals; FormatError for others, and for another keyword."""
    name, *words = (" ".join(word.split()) for word in keyword.strip("*, \t").split(","))
    pairs = [[part.strip(' "') for part in word.split("=")] for word in words]
    said = {pair[0].upper(): pair[-1] for pair in pairs}
    sound = all(len(pair) == 2 and pair[1] for pair in pairs) and len(said) == len(pairs)
    if name.upper() != "MATRIX INPUT" or said.keys() - PARAMETERS or not sound:
        read = " = …, ".join(PARAMETERS)
        raise FormatError(f"{shown(keyword)} is not read: keep *MATRIX INPUT, {read} = …, each once, and its entries")
    return PARAMETERS | said


def _declared(number: int, said: dict[str, str], rows: Rows) -> FileMatrix:
    """The matrix of *MATRIX INPUT."""
    kind = said["TYPE"].upper()
    with read_by("", line=number):
        factor = real(said["SCALE FACTOR"])
        if not factor or kind not in SYMMETRIC:
            raise FormatError(f"SCALE FACTOR is a number, not 0, and TYPE is {' or '.join(SYMMETRIC)}")
    found = _matrix(rows, SYMMETRIC[kind])
    notes = (f"TYPE={kind}", *[f"× {factor:g} by SCALE FACTOR"] * (factor != 1))
    return replace(found, matrix=factor * found.matrix, notes=(*found.notes, *notes))


def _matrix(rows: Rows, symmetric: bool | None, labels: Labels | None = None) -> FileMatrix:
    """The matrix of entries at nodes, or at rows and columns, as many as ``labels`` where these are known."""
    number, first = next(rows(), (None, ""))
    width = len(first.split(maxsplit=5))
    if width not in (3, 5):
        raise FormatError('holds no entries, "row node, dof, column node, dof, value" or "row, column, value"', number)
    places, values = entries_of(rows, width, 1 if width == 3 else -EXACT)
    if width == 5:
        found = labelled(places[:, :2], places[:, 2:], values, symmetric)
    else:
        size = int(places.max()) if labels is None else len(labels)
        found = assembled(places[:, 0] - 1, places[:, 1] - 1, values, (size, size), symmetric, labels)
    return replace(found, held=frozenset(np.flatnonzero(found.matrix.diagonal() >= HELD).tolist()))


def read_calculix(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix of a file, its coordinates named by the file .dof beside it where that is there."""
    require_no_name(name)
    beside = path.with_suffix(".dof")
    labels = _nodes(beside) if beside.exists() else None
    found = _matrix(partial(_rows, text_of(path), 0), True, labels)
    note = f"nodes of {beside.name}" if labels else f"nodes without names, which {beside.name} beside it would have"
    return replace(found, notes=(*found.notes, note))


def _nodes(path: Path) -> Labels:
    """Node and direction of each coordinate, ``12.3`` on a line."""
    labels = dict[tuple[int, int], None]()
    with read_by(path.name):
        for number, line in lines_of(text_of(path)):
            node, _, direction = line.strip().partition(".")
            if direction not in tuple("123456") or (whole(node), int(direction)) in labels:
                raise FormatError(f"{shown(line)} is no node and direction, 12.3, or there twice", number)
            labels[whole(node), int(direction)] = None
    return tuple(labels)
