"""Blocks of a map under way: files, each whole or not at all, and the manifest that says what they are blocks of."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.whole_files import read_sealed, write_sealed
from vibeam.maps.block import Block, Values
from vibeam.runs.keys import digest_of_code
from vibeam.runs.store.errors import StoreError, unwritable


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
    """What a block is of: the grid with that key, its lines, the code."""
    return f"{key} {block.first} {block.last} {digest_of_code()}"


NAME = "manifest"
ANEW = "choose another --out, or start over with --fresh"


@dataclass(frozen=True)
class Manifest:
    """Keys of the grids by fidelity, lines of a block of each, digest of the code (empty: not known)."""

    keys: Mapping[str, str]
    sizes: Mapping[str, int]
    code: str


def opened(folder: Path, keys: Mapping[str, str], sizes: Mapping[str, int]) -> Manifest:
    """The manifest in ``folder``, made where there is none, or a damaged one: blocks say themselves what they are of.

    StoreError where the blocks there are of another map or another version of the code, or the disk fails.
    """
    wanted = Manifest(dict(keys), dict(sizes), digest_of_code())
    path = folder / NAME
    try:
        folder.mkdir(exist_ok=True)
        content = read_sealed(path) if path.exists() else None
        if content is None:
            write_sealed(path, json.dumps(asdict(wanted), indent=1).encode())
            return wanted
    except OSError as fault:
        raise unwritable(folder, fault, "choose another --out") from None
    found = Manifest(**json.loads(content))
    if found.keys != wanted.keys:
        raise StoreError(f"{folder}: holds blocks of another map, or of this one before its case changed: {ANEW}")
    if found.code != wanted.code:
        raise StoreError(f"{folder}: holds blocks that another version of vibeam computed: {ANEW}")
    return found


def discard(folder: Path) -> None:
    """Delete the blocks of a map, the manifest last, so that what is left is known for what it is."""
    if folder.is_dir():
        for file in sorted(folder.glob("*.npz")) + sorted(folder.glob(".*.part")):
            file.unlink()
        (folder / NAME).unlink(missing_ok=True)
        shutil.rmtree(folder)
