"""HDF5 files: a dataset, or a group that holds a sparse matrix as MATLAB 7.3 or scipy's csc and csr have it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from vibeam.exchange.files import FormatError
from vibeam.exchange.hdf5 import contents, opened, text_at, values_of
from vibeam.exchange.matrices.declaration import chosen
from vibeam.exchange.matrices.entries import FileMatrix, compressed, numbers

COMPRESSED = {"data", "indices", "indptr"}  # datasets of a sparse matrix as scipy has it
MATLAB = {"data", "ir", "jc"}  # and as MATLAB has it, with the attribute MATLAB_sparse


def read(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix at a path in the file; MATLAB's, whose arrays lie by columns, are symmetric either way."""
    import h5py

    with opened(path) as file:
        found = _matrices(file)
        name = name.strip("/")
        if found.get(name or wanted, file) is None:
            raise FormatError(f"{name or wanted!r} is a link to another place: copy the values into this file")
        meant = found[chosen([place for place in found if found[place] is not None], name, wanted)]
        return FileMatrix(numbers(values_of(meant)) if isinstance(meant, h5py.Dataset) else _sparse(meant))


def _matrices(file: Any) -> dict[str, Any]:
    """What may be a matrix, by path: datasets, links, and groups that are one, whose own datasets are not listed."""
    import h5py

    found: dict[str, Any] = {}
    inside = "/"
    for place, item, _ in contents(file):
        if place.startswith(inside):
            continue
        if isinstance(item, h5py.Group) and (set(item) >= COMPRESSED or set(item) >= MATLAB):
            inside = f"{place}/"
        if item is None or isinstance(item, h5py.Dataset) or inside == f"{place}/":
            found[place] = item
    return found


def _sparse(group: Any) -> Any:
    names, by_rows = ("data", "ir", "jc"), False
    if set(group) >= COMPRESSED:
        names = ("data", "indices", "indptr")
        by_rows = "csr" in text_at(group, "format", "h5sparse_format")
    values, indices, starts = (_part(group, name) for name in names)
    size = len(starts) - 1
    return compressed(values, indices, starts, (size, size), by_rows=by_rows)


def _part(group: Any, name: str) -> Any:
    import h5py

    if type(group.get(name, getlink=True)) is not h5py.HardLink or not isinstance(group[name], h5py.Dataset):
        raise FormatError(f"{group.name + '/' + name!r} is no dataset of this file: copy it into it")
    return values_of(group[name])
