"""Blocks of results under way: files, each whole or not at all, and a manifest where no file says what they are of."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.whole_files import read_sealed, write_sealed
from vibeam.store.errors import ANEW, ELSEWHERE, ROOM, StoreError, unwritable

Values = dict[str, NDArray[Any]]


def block_path(folder: Path, name: str, first: int) -> Path:
    """File of the block of ``name`` that begins with the point or line ``first``."""
    return folder / f"{name}-{first:09d}.npz"


def write_block(path: Path, file: Path, of: str, values: Values) -> None:
    """Write the arrays of a block, sealed as what it is ``of``; StoreError, naming ``path``, where the disk fails."""
    content = BytesIO()
    arrays: dict[str, Any] = {**values}
    np.savez(content, **dict(arrays))
    try:
        file.parent.mkdir(exist_ok=True)
        write_sealed(file, content.getvalue(), of)
    except OSError as fault:
        raise unwritable(path, fault, ROOM) from None


def read_block(file: Path, of: str) -> Values | None:
    """Arrays of a block; None where it has no file, or one that is damaged or of something else."""
    try:
        content = read_sealed(file, of)
    except OSError:
        return None
    if content is None:
        return None
    with np.load(BytesIO(content), allow_pickle=False) as arrays:
        return {name: arrays[name] for name in arrays.files}


def discard(folder: Path) -> None:
    """Delete all blocks, the manifest last, so that what is left is known for what it is; files of others stay."""
    if folder.is_dir():
        for file in sorted(folder.glob("*.npz")) + sorted(folder.glob(".*.part")):
            file.unlink()
        (folder / MANIFEST).unlink(missing_ok=True)
        if not any(folder.iterdir()):
            folder.rmdir()


MANIFEST = "manifest"


@dataclass(frozen=True)
class Manifest:
    """Keys of the grids by fidelity, lines of a block of each, digest of the code (empty: not known)."""

    keys: Mapping[str, str]
    sizes: Mapping[str, int]
    code: str


def known_manifest(folder: Path) -> Manifest | None:
    """The manifest in ``folder``; None where there is none, or a damaged one. OSError where it cannot be read."""
    file = folder / MANIFEST
    content = read_sealed(file) if file.exists() else None
    return None if content is None else Manifest(**json.loads(content))


def manifest(folder: Path, wanted: Manifest) -> Manifest:
    """The manifest in ``folder``, ``wanted`` where there is none or a damaged one: blocks say what they are of.

    StoreError where the blocks there are of another map or another version of the code, or the disk fails.
    """
    file = folder / MANIFEST
    try:
        folder.mkdir(exist_ok=True)
        found = known_manifest(folder)
        if found is None:
            write_sealed(file, json.dumps(asdict(wanted), indent=1).encode())
            return wanted
    except OSError as fault:
        raise unwritable(folder, fault, ELSEWHERE) from None
    if found.keys != wanted.keys:
        raise StoreError(f"{folder}: holds blocks of another map, or of this one before its case changed: {ANEW}")
    if found.code != wanted.code:
        raise StoreError(f"{folder}: holds blocks that another version of vibeam computed: {ANEW}")
    return found
