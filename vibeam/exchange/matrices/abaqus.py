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
from dataclasses import dataclass, replace
from itertools import islice
from math import inf
from pathlib import Path

import numpy as np

from vibeam.exchange.files import FormatError, Line, lines_of, read_by, real, shown, text_of, whole
from vibeam.exchange.matrices.declaration import chosen
from vibeam.exchange.matrices.entries import FileMatrix, Labels, assembled, labelled
from vibeam.exchange.matrices.text import require_no_name, table

HELD = 1e35  # on the diagonal
MOST = 100  # keywords of a deck
EXACT = 2.0**53  # up to which a double is any whole number
READ = {
    "MATRIX INPUT": {"NAME", "INPUT", "TYPE", "SCALE FACTOR"},
    "MATRIX ASSEMBLE": {"MASS", "STIFFNESS", "VISCOUS DAMPING"},
}
WANTED = {"M": "MASS", "K": "STIFFNESS", "C": "VISCOUS DAMPING"}
SYMMETRIC = {"SYMMETRIC": True, "UNSYMMETRIC": False}


@dataclass
class DeckSection:
    """Keyword as it stands, on lines ``first`` to ``last``, with entries to line ``end``; empty above the first."""

    keyword: str = ""
    first: int = 0
    last: int = 0
    end: float = inf

    def parameters(self) -> dict[str, str]:
        """Parameters in capitals, the keyword itself by an empty name; FormatError for others than are read."""
        name, *words = (" ".join(word.split()) for word in self.keyword.strip("*, ").split(","))
        pairs = [[part.strip(' "') for part in word.split("=")] for word in words]
        said = {pair[0].upper(): pair[-1] for pair in pairs}
        known, sound = READ.get(name.upper()), all(len(pair) == 2 and pair[1] for pair in pairs)
        if known is None or said.keys() - known or not sound or len(said) < len(pairs):
            read = " and ".join(f"*{each}, {' = …, '.join(sorted(READ[each]))} = …" for each in READ)
            raise FormatError(f"{shown(self.keyword)} is not read: keep {read}, each once", self.first)
        return {"": name.upper(), **said}

    def rows(self, text: str) -> Iterator[Line]:
        """Lines below it that are no comment."""
        for number, line in lines_of(text):
            if number >= self.end:
                return
            if number > self.last and line.lstrip()[0] != "*":
                yield number, line.replace(",", " ")


def _sections(text: str) -> list[DeckSection]:
    """Sections of a deck: a keyword begins with one *, and goes on below a comma at its end."""
    found = [DeckSection()]
    for number, line in lines_of(text):
        line, last = line.strip(), found[-1]
        if last.keyword.endswith(",") and last.last == number - 1:
            last.keyword, last.last = f"{last.keyword} {line}", number
        elif line[0] == "*" and line[:2] != "**":
            last.end = number
            found.append(DeckSection(line, number, number))
        if len(found) > MOST:
            raise FormatError(f"has more than {MOST} keywords: keep those of its matrices", number)
    return found


