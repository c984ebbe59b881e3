"""Provenance of a file: what computed its numbers, and what continued it."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version
from time import gmtime, strftime
from typing import TYPE_CHECKING

import numpy as np

from vibeam.flight.engine.entries import origin

if TYPE_CHECKING:
    import h5py


SESSIONS, NOTE = 32, 240  # room for this number of notes, of this number of bytes, on runs that continued the file


def provenance() -> dict[str, str]:
    """Versions of vibeam, numpy, numba and Python, where the compiled kernels come from, platform, time (UTC)."""
    versions = {"vibeam": _version("vibeam"), "numpy": np.__version__, "numba": _version("numba"), "kernels": origin()}
    machine = {"python": platform.python_version(), "platform": platform.platform()}
    return versions | machine | {"time": strftime("%Y-%m-%dT%H:%M:%SZ", gmtime())}


def write_provenance(group: h5py.Group) -> None:
    """Write the provenance into a new file, with room for later continuations."""
    group.attrs.update(provenance())
    group.create_dataset("continued", data=np.zeros(SESSIONS, dtype=f"S{NOTE}")).make_scale()


def note_continued(group: h5py.Group) -> None:
    """Note a continuation in the next free slot, or the last."""
    notes = group["continued"]
    slot = min(int(np.count_nonzero(notes[()] != b"")), len(notes) - 1)
    notes[slot] = ", ".join(f"{name} {value}" for name, value in provenance().items()).encode()[:NOTE]


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"
