"""Participation of the modes in a motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam.observe.motion import Path, last_periods
from vibeam.observe.quadrature import integral
from vibeam_models.arrays import Array


@dataclass(frozen=True)
class Participation:
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
