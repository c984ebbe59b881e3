"""Peak of a fidelity in closed form: its largest motion with one impact a period, or none, over the frequencies.

It is no sweep: which of the motions a sweep would be on, and whether they are stable or strike in between, is not
asked. As a control variate it may be off by any amount, if only it follows the peak of the sweep.
"""

from __future__ import annotations

from dataclasses import dataclass
from time import thread_time
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.fidelity import system
from vibeam.casefile.case_model import CaseModel
from vibeam.orbits.modal_sums import fault
from vibeam.orbits.orbit_derivatives import struck
from vibeam.orbits.output_derivatives import without_contact
from vibeam.orbits.output_signals import SampledOutput
from vibeam.orbits.tangents import ModalData, Tangents
from vibeam.studies.uncertainty.samples import Responses
from vibeam_models.base_motion import drive_amplitude

if TYPE_CHECKING:
    from vibeam.case.case import Case

Array = NDArray[np.float64]

SAMPLES = 64  # a drive period

NEARLY = 1e-6  # distance of a damping ratio from 1 below which the closed forms lose accuracy


@dataclass(frozen=True)
class ClosedForm:
    """Closed-form peaks of a case at other values of its uncertain inputs, at every ``every``-th of its frequencies."""

    case: Case
    keys: tuple[str, ...]
    every: int = 1

    def __call__(self, fidelity: str, inputs: Array) -> Responses:
        """Responses to inputs (m, d); NaN where a system has no closed form."""
        model = CaseModel.of(self.case, fidelity)
        omega = np.sort(2 * np.pi * self.case.sweep.frequency)[:: self.every]
        amplitude, seconds = np.full((len(inputs), len(omega)), np.nan), np.zeros(len(inputs))
        for number, values in enumerate(inputs):
            begin = thread_time()
            data = self._data(model.at(dict(zip(self.keys, values, strict=True))), omega)
            if data is not None:
                amplitude[number] = largest(data, omega)
            seconds[number] = thread_time() - begin
        return Responses.of_amplitude(fidelity, inputs, omega / (2 * np.pi), amplitude, seconds)

    def _data(self, model: CaseModel, omega: Array) -> ModalData | None:
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
