"""Blocks of results under way: files, each whole or not at all."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.whole_files import read_sealed, write_sealed
from vibeam.store.errors import ROOM, writing

Values = dict[str, NDArray[Any]]
MANIFEST = "manifest"


def write_block(path: Path, file: Path, of: str, values: Values) -> None:
    """Write the arrays of a block, sealed as what it is ``of``; StoreError, naming ``path``, where the disk fails."""
    with writing(path, ROOM):
        file.parent.mkdir(exist_ok=True)
        write_sealed(file, packed(values), of)


def read_block(file: Path, of: str) -> Values | None:
    """Arrays of a block; None where it has no file, or one that is damaged or of something else."""
    try:
        content = read_sealed(file, of)
    except OSError:
        return None
    return None if content is None else unpacked(content)


def packed(values: Values) -> bytes:
    """Arrays by name as the bytes of a .npz file."""
    content = BytesIO()
    arrays: dict[str, Any] = {**values}
    np.savez(content, **dict(arrays))
    return content.getvalue()


def unpacked(content: bytes) -> Values:
    """Arrays of what ``packed`` has made."""
    with np.load(BytesIO(content), allow_pickle=False) as arrays:
        return {name: arrays[name] for name in arrays.files}


def discard(folder: Path) -> None:
    """Delete all blocks, the manifest last, so that what is left is known for what it is; files of others stay."""
    if folder.is_dir():
        for pattern in ("*.npz", "*.steps", ".*.part", ".*.lock"):
            for file in sorted(folder.glob(pattern)):
                file.unlink(missing_ok=True)
        (folder / MANIFEST).unlink(missing_ok=True)
        if not any(folder.iterdir()):
            folder.rmdir()
