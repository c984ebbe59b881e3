"""HDF5 files: a dataset, or a group that holds a sparse matrix as MATLAB 7.3 or scipy's csc and csr have it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.matrices.declaration import chosen
from vibeam.exchange.matrices.entries import FileMatrix
from vibeam.exchange.matrices.numpy_files import numbers

COMPRESSED = {"data", "indices", "indptr"}  # datasets of a sparse matrix as scipy has it

MATLAB = {"data", "ir", "jc"}  # and as MATLAB has it, with the attribute MATLAB_sparse


def read(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix at a path in the file; MATLAB's, whose arrays lie by columns, are symmetric either way."""
    import h5py

    with h5py.File(path, "r") as file:
        found = file[chosen(_matrices(file), name.strip("/"), wanted)]
        return FileMatrix(numbers(found[()]) if isinstance(found, h5py.Dataset) else _sparse(found))


def _matrices(file: Any) -> list[str]:
    """Paths of what may be a matrix: datasets, and groups that are one, whose own datasets are not listed."""
    import h5py

    names: list[str] = []

    def visit(name: str, each: Any) -> None:
        inside = any(name.startswith(f"{above}/") for above in names)
        if not inside and (isinstance(each, h5py.Dataset) or set(each) >= COMPRESSED or set(each) >= MATLAB):
            names.append(name)

    file.visititems(visit)
    return names


def _sparse(group: Any) -> Any:
    from scipy.sparse import csc_array, csr_array

    kind, indices, starts = csc_array, "ir", "jc"
    if set(group) >= COMPRESSED:
        by_rows = "csr" in str(group.attrs.get("format", group.attrs.get("h5sparse_format", "csc")))
        kind, indices, starts = (csr_array if by_rows else csc_array), "indices", "indptr"
    size = len(group[starts]) - 1
    parts = group["data"][()].astype(float), group[indices][()].astype(np.int64), group[starts][()].astype(np.int64)
    return csc_array(kind(parts, shape=(size, size)))
