"""Surrogates of a fidelity's peak: its closed form, and a quadratic response surface over the uncertain inputs.

As control variates they may be off by any amount (jumps, folds), if only they follow the peak of the sweep. The closed
form is the largest motion with one impact a period, or none: which of the motions a sweep would be on, and whether they
are stable or strike in between, is not asked. The surface is fitted by least squares to runs of its own, so that it is
independent of those that an estimate is made of.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations_with_replacement
from time import thread_time
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.fidelity import system
from vibeam.periodic.modal_sums import fault
from vibeam.periodic.orbit_derivatives import struck
from vibeam.periodic.output_signals import SampledOutput, without_contact
from vibeam.periodic.tangents import ModalData, Tangents
from vibeam.studies.uncertainty.samples import Responses
from vibeam_models.arrays import Array
from vibeam_models.base_motion import drive_amplitude

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Model


SAMPLES = 64  # a drive period
NEARLY = 1e-6  # distance of a damping ratio from 1 below which the closed forms lose accuracy


@dataclass(frozen=True)
class ClosedFormPeaks:
    """Closed-form peaks of a case at other values of its uncertain inputs, at every ``every``-th of its frequencies."""

    case: Case
    keys: tuple[str, ...]
    every: int = 1

    def __call__(self, fidelity: str, inputs: Array) -> Responses:
        """Responses to inputs (m, d); NaN where a system has no closed form."""
        model = self.case.model(fidelity)
        omega = np.sort(2 * np.pi * self.case.sweep.frequency)[:: self.every]
        amplitude, seconds = np.full((len(inputs), len(omega)), np.nan), np.zeros(len(inputs))
        for number, values in enumerate(inputs):
            begin = thread_time()
            data = self._data(model.at(dict(zip(self.keys, values, strict=True))), omega)
            if data is not None:
                amplitude[number] = largest(data, omega)
            seconds[number] = thread_time() - begin
        return Responses.of_amplitude(fidelity, inputs, omega / (2 * np.pi), amplitude, seconds)

    def _data(self, model: Model, omega: Array) -> ModalData | None:
        """Modal data of a sample's system; None where it has no closed form."""
        scene = model.scene()
        made = system(scene, model.fidelity)
        if fault(made) or (made.omega == 0).any() or (np.abs(made.zeta - 1) < NEARLY).any():
            return None
        drive = np.broadcast_to(np.asarray(drive_amplitude(scene, omega), dtype=float), omega.shape)
        return ModalData.of(made, self.case.sweep.output, drive)


def known(case: Case, fidelity: str) -> bool:
    """Test whether a fidelity's drive, gap and output have closed forms."""
    scene = case.scene_of(fidelity)
    stop = scene.stop
    moving = stop is not None and (stop.drift is not None or stop.wear is not None)
    made = case.system(fidelity)
    return not (scene.harmonics or moving or fault(made)) and made.derivative(case.sweep.output) is None


def largest(data: ModalData, omega: Array) -> Array:
    """Largest amplitude (points,) of the motions at drives ``omega``, from samples; NaN where there is none."""
    still = Tangents.unpacked(np.zeros((0, len(data.packed()))), len(data.omega))
    found = struck(data, still, omega, np.ones(len(omega)), 0)
    signal = SampledOutput(data, still, data.row, still.row, omega, 1, found, None)
    swing = np.ptp(signal.samples(np.linspace(0.0, 1.0, SAMPLES + 1)), axis=1) / 2
    free = without_contact(data, still, omega, "amplitude")
    both = (np.where(found.beyond == 0, swing, -np.inf), np.where(free.beyond == 0, free.value, -np.inf))
    top = np.maximum(*both)
    return np.where(np.isfinite(top), top, np.nan)


RUNS = 3  # a coefficient


@dataclass(frozen=True)
class Surface:
    """Polynomial Σ ``coefficients`` · terms of the inputs about ``middle`` in units of ``scale``.

    ``seconds``: CPU time of the runs that it is fitted to.
    """

    middle: Array
    scale: Array
    coefficients: Array
    seconds: float

    @classmethod
    def of(cls, model: Callable[[str, Array], Responses], fidelity: str, inputs: Array) -> Surface | None:
        """Surface through a model's peaks at ``inputs`` (m, d); None where too few of them have a peak."""
        found = model(fidelity, inputs)
        known = np.isfinite(found.peak)
        middle, scale = inputs.mean(axis=0), inputs.std(axis=0)
        rows = terms((inputs - middle) / np.where(scale > 0, scale, 1.0))
        if known.sum() < 2 * rows.shape[1]:
            return None
        coefficients = np.asarray(np.linalg.lstsq(rows[known], found.peak[known], rcond=None)[0], dtype=float)
        return cls(middle, np.where(scale > 0, scale, 1.0), coefficients, float(found.seconds.sum()))

    def __call__(self, fidelity: str, inputs: Array) -> Responses:
        """Responses to inputs (m, d): their peaks alone."""
        begin = thread_time()
        peak = terms((inputs - self.middle) / self.scale) @ self.coefficients
        each = np.full(len(inputs), (thread_time() - begin) / max(len(inputs), 1))
        return Responses.of_amplitude(fidelity, inputs, np.full(1, np.nan), peak[:, None], each)


def runs(inputs: int) -> int:
    """Number of runs that a surface over so many inputs is fitted to."""
    return RUNS * (inputs + 1) * (inputs + 2) // 2


def terms(x: Array) -> Array:
    """Terms (m, k) of a polynomial of degree two in x (m, d)."""
    columns = [np.ones(len(x)), *x.T]
    columns += [x[:, i] * x[:, j] for i, j in combinations_with_replacement(range(x.shape[1]), 2)]
    return np.column_stack(columns)
