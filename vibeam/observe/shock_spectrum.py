"""Shock response spectrum: largest responses of oscillators to the motion of their base, over natural frequency."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from vibeam.observe.oscillators import Pieces, extremes
from vibeam.system.record import Record
from vibeam_models.arguments import floats, number, refuse
from vibeam_models.arrays import Array, Index, ValueRecord

QUANTITIES = {"acceleration": "m/s²", "pseudo_velocity": "m/s", "displacement": "m"}
PARTS = ("maximax", "primary", "residual", "positive", "negative")


@dataclass(frozen=True, eq=False, repr=False)
class ShockSpectrum(ValueRecord):
    """Largest responses of oscillators of natural ``frequencies`` (F,), Hz, and one ``damping`` ratio.

    ``acceleration`` (p, 2, F), absolute, m/s², and ``displacement`` (p, 2, F), relative to the base, m: least and
    greatest until the shock's end and, where there is one (p = 2), after it, from rest on the base. With a stop
    ``impacts`` (F,) and ``impact_velocity`` (F,), the hardest one's, m/s; accelerations are then those between
    impacts of a rigid stop, which are infinite for no time.

    >>> import vibeam
    >>> vibeam.shock_spectrum(vibeam.Record.step(10.0, 0.2), [20.0, 50.0], 0.0)
    ShockSpectrum(20 … 50 Hz, 2 oscillators, damping 0, acceleration up to 20 m/s²)
    """

    frequencies: Array
    damping: float
    acceleration: Array
    displacement: Array
    impacts: Index | None = None
    impact_velocity: Array | None = None

    def __repr__(self) -> str:
        span = f"{self.frequencies[0]:.6g} … {self.frequencies[-1]:.6g} Hz, {len(self.frequencies)} oscillators"
        peak = f"acceleration up to {self.of('acceleration').max():.6g} m/s²"
        return f"ShockSpectrum({span}, damping {self.damping:g}, {peak}{'' if self.impacts is None else ', a stop'})"

    def of(self, quantity: str = "acceleration", part: str = "maximax") -> Array:
        """Spectrum (F,): largest sizes of a ``quantity``, of all its time or a ``part`` of it.

        ``"acceleration"`` (absolute), ``"displacement"`` (relative), ``"pseudo_velocity"`` (ω times it);
        ``"maximax"``, ``"primary"`` until the shock's end, ``"residual"`` after it, ``"positive"``, ``"negative"``: of
        that sign. ValueError for others, and for the residual part of a motion that goes on.
        """
        faults = [] if quantity in QUANTITIES else [f"quantity: {quantity!r} must be one of {', '.join(QUANTITIES)}"]
        faults += [] if part in PARTS else [f"part: {part!r} must be one of {', '.join(PARTS)}"]
        if part == "residual" and len(self.acceleration) < 2:
            faults.append("part: a motion goes on after its last computed time, so it has no residual spectrum")
        refuse("", faults)
        values = self.acceleration if quantity == "acceleration" else self.displacement
        factor = 2 * np.pi * self.frequencies if quantity == "pseudo_velocity" else 1.0
        return np.asarray(factor * _sized(values, part))


def _sized(values: Array, part: str) -> Array:
    """Largest sizes (F,) of a part of least and greatest values (p, 2, F)."""
    if part == "positive":
        return np.asarray(values[:, 1].max(axis=0))
    if part == "negative":
        return np.asarray(-values[:, 0].min(axis=0))
    chosen = {"primary": values[:1], "residual": values[1:]}.get(part, values)
    return np.asarray(np.abs(chosen).max(axis=(0, 1)))


def checked(frequencies: ArrayLike, damping: Any, faults: list[str]) -> tuple[Array, float]:
    """Frequencies (F,), Hz, and damping ratio; what is wrong is added to ``faults``."""
    rows = np.atleast_1d(floats("frequencies", frequencies))
    if rows.ndim != 1 or not rows.size or not (np.isfinite(rows).all() and np.min(rows) > 0):
        faults.append("frequencies: must be one or more finite numbers above 0, Hz")
    ratio = number("damping", damping, faults, least=0.0)
    if ratio >= 1:
        faults.append(f"damping: {ratio:g} must be below 1, the critical one")
    return rows, ratio


def spectrum_of_record(record: Record, frequencies: Array, damping: float) -> ShockSpectrum:
    """Spectrum of oscillators without stop under a record, exact for its polynomials, extremes between samples too.

    A ramp-invariant filter (ISO 18431-4; Smallwood 1981) gives the same values at samples of a record interpolated
    linearly; the largest of these is less than the peak by up to (ωh)²/8 of it.
    """
    return spectrum_of_pieces(Pieces(record.times, record.coefficients), frequencies, damping)


def spectrum_of_pieces(pieces: Pieces, frequencies: Array, damping: float, parts: int = 2) -> ShockSpectrum:
    """Spectrum of oscillators on a base with these pieces of acceleration; ``parts`` 1: of that time alone."""
    acceleration, displacement = extremes(pieces, frequencies, damping)[:, :parts]
    return ShockSpectrum(frequencies, damping, acceleration, displacement)
