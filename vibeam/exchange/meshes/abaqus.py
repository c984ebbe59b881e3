"""Meshes from input decks of Abaqus and CalculiX: nodes, elements, their sets and surfaces.

Read here, as meshio knows no surfaces and no C3D10 beside CPS6, keeps the last of several blocks of nodes alone, and
gives sets to wrong blocks of elements.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from vibeam.exchange.files import FormatError, lines_of, text_of
from vibeam.exchange.meshes.content import FileContent
from vibeam_models.solid.own_mesh import Indices

VOLUME = re.compile(r"D?C3D(4|5|6|8|10|13|15|20)(?!\d)")
VOLUMES = {4: "tetra", 5: "pyramid", 6: "wedge", 8: "hexahedron", 10: "tetra10", 13: "pyramid13"} | {
    15: "wedge15",
    20: "hexahedron20",
}
SURFACE = re.compile(r"(?:S|DS|CPS|CPE|CPEG|CAX|M3D|SFM3D|R3D|STRI)(3|4|6|8|9)(?!\d)|STRI(65)")
SURFACES = {3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8", 9: "quad9"}
LINE = re.compile(r"(?:T3D|B3|R3D|RB3D|T2D)(2|3)|B3(1|2)")
#: corners of the faces S1, S2 …, by the number of corners of a cell
FACES = {
    4: ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
    8: ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)),
}
Rows = list[tuple[int, list[str]]]  # line, fields


def read_deck(path: Path) -> FileContent:
    """The content of a deck; FormatError with the line of what is wrong, or tells of more than one part."""
    deck = Deck()
    for line, keyword, options, rows in _keywords(text_of(path)):
        try:
            READERS.get(keyword, _skip)(deck, line, options, rows)
        except (ValueError, IndexError) as error:
            if isinstance(error, FormatError):
                raise
            raise FormatError(f"*{keyword}: is damaged: {str(error)[:100]}", line) from None
    return deck.content()


def _keywords(text: str) -> Iterator[tuple[int, str, dict[str, str], Rows]]:
    """Keyword, options and rows of data of each block, with the line of its keyword."""
    start, head = 0, ""
    rows: Rows = []
    for number, line in lines_of(text):
        if line.startswith("**"):
            continue
        if line.lstrip().startswith("*"):
            if head:
                yield start, *_options(head), rows
            start, head, rows = number, line, []
        elif head.rstrip().endswith(",") and not rows:
            head += line
        elif head:
            rows.append((number, [each.strip() for each in line.strip().rstrip(",").split(",")]))
    if head:
        yield start, *_options(head), rows


def _options(head: str) -> tuple[str, dict[str, str]]:
    keyword, *options = head.split(",")
    pairs = (each.partition("=") for each in options)
    return keyword.strip(" *\t").upper(), {name.strip().upper(): said.strip(' \t"') for name, _, said in pairs}


@dataclass
class Deck:
    """Nodes and elements by their numbers, sets of both, surfaces as (elements or a set, face)."""

    nodes: dict[int, int] = field(default_factory=dict)
    places: list[list[float]] = field(default_factory=list)
    blocks: list[tuple[str, list[list[int]]]] = field(default_factory=list)
    elements: dict[int, tuple[int, int]] = field(default_factory=dict)
    node_sets: dict[str, list[int]] = field(default_factory=dict)
    element_sets: dict[str, list[int]] = field(default_factory=dict)
    surfaces: dict[str, list[tuple[str, str]]] = field(default_factory=dict)
    parts: int = 0
    instances: int = 0

    def content(self) -> FileContent:
        """The content, every number of a node or an element by its place."""
        if not self.places:
            raise FormatError("has no *NODE: it is no mesh of Abaqus")
        blocks = [(kind, np.array([self._nodes(each) for each in cells])) for kind, cells in self.blocks]
        made = FileContent(np.array(self.places), blocks)
        for name, numbers in self.node_sets.items():
            made.nodes[name] = np.array(sorted(set(self._nodes(numbers))), dtype=int)
        for name, numbers in self.element_sets.items():
            for block, indices in self._cells(numbers).items():
                made.join(name, block, indices)
            made.members.setdefault(name, {})
        for name, sides in self.surfaces.items():
            made.faces[name] = [faces for side in sides for faces in self._faces(made, *side)]
        return made

    def _nodes(self, numbers: list[int]) -> list[int]:
        try:
            return [self.nodes[each] for each in numbers]
        except KeyError as error:
            raise FormatError(f"node {error} is named and not there") from None

    def _cells(self, numbers: list[int]) -> dict[int, Indices]:
        found: dict[int, list[int]] = {}
        for block, index in filter(None, map(self.elements.get, numbers)):
            found.setdefault(block, []).append(index)
        return {block: np.array(indices) for block, indices in found.items()}

    def _faces(self, made: FileContent, elements: str, face: str) -> Iterator[Indices]:
        numbers = [int(elements)] if elements.isdigit() else _named(self.element_sets, elements)
        for block, indices in self._cells(numbers).items():
            kind, cells = made.blocks[block]
            known = FACES.get(8 if kind.startswith("hexa") else 4 if kind.startswith("tetra") else 0, ())
            if face[:1].upper() == "S" and face[1:].isdigit() and 0 < int(face[1:]) <= len(known):
                yield cells[indices][:, list(known[int(face[1:]) - 1])]
            elif kind.startswith(("triangle", "quad")):
                yield cells[indices][:, : 3 if kind.startswith("triangle") else 4]


def _named(sets: dict[str, list[int]], name: str) -> list[int]:
    """The numbers of a set, whose name has no case and may be of an instance."""
    wanted = name.rpartition(".")[2].lower()
    found = [numbers for each, numbers in sets.items() if each.lower() == wanted]
    if not found:
        raise FormatError(f"the set '{name}' is named and not there")
    return found[0]


def _read_nodes(deck: Deck, line: int, options: dict[str, str], rows: Rows) -> None:
    for number, row in rows:
        if int(row[0]) in deck.nodes:
            raise FormatError(
                f"node {row[0]} is there twice: write the parts as one, with numbers of their own", number
            )
        deck.nodes[int(row[0])] = len(deck.places)
        deck.places.append([float(each or 0) for each in (*row[1:4], "", "", "")[:3]])
    if "NSET" in options:
        deck.node_sets.setdefault(options["NSET"], []).extend(int(row[0]) for _, row in rows)


def _read_elements(deck: Deck, line: int, options: dict[str, str], rows: Rows) -> None:
    kind = options.get("TYPE", "").upper()
    if "C3D27" in kind:
        raise FormatError("elements of type C3D27 are not read: write C3D20", line)
    if volume := VOLUME.match(kind):
        called = VOLUMES[int(volume[1])]
    elif surface := SURFACE.match(kind):
        called = SURFACES[6 if surface[2] else int(surface[1])]
    else:
        return
    size = int(volume[1]) if volume else int(re.sub(r"\D", "", called) or {"triangle": 3, "quad": 4}[called])
    numbers = [int(each) for _, row in rows for each in row if each]
    if len(numbers) % (size + 1):
        raise FormatError(
            f"*ELEMENT: its numbers are no multiple of {size + 1}, as type = {kind} has {size} nodes", line
        )
    cells = [numbers[at : at + size + 1] for at in range(0, len(numbers), size + 1)]
    for index, cell in enumerate(cells):
        deck.elements[cell[0]] = len(deck.blocks), index
    deck.blocks.append((called, [cell[1:] for cell in cells]))
    if "ELSET" in options:
        deck.element_sets.setdefault(options["ELSET"], []).extend(cell[0] for cell in cells)


def _set_reader(of: str) -> Callable[[Deck, int, dict[str, str], Rows], None]:
    def read(deck: Deck, line: int, options: dict[str, str], rows: Rows) -> None:
        sets = deck.node_sets if of == "NSET" else deck.element_sets
        own = sets.setdefault(options.get(of, ""), [])
        for _, row in rows:
            if "GENERATE" in options:
                first, last, *step = map(int, filter(None, row))
                own.extend(range(first, last + 1, *step))
            else:
                for each in filter(None, row):
                    own.extend([int(each)] if each.isdigit() else _named(sets, each))

    return read


def _read_surface(deck: Deck, line: int, options: dict[str, str], rows: Rows) -> None:
    name = options.get("NAME", "")
    if options.get("TYPE", "ELEMENT").upper() == "NODE":
        for _, row in rows:
            numbers = [int(row[0])] if row[0].isdigit() else _named(deck.node_sets, row[0])
            deck.node_sets.setdefault(name, []).extend(numbers)
    else:
        deck.surfaces[name] = [(row[0], row[1] if len(row) > 1 else "") for _, row in rows]


def _read_part(deck: Deck, line: int, options: dict[str, str], rows: Rows) -> None:
    deck.parts += 1
    if deck.parts > 1:
        raise FormatError("is a second part: write the mesh as one part (Abaqus: merge the instances)", line)


def _read_instance(deck: Deck, line: int, options: dict[str, str], rows: Rows) -> None:
    deck.instances += 1
    if deck.instances > 1 or rows:
        raise FormatError("an instance is moved, or a second one: write the mesh as one part, where it stands", line)


def _read_include(deck: Deck, line: int, options: dict[str, str], rows: Rows) -> None:
    raise FormatError("*INCLUDE: another file is not read: put its lines in this one", line)


def _skip(deck: Deck, line: int, options: dict[str, str], rows: Rows) -> None:
    pass


READERS = {
    "NODE": _read_nodes,
    "ELEMENT": _read_elements,
    "NSET": _set_reader("NSET"),
    "ELSET": _set_reader("ELSET"),
    "SURFACE": _read_surface,
    "PART": _read_part,
    "INSTANCE": _read_instance,
    "INCLUDE": _read_include,
}
