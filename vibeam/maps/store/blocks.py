"""Files of blocks: each is written whole or not at all, and says by a digest whether it is."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Mapping
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.whole_files import write_whole
from vibeam.maps.block import Block, Values

DIGEST = "sha256"


def block_path(folder: Path, block: Block) -> Path:
    """File of a block."""
    return folder / f"{block.grid.fidelity}-{block.first:09d}.npz"


def write_block(folder: Path, block: Block, key: str, values: Values) -> None:
    """Write a block's file: under another name, synchronised, renamed, the folder synchronised; OSError."""
    content = BytesIO()
    arrays: dict[str, Any] = {DIGEST: np.array(digest_of(block, key, values)), **values}
    np.savez(content, allow_pickle=False, **arrays)
    write_whole(block_path(folder, block), content.getvalue())
    _synchronise(folder)


def read_block(folder: Path, block: Block, key: str) -> Values | None:
    """Values of a block; None where it has no file, or one that is damaged or of another grid."""
    try:
        with open(block_path(folder, block), "rb") as opened, np.load(opened, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    said = str(arrays.pop(DIGEST, ""))
    return arrays if said == digest_of(block, key, arrays) else None


def digest_of(block: Block, key: str, values: Mapping[str, NDArray[Any]]) -> str:
    """Digest of the values of a block of the grid with that key."""
    found = sha256(f"{key} {block.first} {block.last}".encode())
    if block.points is not None:
        found.update(np.ascontiguousarray(block.points).tobytes())
    for name in sorted(values):
        each = np.ascontiguousarray(values[name])
        found.update(f"{name} {each.dtype.str} {each.shape}".encode())
        found.update(each.tobytes())
    return found.hexdigest()


def _synchronise(folder: Path) -> None:
    """Bring a folder's names to disk, where that can be asked for."""
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:
        return
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
