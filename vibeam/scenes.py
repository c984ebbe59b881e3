"""From the tables of a case to the scene on the bench."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam_models.scene import (
    AddedMass,
    Base,
    Beam,
    Clamp,
    Damping,
    Gravity,
    Mass,
    Platform,
    Scene,
    SdofScene,
    Sensor,
    Shaker,
    Stop,
    Torsion,
)

if TYPE_CHECKING:
    from vibeam.schema import (
        BeamCase,
        BeamTable,
        PlatformTable,
        SdofCase,
        SdofStopTable,
        StopTable,
        TorsionTable,
    )


def scene_of(case: BeamCase | SdofCase) -> Scene | SdofScene:
    """The scene that a checked case declares, SI units."""
    from vibeam.schema import SdofCase

    if isinstance(case, SdofCase):
        return SdofScene(
            natural_frequency=case.sdof.natural_frequency,
            damping_ratio=case.sdof.damping_ratio,
            gap=case.stop.gap,
            restitution=1.0 if case.stop.restitution is None else case.stop.restitution,
            amplitude=case.drive.amplitude,
            stop=_sdof_stop(case.stop),
        )
    return Scene(
        beam=_beam(case.beam),
        mass=None if case.mass is None else Mass(**dict(case.mass)),
        stop=_stop(case.stop, 0.0 if case.mass is None else case.mass.position),
        sensor=Sensor(case.sensor.position),
        base=Base(**dict(case.drive)),
        added_masses=tuple(AddedMass(**dict(added)) for added in case.added_mass),
        **_effects(case),
    )


def _sdof_stop(table: SdofStopTable) -> Stop | None:
    beyond = {name: value for name, value in dict(table).items() if name not in ("gap", "restitution")}
    if all(value is None for value in beyond.values()):
        return None
    return Stop(position=0.0, gap=table.gap, restitution=table.restitution, **beyond)


def _effects(case: BeamCase) -> dict[str, Any]:
    """The effects that have a table of their own, those that the case names."""
    made: dict[str, Callable[[Any], Any]] = {
        "clamp": lambda table: Clamp(**dict(table)),
        "gravity": lambda table: Gravity(**dict(table)),
        "torsion": lambda table: _torsion(table, case.beam),
        "platform": _platform,
        "shaker": lambda table: Shaker(**dict(table)),
    }
    named = {name: getattr(case, name) for name in made}
    return {name: made[name](table) for name, table in named.items() if table is not None}


def _beam(table: BeamTable) -> Beam:
    values = dict(table)
    kind, ratios = values.pop("damping"), values.pop("damping_ratio")
    damping = Damping("list", kind) if isinstance(kind, tuple) else Damping(kind, ratios)
    return Beam(damping=damping, **values)


def _torsion(table: TorsionTable, beam: BeamTable) -> Torsion:
    modulus = table.shear_modulus
    if modulus is None:
        modulus = beam.youngs_modulus / (2 * (1 + (table.poissons_ratio or 0.0)))
    return Torsion(table.eccentricity, modulus, table.polar_inertia)


def _platform(table: PlatformTable) -> Platform:
    coupling: Any = table.coupling
    stiffness, calibrated = table.stiffness, table.calibrated_at
    if stiffness is None:
        stiffness = table.mass * (2 * np.pi * (table.frequency or 0.0)) ** 2
    at = None if calibrated is None else 2 * np.pi * calibrated
    return Platform(table.mass, stiffness, table.damping_ratio, coupling, at)


def _stop(table: StopTable, mass_position: float) -> Stop:
    return Stop(**dict(table) | {"position": mass_position if table.position is None else table.position})
