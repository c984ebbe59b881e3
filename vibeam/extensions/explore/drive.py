"""Base motion B of a fidelity over the drive frequency: a power of Ω where that is exact, else a table of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vibeam.case.case import Case
from vibeam_models.arrays import Array
from vibeam_models.base import POWERS, Base

SIZES = (*POWERS, "voltage")  # keys that say how large a drive is
SAME = 1e-14  # relative difference that is round-off of one power of Ω
WITHIN = 0.05  # share of a frequency by which the slider of that one alone goes on
POINTS = 401  # frequencies of a table, those of the sweep besides


@dataclass(frozen=True)
class DriveLevel:
    """Size of a fidelity's drive: the ``key`` that says it and its ``level`` (SI); 1 of a ``listed`` one.

    A drive that is a list over frequency is a factor on that list.
    """

    key: str
    level: float
    listed: bool

    @classmethod
    def of(cls, base: Base) -> DriveLevel:
        """Level of a scene's drive; ValueError where it has none."""
        name = next((each for each in SIZES if getattr(base, each) is not None), None)
        if name is None:
            raise ValueError("drive: nothing says how large it is")
        given = getattr(base, name)
        listed = isinstance(given, tuple)
        return cls(f"drive.{name}", 1.0 if listed else float(given), listed)


def drive_level(case: Case, name: str) -> DriveLevel:
    """Level of the drive of one fidelity."""
    return DriveLevel.of(_base(case, name))


def drive_amplitude(case: Case, name: str, frequency: Array) -> dict[str, Any]:
    """B a unit of level, for the page: ``power`` and ``factor`` of B = level · factor/Ω^power, or B at ``frequency``.

    ``level`` is the case's own. A table has ``frequency`` (Hz) and ``amplitude`` (m a unit of level).
    """
    own, omega = drive_level(case, name), 2 * np.pi * frequency
    model = case.model(name)
    one = (model if own.listed else model.at({own.key: 1.0})).amplitude(omega)
    found = np.broadcast_to(np.asarray(one, dtype=float), omega.shape)
    head: dict[str, Any] = {"level": own.level}
    for power in (0, 1, 2):
        factor = float(f"{found[0] * omega[0] ** power:.15g}") if power else float(found[0])
        if np.allclose(factor / omega**power, found, rtol=SAME, atol=0.0):
            return head | {"power": power, "factor": factor}
    return head | {"frequency": frequency, "amplitude": np.array(found)}


def frequency_range(case: Case) -> tuple[float, float]:
    """Ends of the frequency slider (Hz): those of the sweep; about a single frequency as far as tables of drives go."""
    low, high = float(case.sweep.frequency[0]), float(case.sweep.frequency[-1])
    if low < high:
        return low, high
    tables = [table for name in case.fidelities if (table := _base(case, name).frequency)]
    least, most = max((each[0] for each in tables), default=0.0), min((each[-1] for each in tables), default=np.inf)
    return max(low * (1 - WITHIN), min(least, low)), min(high * (1 + WITHIN), max(most, high))


def slider_frequencies(case: Case) -> Array:
    """Frequencies (Hz) of tables: those of the sweep, and evenly between the ends of the slider."""
    return np.unique(np.concatenate([case.sweep.frequency, np.linspace(*frequency_range(case), POINTS)]))


def _base(case: Case, name: str) -> Base:
    scene: Any = case.scene_of(name)
    found: Base = scene.base
    return found


def motion_without_stop(case: Case, name: str, output: str) -> float:
    """Largest amplitude of an output of one fidelity over the sweep, as if no stop were there, SI; 0 where unbounded.

    Damping that couples the modes is taken without what couples them: it is a size, not a result.
    """
    system, omega = case.system(name), 2 * np.pi * case.sweep.frequency[:, None]
    derivative, given = system.derivative(output), np.asarray(case.amplitude_of(name, omega[:, 0]))
    stiffness = system.omega**2 - omega**2 + 2j * system.omega * system.zeta * omega
    with np.errstate(divide="ignore", invalid="ignore"):
        modes = system.row(output) * system.load / stiffness
        size = np.abs(omega[:, 0] ** (2 + (derivative.order if derivative else 0)) * given * modes.sum(axis=1))
    return float(np.max(size[np.isfinite(size)], initial=0.0))
