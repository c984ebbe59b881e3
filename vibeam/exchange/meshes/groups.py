"""Groups of a mesh that meshio has read, by the names that each format has for them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from vibeam.exchange.meshes.content import FileContent
from vibeam_models.solid.own_mesh import Indices

MOST = 1000  # values of an array beyond which it tells no groups
DIMENSIONS = {"vertex": 0, "line": 1, "triangle": 2, "quad": 2}


def join_groups(content: FileContent, mesh: Any) -> None:
    """Join the cells and nodes of meshio's mesh to the groups that its file names.

    Sets have their names, physical groups of Gmsh and families of MED theirs. Whole numbers of cells or nodes make
    groups by the name of their array: ``material`` where they are 0 and 1, else ``material 3``, one for each value.
    """
    for name, sets in mesh.cell_sets.items():
        for block, indices in enumerate(sets) if not name.startswith("gmsh:") else ():
            content.join(name, block, np.asarray([] if indices is None else indices, dtype=int))
    for name, indices in mesh.point_sets.items():
        content.nodes[name] = np.asarray(indices, dtype=int)
    names = {(int(value[0]), int(value[1])): name for name, value in mesh.field_data.items() if np.size(value) == 2}
    for called, given in mesh.cell_data.items():
        arrays = [np.ravel(each) if np.shape(each)[1:] == (1,) else each for each in given]
        _join_values(content, mesh, called, arrays, names)
    for called, values in mesh.point_data.items():
        if called == "point_tags":
            _join_families(content, getattr(mesh, "point_tags", {}), values)
        elif called not in ("gmsh:dim_tags", "nastran:ref"):
            for name, indices in _by_value(called, values, _values([values])):
                content.nodes[name] = indices


def _join_values(
    content: FileContent, mesh: Any, called: str, arrays: list[Any], names: dict[tuple[int, int], str]
) -> None:
    values = _values(arrays)
    for block, array in enumerate(arrays):
        if called == "gmsh:physical":
            dimension = DIMENSIONS.get(content.blocks[block][0].rstrip("0123456789"), 3)
            for value in np.unique(array[array != 0]):
                content.join(names.get((int(value), dimension), str(value)), block, np.flatnonzero(array == value))
        elif called == "cell_tags":
            for family, found in getattr(mesh, "cell_tags", {}).items():
                for name in found:
                    content.join(name, block, np.flatnonzero(array == family))
        elif called != "gmsh:geometrical":
            for name, indices in _by_value(called, array, values):
                content.join(name, block, indices)


def _join_families(content: FileContent, families: dict[int, list[str]], values: Indices) -> None:
    for family, names in families.items():
        for name in names:
            found = np.flatnonzero(np.asarray(values) == family)
            content.nodes[name] = np.union1d(content.nodes.get(name, np.empty(0, int)), found)


def _values(arrays: list[Any]) -> Indices | None:
    """The values of arrays of whole numbers, of which a few tell groups; None where they do not."""
    if not all(np.ndim(array) == 1 and np.issubdtype(np.asarray(array).dtype, np.integer) for array in arrays):
        return None
    values = np.unique(np.concatenate([np.asarray(array) for array in arrays])) if arrays else np.empty(0, int)
    return values if len(values) <= MOST else None


def _by_value(called: str, array: Any, values: Indices | None) -> Iterator[tuple[str, Indices]]:
    """Names and indices of the groups that an array of whole numbers tells; Nastran's are properties."""
    if values is None:
        return
    if set(values.tolist()) <= {0, 1}:
        yield called, np.flatnonzero(np.asarray(array) == 1)
        return
    stem = {"nastran:ref": "property"}.get(called, called)
    for value in values:
        yield f"{stem} {value}", np.flatnonzero(np.asarray(array) == value)
