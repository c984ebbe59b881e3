"""Given matrices: from the files and rows that a case names to a structure in SI units, or all that is wrong."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from hashlib import sha256
from pathlib import Path as File
from typing import Any

import numpy as np

from vibeam.casefile.coordinates import Coordinates
from vibeam.casefile.field_tables import file_name
from vibeam.casefile.matrix_faults import damping_faults, entry_faults, mass_faults, stiffness_faults
from vibeam.casefile.quantities import UNIT_SYSTEMS, UnitSystem
from vibeam.exchange.faults import Complaint
from vibeam.exchange.files import FormatError, digest_of
from vibeam.exchange.matrices.declaration import read_matrix
from vibeam.exchange.matrices.entries import FileMatrix, Label, in_labels
from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Damping
from vibeam_models.given import GivenStructure
from vibeam_models.structure import Structure

DENSE = 1000  # coordinates up to which matrices are full arrays
CALLED = {"mass": "M", "stiffness": "K", "damping_matrix": "C"}  # in a file with several
ROWS = ("contact", "sensor", "base", "force")
KEYS = (*CALLED, *ROWS, "outputs", "damping", "damping_ratio", "units", "moving_mass")
KEPT = 8  # structures


def values_of(table: Any) -> dict[str, Any]:
    """The values of [matrices], of a checked table or of a readable part of one."""
    return {key: getattr(table, key) for key in KEYS}


def sources(table: Any, folder: File) -> dict[str, str]:
    """SHA-256 of the content of every file that a table names, by key; a file that is not there has none."""
    found = {}
    for key, said in _files(table).items():
        try:
            found[key] = digest_of(folder / said["file"])
        except FormatError:
            found[key] = ""
    return found


def _files(table: Any) -> dict[str, Mapping[str, str]]:
    named = {key: getattr(table, key) for key in (*CALLED, *ROWS)}
    named |= {f"outputs.{name}": row for name, row in (table.outputs or {}).items()}
    return {key: said for key, said in named.items() if isinstance(said, Mapping)}


def given_matrices(table: Any, folder: File) -> tuple[GivenStructure | None, tuple[Complaint, ...]]:
    """The structure that a table declares (None: it cannot be made), and every complaint about it."""
    values = values_of(table)
    if values["mass"] is None or values["stiffness"] is None or values["units"] is None:
        return None, ()
    said = json.dumps([values, sources(table, folder)], sort_keys=True, default=list)
    return _given(said, folder)


@lru_cache(maxsize=KEPT)
def _given(said: str, folder: File) -> tuple[GivenStructure | None, tuple[Complaint, ...]]:
    values, _ = json.loads(said)
    made = _Reading(values, folder)
    structure = made.structure()
    if structure is None or made.complaints:
        return None, tuple(made.complaints)
    has_it = values["damping_matrix"] or not isinstance(structure.M, np.ndarray)  # sparse ones have it already
    damping = None if has_it else _damping(values)
    digest = sha256(said.encode()).hexdigest()
    return GivenStructure(digest, "matrices", structure, damping, made.carried), ()


def _damping(values: Mapping[str, Any]) -> Damping:
    kind, ratios = values["damping"], values["damping_ratio"]
    return Damping("list", tuple(kind)) if isinstance(kind, list) else Damping(kind, tuple(ratios or (0.0,)))


@dataclass
class _Reading:
    """Files read one after the other; complaints are collected, so that one hides no other."""

    values: Mapping[str, Any]
    folder: File
    complaints: list[Complaint] = field(default_factory=list)
    carried: float | None = None

    def structure(self) -> Structure | None:
        """The structure; None where there are complaints that leave none."""
        files = {key: self._file(key) for key in CALLED if self.values[key] is not None}
        present = {key: each for key, each in files.items() if each is not None}
        if len(present) < len(files) or not self._sized(present):
            return None
        matrices, coordinates = _together(present)
        sound = self._sound(matrices, coordinates)
        rows = self._rows(coordinates)
        whole = "contact" in rows and ("base" in rows or "force" in rows)
        return self._made(matrices, rows, coordinates) if sound and whole and not self.complaints else None

    def _complain(self, key: str, message: str) -> None:
        self.complaints.append((("matrices", *key.split(".")), message))

    def _file(self, key: str) -> FileMatrix | None:
        said = self.values[key]
        try:
            return read_matrix(self.folder / said["file"], said.get("name", ""), CALLED[key])
        except FormatError as error:
            self._complain(key, f"{self._name(key)}: {error}")
            return None

    def _sized(self, files: Mapping[str, FileMatrix]) -> bool:
        """Test whether all are square and go together."""
        square = True
        for key, each in files.items():
            rows, *columns = each.matrix.shape
            if columns != [rows]:
                self._complain(key, f"{self._name(key)}: is {' × '.join(map(str, each.matrix.shape))}, not square")
                square = False
        labelled = [key for key, each in files.items() if each.labels]
        if not square or len(labelled) == len(files):
            return square
        if labelled:
            other = next(key for key in files if key not in labelled)
            self._complain(other, f"{self._name(other)}: names no nodes, and {labelled[0]} does: export both alike")
            return False
        size = files["mass"].matrix.shape[0]
        for key, each in files.items():
            if each.matrix.shape[0] != size:
                own = each.matrix.shape[0]
                self._complain(key, f"{self._name(key)}: has {own} coordinates, {self._name('mass')} has {size}")
        return not self.complaints

    def _name(self, key: str) -> str:
        return file_name(self.values[key]["file"])

    def _sound(self, matrices: dict[str, Any], coordinates: Coordinates) -> bool:
        """Test whether they are a structure's; those that are held are out of it."""
        for key, matrix in matrices.items():
            for fault in entry_faults(matrix, coordinates):
                self._complain(key, f"{self._name(key)}: {fault}")
        if self.complaints:
            return False
        free = free_of(coordinates)
        labels = coordinates.labels
        own = Coordinates(len(free), None if labels is None else tuple(labels[index] for index in free))
        M, K = (_part(matrices[key], free) for key in ("mass", "stiffness"))
        faults = [("mass", fault) for fault in mass_faults(M, own)]
        if not faults:
            faults += [("stiffness", fault) for fault in stiffness_faults(K, M)]
            if "damping_matrix" in matrices:
                faults += [
                    ("damping_matrix", fault) for fault in damping_faults(_part(matrices["damping_matrix"], free), M)
                ]
        for key, fault in faults:
            self._complain(key, f"{self._name(key)}: {fault}")
        return not faults

    def _rows(self, coordinates: Coordinates) -> dict[str, Array]:
        said = {key: self.values[key] for key in ROWS if self.values[key] is not None}
        said |= {f"outputs.{name}": row for name, row in (self.values["outputs"] or {}).items()}
        found = {}
        for key, each in said.items():
            try:
                found[key] = coordinates.row(each, self.folder, key.rpartition(".")[2])
                if not found[key].any():
                    self._complain(key, "reads nothing: all of its values are 0")
            except ValueError as error:
                self._complain(key, str(error))
        return found

    def _made(self, matrices: dict[str, Any], rows: dict[str, Array], coordinates: Coordinates) -> Structure:
        units: UnitSystem = UNIT_SYSTEMS[self.values["units"]]
        free = free_of(coordinates)
        M = matrices["mass"] * units.mass
        read = {key: units.length * row[free] for key, row in rows.items()}
        if "base" in rows:
            pulled = M @ (rows["base"] / units.length)
            load, self.carried = -pulled[free], float(rows["base"] @ pulled) / units.length
        else:
            load = -read["force"]
        self.carried = self.values["moving_mass"] or self.carried
        outputs = {"sensor": read.get("sensor", read["contact"])}
        outputs |= {key.partition(".")[2]: row for key, row in read.items() if key.startswith("outputs.")}
        K = _part(matrices["stiffness"], free) * units.stiffness
        C = _part(matrices["damping_matrix"], free) * units.damping if "damping_matrix" in matrices else 0 * K
        parts: Any = {"load": load, "static": np.zeros(len(free)), "contact": read["contact"], "outputs": outputs}
        parts["units"] = dict.fromkeys(outputs, "m")
        if isinstance(K, np.ndarray):
            return Structure(_part(M, free), C, K, **parts)
        from vibeam_models.sparse import SparseStructure

        damping = None if "damping_matrix" in matrices else _damping(self.values)
        return SparseStructure(_part(M, free), C, K, **parts, damping=damping)


