"""What the libraries in this folder are: ``manifest.json``, written by ``vibeam.flight.ahead_of_time``."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent

LEVELS = ("x86-64-v3", "x86-64-v2", "aarch64")


def file_of(library: str, level: str, folder: Path = FOLDER) -> Path:
    """The compressed library."""
    return folder / level / f"{library}.xz"


@cache
def manifest(folder: Path = FOLDER) -> dict[str, Any]:
    """{library: {sources, entries {name: {arguments, results}}, levels {level: SHA-256}}}, and ``made_with``.

    ``arguments``: ``f8:2`` an array of doubles with two axes, ``i8:1`` one of int64, ``d`` and ``q`` numbers, a list a
    tuple of these. ``results``: numbers.
    """
    path = folder / "manifest.json"
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {"libraries": {}}
    return found
