"""Free decay of a motion: frequency and damping ratio off its maxima, frequency off its spectrum (paper Fig. 30a–b).

As the paper reads them: the damping ratio off the envelope, here the slope of the logarithms of the maxima over time,
and the frequency off the times of the maxima and off the highest line of the spectrum, refined by a parabola through
its neighbours. Both slopes are weighted by the maxima's heights, so that noise on the low ones counts for as much as
it is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam.observe.harmonics import Spectrum, spectrum_of
from vibeam.observe.measuring_chain import MeasuredRecord
from vibeam_models.arrays import Array

LEAST = 3  # maxima for an envelope


@dataclass(frozen=True)
class FreeDecay:
    """Readings of a free decay: ``envelope`` (m,) at the record's times, ``frequency`` (Hz) and ``damping_ratio``.

    ``line``: frequency (Hz) of the highest line of the ``spectrum``.
    """

    envelope: Array
    frequency: float
    damping_ratio: float
    spectrum: Spectrum
    line: float


def free_decay(record: MeasuredRecord, natural: float) -> FreeDecay:
    """Read the decay of a mode near ``natural`` Hz; ValueError for fewer than three maxima."""
    time, height = maxima(record, natural)
    slope, level = np.polyfit(time, np.log(height), 1, w=height)
    turns = np.round((time - time[0]) * natural)
    rate = 2 * np.pi / float(np.polyfit(turns, time, 1, w=height)[0])
    spectrum = spectrum_of(record.time, record.displacement)
    return FreeDecay(
        np.exp(level + slope * record.time),
        rate / (2 * np.pi),
        float(-slope / np.hypot(slope, rate)),
        spectrum,
        highest_line(spectrum.frequency, spectrum.amplitude),
    )


def maxima(record: MeasuredRecord, natural: float) -> tuple[Array, Array]:
    """Times and heights of the maxima, one a natural period, by parabolas; ValueError for fewer than three."""
    from scipy.signal import find_peaks

    x = record.displacement
    top = find_peaks(x, distance=max(1, round(0.6 * record.rate / natural)))[0]
    top = top[x[top] > 0]
    if len(top) < LEAST:
        raise ValueError(f"{len(top)} maxima are too few for an envelope: show more periods")
    shift, height = _vertex(x, top)
    return record.time[top] + shift / record.rate, height


def highest_line(frequency: Array, amplitude: Array) -> float:
    """Frequency of the highest line, refined by a parabola through the logarithms of its neighbours."""
    top = 1 + int(np.argmax(amplitude[1:-1]))
    shift, _ = _vertex(np.log(np.maximum(amplitude, 1e-300)), np.array([top]))
    return float(frequency[top] + shift[0] * (frequency[1] - frequency[0]))


def _vertex(values: Array, at: NDArray[np.int64]) -> tuple[Array, Array]:
    """Place (in steps from ``at``) and height of the vertex of the parabola through three neighbours."""
    left, middle, right = values[at - 1], values[at], values[at + 1]
    bend = left - 2 * middle + right
    shift = (left - right) / (2 * bend)
    return shift, middle - (left - right) * shift / 4
