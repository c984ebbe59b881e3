"""The libraries of one group of entry points: ``python -m vibeam.flight.ahead_of_time.group NAME FOLDER``.

A process of its own, since numba reads its settings (``__main__.SETTINGS``) when it is imported.
"""

from __future__ import annotations

import json
import lzma
import sys
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

from vibeam.flight.ahead_of_time import link
from vibeam.flight.ahead_of_time.emit import TARGETS, emitted
from vibeam.flight.ahead_of_time.modules import Compiled, compiled
from vibeam.flight.ahead_of_time.scenes import SCENES
from vibeam.flight.entries import ENTRIES
from vibeam.flight.kernels.sources import digest
from vibeam.flight.libraries.manifest import file_of
from vibeam.flight.libraries.sources import sources_of


def build(group: str, folder: Path) -> None:
    """Compile the group's entry points, write their libraries into ``folder`` and what they are into ``group.json``."""
    libraries, scenes = SCENES[group]
    entries = [each for each in ENTRIES if each.library in libraries]
    sources = {each.library: digest(sources_of(each.module)) for each in entries}  # before they are compiled
    for scene in scenes:
        scene()
    about = {}
    for library in libraries:
        parts = [compiled(each) for each in entries if each.library == library]
        about[library] = {"sources": sources[library]} | _written(library, parts, folder)
    (folder / f"{group}.json").write_text(json.dumps(about), encoding="utf-8")


def _written(library: str, parts: Sequence[Compiled], folder: Path) -> dict[str, Any]:
    """Write a library for every level; its part of the manifest."""
    levels = {}
    for level in TARGETS:
        content, path = link.linked(emitted(library, parts, level), level), file_of(library, level, folder)
        path.parent.mkdir(exist_ok=True)
        packed = lzma.compress(content, preset=9 | lzma.PRESET_EXTREME)
        path.write_bytes(packed)
        levels[level] = sha256(packed).hexdigest()
    entries = {part.entry.name: {"arguments": part.arguments, "results": part.results} for part in parts}
    return {"entries": entries, "levels": levels}


if __name__ == "__main__":
    build(sys.argv[1], Path(sys.argv[2]))
