"""Findings of the check of an installation: versions of Python, of vibeam and of all packages that it needs."""

from __future__ import annotations

import platform
import re
import sys
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


TOPIC = "packages"

#: names of modules that are not those of their packages
MODULES = {"scikit-fem": "skfem"}

#: extras that a user has a use for, and that
EXTRAS = {"jit": "compiles kernels where there is no library of them", "lab": "reads universal files, TDMS"}

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
