"""Matrices in the text of Abaqus and CalculiX.

Of Abaqus, from *MATRIX GENERATE and *MATRIX OUTPUT, a line is "row node, its degree of freedom, column node, its degree
of freedom, value" (FORMAT=MATRIX INPUT, LABELS) or "row, column, value" (FORMAT=COORDINATE). Above it may stand *MATRIX
INPUT: of a symmetric matrix, which one is without TYPE, one half may stand for both; *MATRIX ASSEMBLE says which matrix
is the mass (Abaqus Keywords Reference Guide). Internal nodes have negative numbers. A degree of freedom that a boundary
condition holds has 1e36 on the diagonal of the stiffness.

CalculiX (*FREQUENCY, SOLVER=MATRIXSTORAGE) writes "row column value" of one half to .sti and .mas, and "node.direction"
of every row to a file .dof beside them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import islice
from math import inf
from pathlib import Path

import numpy as np

from vibeam.exchange.files import FormatError, Line, lines_of, read_by, real, shown, text_of, whole
from vibeam.exchange.matrices.declaration import chosen
from vibeam.exchange.matrices.entries import FileMatrix, Label, assembled, labelled
from vibeam.exchange.matrices.text import require_no_name, table

HELD = 1e35  # on the diagonal
EXACT = 2.0**53  # up to which a double is any whole number
INPUT, ASSEMBLE = "MATRIX INPUT", "MATRIX ASSEMBLE"
PARAMETERS = {INPUT: ("NAME", "INPUT", "TYPE", "SCALE FACTOR"), ASSEMBLE: ("MASS", "STIFFNESS", "VISCOUS DAMPING")}
WANTED = {"M": "MASS", "K": "STIFFNESS", "C": "VISCOUS DAMPING"}
SYMMETRIC = {"SYMMETRIC": True, "UNSYMMETRIC": False}


@dataclass
class Keyword:
    """Keyword that ends on line ``last``, with its parameters; its entries end before line ``end``.

    Without a ``name``: what stands above the first one.
    """

    name: str = ""
    last: int = 0
    end: float = inf
    said: dict[str, str] = field(default_factory=dict)


def read_abaqus(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix by that name, the one that *MATRIX ASSEMBLE says is ``wanted``, or the only one."""
    text = text_of(path)
    loose, *keywords = _keywords(text)
    found = {each.said.get("NAME", "").upper(): each for each in keywords if each.name == INPUT}
    if any(_rows(text, loose)) or not found:
        if found:
            raise FormatError("has entries above *MATRIX INPUT: write another one above them")
        require_no_name(name)
        return _matrix(text, loose, None)
    if len(found) < sum(each.name == INPUT for each in keywords):
        raise FormatError("has two matrices of one NAME")
    for each in keywords:
        stray = next(_rows(text, each), None) if each.name == ASSEMBLE or "INPUT" in each.said else None
        if stray:
            raise FormatError(f"{shown(stray[1])} stands below a keyword without lines of its own", stray[0])
    assembles = {key: said for each in keywords if each.name == ASSEMBLE for key, said in each.said.items()}
    alike = assembles.get(WANTED.get(wanted, ""), wanted)
    return _declared(path, text, found[chosen(list(found), name.upper(), alike.upper())])


def _keywords(text: str) -> list[Keyword]:
    """Keywords: on a line that begins with one *, and those after it as long as a comma ends them."""
    found, more = [Keyword()], False
    for number, line in lines_of(text):
        words = [each.strip() for each in line.split(",")]
        if line.lstrip().startswith("**") or not (more or line.lstrip().startswith("*")):
            continue
        if not more:
            name = " ".join(words.pop(0)[1:].upper().split())
            if name not in PARAMETERS:
                raise FormatError(f"{shown(line)} is not read: keep *{INPUT}, *{ASSEMBLE} and their lines", number)
            found[-1].end = number
            found.append(Keyword(name))
        more = not words[-1] if words else False
        for each in filter(None, words):
            _add(found[-1], each, number)
        found[-1].last = number
    return found


def _add(keyword: Keyword, word: str, number: int) -> None:
    key, _, value = (each.strip() for each in word.partition("="))
    key, known = " ".join(key.upper().split()), PARAMETERS[keyword.name]
    if key not in known or not value or key in keyword.said:
        raise FormatError(
            f"{shown(word)} of *{keyword.name} is not read: there are {', '.join(known)}, each once", number
        )
    keyword.said[key] = value.strip('"')


