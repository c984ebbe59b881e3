"""Meshes from Nastran's bulk data: grids, elements, and as groups properties, constraints and sets.

Read here, as meshio loses the nodes of a continuation whose marks are blank, and all sets.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from vibeam.exchange.files import FormatError, read_by, text_of, whole
from vibeam.exchange.nastran import cards, real_field
from vibeam.extensions.solid.meshes.content import FileContent, by_value

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
SPAN = re.compile(r"([0-9]{1,15})(?: THRU ([0-9]{1,15}))?(?: |$)")
SPANS = re.compile(f"(?:{SPAN.pattern})*")


def read_bulk(path: Path) -> FileContent:
    """The content of a bulk data file, with or without its case control.

    Groups: ``property 3`` the elements of PID 3; ``SPC 1`` the grids that SPC and SPC1 of set 1 hold; ``SET 5`` those
    of a set of the case control. FormatError where grids are in a coordinate system of their own, and for an INCLUDE.
    """
    control, begin, bulk = text_of(path).upper().partition("BEGIN BULK")
    if not begin:
        control, bulk = "", control
    list(cards(control))  # refuses an INCLUDE there too
    data = BulkData()
    for line, name, fields in cards(re.split(r"(?m)^ENDDATA", bulk)[0], control.count("\n")):
        with read_by(name, line=line):
            data.read(name, fields)
    for number, said in re.findall(r"(?m)^[ \t]*SET[ \t]+([0-9]+)[ \t]*=((?:.*,[ \t\r]*\n)*.*)", control):
        data.sets[f"SET {number}"] = re.split(r"[,\s]+", said)
    return data.content()


class BulkData:
    """Grids by number, cells of each kind with their properties, fields of sets by name."""

    def __init__(self) -> None:
        self.grids: dict[int, list[float]] = {}
        self.cells: dict[str, list[tuple[int, list[int]]]] = {}
        self.sets: dict[str, list[str]] = {}

    def read(self, name: str, fields: list[str]) -> None:
        """Read one entry; an error of any kind where it is damaged."""
        if name == "GRID":
            if fields[1] not in ("", "0"):
                raise ValueError(f"is in the coordinate system {fields[1]}: write all grids in the basic one")
            self.grids[whole(fields[0])] = [real_field(each or "0") for each in fields[2:5]]
        elif name in ELEMENTS or name in SKINS:
            kind, nodes = _cell(name, fields[2:])
            self.cells.setdefault(kind, []).append((whole(fields[1] or fields[0]), nodes))
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
            for value, cells in by_value(np.array([each for each, _ in found])):
                made.join(f"property {value}", block, cells)
        numbers = np.array(list(self.grids))
        for name, fields in self.sets.items():
            if SPANS.fullmatch(named := " ".join(filter(None, fields))):
                made.nodes[name] = np.flatnonzero(_among(numbers, named))
        return made


def _cell(name: str, fields: list[str]) -> tuple[str, list[int]]:
    """Kind of a cell and its nodes in the order of VTK; of a face its corners."""
    corners, kind = SKINS.get(name, (None, ""))
    nodes = [whole(each) for each in fields[:corners] if each]
    known = ELEMENTS.get(name, {corners: kind})
    if len(nodes) not in known:
        raise ValueError(f"has {len(nodes)} nodes: it must have {' or '.join(map(str, known))}")
    return known[len(nodes)], [nodes[each] for each in HEXAHEDRON] if len(nodes) == 20 else nodes


def _among(numbers: np.ndarray, named: str) -> np.ndarray:
    """Test of each of the numbers whether it is named, or lies between two with THRU."""
    spans = [(int(first), int(last or first)) for first, last in SPAN.findall(named)]
    first, last = np.array([each for each in spans if each[0] <= each[1]], int).reshape(-1, 2).T
    begun = np.searchsorted(np.sort(first), numbers, "right")
    return np.asarray(begun > np.searchsorted(np.sort(last), numbers, "left"))
