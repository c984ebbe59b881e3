"""Records of stationary Gaussian noise with a one-sided power spectral density, as tests by IEC 60068-2-64 and
MIL-STD-810 have them: synthesis by the fast Fourier transform.

Each line k/T of the transform has a complex Gaussian amplitude of variance S(k/T)/T, so that the samples are Gaussian
and stationary; twice as many as are kept are made, so that the end of a record knows nothing of its start.
Interpolation between samples h apart changes what lies at the frequency f by a factor H(f), and repeats it at k/h ± f:

    H = sinc² fh linear,    H = 3 sinc⁴ fh / (2 + cos 2πfh) cubic (Schoenberg, Cardinal Spline Interpolation, 1973)

with sinc x = sin πx/πx. The samples are made by S/H², so that the record itself, between its samples too, has the
density S in the band; the first repetition has S (H(1/h − f)/H(f))², at f = 1/10h 1.5e-4 linear, 2.3e-8 cubic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from vibeam.system import record_pieces as pieces
from vibeam.system.record_samples import LEAST, MOST_SAMPLES, extent, require_peak
from vibeam_models.arguments import count, number, real, real_array, refuse, word
from vibeam_models.arrays import Array

OVERSAMPLED = 10  # samples a period of the highest frequency of a density, where no rate is said
GRID = 2.0**-24  # of the standard deviation, to which samples are rounded, above what platforms differ by
TINY = 1e-300
LONGEST = 1 << 22  # transform at once


@dataclass(frozen=True, eq=False)
class DensityTable:
    """One-sided power spectral density: ``frequency`` (m,) Hz, ``level`` (m,) (unit)²/Hz, log-log between them."""

    frequency: Array
    level: Array

    def at(self, f: Array) -> Array:
        """Level at frequencies (Hz)."""
        logs = np.interp(np.log(np.maximum(f, TINY)), np.log(np.maximum(self.frequency, TINY)), np.log(self.level))
        return np.where((f >= self.frequency[0]) & (f <= self.frequency[-1]), np.exp(logs), 0.0)

    @property
    def mean_square(self) -> float:
        """Exact integral over frequency, (unit)²."""
        f, s = self.frequency, self.level
        with np.errstate(divide="ignore", invalid="ignore"):
            octaves = np.log(f[1:] / f[:-1])
            power = np.log(s[1:] / s[:-1]) + octaves  # p of f S over the piece, of integral f S (e^p − 1)/p · octaves
            sloped = f[:-1] * s[:-1] * octaves * np.where(np.abs(power) > TINY, np.expm1(power) / power, 1.0)
        return float(np.sum(np.where(s[1:] == s[:-1], s[1:] * np.diff(f), sloped)))


def density_table(density: Any, band: Any, top: float | None, faults: list[str]) -> DensityTable:
    """Density of a table ((f, S), …), or of one level over a ``band`` (Hz), None: from 0 to ``top``."""
    level = real(density)
    if level is not None:
        edges = real_array((0.0, top) if band is None and top is not None else band)
        if edges is None or edges.shape != (2,):
            faults.append("band: must be two frequencies, Hz; without one, white noise needs a rate")
            return DensityTable(np.zeros(0), np.zeros(0))
        density = [(edge, level) for edge in edges]
    elif band is not None:
        faults.append("band: goes with one level; a table has its own first and last frequency")
    table = real_array(density)
    if table is None or table.ndim != 2 or table.shape[1] != 2 or len(table) < 2 or not np.isfinite(table).all():
        faults.append("density: must be rows of frequency (Hz) and level ((unit)²/Hz), two at least, or one level")
        return DensityTable(np.zeros(0), np.zeros(0))
    frequency, levels = table.T
    if np.any(np.diff(frequency) <= 0) or frequency[0] < 0:
        faults.append("density: frequencies must be positive and ascend")
    elif frequency[0] == 0 and levels[0] != levels[1]:
        faults.append("density: log-log interpolation has no frequency 0: begin the table above it")
    if np.any(levels <= 0):
        faults.append("density: levels must be positive: a table ends where there is nothing more")
    return DensityTable(frequency, levels)


class RandomRecords(pieces.MadeOfPieces):
    """Chapter of ``Record``: stationary Gaussian noise."""

    @classmethod
    def random(
        cls, density: Any, duration: float, *, seed: int, rate: float | None = None,
        band: Sequence[float] | None = None, quantity: str = "acceleration", interpolation: str = "cubic",
        start: float = 0.0,
    ) -> Self:  # fmt: skip
        """Record of stationary Gaussian noise of a one-sided power spectral ``density``, in (unit of quantity)²/Hz.

        ``density``: rows of frequency (Hz) and level, joined by straight lines in log-log axes and 0 outside of them;
        or one level, white noise over the ``band`` of two frequencies (None: from 0 to half the ``rate``).
        ``rate``: samples per second, above twice the highest frequency; None: 10 times that. ``duration`` s, up to the
        next whole sample. Lines of the synthesis lie ``rate``/M apart, M the power of 2 from twice the samples on.

        One ``seed`` (numpy's default generator) is one realisation of one duration, rate and density; another duration
        with it is another realisation, a density times a constant is the same one scaled. Samples are rounded to 2⁻²⁴
        of their standard deviation or less, so that machines agree on them. The density holds for the record between
        its samples too; from ``rate`` minus its highest frequency on it has repetitions, which are smaller by 1e-7 for
        ``"cubic"`` and 2e-4 for ``"linear"`` where the rate is the default (``record_random.py``).

        ValueError names every fault: levels and frequencies that are not positive and ascending, a rate too low for
        them, a seed that is no whole number, a root mean square beyond 10⁶ g.

        >>> import vibeam
        >>> table = [(20, 0.96), (80, 3.8), (350, 3.8), (2000, 0.67)]  # (m/s²)²/Hz
        >>> vibeam.Record.random(table, duration=0.5, seed=7) == vibeam.Record.random(table, duration=0.5, seed=7)
        True
        """
        faults: list[str] = []
        top = None if rate is None else extent("rate", rate, faults) / 2
        table = density_table(density, band, top, faults)
        highest = float(table.frequency[-1]) if len(table.frequency) else 1.0
        rate = OVERSAMPLED * highest if rate is None else rate
        if not faults and 2 * highest > rate:
            faults.append(
                f"rate: {rate:g} Hz must be at least twice the highest frequency of the density, {2 * highest:g} Hz"
            )
        duration = extent("duration", duration, faults)
        seed, start = count("seed", seed, faults), number("start", start, faults)
        word("quantity", quantity, ("acceleration", "force", "moment"), faults)
        word("interpolation", interpolation, LEAST, faults)
        if not faults and duration * rate > MOST_SAMPLES:
            faults.append(
                f"duration: {duration * rate:.3g} samples, {MOST_SAMPLES:.3g} at most: shorten it, or lower rate"
            )
        refuse("record", faults)
        n = max(int(np.ceil(duration * rate * (1 - 1e-12))), 3) + 1
        require_peak(table.mean_square**0.5, quantity)
        values, times = gaussian(table, n, rate, seed, interpolation), start + np.arange(n) / rate
        made = pieces.linear(times, values) if interpolation == "linear" else pieces.spline(times, values)
        return cls(times, made, quantity)


def gaussian(table: DensityTable, n: int, rate: float, seed: int, interpolation: str) -> Array:
    """Samples (n,) of one realisation, the record of which has the density ``table`` once they are interpolated."""
    whole = 1 << (2 * n - 1).bit_length()
    lines, random = np.empty(whole // 2 + 1, dtype=complex), np.random.default_rng(seed)
    for part in (lines.real, lines.imag):
        part[:] = random.standard_normal(len(lines))
    for each in pieces.blocks(len(lines)):
        x = np.arange(each.start, each.stop) / whole
        filtered = np.sinc(x) ** 2 if interpolation == "linear" else 3 * np.sinc(x) ** 4 / (2 + np.cos(2 * np.pi * x))
        lines[each] *= np.sqrt(table.at(x * rate) * rate * whole) / 2 / filtered
    lines[[0, -1]] *= 2**0.5  # a line of half the width, and of one real number
    values = transformed(lines, n)
    grid = GRID * 2.0 ** np.floor(np.log2(table.mean_square) / 2)
    values /= grid
    return np.asarray(np.round(values, out=values) * grid)


def transformed(lines: NDArray[np.complex128], n: int) -> Array:
    """First ``n`` of W values by the inverse transform of their W/2 + 1 ``lines``, W a power of 2.

    Long ones as P shorter ones, of every P-th value from r on: with M = W/P, x_{Pm+r} = Σ_q e^{2πi qm/M} y_q / W and
    y_q = Σ_j z_{q+jM} e^{2πi (q+jM)r/W}, where z_{W−k} is conjugate to z_k.
    """
    whole = 2 * (len(lines) - 1)
    count = max(whole // LONGEST, 1)
    length, found = whole // count, np.empty(n)
    lines[[0, -1]] = lines[[0, -1]].real
    turns = np.exp(2j * np.pi / whole * np.arange(length // 2 + 1))
    turn = np.ones(length // 2 + 1, dtype=complex)
    for r in range(count):
        folded = np.zeros(length // 2 + 1, dtype=complex)
        for j in range(count):
            low, far = j * length, (count - j) * length + 1
            part = lines[low : low + len(folded)] if 2 * j < count else lines[far - len(folded) : far][::-1].conj()
            folded += part * np.exp(2j * np.pi * j * r / count)
        found[r::count] = np.fft.irfft(folded * turn, length)[: len(found[r::count])] / count
        turn *= turns
    return found
