"""Meshes from Nastran's bulk data: grids, elements, and as groups properties, constraints and sets.

Read here, as meshio loses the nodes of a continuation whose marks are blank, and all sets.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from vibeam.exchange.files import FormatError, text_of
from vibeam.exchange.meshes.content import FileContent
from vibeam.exchange.nastran import cards

HEXAHEDRON = [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]  # upright edges come before the upper ones
#: kinds of elements by the number of their nodes; of those of skins the corners alone are read
ELEMENTS = {
    "CHEXA": {8: "hexahedron", 20: "hexahedron20"},
    "CTETRA": {4: "tetra", 10: "tetra10"},
    "CPENTA": {6: "wedge", 15: "wedge15"},
    "CPYRAM": {5: "pyramid", 13: "pyramid13"},
    "CPYRA": {5: "pyramid", 13: "pyramid13"},
}
SKINS = dict.fromkeys(("CTRIA3", "CTRIAR", "CTRIA6"), (3, "triangle")) | dict.fromkeys(
    ("CQUAD4", "CQUADR", "CQUAD8", "CQUAD"), (4, "quad")
)


def read_bulk(path: Path) -> FileContent:
    """The content of a bulk data file, with or without its case control.

    Groups: ``property 3`` the elements of PID 3; ``SPC 1`` the grids that SPC and SPC1 of set 1 hold; ``SET 5`` those
    of a set of the case control. FormatError where grids are in a coordinate system of their own.
    """
    text = text_of(path).upper()
    control, begin, bulk = text.partition("BEGIN BULK")
    data = BulkData()
    for line, name, fields in cards(re.split(r"(?m)^ENDDATA", bulk if begin else text)[0]):
        try:
            data.read(name, fields)
        except (ValueError, IndexError) as error:
            raise FormatError(f"{name}: {str(error)[:150]}", line + control.count("\n") * bool(begin)) from None
    for number, said in re.findall(r"(?m)^\s*SET\s+(\d+)\s*=\s*((?:[^\n]*,\s*\n)*[^\n]*)", control if begin else ""):
        data.sets[f"SET {number}"] = re.split(r"[,\s]+", said)
    return data.content()


class BulkData:
    """Grids by number, cells of each kind with their properties, fields of sets by name."""

    def __init__(self) -> None:
        self.grids: dict[int, list[float]] = {}
        self.cells: dict[str, list[tuple[int, list[int]]]] = {}
        self.sets: dict[str, list[str]] = {}

    def read(self, name: str, fields: list[str]) -> None:
        """Read one entry; ValueError and IndexError where it is damaged."""
        if name == "GRID":
            if fields[1] not in ("", "0"):
                raise ValueError(f"is in the coordinate system {fields[1]}: write all grids in the basic one")
            self.grids[int(fields[0])] = [_number(each) for each in fields[2:5]]
        elif name in ELEMENTS or name in SKINS:
            kind, nodes = _cell(name, [int(each) for each in fields[2:] if each.isdigit()])
            self.cells.setdefault(kind, []).append((int(fields[1] or fields[0]), nodes))
        elif name in ("SPC", "SPC1"):
            self.sets.setdefault(f"SPC {fields[0]}", []).extend(fields[2:] if name == "SPC1" else fields[1::3])

    def content(self) -> FileContent:
        """The content, every number of a grid by its place."""
        if not self.grids:
            raise FormatError("has no GRID: it is no mesh of Nastran")
        places = {number: index for index, number in enumerate(self.grids)}
        try:
            blocks = [
                (kind, np.array([[places[node] for node in nodes] for _, nodes in found]))
                for kind, found in self.cells.items()
            ]
        except KeyError as error:
            raise FormatError(f"grid {error} is named and not there") from None
        made = FileContent(np.array(list(self.grids.values())), blocks)
        for block, found in enumerate(self.cells.values()):
            properties = np.array([each for each, _ in found])
            for value in np.unique(properties):
                made.join(f"property {value}", block, np.flatnonzero(properties == value))
        numbers = np.array(list(self.grids))
        for name, fields in self.sets.items():
            made.nodes[name] = np.flatnonzero(_among(numbers, fields))
        return made


def _cell(name: str, nodes: list[int]) -> tuple[str, list[int]]:
    """Kind of a cell and its nodes in the order of VTK; of a face its corners."""
    corners, kind = SKINS.get(name, (0, ""))
    if corners and len(nodes) >= corners:
        return kind, nodes[:corners]
    known = ELEMENTS.get(name, {corners: kind})
    if len(nodes) not in known:
        raise ValueError(f"has {len(nodes)} nodes: it must have {' or '.join(map(str, known))}")
    return known[len(nodes)], [nodes[each] for each in HEXAHEDRON] if len(nodes) == 20 else nodes


def _number(text: str) -> float:
    """A real number, whose exponent may come without its letter: ``1.5-3``; empty: 0."""
    text = text.replace("D", "E")
    return float(text if "E" in text else re.sub(r"(?<=[\d.])([+-])", r"E\1", text) or "0")


def _among(numbers: np.ndarray, fields: list[str]) -> np.ndarray:
    """Test of each of the numbers whether the fields name it, or have it between two with THRU."""
    said = [each for each in fields if each == "THRU" or each.isdigit()]
    found = np.isin(numbers, [int(each) for each in said if each != "THRU"])
    for at, each in enumerate(said[1:-1], 1):
        if each == "THRU" and "THRU" not in (said[at - 1], said[at + 1]):
            found |= (numbers >= int(said[at - 1])) & (numbers <= int(said[at + 1]))
    return found
