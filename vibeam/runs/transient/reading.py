"""Reading of one motion under a record: extremes, impacts, energies, spectra; what the results file keeps of it."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from vibeam.observe.decimation import history_of_cubics
from vibeam.runs.transient.energies import energy_balance
from vibeam.runs.transient.extremes import SignalExtremes, extremes_of, is_exact
from vibeam.runs.transient.samples import A_PERIOD, PLENTY, samples_of
from vibeam.runs.transient.signals import contacts_struck, share_in_contact
from vibeam.system.response import Ended

if TYPE_CHECKING:
    from vibeam.observe.motion import Path
    from vibeam.runs.transient.signals import TransientSignal

Reading = dict[str, NDArray[Any]]  # numbers of one motion: READINGS by name, histories
OUTLINE = 512  # bins of an outline


@dataclass(frozen=True)
class ReadingQuantity:
    """Meaning of a field of a reading, its unit (q: of the signal), its dimensions."""

    long_name: str
    unit: Literal["q", "q2 Hz-1", "c/s", "E", "s", "Hz", "1"]
    dimensions: tuple[str, ...] = ()


SIGNAL, MODE, IMPACT = ("signal",), ("mode",), ("impact",)
READINGS: Mapping[str, ReadingQuantity] = {
    "least": ReadingQuantity("least value", "q", SIGNAL),
    "greatest": ReadingQuantity("greatest value", "q", SIGNAL),
    "least_time": ReadingQuantity("time of the least value", "s", SIGNAL),
    "greatest_time": ReadingQuantity("time of the greatest value", "s", SIGNAL),
    "mean": ReadingQuantity("mean over the record", "q", SIGNAL),
    "rms": ReadingQuantity("root mean square over the record", "q", SIGNAL),
    "outline_least": ReadingQuantity("least value of each bin of the time", "q", ("signal", "bin")),
    "outline_greatest": ReadingQuantity("greatest value of each bin of the time", "q", ("signal", "bin")),
    "frequency": ReadingQuantity("frequency of the spectra", "Hz", ("frequency",)),
    "spectrum": ReadingQuantity("one-sided spectral density, Welch's method", "q2 Hz-1", ("signal", "frequency")),
    "impact_times": ReadingQuantity(
        "times of the impacts, of the begins of contacts where the stop yields", "s", IMPACT
    ),
    "impact_velocities": ReadingQuantity("velocity just before impact", "c/s", IMPACT),
    "impact_contacts": ReadingQuantity("number of the contact struck, 0: the first stop", "1", IMPACT),
    "rest": ReadingQuantity("share of the time held on the stop", "1"),
    "start": ReadingQuantity("energy at the begin", "E", MODE),
    "work": ReadingQuantity("work of the load on the motion relative to the base", "E", MODE),
    "damping": ReadingQuantity("energy lost by damping", "E", MODE),
    "lost": ReadingQuantity("energy lost to the stop, or to other modes through it", "E", MODE),
    "left": ReadingQuantity("energy at the end", "E", MODE),
    "residual": ReadingQuantity("share of the largest energy by which the balance is open", "1"),
    "cpu_seconds": ReadingQuantity("CPU time of the motion", "s"),
    "reading_seconds": ReadingQuantity("CPU time of what is read off it", "s"),
    "ended": ReadingQuantity("why the motion ended", "1"),
    "proved": ReadingQuantity("certificate: 1 complete, 0 not, −1 not asked for", "1"),
}


def reading_of(
    path: Path, record: Any, signals: Sequence[TransientSignal], cpu_seconds: float, bins: int | None = None
) -> Reading:
    """Reading of a motion under ``record`` that took ``cpu_seconds``; of one that ended early, up to its end.

    ``bins``: of its histories, None: it has none.
    """
    begun = time.thread_time()
    samples = samples_of(path, record, signals, A_PERIOD if is_exact(path) else PLENTY)
    outline = extremes_of(path, samples, OUTLINE)
    low, high = outline.least.argmin(axis=1), outline.greatest.argmax(axis=1)
    each = np.arange(len(signals))
    mean, rms = samples.moments()
    frequency, density = samples.spectrum()
    energy = energy_balance(path, record)
    found = {
        "least": outline.least[each, low], "least_time": outline.least_time[each, low],
        "greatest": outline.greatest[each, high], "greatest_time": outline.greatest_time[each, high],
        "mean": mean, "rms": rms, "spectrum": density, "frequency": frequency, **_as_arrays("outline", outline),
        "impact_times": path.impact_times, "impact_velocities": path.impact_velocities,
        "impact_contacts": contacts_struck(path),
        "rest": share_in_contact(path),
        **{name: getattr(energy, name) for name in ("start", "work", "damping", "lost", "left", "residual")},
        "ended": getattr(path, "ended", Ended.COMPLETE).code, "proved": _proved(path), "cpu_seconds": cpu_seconds,
    }  # fmt: skip
    if bins is not None:
        load = history_of_cubics(record.times, record.coefficients, path.t_start, path.t_end, bins)
        found |= {"history_edges": (path.t_start, path.t_end)}
        found |= _as_arrays("history", extremes_of(path, samples, bins))
        found |= {"input_least": np.float32(load.least), "input_greatest": np.float32(load.greatest)}
    return {name: np.asarray(each) for name, each in (found | {"reading_seconds": time.thread_time() - begun}).items()}


def _as_arrays(name: str, bins: SignalExtremes) -> dict[str, Any]:
    """Least and greatest values (o, b) in single precision, as pictures need them."""
    return {f"{name}_{part}": np.float32(getattr(bins, part)) for part in ("least", "greatest")}


def _proved(path: Path) -> int:
    certificate = getattr(path, "certificate", None)
    return -1 if certificate is None else int(certificate.complete)
