"""One fidelity of a case at values of the estimated keys: system, and the modal data that its motions follow from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.fidelity import system
from vibeam.periodic.modal_sums import fault
from vibeam.periodic.tangents import ModalData
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array
from vibeam_models.base_motion import drive_amplitude

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Model
    from vibeam.case.plans import FitKey


NEARLY = 1e-6  # distance of a damping ratio from 1 below which the closed forms lose accuracy


@dataclass(frozen=True)
class Forward:
    """Model of a fidelity, the estimated keys, and the output that is observed.

    ``changed``: False for a key that the fidelity sets itself. ``offsets``: added to the values of the keys.
    """

    model: Model
    keys: tuple[FitKey, ...]
    changed: tuple[bool, ...]
    output: str
    offsets: tuple[float, ...]

    @classmethod
    def of(cls, case: Case, name: str, keys: Sequence[FitKey]) -> Forward:
        """Forward model of one fidelity; ValueError for one whose motions have no closed form."""
        model = case.model(name)
        changed = tuple(each.key not in model.fidelity.changes for each in keys)
        found = cls(model, tuple(keys), changed, case.sweep.output, (0.0,) * len(keys))
        _refuse(case, name, found.system(np.array([each.start for each in keys])))
        return found

    def values(self, x: Array) -> Array:
        """Values of the keys (P,), SI, at shares of their bounds."""
        low, high = (np.array([getattr(each, end) for each in self.keys]) for end in ("low", "high"))
        return np.asarray(low + x * (high - low))

    def at(self, values: Array) -> Model:
        """Model at values (P,) of the keys, SI."""
        rows = zip(self.keys, values, self.offsets, self.changed, strict=True)
        return self.model.at({each.key: float(value + offset) for each, value, offset, changed in rows if changed})

    def system(self, values: Array) -> ImpactSystem:
        """Impact system at values of the keys."""
        return self.at(values).system()

    def data(self, values: Array, omega: Array) -> ModalData:
        """Modal data at drives ``omega`` (points,) rad/s."""
        model = self.at(values)
        scene = model.scene()
        drive = np.broadcast_to(np.asarray(drive_amplitude(scene, omega), dtype=float), omega.shape)
        return ModalData.of(system(scene, model.fidelity), self.output, drive)


def _refuse(case: Case, name: str, made: ImpactSystem) -> None:
    scene = case.scene_of(name)
    told = fault(made)
    if not told and (made.omega == 0).any():
        told = "a mode without stiffness has no closed form here"
    if not told and (np.abs(made.zeta - 1) < NEARLY).any():
        told = "a critically damped mode has no closed form here"
    if not told and scene.harmonics:
        told = "a fit knows a drive of one harmonic: take drive.harmonic away"
    if not told and scene.stop is not None and (scene.stop.drift is not None or scene.stop.wear is not None):
        told = "a fit knows a gap that stays: take drift and wear away"
    if told:
        raise ValueError(f"fidelity.{name}: {told}")
    _require_output(case, made)


def _require_output(case: Case, made: ImpactSystem) -> None:
    try:
        made.output(case.sweep.output)
    except KeyError as wrong:
        raise ValueError(f"sweep.output: {wrong.args[0]}") from None
