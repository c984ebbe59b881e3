"""Meshes from the files of others: `read_mesh`; those that meshio reads, with the groups that each format has."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.files import LARGEST_TEXT, FormatError, read_by, require_room, state_of
from vibeam.exchange.hdf5 import contents, is_own, opened
from vibeam.extensions.solid.elasticity.own_mesh import FileMesh, Indices
from vibeam.extensions.solid.meshes.content import FileContent, by_value, mesh_of
from vibeam.extensions.solid.meshes.declared import require_counts
from vibeam_models.registry import loaded

HERE = "vibeam.extensions.solid.meshes"
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
MOST = 1000  # values of an array beyond which it tells no groups
COUNTS = ("NBR", "NGA")  # attributes of MED by which meshio takes memory
OTHER = ("gmsh:geometrical", "gmsh:dim_tags")  # arrays that tell no groups
DIMENSIONS = {"vertex": 0, "line": 1, "triangle": 2, "quad": 2}


def read_mesh(path: Path) -> FileMesh:
    """The mesh of a file; FormatError for what is none, is damaged, too large, or of elements that are not taken."""
    ending = path.suffix.lower()
    if ending not in FORMATS:
        raise FormatError(f"'{ending}' is no ending of a mesh: {', '.join(FORMATS)} are")
    state_of(path, LARGEST_TEXT)
    reader = FORMATS[ending]
    with read_by():
        if ":" in reader:
            return mesh_of(loaded(reader)(path))
        require_counts(path.read_bytes(), reader)
        return mesh_of(content_of(read_by_meshio(path, reader)))


def read_med(path: Path) -> FileContent:
    """The content of a MED file, whose values lie in it and, with the counts beside them, are no more than are read."""
    import h5py

    room = 0
    with read_by("cannot be read as med"), opened(path) as file:
        for name, item, _ in contents(file):
            values = isinstance(item, h5py.Dataset)
            if item is None or (values and not is_own(item)):
                raise FormatError(f"'{name}' lies in another file: copy it into this one")
            room += max(item.size or 0 if values else 0, *(int(item.attrs.get(each, 0)) for each in COUNTS))
            require_room((room,))
        return content_of(read_by_meshio(path, "med"))


def read_by_meshio(path: Path, name: str) -> Any:
    """The mesh of a file by one of meshio's readers, which print and leave the program where they fail."""
    import meshio

    said = StringIO()
    try:
        with redirect_stdout(said), redirect_stderr(said), np.errstate(all="ignore"):
            return meshio.read(path, name)
    except (Exception, SystemExit) as error:
        lines = (line.strip() for line in said.getvalue().splitlines() if "Couldn't read" not in line)
        why = next(filter(None, lines), "it is damaged" if isinstance(error, SystemExit) else str(error))
        if "Incompatible cell data" in why:
            why = "some of its cells are in no physical group and others are: save the groups alone, not all cells"
        raise FormatError(f"cannot be read as {name}: {' '.join(why.split())[:200] or type(error).__name__}") from None


def content_of(mesh: Any) -> FileContent:
    """The content of meshio's mesh, its groups by the names that each format has for them.

    Physical groups of Gmsh and families of MED have names. Whole numbers of cells or nodes make groups by the name of
    their array: ``material`` where they are 0 and 1, else ``material 3``, one for each value.
    """
    points = np.asarray(mesh.points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise FormatError("its points have no three coordinates: it is no mesh of a body")
    made = FileContent(points, [(block.type, np.asarray(block.data)) for block in mesh.cells])
    for name, sets in mesh.cell_sets.items():
        for block, indices in enumerate(sets) if not name.startswith("gmsh:") else ():
            made.join(name, block, np.asarray([] if indices is None else indices, dtype=int))
    for called, given in mesh.cell_data.items():
        for block, name, cells in _groups(called, given, mesh, [kind for kind, _ in made.blocks]):
            made.join(name, block, cells)
    for called, values in mesh.point_data.items():
        for _, name, nodes in _groups(called, [values], mesh, [""]):
            made.nodes[name] = np.union1d(made.nodes.get(name, np.empty(0, int)), nodes)
    return made


def _groups(called: str, given: list[Any], mesh: Any, kinds: list[str]) -> Iterator[tuple[int, str, Indices]]:
    """Block, name and members of the groups that an array of whole numbers tells: of cells by kind, or of nodes."""
    arrays = [np.ravel(each) if np.shape(each)[1:] == (1,) else np.asarray(each) for each in given]
    if not all(each.ndim == 1 and each.dtype.kind in "iu" for each in arrays):
        return
    values = set(np.unique(np.concatenate([*arrays, np.empty(0, int)])).tolist())
    for block, (array, kind) in enumerate(zip(arrays, kinds, strict=True)):
        if called == "gmsh:physical":
            of = DIMENSIONS.get(kind.rstrip("0123456789"), 3)
            known = {int(at[0]): name for name, at in mesh.field_data.items() if np.size(at) == 2 and at[1] == of}
            names = {value: [known.get(value, str(value))] for value in values - {0}}
        elif called in ("cell_tags", "point_tags"):
            names = getattr(mesh, called, {})
        elif values <= {0, 1}:
            yield block, called, np.flatnonzero(array == 1)
            continue
        else:
            names = {value: [f"{called} {value}"] for value in values if len(values) <= MOST and called not in OTHER}
        yield from ((block, name, found) for value, found in by_value(array) for name in names.get(value, ()))
