"""Snapshots: modal displacements and velocities at instants of one motion."""

from __future__ import annotations

import numpy as np

from vibeam.flight.trajectory import simulate
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended
from vibeam_models.arrays import Array

INSTANTS = 2000


def modal_snapshots(system: ImpactSystem, drive: Drive, periods: int) -> tuple[Array, Array]:
    """Displacements and velocities (modes, instants) over ``periods`` of the drive, from static equilibrium.

    ValueError where the motion ends before.
    """
    path = simulate(system, drive, periods * 2 * np.pi / drive.omega)
    if path.ended is not Ended.COMPLETE:
        raise ValueError(f"the flight of the full model ended at {path.t_end:.4g} s: {path.ended.value}")
    poses = path.modes_at(np.linspace(0.0, path.t_end, INSTANTS + 1)[1:])
    return poses[:, 0].T, poses[:, 1].T
