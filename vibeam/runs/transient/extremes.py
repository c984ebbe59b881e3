"""Least and greatest values of signals in equal bins of the time: exact of exact motions, else of their samples."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.runs.transient.samples import SignalSamples
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.observe.motion import Path


@dataclass(frozen=True, eq=False)
class SignalExtremes:
    """Least and greatest values (o, b) of o signals in b bins, and when they are, s."""

    least: Array
    least_time: Array
    greatest: Array
    greatest_time: Array


def is_exact(path: Path) -> bool:
    """Test whether a motion is known by its segments, in closed form, and not by samples alone."""
    return getattr(path, "segments", None) is not None


def extremes_of(path: Path, samples: SignalSamples, bins: int) -> SignalExtremes:
    """Extremes of the sampled signals in ``bins`` equal bins of a motion.

    Of an exact motion those of displacements, velocities and accelerations are exact, and so is the largest force
    of every contact, whose time is the middle of the contact; of another one they are those of cubics through samples.
    """
    edges, numbers = np.linspace(path.t_start, path.t_end, bins + 1), range(len(samples.signals))
    known = [number for number in numbers if is_exact(path) and samples.signals[number].order >= 0]
    found = SignalExtremes(*np.empty((4, len(numbers), bins)))
    for number in set(numbers) - set(known):
        _take_samples(found, number, samples, edges)
    if known:
        _take_exact(found, known, path, samples, edges)
    return found


def _take_exact(found: SignalExtremes, known: list[int], path: Any, samples: SignalSamples, edges: Array) -> None:
    """Take the exact extremes of the ``known`` signals, and the largest forces of all contacts."""
    from vibeam.flight.extremes import extremes

    exact = extremes(path, [samples.signals[number].name for number in known], edges)
    for name in ("least", "least_time", "greatest", "greatest_time"):
        getattr(found, name)[known] = getattr(exact, name)
    for number, each in enumerate(samples.signals):
        if each.order < 0 and len(path.contacts):
            _take_peaks(found, number, path.contacts, edges)


def _take_peaks(found: SignalExtremes, number: int, contacts: Array, edges: Array) -> None:
    """Let the largest force of every contact count in the bin of its middle."""
    times, peaks = contacts[:, 0] + contacts[:, 1] / 2, contacts[:, 2]
    order = np.argsort(peaks)
    at = np.clip(np.searchsorted(edges, times[order], side="right") - 1, 0, len(edges) - 2)
    above = peaks[order] > found.greatest[number, at]
    found.greatest[number, at[above]] = peaks[order][above]
    found.greatest_time[number, at[above]] = times[order][above]


def _take_samples(found: SignalExtremes, number: int, samples: SignalSamples, edges: Array) -> None:
    """Take least and greatest values of one signal in the bins by its history; the times are the bins' middles."""
    history = samples.history(number, len(edges) - 1)
    found.least[number], found.greatest[number] = history.least, history.greatest
    found.least_time[number] = found.greatest_time[number] = (edges[1:] + edges[:-1]) / 2
