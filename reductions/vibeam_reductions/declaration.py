"""Declaration of a reduction: its name in a case file, the function that makes it, whether it counts modes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from vibeam_models.registry import Registry
from vibeam_models.structure import Structure
from vibeam_reductions.projection import Reduction


@dataclass(frozen=True)
class ReductionDeclaration:
    """A reduction: ``home`` makes it of a structure and, where it ``counts``, of a fidelity's number of modes.

    ``home``: the function, or ``"module:function"``, imported when it is asked for. ``meaning``: in a few words, for
    the reference of keys.
    """

    name: str
    home: str | Callable[..., Reduction]
    meaning: str
    counts: bool = False

    def make(self, structure: Structure, modes: int | None) -> Reduction:
        """The reduction of ``structure``; ValueError for more modes than it has."""
        made: Reduction = _function(self.home)(structure, *([modes] if self.counts else []))
        return made


def _function(home: str | Callable[..., Reduction]) -> Callable[..., Any]:
    if not isinstance(home, str):
        return home
    module, name = home.split(":")
    return getattr(import_module(module), name)  # type: ignore[no-any-return]


REDUCTIONS = Registry(
    "reduction",
    ReductionDeclaration("static_mode", "vibeam_reductions.static_mode:static_mode", "the static deflection alone"),
    ReductionDeclaration("modal", "vibeam_reductions.modal:modal", "so many modes", counts=True),
    ReductionDeclaration("full", "vibeam_reductions.modal:full", "all of the finite elements"),
)


def register_reduction(declaration: ReductionDeclaration) -> None:
    """Let case files name a further reduction; ValueError where the name is taken."""
    REDUCTIONS.add(declaration)