def read_abaqus(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix by that name, the one that *MATRIX ASSEMBLE says is ``wanted``, or the only one."""
    text = text_of(path)
    loose, *sections = _sections(text)
    found, assembles = dict[str, tuple[DeckSection, dict[str, str]]](), dict[str, str]()
    for each in sections:
        said = each.parameters()
        if (said[""] != "MATRIX INPUT" or "INPUT" in said) and any(each.rows(text)):
            raise FormatError(f"{shown(each.keyword)} has entries below it, and takes none", each.first)
        if said[""] != "MATRIX INPUT":
            assembles |= said
        elif found.setdefault(said.get("NAME", "").upper(), (each, said))[0] is not each:
            raise FormatError(f"{shown(each.keyword)}: two matrices have one NAME", each.first)
    if any(loose.rows(text)) or not found:
        if sections:
            raise FormatError("has no *MATRIX INPUT, or entries above it")
        require_no_name(name)
        return _matrix(_entries(text, loose), None)
    alike = assembles.get(WANTED.get(wanted, ""), wanted).upper()
    return _declared(path, text, *found[chosen(list(found), name.upper(), alike)])


def _declared(path: Path, text: str, section: DeckSection, said: dict[str, str]) -> FileMatrix:
    """The matrix of *MATRIX INPUT, whose entries may stand in a file beside the deck."""
    kind = said.get("TYPE", "SYMMETRIC").upper()
    with read_by("", line=section.first):
        factor = real(said.get("SCALE FACTOR", "1"))
        if not factor or kind not in SYMMETRIC:
            raise FormatError(f"SCALE FACTOR is a number, not 0, and TYPE is {' or '.join(SYMMETRIC)}")
    notes = [f"TYPE={kind}"] * ("TYPE" in said) + [f"× {factor:g} by SCALE FACTOR"] * (factor != 1)
    if "INPUT" in said:
        notes.append(f"entries of {said['INPUT']}")
        with read_by(said["INPUT"], line=section.first):
            text = text_of(path.parent / said["INPUT"])
            section, *more = _sections(text)
            if more:
                raise FormatError("has keywords: of what INPUT names entries alone are read")
            entries = _entries(text, section)
    else:
        entries = _entries(text, section)
    found = _matrix(entries, SYMMETRIC[kind])
    return replace(found, matrix=factor * found.matrix, notes=(*found.notes, *notes))


def _matrix(entries: np.ndarray, symmetric: bool | None, labels: Labels | None = None) -> FileMatrix:
    """The matrix of entries at nodes, or at rows and columns, as many as ``labels`` where these are known."""
    places, values = entries[:, :-1].astype(np.int64), entries[:, -1]
    if places.shape[1] == 4:
        found = labelled(places[:, :2], places[:, 2:], values, symmetric)
    else:
        if places.min() < 1:
            raise FormatError("rows and columns are counted from 1")
        size = int(places.max()) if labels is None else len(labels)
        found = assembled(places[:, 0] - 1, places[:, 1] - 1, values, (size, size), symmetric, labels)
    held = np.flatnonzero(found.matrix.diagonal() >= HELD)
    return replace(found, held=frozenset(held.tolist()))


def _entries(text: str, section: DeckSection) -> np.ndarray:
    """The numbers (entries, 3 or 5)."""
    number, first = next(section.rows(text), (0, ""))
    if not first:
        raise FormatError("holds no entries")
    width = len(first.split(maxsplit=5))
    if width not in (3, 5):
        raise FormatError(
            f'{width} numbers: an entry is "row node, dof, column node, dof, value", or "row, column, value"', number
        )
    found = table(lambda: section.rows(text), width)
    wrong = ((found[:, :-1] % 1 != 0) | (np.abs(found[:, :-1]) > EXACT)).any(axis=1)
    if wrong.any():
        number = next(islice(section.rows(text), int(wrong.argmax()), None))[0]
        raise FormatError("nodes, degrees of freedom, rows and columns are whole numbers", number)
    return found


def read_calculix(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix of a file, its coordinates named by the file .dof beside it where that is there."""
    require_no_name(name)
    entries = _entries(text_of(path), DeckSection())
    if entries.shape[1] != 3:
        raise FormatError('an entry of CalculiX is "row column value"')
    beside = path.with_suffix(".dof")
    labels = _nodes(beside) if beside.exists() else None
    found = _matrix(entries, True, labels)
    note = f"nodes of {beside.name}" if labels else f"nodes without names, which {beside.name} beside it would have"
    return replace(found, notes=(*found.notes, note))


def _nodes(path: Path) -> Labels:
    """Node and direction of each coordinate, ``12.3`` on a line."""
    labels = []
    with read_by(path.name):
        for number, line in lines_of(text_of(path)):
            node, _, direction = line.strip().partition(".")
            if direction not in tuple("123456"):
                raise FormatError(f"{shown(line)} is no node and direction, 12.3", number)
            labels.append((whole(node), int(direction)))
    if len(set(labels)) < len(labels):
        raise FormatError(f"{path.name} names a node and direction twice")
    return tuple(labels)
