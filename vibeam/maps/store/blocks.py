"""Files of blocks: each is written whole or not at all, and sealed as the numbers of that block."""

from __future__ import annotations

from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.sealed_files import read_sealed, write_sealed
from vibeam.maps.block import Block, Values
from vibeam.run.code import digest_of_code


def block_path(folder: Path, block: Block) -> Path:
    """File of a block."""
    return folder / f"{block.grid.fidelity}-{block.first:09d}.npz"


def write_block(folder: Path, block: Block, key: str, values: Values) -> None:
    """Write a block's file; OSError."""
    content = BytesIO()
    arrays: dict[str, Any] = {**values}
    np.savez(content, allow_pickle=False, **arrays)
    write_sealed(block_path(folder, block), content.getvalue(), _identity(block, key))


def read_block(folder: Path, block: Block, key: str) -> Values | None:
    """Values of a block; None where it has no file, or one that is damaged or of another grid or code."""
    try:
        content = read_sealed(block_path(folder, block), _identity(block, key))
    except OSError:
        return None
    if content is None:
        return None
    with np.load(BytesIO(content), allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def _identity(block: Block, key: str) -> str:
    """What a block is of: the grid with that key, its lines or points, the code."""
    points = b"" if block.points is None else np.ascontiguousarray(block.points).tobytes()
    return f"{key} {block.first} {block.last} {sha256(points).hexdigest()} {digest_of_code()}"
