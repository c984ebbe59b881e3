"""Model with a subset of the case's effects: its quantities of interest, its size, its CPU time."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from vibeam.case.case import Case
from vibeam.studies.influence.curve import Curve, RefinedPeak, ends, nearest, refined_peak, swept
from vibeam.studies.influence.quantities import NAN, Value
from vibeam.studies.influence.settled_motion import observed_ringing
from vibeam.studies.influence.subsets import Subsets
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.beam import structure_of

IN_MOTION = ("ringing", "ringing_frequency", "apparent_restitution")


@dataclass(frozen=True)
class Model:
    """Number of ``coordinates`` of the finite-element model, ``frequencies`` (Hz) of the swept modes; ``why``: the
    reason where the model cannot be built, with all ``values`` missing.
    """

    kept: tuple[str, ...]
    values: Mapping[str, Value] = field(default_factory=dict)
    coordinates: int = 0
    frequencies: tuple[float, ...] = ()
    case: Case | None = None
    system: ImpactSystem | None = None
    why: str = ""

    @property
    def modes(self) -> int:
        """Number of swept modes."""
        return len(self.frequencies)

    def value(self, quantity: str) -> Value:
        """Value of a quantity."""
        return self.values.get(quantity, Value(NAN, self.why))


def model(subsets: Subsets, kept: Collection[str], wanted: Collection[str], frequency: float | None) -> Model:
    """Build the model and read the quantities in ``wanted``, at ``frequency`` (Hz; None: at its peak)."""
    names = tuple(name for name in subsets.effects if name in kept)
    try:
        case = subsets.case(names)
        curve = swept(case, subsets.fidelity, case.system(subsets.fidelity))
    except ValueError as refusal:
        return Model(names, why=_reason(refusal))
    system = curve.system
    modes = tuple(np.sort(system.omega / (2 * np.pi)).tolist())
    return Model(names, _values(curve, wanted, frequency), _coordinates(case.scene), modes, case, system)


def _values(curve: Curve, wanted: Collection[str], frequency: float | None) -> dict[str, Value]:
    top = refined_peak(curve)
    values = {"peak": top.amplitude, "peak_frequency": top.frequency}
    if {"period_one_from", "period_one_to"} & set(wanted):
        values |= dict(zip(("period_one_from", "period_one_to"), ends(curve), strict=True))
    if set(IN_MOTION) & set(wanted):
        values |= _in_motion(curve, top, frequency)
    return {name: values[name] for name in wanted}


def _in_motion(curve: Curve, top: RefinedPeak, frequency: float | None) -> dict[str, Value]:
    if frequency is not None:
        return observed_ringing(curve, frequency, nearest(curve, frequency))
    if top.near is None:
        return dict.fromkeys(IN_MOTION, top.frequency)
    return observed_ringing(curve, top.frequency.number, top.near)


def _coordinates(scene: Any) -> int:
    """Coordinates of the finite elements, and of a platform that is pushed back."""
    moves = scene.platform is not None and scene.platform.coupling == "two-way"
    return int(structure_of(scene).size) + moves


def _reason(refusal: ValueError) -> str:
    """Reason of a refusal, without the file name before each fault."""
    from vibeam.exchange.faults import CaseError

    if isinstance(refusal, CaseError):
        return "; ".join(f"{fault.key}: {fault.message}" for fault in refusal.faults)
    return str(refusal)
