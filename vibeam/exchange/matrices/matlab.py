"""MATLAB's files up to version 7, by scipy; those of version 7.3 are HDF5."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.matrices.declaration import chosen
from vibeam.exchange.matrices.entries import FileMatrix
from vibeam.exchange.matrices.numpy_files import numbers


def read(path: Path, name: str, wanted: str) -> FileMatrix:
    """The variable by that name, full or sparse."""
    from scipy.io import loadmat
    from scipy.sparse import csc_array

    held = {key: value for key, value in loadmat(path).items() if not key.startswith("__")}
    found: Any = held[chosen(list(held), name, wanted)]
    if isinstance(found, np.ndarray):
        return FileMatrix(numbers(found))
    return FileMatrix(csc_array(found).astype(float))
