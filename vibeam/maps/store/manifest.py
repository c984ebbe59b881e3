"""Manifest of the blocks of a map under way: what they are of, and how the lines are cut into them."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from vibeam.exchange.sealed_files import read_sealed, write_sealed
from vibeam.run.code import digest_of_code
from vibeam.run.store.errors import StoreError, unwritable

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
