"""Meshes from Nastran's bulk data: grids, elements, and as groups properties, constraints and sets.

Read here, as meshio loses the nodes of a continuation whose marks are blank, and all sets.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from vibeam.exchange.files import FormatError, lines_of, text_of
from vibeam.exchange.meshes.content import FileContent

SMALL, LARGE = 8, 16  # characters of a field
HEXAHEDRON = [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]  # upright edges come before the upper ones
#: kinds of elements by the number of their nodes
ELEMENTS = {
    "CHEXA": {8: "hexahedron", 20: "hexahedron20"},
    "CTETRA": {4: "tetra", 10: "tetra10"},
    "CPENTA": {6: "wedge", 15: "wedge15"},
    "CPYRA": {5: "pyramid", 13: "pyramid13"},
    "CPYRAM": {5: "pyramid", 13: "pyramid13"},
}
SKINS = {"CTRIA3": 3, "CTRIAR": 3, "CTRIA6": 3, "CQUAD4": 4, "CQUADR": 4, "CQUAD8": 4, "CQUAD": 4}
Card = tuple[int, list[str]]  # line, name and fields


def read_bulk(path: Path) -> FileContent:
    """The content of a bulk data file, with or without its case control.

    Groups: ``property 3`` the elements of PID 3; ``SPC 1`` the grids that SPC and SPC1 of set 1 hold; ``SET 5`` those
    of a set of the case control. FormatError where grids are in a coordinate system of their own.
    """
    text = text_of(path).upper()
    control, begin, bulk = text.partition("BEGIN BULK")
    if not begin:
        control, bulk = "", text
    places: dict[int, int] = {}
    points: list[list[float]] = []
    cells: dict[str, list[tuple[int, list[int]]]] = {}
    held: dict[str, list[int]] = {}
    for line, (name, *fields) in _cards(re.split(r"(?m)^ENDDATA", bulk)[0], control.count("\n")):
        try:
            if name == "GRID":
                if fields[1] not in ("", "0"):
                    raise FormatError(
                        f"has grids in the coordinate system {fields[1]}: write all in the basic one", line
                    )
                places[int(fields[0])] = len(points)
                points.append([_number(each) for each in fields[2:5]])
            elif name in ELEMENTS or name in SKINS:
                kind, nodes = _cell(name, line, [int(each) for each in fields[2:] if each.isdigit()])
                cells.setdefault(kind, []).append((int(fields[1] or fields[0]), nodes))
            elif name in ("SPC", "SPC1"):
                grids = (
                    _numbers(fields[2:]) if name == "SPC1" else [int(each) for each in fields[1::3] if each.isdigit()]
                )
                held.setdefault(f"SPC {fields[0]}", []).extend(grids)
        except (ValueError, IndexError) as error:
            if isinstance(error, FormatError):
                raise
            raise FormatError(f"{name}: is damaged: {str(error)[:100]}", line) from None
    if not points:
        raise FormatError("has no GRID: it is no mesh of Nastran")
    return _content(places, points, cells, held | dict(_sets(control)))


def _content(
    places: dict[int, int],
    points: list[list[float]],
    cells: dict[str, list[tuple[int, list[int]]]],
    sets: dict[str, list[int]],
) -> FileContent:
    try:
        blocks = [
            (kind, np.array([[places[node] for node in nodes] for _, nodes in found])) for kind, found in cells.items()
        ]
    except KeyError as error:
        raise FormatError(f"grid {error} is named and not there") from None
    made = FileContent(np.array(points), blocks)
    for block, found in enumerate(cells.values()):
        properties = np.array([each for each, _ in found])
        for value in np.unique(properties):
            made.join(f"property {value}", block, np.flatnonzero(properties == value))
    for name, numbers in sets.items():
        known = {places[each] for each in numbers if each in places}
        if known:
            made.nodes[name] = np.array(sorted(known))
    return made


def _cell(name: str, line: int, nodes: list[int]) -> tuple[str, list[int]]:
    """Kind of a cell and its nodes in the order of VTK; of a face its corners."""
    corners = SKINS.get(name, 0)
    if corners and len(nodes) >= corners:
        return {3: "triangle", 4: "quad"}[corners], nodes[:corners]
    known = ELEMENTS.get(name, {corners: ""})
    if len(nodes) not in known:
        raise FormatError(f"{name} has {len(nodes)} nodes: it must have {' or '.join(map(str, known))}", line)
    kind = known[len(nodes)]
    return kind, [nodes[each] for each in HEXAHEDRON] if kind == "hexahedron20" else nodes


def _cards(bulk: str, before: int) -> Iterator[Card]:
    """Name and fields of every entry, its continuations joined, with the line that it begins in."""
    card: Card | None = None
    for number, line in lines_of(bulk):
        text = line.partition("$")[0].rstrip().expandtabs(SMALL)
        if not text:
            continue
        first, fields = _fields(text)
        if card and (not first or first[0] in "+*"):
            card[1].extend(fields)
            continue
        if card:
            yield card
        card = before + number, [first.rstrip("*"), *fields]
    if card:
        yield card


def _fields(text: str) -> tuple[str, list[str]]:
    """First field of a line, and its other ones, filled up so that those of a continuation are in place."""
    if "," in text:
        first, *fields = (each.strip() for each in text.split(","))
        count = 4 if "*" in first else 8
    else:
        first = text[:SMALL].strip()
        width, count = (LARGE, 4) if "*" in first else (SMALL, 8)
        fields = [text[at : at + width].strip() for at in range(SMALL, SMALL + count * width, width)]
    return first, [*fields, *[""] * count][:count]


def _number(text: str) -> float:
    """A real number, whose exponent may come without its letter: ``1.5-3``; empty: 0."""
    return (
        float(re.sub(r"(?<=[\d.])([+-])", r"E\1", text.replace("D", "E")) if "E" not in text else text) if text else 0.0
    )


def _sets(control: str) -> Iterator[tuple[str, list[int]]]:
    """Numbers of the sets of the case control, ``SET 5 = 1, 2, 10 THRU 20``, over several lines."""
    for number, said in re.findall(r"(?m)^\s*SET\s+(\d+)\s*=\s*((?:[^\n]*,\s*\n)*[^\n]*)", control):
        yield f"SET {number}", _numbers(re.split(r"[,\s]+", said))


def _numbers(fields: list[str]) -> list[int]:
    """Numbers, and those from one to another with THRU between them."""
    found: list[int] = []
    through = False
    for each in filter(None, fields):
        if each == "THRU":
            through = True
        elif each.isdigit():
            found.extend(range(found[-1] + 1, int(each) + 1) if through and found else [int(each)])
            through = False
    return found
