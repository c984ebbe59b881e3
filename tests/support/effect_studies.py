"""A quick rig with effects, its cases and their studies."""

from __future__ import annotations

from typing import Any

from stand_in import HELD_AT_CONTACT, RIG

from vibeam.casefile.read import parse
from vibeam.studies.effects import Effects, influence
from vibeam.studies.recorded_numbers import AskedNumber

CASES = RIG.parent
PEAK = AskedNumber("peak")
BEAM = HELD_AT_CONTACT.split("[fidelity.sdof]")[0]
FIDELITY = '[fidelity.beam]\nreduction = "modal"\nmodes = 4\n'
ADDED = '[[added_mass]]\nmass = "2.4 g"\nposition = "90 mm"\n'
CLAMP = '[clamp]\nstiffness = "50 N m/rad"\n'
GRAVITY = '[gravity]\ndirection = "hanging"\n'
TORSION = '[torsion]\neccentricity = "1 mm"\npolar_inertia = "2.988e-5 kg m^2"\npoissons_ratio = 0.3\n'
PLATFORM = (
    '[platform]\nmass = "5 kg"\nfrequency = "3.25 Hz"\ndamping_ratio = 0.05\ncoupling = "one-way"\n'
    'calibrated_at = "15.5 Hz"\n'
)
SHAKER = '[shaker]\nresistance = "4 ohm"\nforce_factor = "20 N/A"\n'
QUICK: dict[str, Any] = {
    "units": "SI",
    "beam.elements": 8,
    "sweep.frequency": {"from": "14 Hz", "to": "16.4 Hz", "points": 7},
    "sweep.direction": "up",
    "sweep.settle": 150,
    "sweep.hold": 4,
}


def case_of(*tables: str, **settings: Any) -> Any:
    """A quick case of the rig with further tables; settings by key with __ for dots."""
    given = {name.replace("__", "."): value for name, value in settings.items()}
    return parse(BEAM + FIDELITY + "\n".join(tables), RIG, QUICK | given)


def study_of(*tables: str, **settings: Any) -> Effects:
    return influence(case_of(*tables, **settings))


def by_name(study: Effects) -> dict[str, Any]:
    return {row.effect: row for row in study.rows}
