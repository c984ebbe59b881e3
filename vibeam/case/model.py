"""Model of one fidelity as a function of the case's keys: its scene, its impact system and its drive."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Self

from vibeam.case.fidelity import Fidelity, system

if TYPE_CHECKING:
    from vibeam.system.impact_system import ImpactSystem
    from vibeam_models.arrays import Array
    from vibeam_models.scene import AnyScene


class Model(ABC):
    """Model of one fidelity of a case; ``at`` gives it with other values of keys."""

    @abstractmethod
    def at(self, values: Mapping[str, float]) -> Self:
        """Model with keys at other values, SI; they win over what the fidelity sets, not over what it leaves out.

        CaseError for a key that the case cannot have, or a value that it may not have by itself.
        """

    @abstractmethod
    def checked(self) -> Self:
        """The same model; CaseError where the rules between the keys of the rig refuse it."""

    @abstractmethod
    def value(self, key: str) -> Any:
        """Value of a key, SI; None where the case has none."""

    @property
    @abstractmethod
    def fidelity(self) -> Fidelity:
        """Fidelity, with the number of modes that a key gave it."""

    @property
    @abstractmethod
    def most_modes(self) -> int:
        """Largest number of modes that the structure has; 0 where that is not known."""

    @abstractmethod
    def scene(self) -> AnyScene:
        """Scene; ValueError for an impossible one."""

    def system(self) -> ImpactSystem:
        """Impact system; ValueError for an impossible one."""
        return system(self.scene(), self.fidelity)

    def amplitude(self, omega: Array) -> float | Array:
        """Drive amplitude at ``omega`` (rad/s): one for all, or one each where it depends on that."""
        from vibeam_models.base_motion import drive_amplitude

        return drive_amplitude(self.scene(), omega)
