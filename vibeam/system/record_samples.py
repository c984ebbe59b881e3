"""Records of samples: their faults, how they are joined, the rate that a mode needs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from vibeam.system import record_pieces as pieces
from vibeam_models.arguments import counted, number, real_array, refuse, shown, word
from vibeam_models.arrays import Array, Index

GRAVITY = 9.80665  # m/s² of a unit g of acceleration
MOST = 1e6 * GRAVITY  # m/s²: pyrotechnic devices make 10⁴ to 10⁵ g at their own metal
LISTED = 3  # indices named in a message
GAP = 1.5  # length of a step, in median steps, from which on a sample is missing
EVEN = 0.9  # share of steps near the median, from which on samples are meant to be even
#: interpolations by quantity, the first the default; velocities and displacements are those of a cubic spline
JOINED = {
    "acceleration": ("linear", "cubic"),
    "force": ("linear", "cubic"),
    "moment": ("linear", "cubic"),
    "velocity": ("cubic",),
    "displacement": ("cubic",),
}
DERIVATIVE = {"velocity": 1, "displacement": 2}
LEAST = {"linear": 2, "cubic": 4}  # samples
MOST_SAMPLES = 12_500_000
#: error of the load under a sine, (ωh)ᵖ/C of its amplitude, as (C, p), by ``Record.samples``
ERRORS = {"linear": (8, 2), "cubic": (384, 4), "velocity": (72 * 3**0.5, 3), "displacement": (12, 2)}


Named = Callable[[int], str]  # name of a sample in a message, by its index


def extent(name: str, value: Any, faults: list[str]) -> float:
    """A duration, frequency or ratio as a float in bounds beyond which floats end; as ``number``."""
    return number(name, value, faults, least=1e-12, most=1e12)


def by_index(index: int) -> str:
    """Name of a sample of an array."""
    return f"index {index}"


class SampledRecords(pieces.MadeOfPieces):
    """Chapter of ``Record``: records of samples."""

    @classmethod
    def sampled(
        cls,
        values: ArrayLike,
        *,
        rate: float | None = None,
        times: ArrayLike | None = None,
        start: float = 0.0,
        quantity: str = "acceleration",
        interpolation: str | None = None,
        remove: str | None = None,
    ) -> Self:
        """Record of samples (n,), ``rate`` of them a second (Hz) from ``start`` (s) on, or at ``times`` (n,), s.

        ``quantity``: ``"acceleration"`` (m/s²), ``"velocity"`` (m/s) or ``"displacement"`` (m) of the base,
        ``"force"`` (N), ``"moment"`` (N m). ``interpolation`` of an acceleration or force: ``"linear"`` between
        samples (the default), or ``"cubic"``, the spline through all of them. Velocities and displacements are those of
        a cubic spline, whose derivative is the acceleration. ``remove``: as in ``without``. Under a sine of the angular
        frequency ω, sampled every h seconds, the load is off by at most, as a share of its amplitude and to first
        order: (ωh)²/8 linear, (ωh)⁴/384 cubic, (ωh)³/125 by velocities, (ωh)²/12 by displacements.

        ValueError names every fault, with the index of the sample: fewer than 2 samples (4 for a spline), times that do
        not ascend, gaps where samples are missing, NaN, no rate, and an acceleration beyond 10⁶ g, ten times what
        pyrotechnic devices make beside them: its unit is wrong.

        >>> import vibeam
        >>> record = vibeam.Record.sampled([0.0, 9.0, -9.0, 3.0, 0.0], rate=2000.0, interpolation="cubic")
        >>> record.peak > 9.0, record.duration, round(float(record.at(0.001)), 12)
        (True, 0.002, -9.0)
        """
        faults: list[str] = []
        kinds = JOINED[word("quantity", quantity, JOINED, faults)]
        asked = kinds[0] if interpolation is None else interpolation
        joined = word(f"interpolation of {quantity}", asked, kinds, faults)
        known = samples_of(values, LEAST[joined], faults)
        knots = times_of(len(known), rate, times, start, faults)
        refuse("record", faults)
        derivative = DERIVATIVE.get(quantity, 0)
        made = pieces.linear(knots, known) if joined == "linear" else pieces.spline(knots, known, derivative)
        require_peak(max(map(abs, pieces.bounds(knots, made))), "acceleration" if derivative else quantity)
        if not derivative:
            return cls(knots, made, quantity, samples=joined).without(remove)
        velocity = known[0] if derivative == 1 else pieces.spline(knots, known, 1)[0, 0]
        initial = (float(velocity), 0.0 if derivative == 1 else float(known[0]))
        return cls(knots, made, "acceleration", initial, quantity).without(remove)


def samples_of(values: ArrayLike, least: int, faults: list[str], named: Named = by_index) -> Array:
    """Samples as floats (n,), with a line in ``faults`` where they are none, too few, too many, or not finite."""
    found = real_array(values)
    if found is None or found.ndim != 1:
        faults.append("values: must be a row of numbers, one a sample")
        return np.zeros(0)
    if len(found) < least:
        faults.append(f"values: {counted(len(found), 'sample')}, at least {least} make a record")
    if len(found) > MOST_SAMPLES:
        faults.append(f"values: {len(found)} samples, {MOST_SAMPLES} at most: cut the record, or sample it again")
    wrong = np.flatnonzero(~np.isfinite(found))
    if len(wrong):
        count = counted(len(wrong), "sample")
        faults.append(
            f"values: {count} no finite number, {_listed(wrong, named)}: cut the record there, or fill the gap"
        )
    return found


def times_of(n: int, rate: Any, times: Any, start: Any, faults: list[str], named: Named = by_index) -> Array:
    """Times of ``n`` samples from a rate or as they are given, with lines in ``faults`` for what is wrong of them."""
    if (rate is None) == (times is None):
        faults.append(f"rate, times: {'one of both' if rate is None else 'one of both alone'} says when samples are")
        return np.zeros(0)
    if times is None:
        first, rate = number("start", start, faults), extent("rate", rate, faults)
        return np.asarray(first + np.arange(n) / rate)
    found = real_array(times)
    if found is None or found.ndim != 1:
        faults.append("times: must be a row of numbers, s")
        return np.zeros(0)
    if n and len(found) != n:
        faults.append(f"times: {len(found)} for {counted(n, 'sample')}")
    faults.extend(ascent_faults(found, named) or gap_faults(found, named))
    return found


def ascent_faults(times: Array, named: Named = by_index) -> list[str]:
    """Faults of times that do not ascend, or are not finite, with their places."""
    wrong = np.flatnonzero(~np.isfinite(times))
    if len(wrong):
        return [f"times: {len(wrong)} no finite number, {_listed(wrong, named)}: fill them, or say the rate"]
    steps = np.diff(times)
    same, back = np.flatnonzero(steps == 0) + 1, np.flatnonzero(steps < 0) + 1
    told = (("repeated", same, "delete one of both"), ("before the one ahead of it", back, "sort them"))
    return [
        f"times: {len(each)} {what}, {_listed(each, named, times)}: {cure}" for what, each, cure in told if len(each)
    ]


def gap_faults(times: Array, named: Named = by_index) -> list[str]:
    """Faults of times that are even but for gaps, where samples are missing; none where they are uneven."""
    steps = np.diff(times)
    if len(steps) < 4:
        return []
    usual = float(np.median(steps))
    even = np.abs(steps - usual) < (GAP - 1) * usual
    gaps = np.flatnonzero(steps >= GAP * usual) + 1
    if not len(gaps) or np.mean(even) < EVEN:
        return []
    missing = int(np.sum(np.round(steps[gaps - 1] / usual) - 1))
    where = f"{counted(len(gaps), 'gap')} before {_listed(gaps, named, times)}"
    return [f"times: {where}, {counted(missing, 'sample')} missing: fill them, or cut the record there"]


def _listed(indices: Index, named: Named, times: Array | None = None) -> str:
    """``index 3 (0.5 s), index 7 (1 s) and 2 more``."""
    told = [named(i) + ("" if times is None else f" ({times[i]:.6g} s)") for i in indices[:LISTED].tolist()]
    more = f" and {len(indices) - LISTED} more" if len(indices) > LISTED else ""
    return f"{', '.join(told)}{more}"


def require_peak(peak: float, quantity: str) -> None:
    """ValueError for an acceleration (m/s²) that no base has, beyond 10⁶ g, and no other ``quantity``."""
    if quantity == "acceleration" and abs(peak) > MOST:
        told = f"an acceleration of {abs(peak) / GRAVITY:.3g} g, more than 10⁶ g, ten times a pyrotechnic shock's"
        raise ValueError(f"record: {told}: is the unit, or the rate of the samples, the right one?")


def too_coarse(record: Any, highest_rate: float, error: float = 0.1) -> float | None:
    """Samples per second that a record needs for a mode of ``highest_rate`` rad/s; None where it has them.

    Needed is that a sine of this frequency, sampled so, is off by at most ``error``, a share of its amplitude, once it
    is joined as the record's samples were (``Record.sampled`` has the formulas). A record that is exact between its
    knots needs none. ValueError for a rate or an error that is not positive.

    >>> import vibeam
    >>> record = vibeam.Record.sampled([0.0, 1.0, 0.0, -1.0, 0.0], rate=1000.0)
    >>> round(vibeam.too_coarse(record, highest_rate=3000.0, error=0.01))
    10607
    """
    faults: list[str] = []
    if not isinstance(record, SampledRecords):
        faults.append(f"record: must be a Record, not {shown(record)}")
    highest_rate = number("highest_rate", highest_rate, faults, above=0.0)
    error = number("error", error, faults, above=0.0)
    refuse("too_coarse", faults)
    if record.samples is None:
        return None
    constant, power = ERRORS[record.samples]
    needed = highest_rate / (constant * error) ** (1 / power)
    return needed if float(np.diff(record.times).max()) * needed > 1 + 1e-9 else None
