"""Reading of a structure that is given: its files and rows, with every complaint; the coordinates of matrices."""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from hashlib import sha256
from pathlib import Path as File
from typing import Any, ClassVar

import numpy as np

from vibeam.casefile.field_tables import DIRECTIONS, file_name
from vibeam.exchange.faults import Complaint
from vibeam.exchange.files import FormatError
from vibeam.exchange.matrices.declaration import digest_with, read_matrix
from vibeam.exchange.matrices.entries import Label
from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Damping
from vibeam_models.given import GivenStructure
from vibeam_models.structure import Structure

ROWS = ("contact", "sensor", "base", "force")
KEPT = 8  # structures
SHOWN = 6  # nodes in a message


@dataclass
class StructureReading(ABC):
    """Files and rows of a given structure, read one after the other: complaints are collected, none hides another.

    ``values``: of its table; ``carried``: mass that a platform carries, kg; ``taken``: what was taken of its files.
    """

    values: Mapping[str, Any]
    folder: File
    complaints: list[Complaint] = field(default_factory=list)
    carried: float | None = None
    taken: list[str] = field(default_factory=list)

    kind: ClassVar[str]
    keys: ClassVar[tuple[str, ...]]

    @abstractmethod
    def structure(self) -> Structure | None:
        """Structure; None where there are complaints that leave none."""

    def damping(self) -> Damping | None:
        """Damping of the modes, of a structure that does not have it already."""
        return None

    def complain(self, key: str, message: str) -> None:
        """Complain about a key of the table."""
        self.complaints.append(((self.kind, *key.split(".")), message))

    def content(self, key: str, name: str, read: Callable[..., Any], *wanted: Any) -> Any:
        """Content of a file by ``read``, with the line that says so; None with a complaint where it cannot be read."""
        try:
            found = read(self.folder / name, *wanted)
        except FormatError as error:
            self.complain(key, f"{file_name(name)}: {error}")
            return None
        self.taken.append(found.taken(file_name(name)))
        return found

    def rows_said(self) -> dict[str, Any]:
        """Rows that the table says, outputs among them."""
        said = {key: self.values[key] for key in ROWS if self.values[key] is not None}
        return said | {f"outputs.{name}": row for name, row in (self.values["outputs"] or {}).items()}


def outputs_of(rows: Mapping[str, Array]) -> dict[str, Array]:
    """Outputs among rows by name: the sensor, at the contact where it has no place of its own, and further ones."""
    outputs = {"sensor": rows.get("sensor", rows["contact"])}
    return outputs | {key.partition(".")[2]: row for key, row in rows.items() if key.startswith("outputs.")}


def digests(named: Mapping[str, str], folder: File) -> dict[str, str]:
    """SHA-256 of the content of files, by key; a file that is not there has none."""
    found = {}
    for key, name in named.items():
        try:
            found[key] = digest_with(folder / name)
        except FormatError:
            found[key] = ""
    return found


def given(
    reading: type[StructureReading], table: Any, files: Mapping[str, str], folder: File
) -> tuple[GivenStructure | None, tuple[Complaint, ...]]:
    """Structure that a table with these ``files`` declares (None: it cannot be made), and every complaint about it."""
    values = {key: getattr(table, key) for key in reading.keys}
    return _given(reading, json.dumps([values, digests(files, folder)], sort_keys=True, default=list), folder)


@lru_cache(maxsize=KEPT)
def _given(
    reading: type[StructureReading], said: str, folder: File
) -> tuple[GivenStructure | None, tuple[Complaint, ...]]:
    made = reading(json.loads(said)[0], folder)
    structure = made.structure()
    if structure is None or made.complaints:
        return None, tuple(made.complaints)
    digest = sha256(said.encode()).hexdigest()
    return GivenStructure(digest, made.kind, structure, made.damping(), made.carried, tuple(made.taken)), ()


@dataclass(frozen=True)
class Coordinates:
    """``size`` coordinates, counted from 1; ``labels``: node and direction of each, where the files say them.

    ``held``: those, from 0, that are held at rest relative to the base: they are in no row.
    """

    size: int
    labels: tuple[Label, ...] | None = None
    held: frozenset[int] = frozenset()

    def called(self, index: int) -> str:
        """A coordinate (from 0) in words: ``coordinate 3``, or ``node 2 direction 1``."""
        if self.labels is None:
            return f"coordinate {index + 1}"
        return "node {} direction {}".format(*self.labels[index])

    def row(self, said: Any, folder: File, name: str = "") -> Array:
        """The row (size,) that a case says, ``name`` being what it would be called in a file; ValueError."""
        if isinstance(said, str):
            return self._along(said)
        if isinstance(said, Mapping):
            return self._from_file(said, folder, name)
        row = np.zeros(self.size)
        for term in said:
            row[self._index(term)] += float(term.get("value", 1.0))
        return row

    def _along(self, word: str) -> Array:
        if word == "all":
            return np.ones(self.size)
        if self.labels is None:
            raise ValueError(
                f'"{word}" needs the direction of each coordinate, and the files name none: write "all", or a row'
            )
        return np.array([float(direction == DIRECTIONS[word]) for _, direction in self.labels])

    def _index(self, term: Mapping[str, Any]) -> int:
        index = self._place(term) if "node" in term else int(term["coordinate"]) - 1
        if not 0 <= index < self.size:
            raise ValueError(
                f"coordinate {index + 1} is not there: they are 1 to {self.size}, as the rows of the matrices"
            )
        if index in self.held:
            raise ValueError(f"{self.called(index)} is held by a boundary condition (1e36 on the diagonal): it rests")
        return index

    def _place(self, term: Mapping[str, Any]) -> int:
        if self.labels is None:
            raise ValueError("the files name no nodes: write coordinate = its row in the matrices, counted from 1")
        wanted = int(term["node"]), DIRECTIONS.get(term["direction"], term["direction"])
        if wanted in self.labels:
            return self.labels.index(wanted)
        own = sorted({direction for node, direction in self.labels if node == wanted[0]})
        if own:
            raise ValueError(f"node {wanted[0]} has no direction {wanted[1]}: it has {', '.join(map(str, own))}")
        nodes = sorted({node for node, _ in self.labels})
        some = ", ".join(map(str, nodes[:SHOWN])) + (" …" if len(nodes) > SHOWN else "")
        raise ValueError(f"there is no node {wanted[0]}: there are {some}")

    def _from_file(self, said: Mapping[str, Any], folder: File, name: str) -> Array:
        try:
            found = read_matrix(folder / said["file"], said.get("name", ""), name).matrix
        except FormatError as error:
            raise ValueError(f"{file_name(said['file'])}: {error}") from None
        row = np.asarray(found if isinstance(found, np.ndarray) else found.toarray(), dtype=float)
        if max(row.shape, default=0) != row.size or row.size != self.size:
            shape = " × ".join(map(str, row.shape))
            raise ValueError(f"{file_name(said['file'])}: is {shape}, the matrices have {self.size} coordinates")
        bad = np.flatnonzero(~np.isfinite(row.ravel()))
        if len(bad):
            raise ValueError(f"{file_name(said['file'])}: its entry {bad[0] + 1} is not a finite number")
        return row.ravel()