def _rows(text: str, keyword: Keyword) -> Iterator[Line]:
    """Lines of a keyword that are no comment."""
    for number, line in lines_of(text):
        if number >= keyword.end:
            return
        if number > keyword.last and line.lstrip()[0] != "*":
            yield number, line.replace(",", " ")


def _declared(path: Path, text: str, keyword: Keyword) -> FileMatrix:
    """The matrix of *MATRIX INPUT, whose entries may stand in a file beside the deck."""
    said = keyword.said
    with read_by("", line=keyword.last):
        kind, factor = said.get("TYPE", "SYMMETRIC").upper(), real(said.get("SCALE FACTOR", "1"))
        if not factor or kind not in SYMMETRIC:
            raise FormatError(f"SCALE FACTOR is a number, not 0, and TYPE is {' or '.join(SYMMETRIC)}")
    found = _matrix(text, keyword, SYMMETRIC[kind]) if "INPUT" not in said else None
    if found is None:
        with read_by(said["INPUT"], line=keyword.last):
            inner = text_of(path.parent / said["INPUT"])
            only, *more = _keywords(inner)
            if more:
                raise FormatError("has keywords: entries alone are read of what INPUT names")
            found = _matrix(inner, only, SYMMETRIC[kind])
    notes = [f"TYPE={kind}" * ("TYPE" in said), f"entries of {said.get('INPUT')}" * ("INPUT" in said)]
    notes.append(f"× {factor:g} by SCALE FACTOR" * (factor != 1))
    return replace(found, matrix=factor * found.matrix, notes=(*found.notes, *filter(None, notes)))


def _matrix(text: str, keyword: Keyword, symmetric: bool | None) -> FileMatrix:
    entries = _entries(text, keyword)
    places, values = entries[:, :-1].astype(np.int64), entries[:, -1]
    if places.shape[1] == 2:
        found = _numbered(places, values, symmetric)
    else:
        found = labelled(places[:, :2], places[:, 2:], values, symmetric)
    held = np.flatnonzero(found.matrix.diagonal() >= HELD)
    return replace(found, held=frozenset(held.tolist()))


def _numbered(
    places: np.ndarray, values: np.ndarray, symmetric: bool | None, labels: tuple[Label, ...] | None = None
) -> FileMatrix:
    """The matrix of entries at rows and columns, as many as there are ``labels`` where these are known."""
    size = int(places.max()) if labels is None else len(labels)
    if places.min() < 1:
        raise FormatError("rows and columns are counted from 1")
    return assembled(places[:, 0] - 1, places[:, 1] - 1, values, (size, size), symmetric, labels)


def _entries(text: str, keyword: Keyword) -> np.ndarray:
    """The numbers (entries, 3 or 5)."""
    number, first = next(_rows(text, keyword), (0, ""))
    if not first:
        raise FormatError("holds no entries")
    width = len(first.split(maxsplit=5))
    if width not in (3, 5):
        raise FormatError(
            f'{width} numbers: an entry is "row node, dof, column node, dof, value", or "row, column, value"', number
        )
    found = table(lambda: _rows(text, keyword), width)
    wrong = ((found[:, :-1] % 1 != 0) | (np.abs(found[:, :-1]) > EXACT)).any(axis=1)
    if wrong.any():
        number = next(islice(_rows(text, keyword), int(wrong.argmax()), None))[0]
        raise FormatError("nodes, degrees of freedom, rows and columns are whole numbers", number)
    return found


def read_calculix(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix of a file, its coordinates named by the file .dof beside it where that is there."""
    require_no_name(name)
    entries = _entries(text_of(path), Keyword())
    if entries.shape[1] != 3:
        raise FormatError('an entry of CalculiX is "row column value"')
    beside = path.with_suffix(".dof")
    labels = _nodes(beside) if beside.exists() else None
    found = _numbered(entries[:, :2].astype(np.int64), entries[:, 2], True, labels)
    note = f"nodes of {beside.name}" if labels else f"nodes without names, which {beside.name} beside it would have"
    return replace(found, notes=(*found.notes, note))


def _nodes(path: Path) -> tuple[Label, ...]:
    """Node and direction of each coordinate, ``12.3`` on a line."""
    with read_by(path.name):
        parts = [(number, *line.strip().partition(".")[::2]) for number, line in lines_of(text_of(path))]
        for number, node, direction in parts:
            if direction not in tuple("123456"):
                raise FormatError(f"{shown(node)} and {shown(direction)} are no node and direction, 12.3", number)
        labels = tuple((whole(node), int(direction)) for _, node, direction in parts)
        if len(set(labels)) < len(labels):
            raise FormatError("names a node and direction twice")
    return labels
