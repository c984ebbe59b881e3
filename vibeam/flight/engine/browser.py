"""Libraries of compiled kernels for web pages: their bytes, and the table of slots by which JavaScript calls them.

A page makes one memory of ``FIRST`` bytes and gives it to all of them; each has its constants and its stack in a place
of its own below ``FIRST``, the page's arrays begin there. No numba is needed for any of this.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from typing import Any

from vibeam.flight.engine.entries import ENTRIES
from vibeam.flight.engine.loading import (
    FOLDER,
    WASM,
    KernelsUnavailable,
    LibraryUnavailable,
    level_of,
    manifest,
    packed_of,
)

LIBRARIES = {  # what pages call of each library
    "tables": ("tabulate",), "flight": ("move", "poses_at"), "points": ("run",), "regimes": ("move", "poses_at"),
}  # fmt: skip
SLOT = 1 << 20  # bytes of memory for the constants and the stack of one library
FIRST = 8 * SLOT  # the first byte that belongs to the page
LAYOUTS = {
    "layout": "vibeam.flight.kernels.layout",
    "lanes": "vibeam.flight.kernels.lanes.layout",
    "points": "vibeam.flight.points.kernels.layout",
    "regimes": "vibeam.flight.kernels.regimes.layout",
}


def place_of(library: str) -> int:
    """The first byte of memory that belongs to a library; those below the first one's belong to none."""
    return SLOT * (1 + tuple(LIBRARIES).index(library))


def browser_libraries(names: Iterable[str], folder: Path = FOLDER) -> dict[str, str]:
    """{library: base64 of its gzipped module}; KernelsUnavailable where one is missing, damaged or stale."""
    found = {}
    for library in names:
        try:
            for each in ENTRIES:
                if each.library == library and each.name in LIBRARIES[library]:
                    level_of(library, each.module, each.name, WASM, folder)
            found[library] = b64encode(packed_of(library, WASM, folder)).decode()
        except LibraryUnavailable as reason:
            raise KernelsUnavailable(f"a page cannot carry the engine: {reason}") from None
    return found


def slots_table(names: Iterable[str]) -> dict[str, Any]:
    """``entries`` {library.entry: {arguments, results}}, ``rows`` {layout: {name: row}}, ``first`` byte of the page.

    An argument is [name, kind], a kind as the manifest's, of a tuple {tuple: its class, fields: [[name, kind], …]}.
    """
    libraries = manifest()["libraries"]
    entries = {
        f"{library}.{name}": _described(libraries[library]["entries"][name])
        for library in names
        for name in LIBRARIES[library]
    }
    return {"entries": entries, "rows": {name: _rows(module) for name, module in LAYOUTS.items()}, "first": FIRST}


def _described(entry: dict[str, Any]) -> dict[str, Any]:
    arguments = [_named(*each) for each in zip(entry["names"], entry["arguments"], strict=True)]
    return {"arguments": arguments, "results": entry["results"]}


def _named(name: Any, kind: Any) -> list[Any]:
    if isinstance(kind, str):
        return [name, kind]
    own, class_name, *fields = name
    return [own, {"tuple": class_name, "fields": [_named(*each) for each in zip(fields, kind, strict=True)]}]


def _rows(module: str) -> dict[str, float]:
    """Every number among the constants of a layout's module."""
    return {name: value for name, value in vars(import_module(module)).items() if name.isupper()}
