"""Estimated error of a model's response against a fuller model, point by point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.periodic.modal_sums import resonant
from vibeam.periodic.predicted_response import OrbitKind, PredictedResponse, predicted, predicted_free
from vibeam.periodic.train_sums import Trains
from vibeam.runs.closed_motions import unsuited
from vibeam.runs.estimate.motions import SweptMotions, swept_motions
from vibeam.runs.estimate.records import QUANTITIES, Basis, ErrorEstimate
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import StatesAfter
from vibeam_models.arrays import Array

READ_OFF = 2e-6  # share to which a flight is read off


def estimate_error(
    response: FrequencyResponse, system: ImpactSystem, full: ImpactSystem, amplitude: ArrayLike,
    output: str = "contact", after: StatesAfter | None = None,
) -> ErrorEstimate:  # fmt: skip
    """Estimate the error of ``response``, of the model ``system``, against the same motion of the model ``full``.

    It is not flown: where several motions coexist, a sweep of it may be on another one (``flown`` tells).

    ``amplitude`` of the base motion, m, one number or one a point; ``output``: what the response was read of. The
    states ``after`` its points are needed for motions with several impacts. ValueError where one of the models has no
    closed-form motions.
    """
    for each, name in ((system, "the model"), (full, "the full model")):
        if reason := unsuited(each):
            raise ValueError(f"{name}: {reason}")
    base = np.array(np.broadcast_to(np.asarray(amplitude, dtype=float), len(response)))
    swept = swept_motions(system, response, base, after)
    made = _Rows(np.full((len(QUANTITIES), len(response)), np.nan), np.full((4, len(response)), np.nan), swept.basis)
    for which, trains in _without_resonance(full, swept):
        different, back = _distinct(trains)
        there = predicted(full, trains.at(different), output)
        made.enter(response, which, PredictedResponse._make(row[back] for row in there), Basis.ORBIT)
    if len(swept.free):
        omega = 2 * np.pi * response.frequency[swept.free]
        made.enter(response, swept.free, predicted_free(full, omega, base[swept.free], output), Basis.FREE)
    names = (*QUANTITIES, *(f"{name}_bound" for name in QUANTITIES), "correction")
    rows = dict(zip(names, (*made.signed, *made.bounds), strict=True))
    return ErrorEstimate(frequency=response.frequency.copy(), basis=made.basis, **rows)


def _distinct(trains: Trains) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Motions that differ, and for each motion its place among them: a sweep down repeats most of the one up."""
    rows = np.column_stack([trains.omega, trains.amplitude, trains.phases, trains.impulses])
    _, first, back = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return first, back.ravel()


def _without_resonance(full: ImpactSystem, swept: SweptMotions) -> list[tuple[NDArray[np.int64], Trains]]:
    """Trains at whose drives the full model has a steady response."""
    found = []
    for which, trains in swept.trains:
        bad = np.array([bool(resonant(full, float(omega), trains.periods)) for omega in trains.omega], dtype=bool)
        swept.basis[which[bad]] = Basis.RESONANT.code
        if not bad.all():
            found.append((which[~bad], trains.at(np.flatnonzero(~bad))))
    return found


@dataclass(frozen=True, eq=False)
class _Rows:
    """Signed differences, their bounds and the correction, and the basis, filled part by part."""

    signed: Array
    bounds: Array
    basis: NDArray[np.int64]

    def enter(
        self, response: FrequencyResponse, which: NDArray[np.int64], there: PredictedResponse, same: Basis
    ) -> None:
        """Enter the other model's response at the points ``which``; ``same``: basis where its motion is the same."""
        values = there.amplitude, there.reach, there.impact_velocity
        unsure = there.uncertainty, there.reach_uncertainty, np.zeros(len(which))
        for row, (name, value, off) in enumerate(zip(QUANTITIES, values, unsure, strict=True)):
            with np.errstate(invalid="ignore", divide="ignore"):
                signed = getattr(response, name)[which] / value - 1
                self.signed[row, which] = signed
                self.bounds[row, which] = np.abs(signed) + (1 + np.abs(signed)) * (off / np.abs(value) + READ_OFF)
        self.bounds[3, which] = there.first
        codes = np.array([same.code, *(Basis[each.name].code for each in OrbitKind if each is not OrbitKind.ORBIT)])
        self.basis[which] = codes[there.found]
