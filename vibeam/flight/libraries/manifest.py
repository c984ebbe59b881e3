"""What the libraries in this folder are: ``manifest.json``, written by ``vibeam.flight.ahead_of_time``."""

from __future__ import annotations

import json
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from vibeam.flight.libraries.errors import LibraryUnavailable

FOLDER = Path(__file__).parent
NAME = "manifest.json"
LEVELS = ("x86-64-v3", "x86-64-v2", "aarch64")


def file_of(library: str, level: str, folder: Path = FOLDER) -> Path:
    """The compressed library."""
    return folder / level / f"{library}.xz"


@cache
def manifest(folder: Path = FOLDER) -> dict[str, Any]:
    """{library: {sources, entries {name: {arguments, results}}, levels {level: SHA-256 of its file}}}, ``made_with``.

    LibraryUnavailable for a damaged one.
    ``arguments``: ``f8:2`` an array of doubles with two axes, ``i8:1`` one of int64, ``d`` and ``q`` numbers, a list a
    tuple of these. ``results``: numbers.
    """
    path = folder / NAME
    if not path.exists():
        return {"libraries": {}}
    try:
        found: dict[str, Any] = json.loads(path.read_bytes())
        if found.pop("sha256") == _digest(found):
            return found
        fault = "its digest does not fit"
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        fault = f"{type(error).__name__}: {error}"
    raise LibraryUnavailable(f"the list of compiled kernels, {path}, is damaged ({fault}): install vibeam again")


def write_manifest(folder: Path, made_with: dict[str, str], libraries: dict[str, Any]) -> None:
    """Write the manifest, with a digest of itself."""
    whole = {"made_with": made_with, "libraries": dict(sorted(libraries.items()))}
    (folder / NAME).write_text(json.dumps(whole | {"sha256": _digest(whole)}, indent=1) + "\n", encoding="utf-8")


def _digest(whole: dict[str, Any]) -> str:
    return sha256(json.dumps(whole, sort_keys=True).encode()).hexdigest()
