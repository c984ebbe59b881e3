"""Snapshots for a reduction that is made of a flight of the full model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam_models.registry import loaded

if TYPE_CHECKING:
    from vibeam.system.impact_system import ImpactSystem
    from vibeam_models.scene import RigScene
    from vibeam_reductions.subspaces import Snapshots

FLIGHT = "vibeam.flight.snapshots:modal_snapshots"
PERIODS = 50
KEPT = 8


def with_snapshots(
    scene: RigScene, parameters: Mapping[str, Any], full: Callable[[RigScene], ImpactSystem]
) -> Mapping[str, Any]:
    """Parameters of a reduction, with the ``snapshots`` of a flight in place of its frequency and periods.

    ``full``: the scene's full model. ValueError on a platform, whose own motion is none of the beam's modes.
    """
    if scene.platform is not None:
        raise ValueError(
            "pod: its flight is over a base that moves as prescribed, and this rig has a platform: "
            'write reduction = "residual_flexibility"'
        )
    given = dict(parameters)
    snapshots = _flown(scene, given.pop("frequency"), given.pop("periods", PERIODS), full)
    return given | {"snapshots": snapshots}


@lru_cache(maxsize=KEPT)
def _flown(scene: RigScene, frequency: float, periods: int, full: Callable[[RigScene], ImpactSystem]) -> Snapshots:
    from vibeam.system.impact_system import Drive
    from vibeam_models.base_motion import drive_amplitude
    from vibeam_reductions.subspaces import Snapshots

    omega = 2 * np.pi * frequency
    amplitude = float(np.ravel(drive_amplitude(scene, np.array([omega])))[0])
    return Snapshots(*loaded(FLIGHT)(full(scene), Drive(omega, amplitude), periods))
