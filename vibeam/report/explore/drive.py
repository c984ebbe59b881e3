"""Base motion B of a fidelity over the drive frequency: a power of Ω where that is exact, else a table of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam_models.base import POWERS, Base

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam_models.arrays import Array

SIZES = (*POWERS, "voltage")  # keys that say how large a drive is
SAME = 1e-14  # relative difference that is round-off of one power of Ω
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
    scene: Any = case.scene_of(name)
    return DriveLevel.of(scene.base)


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


def slider_frequencies(case: Case) -> Array:
    """Frequencies (Hz) of tables: those of the sweep, and evenly between its ends."""
    swept = case.sweep.frequency
    return np.unique(np.concatenate([swept, np.linspace(swept[0], swept[-1], POINTS)]))
