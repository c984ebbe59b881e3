"""Masses on springs of which others have printed numbers, as vibeam builds and moves them: with a stop or without."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

import vibeam
from tests.others.problem import spoiled

STILL = vibeam.Drive(0.0, 0.0)
FAR = 1e6  # gap of a stop that is never met


def one_mass(mass: float, stiffness: float = 0.0, damping: float = 0.0, force: float = 0.0, **more: Any):
    """A mass on a spring and a damper under a constant force; output ``"x"``. Springs and forces are spoiled."""
    row, omega = np.array([mass**-0.5]), np.sqrt(spoiled() * stiffness / mass)
    ratio = damping / (2 * mass * omega) if damping else 0.0
    given = {"gap": FAR, "restitution": 0.5, "static": spoiled() * force * row, "outputs": {"x": row}}
    if "law" in more:
        del given["restitution"]
    return vibeam.ImpactSystem.from_modes([omega], ratio, row, row, **{**given, **more})


def masses(mass: ArrayLike, stiffness: ArrayLike, contact: ArrayLike, static: ArrayLike, load: ArrayLike, **more: Any):
    """Masses on springs by their matrices, outputs ``"0"``, ``"1"`` …; springs and constant forces are spoiled."""
    inertia = np.diag(np.asarray(mass, dtype=float))
    rows = {str(i): row for i, row in enumerate(np.eye(len(inertia)))}
    structure = vibeam.Structure(
        M=inertia, C=0 * inertia, K=spoiled() * np.asarray(stiffness, dtype=float), load=load,
        static=spoiled() * np.asarray(static, dtype=float), contact=contact, outputs=rows,
        units=dict.fromkeys(rows, "m"),
    )  # fmt: skip
    return vibeam.ImpactSystem.from_structure(structure, **{"gap": FAR, "restitution": 0.5, **more})


def flown(system: vibeam.ImpactSystem, end: float, place: ArrayLike, speed: ArrayLike, drive: Any = STILL):
    """Motion of masses from given places and speeds, in the outputs ``"x"`` or ``"0"``, ``"1"`` …"""
    rows = np.array([row for name, row in system.outputs.items() if name == "x" or name.isdigit()])
    start = (np.linalg.solve(rows, np.atleast_1d(np.asarray(each, dtype=float))) for each in (place, speed))
    return vibeam.simulate(system, drive, end, vibeam.State(*start))


def turned(path: vibeam.Trajectory, output: str, after: float, before: float) -> tuple[float, float]:
    """When the velocity of an output is 0 between two times, and where it is then."""
    time = brentq(lambda t: float(path.velocity_at(t, output)), after, before, xtol=1e-14)
    return time, float(path.at(time, output))
