"""Deflected shape of the beam in a reduced model: from modal coordinates back to all of the beam.

Rows of deflection and slope at points along the beam pass through the reduction as outputs do: w(x) = w_x Φ q, with Φ
of the reduction's ``expand``. So a shape belongs to the same modes, signs included, as the system that moves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import isinf

import numpy as np

from vibeam.case.case import Case
from vibeam.case.fidelity import Fidelity
from vibeam.case.fidelity import system as system_of
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, ValueRecord
from vibeam_models.beam import assemble_with_space
from vibeam_models.beams.beam import Beam
from vibeam_models.effects.field_points import FieldPoints, output_names, points_of
from vibeam_models.scene import AnyScene, Scene
from vibeam_models.structure import Structure


@dataclass(frozen=True, eq=False, repr=False)
class BeamField(ValueRecord):
    """Points of one beam: ``positions`` (k,) m, rows (k, n) of ``deflection`` (m) and ``slope`` (rad) on coordinates.

    ``height`` (k,): of the section in the direction of motion, m, NaN where its shape does not say it.
    """

    positions: Array
    deflection: Array
    slope: Array
    height: Array


Fields = Mapping[str, BeamField]


def with_points(scene: AnyScene) -> Scene:
    """The scene with outputs at points along its beams; ValueError, with the reason, where it has no beam."""
    if not isinstance(scene, Scene):
        raise ValueError(f"no beam to draw: {scene.no_beam or 'the case gives no places of its coordinates'}")
    space = assemble_with_space(scene)[1]
    others = [points_of(each.other_beam(scene)[1]) for each in scene.named("opposite")]
    return replace(scene, effects=(*scene.effects, FieldPoints(points_of(space), *others)))


def field_system(scene: AnyScene, fidelity: Fidelity) -> tuple[ImpactSystem, Scene]:
    """System of a fidelity whose outputs hold ``fields``, and the scene with its points; errors as ``with_points``."""
    pointed = with_points(scene)
    return system_of(pointed, fidelity), pointed


def fields(pointed: Scene, model: ImpactSystem | Structure) -> Fields:
    """Fields by beam, ``"beam"`` and, where there is one, ``"opposite"``, of a system or structure ``with_points``."""
    points: FieldPoints = pointed.named(FieldPoints.name)[0]
    found = {"beam": _field("beam", points.positions, pointed.shaped_beam, model)}
    for other in pointed.named("opposite"):
        found["opposite"] = _field("opposite", points.opposite, other.beam(pointed), model)
    return found


def _field(name: str, positions: tuple[float, ...], beam: Beam, model: ImpactSystem | Structure) -> BeamField:
    deflection, slope = (
        np.array([model.outputs[each] for each in output_names(name, order, len(positions))], dtype=float)
        for order in (0, 1)
    )
    height = np.array([beam.height_at(x) for x in positions])
    return BeamField(np.array(positions), deflection, slope, height)


def stop_places(scene: Scene, system: ImpactSystem) -> list[tuple[float, float, float]]:
    """Place along the beam and touching deflection (m) of every stop, with 1 above the beam and −1 below."""
    first = scene.stop.position
    found = [(first, system.gap, 1.0)]
    found += [] if system.second_gap is None else [(first, -system.second_gap, -1.0)]
    for own, contact in zip(scene.named("further_stop"), system.further or (), strict=True):
        side = 1.0 if own.side == "above" else -1.0
        found.append((own.position, side * contact.gap, side))
    return found


STATIONS = 25  # places along the beam at which a page draws it


def stations(case: Case, name: str) -> dict[str, float]:
    """Places (m) along the beam at which it is drawn, by name; empty where no places are known."""
    scene = case.scene_of(name)
    if not isinstance(scene, Scene):
        return {}
    taken = {each.name for each in scene.outputs}
    places = np.linspace(0, scene.beam.length, STATIONS)[1:]
    return {made: float(x) for x in places if (made := f"at {x:.6g} m") not in taken}


def held_at_zero(case: Case, name: str) -> bool:
    """Test whether the beam's end at 0 stays at its base."""
    scene = case.scene_of(name)
    return isinstance(scene, Scene) and any(each.position == 0 and isinf(each.stiffness) for each in scene.carrier.held)
