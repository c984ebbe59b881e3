"""vibeam: how much model does a vibro-impact beam need?

The public names, loaded when first used: ``import vibeam`` itself loads no scipy, matplotlib, numba or pint.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vibeam import observe as observe
    from vibeam.case import Case as Case
    from vibeam.case import load as load
    from vibeam.check import check as check
    from vibeam.cost.study import cost as cost
    from vibeam.derive import derive as derive
    from vibeam.faults import CaseError as CaseError
    from vibeam.influence.study import influence as influence
    from vibeam.modes import modes as modes
    from vibeam.outcome import Outcome as Outcome
    from vibeam.periodic.boundaries import boundaries as boundaries
    from vibeam.periodic.curve import orbit_curve as orbit_curve
    from vibeam.periodic.follow import follow as follow
    from vibeam.periodic.line import Kind as Kind
    from vibeam.periodic.map import orbit_map as orbit_map
    from vibeam.periodic.orbit import Orbit as Orbit
    from vibeam.periodic.orbit import orbits as orbits
    from vibeam.periodic.several import settled_orbit as settled_orbit
    from vibeam.periodic.several import train_orbit as train_orbit
    from vibeam.periodic.train_boundaries import train_boundaries as train_boundaries
    from vibeam.plot import plot as plot
    from vibeam.response import Branches as Branches
    from vibeam.response import Ended as Ended
    from vibeam.response import FrequencyResponse as FrequencyResponse
    from vibeam.result import Result as Result
    from vibeam.run import run as run
    from vibeam.simulate import Trajectory as Trajectory
    from vibeam.simulate import simulate as simulate
    from vibeam.stability.study import stability as stability
    from vibeam.state import State as State
    from vibeam.store.faults import StoreError as StoreError
    from vibeam.sweep import sweep as sweep
    from vibeam.system import Drive as Drive
    from vibeam.system import ImpactSystem as ImpactSystem
    from vibeam_models.structure import Structure as Structure
    from vibeam_reductions.modal import modal as modal

__version__ = "0.1.0"

_HOMES = {
    "load": "vibeam.case",
    "run": "vibeam.run",
    "derive": "vibeam.derive",
    "ImpactSystem": "vibeam.system",
    "Drive": "vibeam.system",
    "State": "vibeam.state",
    "simulate": "vibeam.simulate",
    "sweep": "vibeam.sweep",
    "orbits": "vibeam.periodic.orbit",
    "Orbit": "vibeam.periodic.orbit",
    "orbit_curve": "vibeam.periodic.curve",
    "boundaries": "vibeam.periodic.boundaries",
    "orbit_map": "vibeam.periodic.map",
    "stability": "vibeam.stability.study",
    "influence": "vibeam.influence.study",
    "Kind": "vibeam.periodic.line",
    "follow": "vibeam.periodic.follow",
    "settled_orbit": "vibeam.periodic.several",
    "train_orbit": "vibeam.periodic.several",
    "train_boundaries": "vibeam.periodic.train_boundaries",
    "Ended": "vibeam.response",
    "Outcome": "vibeam.outcome",
    "FrequencyResponse": "vibeam.response",
    "cost": "vibeam.cost.study",
    "check": "vibeam.check",
    "modes": "vibeam.modes",
    "plot": "vibeam.plot",
    "Case": "vibeam.case",
    "CaseError": "vibeam.faults",
    "StoreError": "vibeam.store.faults",
    "Result": "vibeam.result",
    "Branches": "vibeam.response",
    "Trajectory": "vibeam.simulate",
    "Structure": "vibeam_models.structure",
    "modal": "vibeam_reductions.modal",
}
_MODULES = ("observe",)  # handed on whole

__all__ = [
    "Branches",
    "Case",
    "CaseError",
    "Drive",
    "Ended",
    "FrequencyResponse",
    "ImpactSystem",
    "Kind",
    "Orbit",
    "Outcome",
    "Result",
    "State",
    "StoreError",
    "Structure",
    "Trajectory",
    "__version__",
    "boundaries",
    "check",
    "cost",
    "derive",
    "follow",
    "influence",
    "load",
    "modal",
    "modes",
    "observe",
    "orbit_curve",
    "orbit_map",
    "orbits",
    "plot",
    "run",
    "settled_orbit",
    "simulate",
    "stability",
    "sweep",
    "train_boundaries",
    "train_orbit",
]


class _House(ModuleType):
    """A package in which ``vibeam.sweep`` stays the function, though importing it brings a module of that name."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in _HOMES and isinstance(value, ModuleType)):
            super().__setattr__(name, value)

    def __getattr__(self, name: str) -> Any:
        if name in _MODULES:
            return import_module(f"vibeam.{name}")
        if name not in _HOMES:
            raise AttributeError(f"module 'vibeam' has no attribute {name!r}")
        value = getattr(import_module(_HOMES[name]), name)
        setattr(self, name, value)
        return value

    def __dir__(self) -> list[str]:
        return __all__


sys.modules[__name__].__class__ = _House
