"""MATLAB's files up to version 7, by scipy; those of version 7.3 are HDF5."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.files import require_room
from vibeam.exchange.mat import variables
from vibeam.exchange.matrices.declaration import chosen
from vibeam.exchange.matrices.entries import FileMatrix, compressed, numbers, scattered


def read(path: Path, name: str, wanted: str) -> FileMatrix:
    """The variable by that name, full or sparse."""
    held = {each.name: each for each in variables(path) if each.plain}
    found: Any = held[chosen(list(held), name, wanted)].read()
    if isinstance(found, np.ndarray):
        require_room(found.shape)
        return FileMatrix(numbers(found))
    if found.format == "coo":
        return FileMatrix(scattered(found.data, found.row, found.col, found.shape))
    return FileMatrix(compressed(found.data, found.indices, found.indptr, found.shape))
