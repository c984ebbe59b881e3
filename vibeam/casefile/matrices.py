"""Given matrices: from the files and rows that a case names to a structure in SI units, or all that is wrong."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path as File
from typing import Any, ClassVar

import numpy as np

from vibeam.casefile.coordinates import ROWS, Coordinates, StructureReading, given, outputs_of
from vibeam.casefile.field_tables import file_name
from vibeam.casefile.matrix_faults import damping_faults, entry_faults, mass_faults, stiffness_faults
from vibeam.casefile.quantities import UNIT_SYSTEMS, UnitSystem
from vibeam.exchange.faults import Complaint
from vibeam.exchange.matrices.declaration import read_matrix
from vibeam.exchange.matrices.entries import FileMatrix, Label, in_labels
from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Damping
from vibeam_models.given import GivenStructure
from vibeam_models.structure import Structure

DENSE = 1000  # coordinates up to which matrices are full arrays
CALLED = {"mass": "M", "stiffness": "K", "damping_matrix": "C"}  # in a file with several
KEYS = (*CALLED, *ROWS, "outputs", "damping", "damping_ratio", "units", "moving_mass")


def files_of(table: Any) -> dict[str, str]:
    """Files that [matrices] names, by key."""
    named = {key: getattr(table, key) for key in (*CALLED, *ROWS)}
    named |= {f"outputs.{name}": row for name, row in (table.outputs or {}).items()}
    return {key: said["file"] for key, said in named.items() if isinstance(said, Mapping)}


def given_matrices(table: Any, folder: File) -> tuple[GivenStructure | None, tuple[Complaint, ...]]:
    """Structure that [matrices] declares (None: it cannot be made), and every complaint about it."""
    if table.mass is None or table.stiffness is None or table.units is None:
        return None, ()
    return given(MatricesReading, table, files_of(table), folder)


@dataclass
class MatricesReading(StructureReading):
    """Reading of matrices and of the rows over their coordinates."""

    kind: ClassVar[str] = "matrices"
    keys: ClassVar[tuple[str, ...]] = KEYS
    sparse: bool = False

    def damping(self) -> Damping | None:
        """Damping of the modes; none beside a matrix, or of a sparse structure, which has it."""
        return None if self.values["damping_matrix"] or self.sparse else self._damping()

    def _damping(self) -> Damping:
        kind, ratios = self.values["damping"], self.values["damping_ratio"]
        return Damping("list", tuple(kind)) if isinstance(kind, list) else Damping(kind, tuple(ratios or (0.0,)))

    def structure(self) -> Structure | None:
        """As ``StructureReading.structure``."""
        files = {key: self._file(key) for key in CALLED if self.values[key] is not None}
        present = {key: each for key, each in files.items() if each is not None}
        if len(present) < len(files) or not self._sized(present):
            return None
        matrices, coordinates = _together(present)
        sound = self._sound(matrices, coordinates)
        rows = self._rows(coordinates)
        whole = "contact" in rows and ("base" in rows or "force" in rows)
        return self._made(matrices, rows, coordinates) if sound and whole and not self.complaints else None

    def _file(self, key: str) -> Any:
        said = self.values[key]
        return self.content(key, said["file"], read_matrix, said.get("name", ""), CALLED[key])

    def _sized(self, files: Mapping[str, FileMatrix]) -> bool:
        """Test whether all are square and go together."""
        square = True
        for key, each in files.items():
            rows, *columns = each.matrix.shape
            if columns != [rows]:
                self.complain(key, f"{self._name(key)}: is {' × '.join(map(str, each.matrix.shape))}, not square")
                square = False
        labelled = [key for key, each in files.items() if each.labels]
        if not square or len(labelled) == len(files):
            return square
        if labelled:
            other = next(key for key in files if key not in labelled)
            self.complain(other, f"{self._name(other)}: names no nodes, and {labelled[0]} does: export both alike")
            return False
        size = files["mass"].matrix.shape[0]
        for key, each in files.items():
            if each.matrix.shape[0] != size:
                own = each.matrix.shape[0]
                self.complain(key, f"{self._name(key)}: has {own} coordinates, {self._name('mass')} has {size}")
        return not self.complaints

    def _name(self, key: str) -> str:
        return file_name(self.values[key]["file"])

    def _sound(self, matrices: dict[str, Any], coordinates: Coordinates) -> bool:
        """Test whether they are a structure's; those that are held are out of it."""
        for key, matrix in matrices.items():
            for fault in entry_faults(matrix, coordinates):
                self.complain(key, f"{self._name(key)}: {fault}")
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
            self.complain(key, f"{self._name(key)}: {fault}")
        return not faults

    def _rows(self, coordinates: Coordinates) -> dict[str, Array]:
        found = {}
        for key, each in self.rows_said().items():
            try:
                found[key] = coordinates.row(each, self.folder, key.rpartition(".")[2])
                if not found[key].any():
                    self.complain(key, "reads nothing: all of its values are 0")
            except ValueError as error:
                self.complain(key, str(error))
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
        outputs = outputs_of(read)
        K = _part(matrices["stiffness"], free) * units.stiffness
        C = _part(matrices["damping_matrix"], free) * units.damping if "damping_matrix" in matrices else 0 * K
        parts: Any = {"load": load, "static": np.zeros(len(free)), "contact": read["contact"], "outputs": outputs}
        parts["units"] = dict.fromkeys(outputs, "m")
        if isinstance(K, np.ndarray):
            return Structure(_part(M, free), C, K, **parts)
        from vibeam_models.sparse import SparseStructure

        self.sparse, damping = True, None if "damping_matrix" in matrices else self._damping()
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
