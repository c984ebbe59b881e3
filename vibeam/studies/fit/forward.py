"""Modal data of a fidelity at values of the estimated keys, and their derivatives.

Orbit equations are differentiated exactly (``orbits.orbit_derivatives``); what goes into them, the modal sums of the
structure, gap, restitution and drive as functions of the keys, by central differences at 1/5000 of the keys' bounds.
These are exact to round-off for keys that enter as a polynomial of degree two (gain, voltage, gap, restitution,
damping ratio), and accurate to about 1e-8 for those of the structure (mass, thickness): no difference is ever taken of
a motion, which is ill-conditioned near a fold.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.case.fidelity import system
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.read import validate
from vibeam.casefile.toml import key_parts
from vibeam.maps.variation import narrowed
from vibeam.orbits.modal_sums import fault
from vibeam.orbits.tangents import ModalData, Tangents, aligned
from vibeam.studies.uncertainty.samples import put
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.base_motion import drive_amplitude

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Fidelity
    from vibeam.case.plans import FitKey

Array = NDArray[np.float64]

STEP = 2e-4  # of the difference quotients, share of a key's bounds

NEARLY = 1e-6  # distance of a damping ratio from 1 below which the closed forms lose accuracy


@dataclass(frozen=True)
class Forward:
    """One fidelity's tables, the paths of the estimated keys, and the output that is observed."""

    tables: Any
    fidelity: Fidelity
    folder: Path
    keys: tuple[FitKey, ...]
    changed: tuple[bool, ...]  # False: the fidelity sets the key itself
    output: str
    offsets: tuple[float, ...] = ()  # added to the values of the keys

    @classmethod
    def of(cls, case: Case, name: str, keys: Sequence[FitKey]) -> Forward:
        """Forward model of one fidelity; ValueError for one whose motions have no closed form."""
        own, changes = validate(narrowed(case, name), case.path, {})
        fidelity = case.fidelities[name]
        found = cls(
            changes.get(name, own), fidelity, case.path.parent, tuple(keys),
            tuple(each.key not in fidelity.changes for each in keys), case.sweep.output,
            (0.0,) * len(keys),
        )  # fmt: skip
        _refuse(case, name, found.system(np.array([each.start for each in keys])))
        return found

    def scene(self, values: Array) -> Any:
        """Scene at values of the keys."""
        tables = self.tables
        for each, value, changed in zip(self.keys, values + np.array(self.offsets), self.changed, strict=True):
            tables = put(tables, key_parts(each.key), float(value)) if changed else tables
        return KINDS[tables.kind].scene_of(tables, self.folder)

    def system(self, values: Array) -> ImpactSystem:
        """Impact system at values of the keys."""
        return system(self.scene(values), self.fidelity)

    def data(self, values: Array, omega: Array) -> ModalData:
        """Modal data at drives ``omega`` (points,) rad/s."""
        scene = self.scene(values)
        made = system(scene, self.fidelity)
        drive = np.broadcast_to(np.asarray(drive_amplitude(scene, omega), dtype=float), omega.shape)
        return ModalData.of(made, self.output, drive)

    def with_tangents(self, values: Array, omega: Array) -> tuple[ModalData, Tangents]:
        """Modal data and their derivatives by the keys."""
        data = self.data(values, omega)
        rows = [self._slope(data, values, k, omega) for k in range(len(self.keys))]
        return data, Tangents.unpacked(np.array(rows), len(data.omega))

    def _slope(self, data: ModalData, values: Array, k: int, omega: Array) -> Array:
        packed = data.packed()
        if not self.changed[k]:
            return np.zeros_like(packed)
        low, high = self.keys[k].low, self.keys[k].high
        step = STEP * (high - low)
        below, above = round((values[k] - low) / step), round((high - values[k]) / step)
        shift = max(1 - below, 0) - max(1 - above, 0)  # all nodes within the bounds
        nodes = np.arange(-1, 2) + shift
        total = np.zeros_like(packed)
        for node, weight in zip(nodes.tolist(), _weights(nodes), strict=True):
            at = values.copy()
            at[k] = min(max(at[k] + node * step, low), high)
            if node == 0:
                continue
            moved = aligned(self.data(at, omega), data).packed()
            total += weight * (moved - packed)
        return total / step


def _weights(nodes: NDArray[np.int64]) -> Array:
    """Weights of the first derivative at 0 from values at three whole numbers."""
    powers = np.vander(nodes.astype(float), 3, increasing=True).T
    return np.linalg.solve(powers, np.eye(3)[1])


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
