"""Spectra of sampled signals in physical units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vibeam_models.arrays import Array


@dataclass(frozen=True)
class Spectrum:
    """One-sided, at ``frequency`` (m,) Hz, of a signal in unit u.

    ``amplitude`` (m,) u: a sine on a line reads its peak value there. ``density`` (m,) u²/Hz: its integral is the mean
    square. ``resolution``: the window's equivalent noise bandwidth, Hz.
    """

    frequency: Array
    amplitude: Array
    density: Array
    resolution: float


def spectrum_of(
    time: ArrayLike, values: ArrayLike, *, window: str = "hann", segment: float | None = None, mean: bool = False
) -> Spectrum:
    """Spectrum of evenly sampled values (m,); Welch's mean over half-overlapping segments of ``segment`` seconds.

    ``window``: any name that scipy.signal knows; ``segment`` None: all at once. The mean is taken off unless ``mean``.
    ValueError for samples that are not evenly spaced or a segment that is longer than all of them.
    """
    from scipy import signal

    t, x = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    rate = sampling_rate(t)
    count = len(t) if segment is None else round(segment * rate)
    if not 2 <= count <= len(t):
        raise ValueError(f"segment: {segment} s is not between 2 samples and all of the {len(t)} there are")
    shape = signal.get_window(window, count)
    common = {"fs": rate, "window": shape, "nperseg": count, "detrend": False if mean else "constant"}
    frequency, power = signal.welch(x, scaling="spectrum", **common)
    density = signal.welch(x, scaling="density", **common)[1]
    sine = np.where((frequency > 0) & (frequency < rate / 2 * (1 - 1e-12)), 2.0, 1.0)
    resolution = rate * float(np.sum(shape**2) / np.sum(shape) ** 2)
    return Spectrum(frequency, np.sqrt(sine * power), density, resolution)


def sampling_rate(time: Array) -> float:
    """Samples a second of evenly spaced times (m,); ValueError where they are not even."""
    steps = np.diff(time)
    if time.ndim != 1 or not len(steps) or not np.all(np.isfinite(steps)):
        raise ValueError("time: must be two or more finite times")
    step = float(time[-1] - time[0]) / len(steps)
    if not (step > 0 and np.max(np.abs(steps - step)) <= 1e-6 * step):
        raise ValueError("time: must be evenly spaced")
    return 1 / step
