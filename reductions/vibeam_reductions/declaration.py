"""Declaration of a reduction: its name in a case file, the function that makes it, whether it counts modes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from vibeam_models.keys import Key
from vibeam_models.registry import Registry, loaded
from vibeam_models.structure import Structure
from vibeam_reductions.projection import Reduction

#: keys of a fidelity that a reduction may take
PARAMETERS: Mapping[str, Key] = {
    "boundary": Key(
        "of craig_bampton: contact, masses, outputs by name; absent = contact, masses, sensor", ["contact", "sensor"],
        text=True, several=True,
    ),
    "frequency": Key("of pod: of the drive of that motion", "15 Hz", "Hz", above=0),
    "periods": Key(
        "of pod: drive periods that are flown from rest, absent = 50", 50, whole=True, least=1, most=1_000_000
    ),
    "inner_product": Key("of pod: by which it measures, absent = mass", "mass", words=("mass", "energy")),
}  # fmt: skip


@dataclass(frozen=True)
class ReductionDeclaration:
    """A reduction: ``home`` makes it of a structure and, where it ``counts``, of a fidelity's number of modes.

    ``home``: the function, or ``"module:function"``, imported when it is asked for. ``meaning``: in a few words, for
    the reference of keys. ``takes``: those of ``PARAMETERS`` that it has, handed
    on by name where they are written; ``needs``: of these, the ones that must be.
    ``flown``: it is made of a flight of the full model, at "frequency" over "periods", which it gets as ``snapshots``.
    ``massless``: it leaves the contact without mass, so that the stop must be a linear spring.

    >>> import vibeam
    >>> def half(structure):
    ...     return vibeam.modal(structure, structure.size // 2)
    >>> vibeam.ReductionDeclaration("half", half, "half of all modes").counts  # a fidelity does not say how many
    False
    """

    name: str
    home: str | Callable[..., Reduction]
    meaning: str
    counts: bool = False
    takes: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    flown: bool = False
    massless: bool = False

    def make(self, structure: Structure, modes: int | None, **parameters: Any) -> Reduction:
        """The reduction of ``structure``; ValueError for more modes than it has."""
        made: Reduction = loaded(self.home)(structure, *([modes] if self.counts else []), **parameters)
        return made


def _counting(chapter: str, name: str, meaning: str, **more: Any) -> ReductionDeclaration:
    return ReductionDeclaration(name, f"vibeam_reductions.{chapter}:{name}", meaning, counts=True, **more)


REDUCTIONS = Registry(
    "reduction",
    ReductionDeclaration("static_mode", "vibeam_reductions.static_shapes:static_mode", "the static deflection alone"),
    _counting("modes", "modal", "so many modes"),
    ReductionDeclaration("full", "vibeam_reductions.modes:full", "all of the finite elements"),
    _counting("modes", "residual_flexibility", "modes, and the flexibility that they leave out at the contact"),
    _counting("modes", "massless_boundary", "the same without the mass of that flexibility", massless=True),
    _counting(
        "static_shapes", "craig_bampton", "modes with the boundary held, and its constraint modes", takes=("boundary",)
    ),
    _counting(
        "pod",
        "pod",
        "what a flight of the full model consists of",
        takes=("frequency", "periods", "inner_product"),
        needs=("frequency",),
        flown=True,
    ),
)


def register_reduction(declaration: ReductionDeclaration) -> None:
    """Let case files name a further reduction; ValueError where the name is taken.

    >>> import vibeam
    >>> def half(structure):
    ...     return vibeam.modal(structure, structure.size // 2)
    >>> vibeam.register_reduction(vibeam.ReductionDeclaration("half", half, "half of all modes"))
    >>> vibeam.load("cases/dtu_neutral.toml", {"fidelity.sdof.reduction": "half"}).system("sdof").size
    32
    """
    REDUCTIONS.add(declaration)
