"""Given modes: from the numbers and places that a case names to a structure in modal coordinates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path as File
from typing import Any

import numpy as np

from vibeam.casefile.coordinates import ROWS, SHOWN, StructureReading, given, outputs_of
from vibeam.casefile.field_tables import DIRECTIONS
from vibeam.exchange.faults import Complaint
from vibeam.exchange.nastran_output import read_modes
from vibeam.exchange.uff import FileModes
from vibeam_models.arrays import Array
from vibeam_models.given import GivenStructure
from vibeam_models.structure import Structure

KEYS = (*ROWS, "outputs", "file", "skip", "frequency", "damping_ratio", "modal_mass", "moving_mass")


def files_of(table: Any) -> dict[str, str]:
    """Files that [modes] names, by key."""
    return {} if table.file is None else {"file": table.file}


def given_modes(table: Any, folder: File) -> tuple[GivenStructure | None, tuple[Complaint, ...]]:
    """Structure that [modes] declares (None: it cannot be made), and every complaint about it."""
    return given(ModesReading, table, files_of(table), folder)


class ModesReading(StructureReading):
    """Reading of modes, and of the shapes at places."""

    kind = "modes"
    keys = KEYS

    def structure(self) -> Structure | None:
        """As ``StructureReading.structure``."""
        self.carried = self.values["moving_mass"]
        said = self.values["file"]
        skip = self.values["skip"] or ()
        file: FileModes | None = None if said is None else self.content("file", said, read_modes, skip)
        if skip and said is None:
            self.complain("skip", "omits modes of a file, and there is none: leave it out")
        frequency = self._each("frequency", None if file is None else file.frequency)
        if frequency is None:
            return None
        damping = self._each("damping_ratio", None if file is None else file.damping, len(frequency))
        mass = self._each("modal_mass", np.ones(len(frequency)) if file is None else file.mass, len(frequency))
        if damping is None or mass is None:
            return None
        if not mass.all():
            said = "its modes have no modal mass, so that their shapes have no scale"
            self.complain("modal_mass", f'missing ({said}): write modal_mass = "1 kg" if they are mass-normalised')
            return None
        rows = self._rows(file, mass)
        self._carries(rows)
        whole = "contact" in rows and ("base" in rows or "force" in rows)
        return _made(frequency, damping, rows) if whole and not self.complaints else None

    def _each(self, key: str, known: Array | None, count: int | None = None) -> Array | None:
        """One number for each mode: the case's, or what is ``known`` without."""
        said = self.values[key]
        if said is None:
            if known is None and (key != "frequency" or self.values["file"] is None):
                self.complain(key, f"missing: write {key} = [{EXAMPLES[key]}], one for each mode")
            return known
        numbers = np.array(said, dtype=float)
        wanted = count if known is None else len(known)
        if wanted is not None and len(numbers) not in ((1, wanted) if key != "frequency" else (wanted,)):
            self.complain(key, f"{len(numbers)} numbers for {wanted} modes")
            return None
        return numbers if wanted is None else np.broadcast_to(numbers, (wanted,))

    def _rows(self, file: FileModes | None, mass: Array) -> dict[str, Array]:
        found = {}
        for key, each in self.rows_said().items():
            try:
                row = self._row(each, file, len(mass))
            except ValueError as error:
                self.complain(key, str(error))
                continue
            found[key] = row / np.sqrt(mass)
            if not row.any():
                self.complain(key, "reads nothing: all of its values are 0")
        return found

    def _row(self, said: Sequence[Any], file: FileModes | None, count: int) -> Array:
        if isinstance(said[0], Mapping):
            return np.asarray(np.sum([_at(file, term) for term in said], axis=0))
        if len(said) != count:
            raise ValueError(f"{len(said)} numbers for {count} modes")
        return np.array(said, dtype=float)

    def _carries(self, rows: Mapping[str, Array]) -> None:
        carried = self.values["moving_mass"]
        if carried is not None and "base" in rows and carried < (least := float(rows["base"] @ rows["base"])):
            self.complain("moving_mass", f"{carried:g} kg is less than the modes move by themselves, {least:.4g} kg")


EXAMPLES = {"frequency": '"… Hz", "… Hz"', "damping_ratio": "…, …", "modal_mass": '"… kg"'}


def _at(file: FileModes | None, term: Mapping[str, Any]) -> Array:
    if file is None:
        raise ValueError("a node and its direction are of a file: write one number for each mode, or file")
    label = int(term["node"]), int(DIRECTIONS.get(term["direction"], term["direction"]))
    if label not in file.shapes:
        nodes = sorted({node for node, _ in file.shapes})
        some = ", ".join(map(str, nodes[:SHOWN])) + (" …" if len(nodes) > SHOWN else "")
        raise ValueError(f"the file has no node {label[0]} with direction {label[1]}: its nodes are {some}")
    return np.asarray(file.shapes[label] * float(term.get("value", 1.0)))


def _made(frequency: Array, damping: Array, rows: Mapping[str, Array]) -> Structure:
    """M = I, C = diag(2ζω), K = diag(ω²)."""
    omega = 2 * np.pi * frequency
    outputs = outputs_of(rows)
    return Structure(
        M=np.eye(len(omega)),
        C=np.diag(2 * damping * omega),
        K=np.diag(omega**2),
        load=-rows["base" if "base" in rows else "force"],
        static=np.zeros(len(omega)),
        contact=rows["contact"],
        outputs=outputs,
        units=dict.fromkeys(outputs, "m"),
    )
