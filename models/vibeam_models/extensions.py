"""Extensions: packages found by entry point, which bring declarations to the registries.

An entry point of the group ``vibeam.extensions`` names an ``Extension`` in a module that is cheap to import, for every
command imports it. What it brings is named by text, and imported where a registry of that kind is first read.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any

OWN = "vibeam"  # package whose extensions come with it
GROUP = f"{OWN}.extensions"
#: kinds of declarations, as the registries call them
KINDS = (
    "effect", "contact law", "reduction", "solver", "model", "kind of case", "kind of figure", "plan of a study",
    "study", "stage of a verdict", "command", "section of a page", "format of matrices",
    "reader of meshes",
)  # fmt: skip
#: what the extensions of this package bring, by the names that cases, commands and programs have: of one that is absent
OURS = {
    "dictionary": (
        "mode_share", "vibeam mode_share", "vibeam.mode_share", "vibeam.contact_terms", "vibeam.restitution_in",
    ),
    "explore": ("vibeam explore", "vibeam.explore"),
    "identification": (
        "vibeam fit FILE", "vibeam.identify_decay", "vibeam.identify_frequency_response", "vibeam.identify_response",
        "vibeam.identify_spectrum",
    ),
    "paper": (
        "averaging", "mapping", "zhuravlev", "ivanov", "coordinates", "boundaries", "least_stable_reach", "largest_gap",
        "physical_jump", "unfolded_jump",
    ),
    "solid": ("solid", "vibeam.SolidVerdict", "vibeam.solid_verdict"),
}  # fmt: skip


class ExtensionError(Exception):
    """Extension that cannot be used: it is not registered, or its declarations are wrong."""


@dataclass(frozen=True)
class Extension:
    """Declarations that a package brings: for each kind (``KINDS``) the ``"module:NAME"`` of a tuple of them.

    ``replaces``: names of vibeam's own commands in whose place those of the extension stand. ValueError for an unknown
    kind.

    >>> from vibeam_models.extensions import Extension
    >>> Extension({"solver": "mine.solvers:SOLVERS"}).brings["solver"]
    'mine.solvers:SOLVERS'
    """

    brings: Mapping[str, str]
    replaces: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if unknown := [kind for kind in self.brings if kind not in KINDS]:
            raise ValueError(f"brings {', '.join(unknown)}: what can be brought is {', '.join(KINDS)}")


@dataclass(frozen=True)
class ExtensionPoint:
    """Entry point of an extension: its ``name``, the ``place`` of its declaration, the ``package`` that has it."""

    name: str
    place: str
    package: str

    def extension(self) -> Extension:
        """Declaration that it names; ExtensionError where that cannot be loaded."""
        found: Extension = self._loaded(self.place)
        return found

    def brought(self, kind: str) -> tuple[Any, ...]:
        """Declarations of a kind; ExtensionError where they cannot be loaded."""
        place = self.extension().brings.get(kind)
        return tuple(self._loaded(place)) if place else ()

    def _loaded(self, place: str) -> Any:
        module, _, name = place.partition(":")
        try:
            return getattr(import_module(module), name)
        except Exception as error:
            said = f"extension {self.name!r} of the package {self.package!r}: {place} cannot be loaded: {error}"
            raise ExtensionError(f"{said}; install {self.package} again, or uninstall it") from error


@cache
def entry_points() -> tuple[ExtensionPoint, ...]:
    """Entry points of all extensions, of every package those that come first on the path.

    ``importlib.metadata`` finds the same; its import alone takes 40 ms, reading the files 2 ms.
    """
    found: dict[str, list[ExtensionPoint]] = {}
    for folder in dict.fromkeys(sys.path):
        for name in _listed(folder):
            package = name.partition("-")[0].lower().replace("_", "-").replace(".", "-")
            if name.endswith((".dist-info", ".egg-info")) and package not in found:
                found[package] = list(_in_file(os.path.join(folder, name, "entry_points.txt"), package))
    return tuple(each for points in found.values() for each in points)


def _listed(folder: str) -> list[str]:
    """Names in a folder; none where it is no folder."""
    try:
        return sorted(os.listdir(folder or "."))
    except OSError:
        return []


def _in_file(path: str, package: str) -> Iterator[ExtensionPoint]:
    """Entry points of the group in a package's file of entry points."""
    try:
        with open(path, encoding="utf-8") as file:
            lines = file.read().splitlines()
    except OSError:
        return
    section = ""
    for line in map(str.strip, lines):
        name, equal, place = map(str.strip, line.partition("="))
        if line.startswith("["):
            section = line.strip("[] ")
        elif section == GROUP and equal:
            yield ExtensionPoint(name, place, package)


def brought(kind: str) -> Iterator[tuple[ExtensionPoint, Any]]:
    """Declarations of a kind that extensions bring, each with the entry point of its extension."""
    for point in entry_points():
        for each in point.brought(kind):
            yield point, each


def no_such_name(package: str, name: str, known: Iterable[str]) -> str:
    """Sentence on a public name that a package does not have: what is meant, or which absent extension brings it."""
    from difflib import get_close_matches

    near = [f"did you mean {each!r}?" for each in get_close_matches(name, known, 1)]
    meant = [f"; {each}" for each in (absent(f"{package}.{name}"), *near) if each]
    return f"{package} has no name {name!r}{''.join(meant[:1])}"


def absent(name: str) -> str:
    """Sentence on a name that an extension of this package brings which is not registered; else empty."""
    extension = next((each for each, names in OURS.items() if name in names), "")
    if not extension or any(each.name == extension and each.package == OWN for each in entry_points()):
        return ""
    return f"it comes with the extension {extension!r}, which is not registered: install vibeam again (pip install)"
