"""Meshes from input decks of Abaqus and CalculiX: nodes, elements, their sets and surfaces.

Read here, as meshio knows no surfaces and no C3D10 beside CPS6, keeps the last of several blocks of nodes alone, and
gives sets to wrong blocks of elements.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from functools import partialmethod
from pathlib import Path

import numpy as np

from vibeam.exchange.files import FormatError, lines_of, read_by, real, text_of, whole
from vibeam.extensions.solid.elasticity.own_mesh import Indices
from vibeam.extensions.solid.meshes.content import FileContent

TYPE = re.compile(r"(D?C3D|S|DS|CPS|CPE|M3D|SFM3D|R3D|STRI)([0-9]+)")
VOLUMES = {4: "tetra", 5: "pyramid", 6: "wedge", 8: "hexahedron", 10: "tetra10", 15: "wedge15", 20: "hexahedron20"}
SKINS = {3: "triangle", 4: "quad", 6: "triangle6", 65: "triangle6", 8: "quad8", 9: "quad9"}
#: corners of the faces S1, S2 …
FACES = {
    "tetra": ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
    "hexahedron": ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)),
}
NAMED = 10_000_000  # numbers in all sets
LONGEST = 10_000  # characters of a keyword's line
MERGE = "write the mesh as one part, where it stands (Abaqus: merge the instances)"
Options = dict[str, str]
Rows = list[list[str]]


def read_deck(path: Path) -> FileContent:
    """The content of a deck; FormatError with the line of the keyword that is wrong, or for more than one part."""
    deck = Deck()
    for line, keyword, options, rows in _keywords(text_of(path)):
        if read := getattr(deck, f"read_{keyword.lower()}", None):
            with read_by(f"*{keyword}", line=line):
                read(options, rows)
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
        elif head[-LONGEST:].rstrip().endswith(",") and not rows:
            head += line
            if len(head) > LONGEST:
                raise FormatError(f"has a keyword of more than {LONGEST} characters", start)
        else:
            rows.append([each.strip() for each in line.strip().rstrip(",").split(",")])


class Deck:
    """Nodes and elements by their numbers, sets of both by name, surfaces as elements, or a set, and face."""

    def __init__(self) -> None:
        self.nodes: dict[int, list[float]] = {}
        self.cells: dict[str, dict[int, list[int]]] = {}
        self.sets: dict[str, dict[str, tuple[str, set[int]]]] = {"NSET": {}, "ELSET": {}}
        self.named = 0  # numbers in sets, each as often as it is named
        self.surfaces: dict[str, list[tuple[str, str]]] = {}
        self.parts: set[str] = set()

    def content(self) -> FileContent:
        """The content, every number of a node or an element by its place."""
        if not self.nodes:
            raise FormatError("has no *NODE: it is no mesh of Abaqus")
        places = {number: index for index, number in enumerate(self.nodes)}
        cells = {kind: list(found.values()) for kind, found in self.cells.items()}
        try:
            blocks = [(kind, np.array([[places[each] for each in one] for one in of])) for kind, of in cells.items()]
            made = FileContent(np.array(list(self.nodes.values())), blocks)
            nodes = self.sets["NSET"].values()
            made.nodes |= {name: np.array([places[at] for at in sorted(each)], int) for name, each in nodes}
        except KeyError as error:
            raise FormatError(f"node {error} is named and not there") from None
        index = [{number: place for place, number in enumerate(cells)} for cells in self.cells.values()]
        for name, numbers in self.sets["ELSET"].values():
            made.members[name] = {}
            for block, known in enumerate(index):
                made.join(name, block, np.array([known[each] for each in numbers if each in known], int))
        for name, sides in self.surfaces.items():
            made.faces[name] = [face for side in sides for face in self._faces(blocks, index, *side)]
        return made

    def _faces(
        self, blocks: list[tuple[str, Indices]], index: list[dict[int, int]], elements: str, face: str
    ) -> Iterator[Indices]:
        numbers = self._counted(self._named("ELSET", elements))
        for (kind, cells), known in zip(blocks, index, strict=True):
            sides = {f"S{number}": side for number, side in enumerate(FACES.get(kind.rstrip("0123456789"), ()), 1)}
            found = [known[each] for each in numbers if each in known]
            if found and face.upper() in sides:
                yield cells[found][:, list(sides[face.upper()])]
            elif found and kind in SKINS.values():
                yield cells[found][:, : 3 if kind.startswith("triangle") else 4]

    def _named(self, of: str, name: str) -> Collection[int]:
        """A number, or the numbers of a set, whose name has no case and may be of an instance."""
        if name[:1].isdigit():
            return [whole(name)]
        wanted = name.rpartition(".")[2].lower()
        if wanted not in self.sets[of]:
            raise FormatError(f"the set '{name}' is named and not there")
        return self.sets[of][wanted][1]

    def _counted(self, numbers: Collection[int]) -> Collection[int]:
        """The numbers; FormatError where all sets name too many: a set may name others, or itself, again and again."""
        self.named += len(numbers)
        if self.named > NAMED:
            raise FormatError(f"its sets name more than {NAMED} nodes and elements: name fewer")
        return numbers

    def _join(self, of: str, name: str | None, numbers: Collection[int]) -> None:
        if name is not None:
            self.sets[of].setdefault(name.lower(), (name, set()))[1].update(self._counted(numbers))

    def read_node(self, options: Options, rows: Rows) -> None:
        """Nodes, of which no number comes twice."""
        for number, *place in rows:
            if whole(number) in self.nodes:
                raise ValueError(f"node {number} is there twice: {MERGE}")
            self.nodes[int(number)] = [real(each or "0") for each in (*place, "", "", "")[:3]]
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
        numbers = [whole(each) for row in rows for each in row if each]
        if len(numbers) % (size + 1):
            raise ValueError(f"its numbers are no multiple of {size + 1}: an element of type {kind} has {size} nodes")
        cells = {numbers[at]: numbers[at + 1 : at + size + 1] for at in range(0, len(numbers), size + 1)}
        self.cells.setdefault(called, {}).update(cells)
        self._join("ELSET", options.get("ELSET"), cells)

    def _read_set(self, of: str, options: Options, rows: Rows) -> None:
        self._join(of, options[of], ())
        for row in rows:
            if "GENERATE" in options:
                first, last, *step = map(whole, filter(None, row))
                self._join(of, options[of], range(first, last + 1, *step))
            else:
                for each in filter(None, row):
                    self._join(of, options[of], self._named(of, each))

    read_nset, read_elset = partialmethod(_read_set, "NSET"), partialmethod(_read_set, "ELSET")

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
