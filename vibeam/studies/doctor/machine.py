"""Findings of the check of an installation: versions of all packages, processor, environment, folders for caches."""

from __future__ import annotations

import os
import platform
import re
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from importlib import import_module
from importlib.metadata import PackageNotFoundError, distribution, version
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
    *("VIBEAM_CACHE", "NUMBA_CACHE_DIR", "MPLCONFIGDIR", "MPLBACKEND", "TMPDIR", "PYTHONPATH"),
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
    """Findings about folders that must be writable."""
    yield _folder("temporary files", tempfile.gettempdir, Severity.FAULT, "set TMPDIR to a folder that is")
    yield _folder("matplotlib's cache", _of_matplotlib, Severity.NOTE, "set MPLCONFIGDIR to one: starts are quicker")
    yield _folder(
        "numba's cache", _of_numba, Severity.NOTE, "set NUMBA_CACHE_DIR to one, or kernels are compiled at each start"
    )


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


TOPIC = "packages"

#: names of modules that are not those of their packages
MODULES = {"scikit-fem": "skfem"}

#: extras that a user has a use for, and that
EXTRAS = {"jit": "compiles kernels where there is no library of them", "lab": "reads universal files"}

#: a requirement in the metadata of the project: a name, its least version, the extra that wants it
_REQUIRED = re.compile(r"""([\w.-]+)>=([\d.]+)(?:; extra == ['"](\w+)['"])?""")


@dataclass(frozen=True)
class Requirement:
    """A package that is required from its version ``least`` on; ``extra``: by that extra alone."""

    name: str
    least: str
    extra: str = ""

    def __str__(self) -> str:
        """As pip takes it."""
        return f"{self.name}>={self.least}"

    def met_by(self, installed: str) -> bool:
        """Test whether a version is new enough, by the numbers that it begins with."""
        return _numbers(installed) >= _numbers(self.least)


def _numbers(version: str) -> list[int]:
    return [int(number) for number in re.findall(r"\d+", re.split(r"[^\d.]", version)[0])]


def packages() -> Iterator[Finding]:
    """Findings about Python, vibeam and all requirements."""
    yield Finding(TOPIC, "Python", Severity.GOOD, f"{platform.python_version()} ({sys.executable})")
    yield _own()
    yield from map(package, requirements())


def _own() -> Finding:
    place, running = Path(__file__).parents[2], str(vars(sys.modules["vibeam"])["__version__"])
    installed = _version("vibeam")
    if installed is None:
        return Finding(TOPIC, "vibeam", Severity.NOTE, f"{running} in {place}, run from its sources", "")
    if installed != running:
        said = f"{running} in {place} hides the installed {installed}"
        return Finding(TOPIC, "vibeam", Severity.FAULT, said, "start in another folder, or unset PYTHONPATH")
    return Finding(TOPIC, "vibeam", Severity.GOOD, f"{installed} in {place}")


def requirements() -> list[Requirement]:
    """Requirements by the installed metadata, of extras those of ``EXTRAS``; none where vibeam is not installed.

    One under another condition, as of numba where no library of kernels serves, is left to the check of what it is for.
    """
    try:
        found = map(_REQUIRED.fullmatch, distribution("vibeam").requires or ())
    except PackageNotFoundError:
        return []
    return [Requirement(*each.groups("")) for each in found if each and each[3] in (None, *EXTRAS)]


def package(wanted: Requirement) -> Finding:
    """Finding about a package: its version, and that it can be imported; one of an extra may be absent."""
    installed, extra = _version(wanted.name), wanted.extra
    if installed is not None:
        return _imported(wanted, installed) or _judged(wanted, installed)
    if not extra:
        return Finding(TOPIC, wanted.name, Severity.FAULT, "not installed", f"pip install '{wanted}'")
    said = f"not installed ({EXTRAS[extra]})"
    return Finding(TOPIC, wanted.name, Severity.ABSENT, said, f"to have it: pip install 'vibeam[{extra}]'")


def _imported(wanted: Requirement, installed: str) -> Finding | None:
    """A fault where the import fails, whatever with: a missing system library, a package for another numpy."""
    try:
        import_module(MODULES.get(wanted.name, wanted.name.replace("-", "_")))
    except Exception as fault:
        said = f"{installed} cannot be imported: {type(fault).__name__}: {str(fault).partition(chr(10))[0]}"
        cure = f"pip install --force-reinstall '{wanted}'"
        return Finding(TOPIC, wanted.name, Severity.FAULT, said, cure)
    return None


def _judged(wanted: Requirement, installed: str) -> Finding:
    if not wanted.met_by(installed):
        cure = f"pip install --upgrade '{wanted}'"
        return Finding(TOPIC, wanted.name, Severity.FAULT, f"{installed} is not >={wanted.least}", cure)
    return Finding(TOPIC, wanted.name, Severity.GOOD, installed)


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
