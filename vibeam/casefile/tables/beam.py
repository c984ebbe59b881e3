"""Tables of the beam and what is fixed to it; rules between their keys: places along the beam, its damping."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path as File
from types import SimpleNamespace
from typing import Any

from vibeam.case.study_plans import MOST_ELEMENTS
from vibeam.casefile import quantities as units
from vibeam.casefile.fields import Count, Quantity, Several, Word
from vibeam.casefile.kinds import MODELS
from vibeam.casefile.quantities import POSITIVE, Range
from vibeam.casefile.tables.declared import Table, key, table
from vibeam.casefile.tables.drive import drive_checks
from vibeam.casefile.tables.effects import effect_checks, effects_in
from vibeam.casefile.tables.held_places import held_checks
from vibeam.casefile.tables.outputs import output_checks
from vibeam.casefile.tables.sweep import model_named
from vibeam.casefile.tables.table import Length, Ratio, declared_key, plan_keys
from vibeam.casefile.toml_writing import to_fill_in
from vibeam.exchange.faults import Complaint, KeyPath
from vibeam_models.beams.shapes import SHAPES, foreign_dimensions
from vibeam_models.keys import defaults_of, keys_of
from vibeam_models.registry import loaded
from vibeam_models.scene import Mass, Sensor


def beam_rules(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Complaints about a beam, its drive and its effects."""
    yield from beam_checks(case)
    yield from drive_checks(case)
    yield from effect_checks(case)
    yield from output_checks(case)
    yield from held_checks(case)
    used = {model_named(each) for each in case.fidelity.values()}
    for name, model in MODELS.items():
        if model.rules and (name in used or getattr(case, name) is not None):
            yield from loaded(model.rules)(case, folder)


def beam_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the beam and what is fixed to it."""
    yield from _positions(case)
    if case.mass is None:
        yield from _bare(case)
    yield from _shape(case.beam)
    yield from damping_checks(case.beam, "beam")


def _shape(beam: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the dimensions of the section."""
    kind = SHAPES[beam.shape or "rectangle"]
    own = keys_of(kind)
    for name in [each for each in own if each not in defaults_of(kind)]:
        if getattr(beam, name) is None:
            yield ("beam", name), f"missing ({own[name].meaning}): write {name} = {to_fill_in(own[name].example)}"
    faults = (*foreign_dimensions(beam, kind.name), *kind.faults(beam))
    yield from ((("beam", name), message) for name, message in faults)


def _positions(case: SimpleNamespace) -> Iterator[Complaint]:
    named = {"mass": case.mass, "sensor": case.sensor, "stop": case.stop}
    places: dict[KeyPath, SimpleNamespace] = {(name, "position"): each for name, each in named.items()}
    length = case.beam.length
    for path, each in places.items():
        if length is not None and each is not None and each.position is not None and each.position > length:
            yield path, f"{each.position:g} m is beyond the tip: beam.length is {length:g} m"


def _bare(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about a beam without an attached mass."""
    if case.stop.position is None:
        yield (
            ("stop", "position"),
            'missing (without [mass] the stop is nowhere): write position = "… mm", or add [mass]',
        )
    if case.beam.massless and not any(effect.inertias for _, effect, _ in effects_in(case)):
        yield ("beam", "massless"), "nothing is left that has mass: add [mass], or take massless out"
    if case.drive.gain is not None:
        yield ("drive", "gain"), 'is of a beam with an attached mass: write amplitude = "… mm", or add [mass]'


def damping_checks(beam: SimpleNamespace, name: str) -> Iterator[Complaint]:
    """Complaints about the damping ratios of the table [``name``]."""
    path, ratios = (name, "damping_ratio"), beam.damping_ratio
    if isinstance(beam.damping, tuple):
        if ratios is not None:
            yield path, f"{name}.damping lists the ratios already: keep one of the two"
    elif beam.damping is not None and ratios is None:
        yield path, "missing (damping ratio of the first mode): write damping_ratio = …"
    elif beam.damping == "rayleigh" and len(ratios) != 2:
        yield path, 'damping = "rayleigh" needs the ratios of modes 1 and 2: write damping_ratio = […, …]'
    elif beam.damping is not None and beam.damping != "rayleigh" and len(ratios) != 1:
        yield path, f'damping = "{beam.damping}" needs one number; a list of ratios goes into damping'


def most_modes(case: Any, folder: File) -> tuple[int, str]:
    """Largest number of modes of a beam's case (0: not known), and the key that sets it."""
    effects = [effect for _, effect, _ in effects_in(case)]
    if case.beam.massless:
        return (case.mass is not None) + sum(effect.inertias for effect in effects), "a massless beam's inertias give"
    each = 2 + sum(effect.modes_per_element for effect in effects)
    return each * (case.beam.elements or 0), "beam.elements gives"


def _shape_keys() -> dict[str, Any]:
    """The keys of all shapes of a section, none of which every beam has."""
    return {name: declared_key(each, None) for shape in SHAPES.values() for name, each in keys_of(shape).items()}


class _Along(Table):
    length = key(Length, "length, from x = 0 to the tip", "180 mm")
    shape = key(Word(tuple(SHAPES)), "of the section; absent = rectangle", "tube", None)


class _Made(Table):
    youngs_modulus = key(Quantity(units.PRESSURE, POSITIVE), "modulus of elasticity", "210 GPa")
    density = key(Quantity(units.DENSITY, POSITIVE), "mass per volume", "7850 kg/m^3")
    poissons_ratio = key(
        Quantity(units.RATIO, Range(0, 0.5)),
        "of theory timoshenko, torsion, a solid, and of a stop that yields by shape and materials",
        0.3,
        None,
    )
    damping_ratio = key(
        Several(Ratio, alone=True),
        "of the first elastic mode; for rayleigh a list of two, of elastic modes 1 and 2; absent where damping is one",
        0.017,
        None,
    )
    damping = key(
        Several(Ratio, words=("constant", "stiffness", "rayleigh")),
        "constant: the same ratio in every mode; stiffness: in proportion to the frequency; rayleigh: mass and "
        "stiffness; or the ratios of the elastic modes one by one (rigid-body modes have none)",
        "constant",
        "constant",
    )
    elements = key(Count(1, MOST_ELEMENTS), "finite elements along the beam", 36, 36)


BeamTable = table("BeamTable", "The beam, clamped at 0 unless ends says otherwise.", _Along, _shape_keys(), _Made)


MassTable = table("MassTable", Mass.__doc__, plan_keys(Mass))
SensorTable = table("SensorTable", Sensor.__doc__, plan_keys(Sensor))
