"""A scene whose structure is given, by matrices or modes of the user's own, in place of a beam."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import nan
from typing import Any

from vibeam_models.base import Base
from vibeam_models.beam import structure_of
from vibeam_models.beams.beam import Damping
from vibeam_models.damping import damped
from vibeam_models.scene import Effect, RigScene
from vibeam_models.stop import Stop
from vibeam_models.structure import Structure


@dataclass(frozen=True)
class GivenStructure:
    """A structure from elsewhere: ``digest`` stands for its content, by which two of them are compared.

    ``made``: the structure, or what makes it. ``damping``: by modal ratios, None where C has it. ``carried``: mass in
    kg that a base would move with it, None where that is not known. ``kind``: ``"matrices"``, ``"modes"`` or another.
    ``assumed``, ``spatial``: as of a scene; of a spatial one ``body`` makes the body.
    """

    digest: str
    kind: str
    made: Structure | Callable[[], Structure] = field(compare=False, repr=False)
    damping: Damping | None = field(default=None, compare=False)
    carried: float | None = field(default=None, compare=False)
    assumed: tuple[str, ...] = field(default=(), compare=False)
    spatial: str = field(default="", compare=False)
    body: Callable[[], Any] | None = field(default=None, compare=False, repr=False)

    @property
    def structure(self) -> Structure:
        """The structure itself, which a mesh assembles where it is first asked for."""
        return self.made() if callable(self.made) else self.made


@dataclass(frozen=True)
class GivenScene(RigScene):
    """A given structure at a stop, on a shaken base or under a force, with the effects on its base."""

    given: GivenStructure
    stop: Stop
    base: Base
    effects: tuple[Effect, ...] = ()

    @property
    def no_beam(self) -> str:
        """As ``AnyScene.no_beam``."""
        given = "a mesh" if self.spatial else self.given.kind
        return f"this case gives {given} in place of a beam, there is no beam"

    @property
    def all_modes(self) -> bool:
        """As ``RigScene.all_modes``."""
        return self.given.kind != "modes"

    @property
    def spatial(self) -> str:
        """As ``AnyScene.spatial``."""
        return self.given.spatial

    @property
    def assumed(self) -> tuple[str, ...]:
        """As ``AnyScene.assumed``."""
        return self.given.assumed

    def structural(self) -> GivenScene:
        """As ``RigScene.structural``: the given structure alone."""
        return replace(self, stop=Stop(0.0, 0.0), base=Base(), effects=())

    @property
    def bulk(self) -> tuple[tuple[float, ...], float, float]:
        """As ``AnyScene.bulk``."""
        return (), nan, nan if self.given.carried is None else self.given.carried

    @property
    def moving_mass(self) -> float:
        """As ``RigScene.moving_mass``; ValueError where it is not known."""
        if self.given.carried is None:
            raise ValueError("platform: the mass that it carries is not known: write moving_mass")
        return self.given.carried


@structure_of.register
def _(scene: GivenScene) -> Structure:
    """The given structure with its damping."""
    bare, damping = scene.given.structure, scene.given.damping
    return bare if damping is None else damped(bare, damping)
