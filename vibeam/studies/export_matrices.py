"""Matrices of a case's structure, for other programs, and to be read again as [matrices]."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.exchange.matrices.declaration import Arrays, write_arrays
from vibeam_models.beam import structure_of

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam_models.scene import AnyScene


def export_matrices(case: Case | AnyScene, path: str | PathLike[str]) -> str:
    """Write M, C and K of the whole model and its rows to ``path``; returns the [matrices] table that reads them.

    One file (.npz, .h5, .mat), or one for each array with its name (.mtx, .npy). SI units, on a base held still: a
    platform is not in them. The rows are those of contact, sensor and further displacements, and, as ``base``, the r of
    the load −M r; or, as ``force``, that of the place which a force or a moment drives, whose amplitude in N or N m is
    then drive.force. ValueError for another ending, and for matrices that stay sparse.
    """
    given: Any = case
    scene: AnyScene = getattr(given, "scene", given)
    places = write_arrays(arrays_of(scene), Path(path))
    keys = {"mass": "M", "stiffness": "K", "damping_matrix": "C", "contact": "contact"}
    keys |= {name: name for name in ("base", "force") if name in places}
    rows = {name: name for name in places if name not in keys.values()}
    keys |= {"sensor": rows.pop("sensor")} if "sensor" in rows else {}
    lines = [f"{key} = {_said(*places[name])}" for key, name in keys.items()]
    further = ", ".join(f"{name} = {_said(*places[name])}" for name in rows)
    return "\n".join(["[matrices]", *lines, 'units = "SI"', *([f"outputs = {{ {further} }}"] if further else []), ""])


def arrays_of(scene: AnyScene) -> Arrays:
    """The matrices and rows by name; ValueError for sparse ones, which would become full."""
    structure = structure_of(scene)
    if not isinstance(structure.M, np.ndarray):
        raise ValueError(f"{structure.size} coordinates stay sparse, in the files that the case names")
    found = {"M": structure.M, "C": structure.C, "K": structure.K, "contact": structure.contact, **_driven(scene)}
    return found | {name: row for name, row in structure.outputs.items() if structure.units.get(name, "m") == "m"}


def _driven(scene: Any) -> Arrays:
    """The row of what drives the structure: of the base's motion, or of the place of a force."""
    structure = structure_of(scene)
    if scene.base.on_beam is not None:
        return {"force": -structure.load}
    return {"base": np.asarray(np.linalg.solve(structure.M, -structure.load), dtype=np.float64)}


def _said(file: Path, name: str) -> str:
    return f'{{ file = "{file.name}", name = "{name}" }}' if name else f'"{file.name}"'
