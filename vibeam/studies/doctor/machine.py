"""Findings of the check of an installation: versions of all packages, processor, environment, folders for caches."""

from __future__ import annotations

import os
import platform
import re
import sys
import tempfile
from collections.abc import Iterable, Iterator
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
LEAST_PYTHON = (3, 11)

#: names of modules that are not those of their packages
MODULES = {"scikit-fem": "skfem", "tomli-w": "tomli_w"}

#: extras that a user has a use for, and that
EXTRAS = {"jit": "compiles kernels where there is no library of them", "lab": "reads universal files"}
ENTRY = re.compile(r"([\w.-]+)(?:\[[^\]]*\])?\s*(?:>=\s*([\w.]+))?")
WANTED_BY = re.compile(r"extra\s*==\s*['\"]([^'\"]+)")


@dataclass(frozen=True)
class Requirement:
    """Package that is required in version ``least`` or higher (empty: any), ``extra``: by that alone."""

    name: str
    least: str
    extra: str = ""


def packages() -> Iterator[Finding]:
    """Findings about Python, vibeam and all requirements."""
    new = sys.version_info >= LEAST_PYTHON
    least = ".".join(map(str, LEAST_PYTHON))
    state, cure = (Severity.GOOD, "") if new else (Severity.FAULT, f"install {least} or higher")
    yield Finding(TOPIC, "Python", state, f"{platform.python_version()} ({sys.executable})", cure)
    yield _own()
    yield from (package(each) for each in requirements() if not each.extra or each.extra in EXTRAS)


def _own() -> Finding:
    place, running = Path(__file__).parents[2], str(vars(sys.modules["vibeam"])["__version__"])
    try:
        installed = version("vibeam")
    except PackageNotFoundError:
        return Finding(TOPIC, "vibeam", Severity.NOTE, f"{running} in {place}, run from its sources", "")
    if installed != running:
        said = f"{running} in {place} hides the installed {installed}"
        return Finding(TOPIC, "vibeam", Severity.FAULT, said, "start in another folder, or unset PYTHONPATH")
    return Finding(TOPIC, "vibeam", Severity.GOOD, f"{installed} in {place}")


def requirements() -> list[Requirement]:
    """Requirements by the installed metadata, or by pyproject.toml in a checkout; none where there is neither."""
    try:
        return once(map(parsed, distribution("vibeam").requires or ()))
    except PackageNotFoundError:
        return once(_of_checkout(Path(__file__).parents[3] / "pyproject.toml"))


def once(found: Iterable[Requirement]) -> list[Requirement]:
    """Each package once, by the first extra that wants it; the tests' extra, which takes others in, comes last."""
    kept: dict[str, Requirement] = {}
    for each in found:
        if each.name not in kept or kept[each.name].extra == "test":
            kept[each.name] = each
    return list(kept.values())


def _of_checkout(path: Path) -> list[Requirement]:
    import tomllib

    try:
        project = tomllib.loads(path.read_text(encoding="utf-8"))["project"]
    except (OSError, KeyError, ValueError):
        return []
    extras = project.get("optional-dependencies", {})
    return [
        *map(parsed, project["dependencies"]),
        *(parsed(f'{entry}; extra == "{extra}"') for extra, entries in extras.items() for entry in entries),
    ]


def parsed(entry: str) -> Requirement:
    """Requirement of one entry, as ``scipy>=1.15`` or ``numba>=0.60; extra == "jit"``."""
    what, _, condition = entry.partition(";")
    found, extra = ENTRY.match(what.strip()), WANTED_BY.search(condition)
    assert found is not None
    return Requirement(found[1].lower(), found[2] or "", extra[1] if extra else "")


def package(wanted: Requirement) -> Finding:
    """Finding about a package: its version, and that it can be imported; one of an extra may be absent."""
    installed = _version(wanted.name)
    if installed is not None:
        return _imported(wanted, installed) or _judged(wanted, installed)
    if not wanted.extra:
        return Finding(TOPIC, wanted.name, Severity.FAULT, "not installed", f"pip install '{_as_pip(wanted)}'")
    said = f"not installed ({EXTRAS[wanted.extra]})"
    return Finding(TOPIC, wanted.name, Severity.ABSENT, said, f"to have it: pip install 'vibeam[{wanted.extra}]'")


def _imported(wanted: Requirement, installed: str) -> Finding | None:
    """A fault where the import fails, whatever with: a missing system library, a package for another numpy."""
    try:
        import_module(MODULES.get(wanted.name, wanted.name.replace("-", "_")))
    except Exception as fault:
        said = f"{installed} cannot be imported: {type(fault).__name__}: {str(fault).partition(chr(10))[0]}"
        cure = f"pip install --force-reinstall '{_as_pip(wanted)}'"
        return Finding(TOPIC, wanted.name, Severity.FAULT, said, cure)
    return None


def _judged(wanted: Requirement, installed: str) -> Finding:
    if numbers(installed) < numbers(wanted.least):
        cure = f"pip install --upgrade '{_as_pip(wanted)}'"
        return Finding(TOPIC, wanted.name, Severity.FAULT, f"{installed} is older than {wanted.least}", cure)
    return Finding(TOPIC, wanted.name, Severity.GOOD, installed)


def numbers(written: str) -> tuple[int, ...]:
    """Numbers of a release, (1, 15, 0) of ``1.15.0rc1``, without zeros at its end."""
    release = re.match(r"\d+(?:\.\d+)*", written)
    found = [int(each) for each in release[0].split(".")] if release else []
    while found and found[-1] == 0:
        found.pop()
    return tuple(found)


def _as_pip(wanted: Requirement) -> str:
    return f"{wanted.name}>={wanted.least}" if wanted.least else wanted.name


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
