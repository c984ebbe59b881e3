"""Findings of the check of an installation; platform, processor, environment variables, folders for caches."""

from __future__ import annotations

import os
import platform
import shutil
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path


class Severity(StrEnum):
    """State of what was examined."""

    GOOD = "ok"
    FAULT = "fault"
    ABSENT = "absent"  # optional, and not there
    NOTE = "note"  # works, and may be better
    FACT = "fact"  # nothing to judge


@dataclass(frozen=True)
class Finding:
    """Finding of ``name`` in a ``topic``; ``cure``: what helps, where something does."""

    topic: str
    name: str
    state: Severity
    value: str
    cure: str = ""

    def __str__(self) -> str:
        """As one line."""
        head = {Severity.FAULT: "FAULT", Severity.FACT: ""}.get(self.state, self.state.value)
        said = f"{head:6}  {self.name}: {self.value}"
        return f"{said}; {self.cure}" if self.cure else said


MACHINE, PLACES = "machine", "places"

#: of the kernels, threads of linear algebra, caches, what is imported
VARIABLES = (
    *("VIBEAM_KERNELS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"),
    *("NUMBA_CACHE_DIR", "MPLCONFIGDIR", "MPLBACKEND", "TMPDIR", "PYTHONPATH"),
)


def machine() -> Iterator[Finding]:
    """Findings about what the program runs on: facts, nothing to judge."""
    yield _fact("platform", platform.platform())
    yield _fact("processor", processor())
    yield _fact("cores", _cores())
    yield _fact("linear algebra", _linear_algebra())
    given = [f"{name}={os.environ[name]}" for name in VARIABLES if name in os.environ]
    yield _fact("environment", ", ".join(given) or "none of the variables that matter is set")


def _fact(name: str, value: str) -> Finding:
    return Finding(MACHINE, name, Severity.FACT, value)


def processor(cpuinfo: Path = Path("/proc/cpuinfo")) -> str:
    """Name of the processor, else its architecture."""
    try:
        lines = cpuinfo.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    named = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return f"{next(named, platform.processor() or 'unnamed')}, {platform.machine()}"


def _cores() -> str:
    from vibeam.runs.parallel import cores

    usable, there = cores(), os.cpu_count() or 1
    return f"{usable} usable" + (f" of {there}" if usable != there else "")


def _linear_algebra() -> str:
    import numpy as np

    try:
        built = np.show_config(mode="dicts")["Build Dependencies"]["blas"]
        return f"{built['name']} {built['version']}"
    except (KeyError, TypeError):
        return "not known"


def places() -> Iterator[Finding]:
    """Findings about folders that must be writable, and about ffmpeg."""
    yield _folder("temporary files", tempfile.gettempdir, Severity.FAULT, "set TMPDIR to a folder that is")
    yield _folder("matplotlib's cache", _of_matplotlib, Severity.NOTE, "set MPLCONFIGDIR to one: starts are quicker")
    yield _folder(
        "numba's cache", _of_numba, Severity.NOTE, "set NUMBA_CACHE_DIR to one, or kernels are compiled at each start"
    )
    found = shutil.which("ffmpeg")
    cure = "" if found else "if you need that: install it (apt install ffmpeg)"
    yield Finding(PLACES, "ffmpeg", Severity.GOOD if found else Severity.ABSENT, found or "not found (mp4 files)", cure)


def _of_matplotlib() -> str:
    import matplotlib as mpl

    return mpl.get_cachedir()


def _of_numba() -> str:
    """Folder of numba's cache: its variable, else beside the kernels."""
    return os.environ.get("NUMBA_CACHE_DIR") or str(Path(__file__).parents[2] / "flight" / "kernels")


def _folder(name: str, where: object, otherwise: Severity, cure: str) -> Finding:
    assert callable(where)
    try:
        folder = str(where())
        os.makedirs(folder, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return Finding(PLACES, name, Severity.GOOD, folder)
    except Exception as fault:
        return Finding(PLACES, name, otherwise, f"no folder that is writable: {fault}", cure)
