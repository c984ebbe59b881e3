"""Meshes from input decks of Abaqus and CalculiX: nodes, elements, their sets and surfaces.

Read here, as meshio knows no surfaces and no C3D10 beside CPS6, keeps the last of several blocks of nodes alone, and
gives sets to wrong blocks of elements.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from vibeam.exchange.files import LINES, FormatError, lines_of, text_of
from vibeam.exchange.meshes.content import FileContent
from vibeam_models.solid.own_mesh import Indices

TYPE = re.compile(r"(D?C3D|S|DS|CPS|CPE|M3D|SFM3D|R3D|STRI)(\d+)")
VOLUMES = {4: "tetra", 5: "pyramid", 6: "wedge", 8: "hexahedron", 10: "tetra10", 15: "wedge15", 20: "hexahedron20"}
SKINS = {3: "triangle", 4: "quad", 6: "triangle6", 65: "triangle6", 8: "quad8", 9: "quad9"}
#: corners of the faces S1, S2 …
FACES = {
    "tetra": ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
    "hexahedron": ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)),
}
MERGE = "write the mesh as one part, where it stands (Abaqus: merge the instances)"
Options = dict[str, str]
Rows = list[list[str]]


def read_deck(path: Path) -> FileContent:
    """The content of a deck; FormatError with the line of the keyword that is wrong, or for more than one part."""
    deck = Deck()
    for line, keyword, options, rows in _keywords(text_of(path)):
        read = getattr(deck, f"read_{keyword.lower()}", None)
        try:
            if read:
                read(options, rows)
        except (ValueError, IndexError, KeyError) as error:
            raise FormatError(f"*{keyword}: {str(error)[:150]}", line) from None
    return deck.content()


def _keywords(text: str) -> Iterator[tuple[int, str, Options, Rows]]:
    """Line, keyword, options and rows of data of each block."""
    start, head = 0, ""
    rows: Rows = []
    for number, line in (*lines_of(text), (0, "*")):
        if line.startswith("**"):
            continue
        if line.lstrip().startswith("*"):
            keyword, *options = head.split(",")
            pairs = (each.partition("=") for each in options)
            yield start, keyword.strip(" *\t").upper(), {a.strip().upper(): b.strip(' \t"') for a, _, b in pairs}, rows
            start, head, rows = number, line, []
        elif head.rstrip().endswith(",") and not rows:
            head += line
        else:
            rows.append([each.strip() for each in line.strip().rstrip(",").split(",")])


class Deck:
    """Nodes and elements by their numbers, sets of both by name, surfaces as elements, or a set, and face."""

    def __init__(self) -> None:
        self.nodes: dict[int, list[float]] = {}
        self.cells: dict[str, dict[int, list[int]]] = {}
        self.sets: dict[str, dict[str, list[int]]] = {"NSET": {}, "ELSET": {}}
        self.surfaces: dict[str, list[tuple[str, str]]] = {}
        self.parts: set[str] = set()

    def content(self) -> FileContent:
        """The content, every number of a node or an element by its place."""
        if not self.nodes:
            raise FormatError("has no *NODE: it is no mesh of Abaqus")
        places = {number: index for index, number in enumerate(self.nodes)}

        def placed(numbers: Iterable[int]) -> list[int]:
            return [places[each] for each in numbers]

        try:
            blocks = [(kind, np.array([placed(cell) for cell in cells.values()])) for kind, cells in self.cells.items()]
            made = FileContent(np.array(list(self.nodes.values())), blocks)
            made.nodes |= {name: np.array(sorted(set(placed(each))), int) for name, each in self.sets["NSET"].items()}
        except KeyError as error:
            raise FormatError(f"node {error} is named and not there") from None
        index = [{number: place for place, number in enumerate(cells)} for cells in self.cells.values()]
        for name, numbers in self.sets["ELSET"].items():
            made.members[name] = {}
            for block, known in enumerate(index):
                made.join(name, block, np.array([known[each] for each in numbers if each in known], int))
        for name, sides in self.surfaces.items():
            made.faces[name] = [face for side in sides for face in self._faces(blocks, index, *side)]
        return made

    def _faces(
        self, blocks: list[tuple[str, Indices]], index: list[dict[int, int]], elements: str, face: str
    ) -> Iterator[Indices]:
        numbers = self._named("ELSET", elements)
        for (kind, cells), known in zip(blocks, index, strict=True):
            faces = FACES.get(kind.rstrip("0123456789"), ())
            found = [known[each] for each in numbers if each in known]
            if found and face[:1].upper() == "S" and face[1:].isdigit() and 0 < int(face[1:]) <= len(faces):
                yield cells[found][:, list(faces[int(face[1:]) - 1])]
            elif found and kind in SKINS.values():
                yield cells[found][:, : 3 if kind.startswith("triangle") else 4]

    def _named(self, of: str, name: str) -> list[int]:
        """A number, or the numbers of a set, whose name has no case and may be of an instance."""
        if name.isdigit():
            return [int(name)]
        wanted = name.rpartition(".")[2].lower()
        found = [numbers for each, numbers in self.sets[of].items() if each.lower() == wanted]
        if not found:
            raise FormatError(f"the set '{name}' is named and not there")
        return found[0]

    def _join(self, of: str, name: str | None, numbers: Iterable[int]) -> None:
        if name is not None:
            self.sets[of].setdefault(name, []).extend(numbers)

    def read_node(self, options: Options, rows: Rows) -> None:
        """Nodes, of which no number comes twice."""
        for number, *place in rows:
            if int(number) in self.nodes:
                raise ValueError(f"node {number} is there twice: {MERGE}")
            self.nodes[int(number)] = [float(each or 0) for each in (*place, "", "", "")[:3]]
        self._join("NSET", options.get("NSET"), [int(row[0]) for row in rows])

    def read_element(self, options: Options, rows: Rows) -> None:
        """Elements of volume and of skins; others are none of a body."""
        found = TYPE.match(kind := options.get("TYPE", "").upper())
        if found is None:
            return
        volume, size = found[1].endswith("C3D"), int(found[2])
        if size not in (VOLUMES if volume else SKINS):
            raise ValueError(f"elements of type {kind} are not read")
        called, size = (VOLUMES if volume else SKINS)[size], 6 if size == 65 else size
        numbers = [int(each) for row in rows for each in row if each]
        if len(numbers) % (size + 1):
            raise ValueError(f"its numbers are no multiple of {size + 1}: an element of type {kind} has {size} nodes")
        cells = {numbers[at]: numbers[at + 1 : at + size + 1] for at in range(0, len(numbers), size + 1)}
        self.cells.setdefault(called, {}).update(cells)
        self._join("ELSET", options.get("ELSET"), cells)

    def _read_set(self, of: str, options: Options, rows: Rows) -> None:
        self._join(of, options[of], ())
        for row in rows:
            if "GENERATE" in options:
                first, last, *step = map(int, filter(None, row))
                numbers = range(first, last + 1, *step)
                if len(numbers) > LINES:
                    raise ValueError(f"{len(numbers)} numbers are more than a file can have")
                self._join(of, options[of], numbers)
            else:
                for each in filter(None, row):
                    self._join(of, options[of], self._named(of, each))

    def read_nset(self, options: Options, rows: Rows) -> None:
        """A set of nodes."""
        self._read_set("NSET", options, rows)

    def read_elset(self, options: Options, rows: Rows) -> None:
        """A set of elements."""
        self._read_set("ELSET", options, rows)

    def read_surface(self, options: Options, rows: Rows) -> None:
        """A surface of faces of elements, or of nodes."""
        if options.get("TYPE", "").upper() == "NODE":
            self._join("NSET", options["NAME"], [each for row in rows for each in self._named("NSET", row[0])])
        else:
            self.surfaces[options["NAME"]] = [(row[0], (*row, "")[1]) for row in rows]

    def read_instance(self, options: Options, rows: Rows) -> None:
        """The instance of the one part, which is not moved."""
        self.parts.add(options.get("NAME", ""))
        if rows or len(self.parts) > 1:
            raise ValueError(f"moves the part, or is a second one: {MERGE}")

    def read_include(self, options: Options, rows: Rows) -> None:
        """Lines of another file, which is not read."""
        raise ValueError("another file is not read: put its lines into this one")
