"""NumPy's files: one array (.npy), several by name (.npz), or one of scipy's sparse arrays (.npz)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vibeam.exchange.matrices.declaration import chosen
from vibeam.exchange.matrices.entries import FileMatrix, FormatError

SPARSE = {"format", "shape", "data"}  # what scipy.sparse.save_npz writes in every file


def read(path: Path, name: str, wanted: str) -> FileMatrix:
    """The array of a file, or the one by that name; objects of Python's are none."""
    return FileMatrix(_npz(path, name, wanted) if path.suffix.lower() == ".npz" else _npy(path, name))


def _npy(path: Path, name: str) -> object:
    if name:
        raise FormatError(f"holds one array without a name: leave name = {name!r} away")
    return numbers(np.load(path, allow_pickle=False))


def _npz(path: Path, name: str, wanted: str) -> object:
    with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
        if not set(file.files) >= SPARSE:
            return numbers(file[chosen(list(file.files), name, wanted)])
    from scipy.sparse import csc_array, load_npz

    return csc_array(load_npz(path)).astype(float)


def numbers(array: np.ndarray) -> np.ndarray:
    """The array as floats; FormatError where it holds anything else."""
    if array.dtype.kind not in "fiu":
        raise FormatError(f"holds {array.dtype} in place of real numbers")
    return array.astype(float)
