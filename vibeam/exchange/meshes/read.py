"""Meshes from the files of others, through meshio: `read_mesh`, with all that a file may be in place of a mesh."""

from __future__ import annotations

from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.files import LARGEST_TEXT, FormatError, read_by, require_room, state_of
from vibeam.exchange.meshes.content import FileContent, mesh_of
from vibeam.exchange.meshes.groups import join_groups
from vibeam_models.registry import loaded
from vibeam_models.solid.own_mesh import FileMesh

HERE = "vibeam.exchange.meshes"
#: reader of a path by the file's ending: meshio's name of the format, or a function
FORMATS = {
    ".msh": "gmsh",
    ".inp": f"{HERE}.abaqus:read_deck",
    **dict.fromkeys((".bdf", ".nas", ".fem"), f"{HERE}.nastran:read_bulk"),
    ".vtk": "vtk",
    ".vtu": "vtu",
    ".med": f"{HERE}.read:read_med",
    ".mesh": "medit",
}


def read_mesh(path: Path) -> FileMesh:
    """The mesh of a file; FormatError for what is none, is damaged, too large, or of elements that are not taken."""
    ending = path.suffix.lower()
    if ending not in FORMATS:
        raise FormatError(f"'{ending}' is no ending of a mesh: {', '.join(FORMATS)} are")
    state_of(path, LARGEST_TEXT)
    reader = FORMATS[ending]
    return mesh_of(loaded(reader)(path) if ":" in reader else content_of(read_by_meshio(path, reader)))


def read_med(path: Path) -> FileContent:
    """The content of a MED file, whose values lie in it and are no more than can be read."""
    import h5py

    from vibeam.exchange.hdf5 import contents, is_own, opened

    with read_by("cannot be read as med", OSError), opened(path) as file:
        for name, item, _ in contents(file):
            values = isinstance(item, h5py.Dataset)
            if item is None or (values and not is_own(item)):
                raise FormatError(f"'{name}' lies in another file: copy it into this one")
            require_room((item.shape or ()) if values else ())
    return content_of(read_by_meshio(path, "med"))


def read_by_meshio(path: Path, name: str) -> Any:
    """The mesh of a file by one of meshio's readers, which print and leave the program where they fail."""
    import meshio

    said = StringIO()
    try:
        with redirect_stdout(said), redirect_stderr(said), np.errstate(all="ignore"):
            return meshio.read(path, name)
    except (Exception, SystemExit) as error:
        lines = [line.strip() for line in said.getvalue().splitlines() if "Couldn't read" not in line]
        known = isinstance(error, SystemExit)
        why = " ".join(next(filter(None, lines), "" if known else str(error)).split())[:200]
        if "Incompatible cell data" in why:
            why = "some of its cells are in no physical group and others are: save the groups alone, not all cells"
        elif isinstance(error, KeyError):
            why = f"it has {why}, which is not known"
        elif not known or not why:
            why = f"it is damaged, or has what is not known{why and f' ({why})'}"
        raise FormatError(f"cannot be read as {name}: {why}") from None


def content_of(mesh: Any) -> FileContent:
    """The content of meshio's mesh, its groups by the names that each format has for them."""
    points = np.asarray(mesh.points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise FormatError("its points have no three coordinates: it is no mesh of a body")
    made = FileContent(points, [(block.type, np.asarray(block.data)) for block in mesh.cells])
    join_groups(made, mesh)
    return made