def free_of(coordinates: Coordinates) -> Any:
    """The coordinates, from 0, that are not held."""
    return np.array([index for index in range(coordinates.size) if index not in coordinates.held], dtype=np.int64)


def _part(matrix: Any, free: Any) -> Any:
    return matrix if len(free) == matrix.shape[0] else matrix[free][:, free]


def _together(files: Mapping[str, FileMatrix]) -> tuple[dict[str, Any], Coordinates]:
    """The matrices in the same coordinates, full where they are few, and these."""
    labels = _union(files)
    held: frozenset[int] = frozenset()
    matrices: dict[str, Any] = {}
    for key, each in files.items():
        matrix = each.matrix if labels is None else in_labels(each, labels)
        own = each.labels or ()
        held |= each.held if labels is None else {labels.index(own[index]) for index in each.held}
        matrices[key] = _full_or_sparse(matrix)
    size = matrices["mass"].shape[0]
    return matrices, Coordinates(size, labels, held)


def _union(files: Mapping[str, FileMatrix]) -> tuple[Label, ...] | None:
    if any(each.labels is None for each in files.values()):
        return None
    return tuple(sorted(set().union(*(each.labels or () for each in files.values()))))


def _full_or_sparse(matrix: Any) -> Any:
    from scipy.sparse import csc_array

    full = isinstance(matrix, np.ndarray)
    if matrix.shape[0] > DENSE:
        return csc_array(matrix) if full else matrix.tocsc()
    return np.ascontiguousarray(matrix if full else matrix.toarray())  # one layout, so that round-off is the same
