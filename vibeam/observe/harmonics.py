"""Harmonics and subharmonics of a motion (paper Fig. 20), spectra of sampled signals, the modes' shares in a motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vibeam.observe.motion import Path, integral, last_periods
from vibeam_models.arrays import Array, Complex, ValueRecord


@dataclass(frozen=True, eq=False, repr=False)
class Harmonics(ValueRecord):
    """x(t) ≈ Re Σ amplitude·e^{i·order·Ωt}, the drive's phase being 0 at t = 0.

    ``order`` (m,): multiples of the drive frequency, ascending, 0 first; ``frequency`` (m,) Hz; ``amplitude`` (m,)
    complex, in m: of order 0 the mean, of the others a sine's peak value and phase.
    """

    order: Array
    frequency: Array
    amplitude: Complex

    def of(self, order: float) -> complex:
        """Amplitude of one order; KeyError for an order not computed."""
        found = np.flatnonzero(np.abs(self.order - order) < 1e-9)
        if not len(found):
            raise KeyError(f"no order {order}: there are {', '.join(f'{k:g}' for k in self.order)}")
        return complex(self.amplitude[found[0]])


def harmonic_amplitudes(
    path: Path, output: str = "sensor", *, periods: int = 1, highest: int = 8, subdivision: int = 1
) -> Harmonics:
    """Harmonics of order 0, 1/m, 2/m … ``highest`` (m = ``subdivision``) of an output over the last drive ``periods``.

    X_k = 2/T ∫ x e^{−ikΩt} dt, of order 0 half of it, to round-off: see ``quadrature``. ValueError for ``periods`` that
    are no multiple of ``subdivision`` or more than available, KeyError for an unknown output.
    """
    order = _orders(highest, subdivision)
    if periods % subdivision:
        raise ValueError(f"periods: {periods} are no multiple of the subdivision {subdivision}")
    path.system.derivative(output)  # KeyError for an unknown one
    begin, end = last_periods(path, periods)
    omega = path.drive.omega

    def turned(t: Array) -> Complex:
        return np.asarray(path.at(t, output)[:, None] * np.exp(-1j * omega * t[:, None] * order))

    amplitude: Complex = integral(path, begin, end, turned, highest=highest * omega)
    amplitude *= 2 / (end - begin)
    amplitude[0] /= 2
    return Harmonics(order, order * omega / (2 * np.pi), amplitude)


def _orders(highest: int, subdivision: int) -> Array:
    if highest < 1 or subdivision < 1:
        raise ValueError(f"highest {highest} and subdivision {subdivision} must be ≥ 1")
    return np.arange(highest * subdivision + 1) / subdivision


@dataclass(frozen=True, eq=False, repr=False)
class Spectrum(ValueRecord):
    """One-sided, at ``frequency`` (m,) Hz, of a signal: ``amplitude`` (m,), a sine on a line reads its peak value."""

    frequency: Array
    amplitude: Array


def spectrum_of(time: ArrayLike, values: ArrayLike, *, window: str = "hann") -> Spectrum:
    """Spectrum of evenly sampled values (m,) about their mean, through a ``window``: any name that scipy.signal knows.

    ValueError for samples that are not evenly spaced.
    """
    from scipy import signal

    t, x = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    rate = sampling_rate(t)
    shape = signal.get_window(window, len(t))
    frequency, power = signal.welch(x, fs=rate, window=shape, nperseg=len(t), scaling="spectrum")
    sine = np.where((frequency > 0) & (frequency < rate / 2 * (1 - 1e-12)), 2.0, 1.0)
    return Spectrum(frequency, np.sqrt(sine * power))


def sampling_rate(time: Array) -> float:
    """Samples a second of evenly spaced times (m,); ValueError where they are not even."""
    steps = np.diff(time)
    if time.ndim != 1 or not len(steps) or not np.all(np.isfinite(steps)):
        raise ValueError("time: must be two or more finite times")
    step = float(time[-1] - time[0]) / len(steps)
    if not (step > 0 and np.max(np.abs(steps - step)) <= 1e-6 * step):
        raise ValueError("time: must be evenly spaced")
    return 1 / step


@dataclass(frozen=True, eq=False, repr=False)
class Participation(ValueRecord):
    """Shares of the modes (n,), and the absolute values behind them.

    ``energy``: time-mean ½(η'² + ω²η²), J, and ``energy_share`` of their sum. ``displacement`` and ``velocity``: rms of
    each mode's part at the sensor (m, m/s; displacement about its mean), and ``…_share``: of the sum of their squares,
    so that shares add up to 1 whatever the modes' correlation. ``impulse_share``: c_i²/S, the part of an impulse's
    velocity change at the contact that mode i takes.
    """

    frequency: Array
    energy: Array
    energy_share: Array
    displacement: Array
    displacement_share: Array
    velocity: Array
    velocity_share: Array
    impulse_share: Array


def modal_participation(path: Path, output: str = "sensor", *, periods: int) -> Participation:
    """Participation of every mode over the last ``periods`` drive periods, integrated to round-off.

    ValueError for more periods than available, KeyError for an unknown output.
    """
    begin, end = last_periods(path, periods)
    system, row = path.system, path.system.output(output)
    means = integral(path, begin, end, lambda t: _moments(path.modes_at(t))) / (end - begin)
    middle, square, speed = means
    spread = np.maximum(square - middle**2, 0.0)
    energy = (speed + system.omega**2 * square) / 2
    return Participation(
        system.omega / (2 * np.pi),
        energy,
        shares(energy),
        np.abs(row) * np.sqrt(spread),
        shares(row**2 * spread),
        np.abs(row) * np.sqrt(speed),
        shares(row**2 * speed),
        shares(system.contact**2),
    )


def _moments(values: Array) -> Array:
    """Moments η, η², η'² (m, 3, n) of modal values (m, 2, n)."""
    return np.stack([values[:, 0], values[:, 0] ** 2, values[:, 1] ** 2], axis=1)


def shares(parts: Array) -> Array:
    """Shares of the sum; NaN where all parts are 0."""
    total = float(np.sum(parts))
    return parts / total if total > 0 else np.full(len(parts), np.nan)
