"""What every kind of scene says of itself."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from math import nan
from typing import TYPE_CHECKING, Any

from vibeam_models.base import Base
from vibeam_models.stop import Stop

if TYPE_CHECKING:
    from vibeam_models.effects import Effect
    from vibeam_models.effects.platform import Platform, Shaker
    from vibeam_models.outputs import Output
    from vibeam_models.structure import Structure


class AnyScene(ABC):
    """What every kind of scene says of itself, so that nobody need ask which kind it is."""

    stop: Stop | None
    outputs: tuple[Output, ...] = ()

    @property
    def harmonics(self) -> tuple[tuple[int, float, float], ...]:
        """Order, share and phase of every further harmonic of the drive, as ``Base.harmonics``."""
        rig: Any = self
        found: tuple[tuple[int, float, float], ...] = rig.base.harmonics
        return found

    @property
    @abstractmethod
    def held(self) -> tuple[str, float]:
        """Whose coefficient of restitution the scene gives (empty: there is one mode alone), and its value."""

    @abstractmethod
    def structure(self) -> Structure:
        """The structure on a base held still; ValueError where it is impossible."""

    @property
    def natural_unit(self) -> float | None:
        """Frequency in rad/s that a scene without dimensions counts by; None: it has SI units."""
        return None

    @property
    def given_mode(self) -> tuple[float, float] | None:
        """ω (rad/s) and ζ of the one mode that the scene is; None: its structure is reduced as a fidelity asks."""
        return None

    @property
    def no_beam(self) -> str:
        """Why there is no beam to speak of, as the end of a sentence; empty where there is one."""
        return ""

    @property
    def bulk(self) -> tuple[tuple[float, ...], float, float]:
        """Lengths of the beam in m, its length first; its mass and the moving mass in kg. Empty, NaN: not known."""
        return (), nan, nan

    def named(self, name: str) -> tuple[Any, ...]:
        """The effects of a name, in their order; empty where there is none."""
        return ()

    def without(self, *names: str) -> Any:
        """The scene less the effects of these names."""
        return self

    @property
    def platform(self) -> Platform | None:
        """Platform under clamp and stop; None: the base motion is prescribed."""
        return next(iter(self.named("platform")), None)

    @property
    def shaker(self) -> Shaker | None:
        """The exciter on the platform; None: the force is prescribed."""
        return next(iter(self.named("shaker")), None)


class RigScene(AnyScene):
    """A scene in SI units with a stop and effects, which is reduced as a fidelity asks."""

    stop: Stop
    base: Base
    effects: tuple[Effect, ...]

    @property
    def held(self) -> tuple[str, float]:
        """As ``AnyScene.held``."""
        return self.stop.restitution_of, self.stop.usual_restitution

    @property
    @abstractmethod
    def moving_mass(self) -> float:
        """Mass carried by the base in kg."""

    @property
    def all_modes(self) -> bool:
        """Test whether the structure has all of the modes that its contact moves, and not a few that are known."""
        return True

    @abstractmethod
    def structural(self) -> Any:
        """The scene less what its structure does not depend on: equal ones have the same structure."""

    def named(self, name: str) -> tuple[Any, ...]:
        """As ``AnyScene.named``."""
        return tuple(effect for effect in self.effects if effect.name == name)

    def without(self, *names: str) -> Any:
        """As ``AnyScene.without``."""
        made: Any = self
        return replace(made, effects=tuple(effect for effect in self.effects if effect.name not in names))
