"""Reduced beams that are kept are those that would be assembled anew, whatever the case changed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import ClassVar

import numpy as np
import pytest
from observed import NEUTRAL

import vibeam
from vibeam.case import reduced_structure
from vibeam.case.fidelity import system
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.scene import Effect, Scene
from vibeam_models.space import BeamSpace
from vibeam_models.structure import Structure

CHANGES = [
    {"stop.gap": "0.2 mm"},
    {"stop.gap": "0.2 mm", "stop.gap_at": "contact"},
    {"stop.restitution_of": "contact"},
    {"stop.position": "131 mm"},
    {"sensor.position": "90 mm"},
    {"beam.damping_ratio": 0.01},
    {"mass.mass": "0.1 kg"},
    {"gravity.direction": "transverse"},
    {"torsion.eccentricity": "2 mm", "torsion.polar_inertia": "3e-5 kg m^2", "torsion.poissons_ratio": 0.3},
    {
        "platform.mass": "5 kg",
        "platform.frequency": "3.25 Hz",
        "platform.damping_ratio": 0.05,
        "platform.coupling": "two-way",
        "platform.calibrated_at": "15.5 Hz",
    },
]


@pytest.fixture(autouse=True)
def nothing_kept() -> Iterator[None]:
    reduced_structure._kept.cache_clear()
    yield
    reduced_structure._kept.cache_clear()


def same(one: ImpactSystem, other: ImpactSystem) -> bool:
    pairs = [(getattr(one, field.name), getattr(other, field.name)) for field in fields(ImpactSystem)]
    return all(
        all(np.array_equal(a[key], b[key]) for key in a | b) if isinstance(a, dict) else np.array_equal(a, b)
        for a, b in pairs
    )


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: ", ".join(change))
def test_a_kept_beam_gives_the_system_of_a_new_one(change: dict[str, object]) -> None:
    plain, changed = vibeam.load(NEUTRAL), vibeam.load(NEUTRAL, set=change)
    before = plain.system("two_modes")
    with_kept = changed.system("two_modes")
    reduced_structure._kept.cache_clear()
    assert same(with_kept, changed.system("two_modes"))
    assert not same(with_kept, before)


def test_gap_and_restitution_assemble_nothing() -> None:
    for gap in ("0 mm", "0.1 mm", "0.2 mm"):
        vibeam.load(NEUTRAL, set={"stop.gap": gap, "stop.restitution": 0.6}).system("two_modes")
    assert reduced_structure._kept.cache_info().misses == 1


@dataclass(frozen=True)
class Weight(Effect):
    """Static load as large as the gap, to read of the stop what no effect of the package reads."""

    name: ClassVar[str] = "weight"

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        return structure.with_(static=structure.static + scene.stop.gap), space


def test_effects_of_users_may_read_the_whole_scene() -> None:
    case, pushed = vibeam.load(NEUTRAL), []
    for gap in (1e-4, 2e-4):
        scene = replace(case.scene, stop=replace(case.scene.stop, gap=gap), effects=(*case.scene.effects, Weight()))
        pushed.append(system(scene, case.fidelities["sdof"]).static[0])
    assert pushed[1] == pytest.approx(2 * pushed[0])
    assert pushed[0] != 0
