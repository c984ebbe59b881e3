"""Reading of a mesh, by the extension that brings solids: the name under which other programs import it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from vibeam.exchange.files import FormatError
from vibeam_models.extensions import brought


def read_mesh(path: Path) -> Any:
    """The mesh of a file; FormatError where none can be read of it, or nothing here reads meshes."""
    for _, read in brought("reader of meshes"):
        return read.load()(path)
    raise FormatError("is a mesh, and no extension that reads meshes is registered: install vibeam again")
