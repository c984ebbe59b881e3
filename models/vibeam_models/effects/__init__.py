"""Optional effects, one a file, each imported only where a scene names it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from vibeam_models.space import BeamSpace
    from vibeam_models.structure import Structure


class Effect(Protocol):
    """Declared data and one function: the structure with the effect, and the space that its coordinates belong to."""

    def apply(self, structure: Structure, space: BeamSpace) -> tuple[Structure, BeamSpace]:
        """The structure and its space with this effect in them."""
        ...
