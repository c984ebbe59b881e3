"""Tables of the beam and what is fixed to it; rules between their keys: places along the beam, its damping."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Annotated

from vibeam.case.faults import Complaint, KeyPath
from vibeam.casefile import quantities as units
from vibeam.casefile.field_lists import Several
from vibeam.casefile.fields import POSITIVE, Count, Quantity
from vibeam.casefile.tables.effects import effects_in
from vibeam.casefile.tables.table import MOST_ELEMENTS, Length, Place, Ratio, Table, key


def beam_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the beam and what is fixed to it."""
    yield from _positions(case)
    if case.mass is None:
        yield from _bare(case)
    yield from _damping(case.beam)


def _positions(case: SimpleNamespace) -> Iterator[Complaint]:
    named = {"mass": case.mass, "sensor": case.sensor, "stop": case.stop}
    places: dict[KeyPath, SimpleNamespace] = {(name, "position"): table for name, table in named.items()}
    length = case.beam.length
    for path, table in places.items():
        if length is not None and table is not None and table.position is not None and table.position > length:
            yield path, f"{table.position:g} m is beyond the tip: beam.length is {length:g} m"


def _bare(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about a beam without an attached mass."""
    if case.stop.position is None:
        yield (
            ("stop", "position"),
            'missing (without [mass] the stop is nowhere): write position = "132 mm", or add [mass]',
        )
    if case.beam.massless and not any(effect.inertias for _, effect, _ in effects_in(case)):
        yield ("beam", "massless"), "nothing is left that has mass: add [mass], or take massless out"
    if case.drive.gain is not None:
        yield ("drive", "gain"), 'is of a beam with an attached mass: write amplitude = "0.05 mm", or add [mass]'


def _damping(beam: SimpleNamespace) -> Iterator[Complaint]:
    path, ratios = ("beam", "damping_ratio"), beam.damping_ratio
    if isinstance(beam.damping, tuple):
        if ratios is not None:
            yield path, "beam.damping lists the ratios already: keep one of the two"
    elif beam.damping is not None and ratios is None:
        yield path, "missing (damping ratio of the first mode): write damping_ratio = 0.017"
    elif beam.damping == "rayleigh" and len(ratios) != 2:
        yield path, 'damping = "rayleigh" needs the ratios of modes 1 and 2: write damping_ratio = [0.017, 0.02]'
    elif beam.damping is not None and beam.damping != "rayleigh" and len(ratios) != 1:
        yield path, f'damping = "{beam.damping}" needs one number; a list of ratios goes into damping'


class BeamTable(Table):
    """The beam: a uniform cantilever of rectangular section, clamped at 0."""

    length: Annotated[float, Length] = key("free length, clamp to tip", "180 mm")
    width: Annotated[float, Length] = key("width of the section", "20 mm")
    thickness: Annotated[float, Length] = key("thickness of the section, in the direction of motion", "1.034 mm")
    youngs_modulus: Annotated[float, Quantity(units.PRESSURE, POSITIVE)] = key("modulus of elasticity", "210 GPa")
    density: Annotated[float, Quantity(units.DENSITY, POSITIVE)] = key("mass per volume", "7850 kg/m^3")
    damping_ratio: Annotated[tuple[float, ...] | None, Several(Ratio, alone=True)] = key(
        "of the first mode; for rayleigh a list of two, of modes 1 and 2; left away where damping is a list",
        0.017,
        None,
    )
    damping: Annotated[str | tuple[float, ...], Several(Ratio, words=("constant", "stiffness", "rayleigh"))] = key(
        "constant: the same ratio in every mode; stiffness: in proportion to the frequency; rayleigh: mass and "
        "stiffness; or the ratios mode by mode",
        "constant",
        "constant",
    )
    elements: Annotated[int, Count(1, MOST_ELEMENTS)] = key("finite elements along the beam", 36, 36)


class MassTable(Table):
    """The mass attached to the beam; absent = a bare beam."""

    mass: Annotated[float, Quantity(units.MASS, POSITIVE)] = key("attached mass", "0.2 kg")
    position: Annotated[float, Place] = key("distance from the clamp, in (0, length]", "132 mm")


class SensorTable(Table):
    """The sensor of the displacement."""

    position: Annotated[float, Place] = key("distance from the clamp, in (0, length]", "100 mm")


class SdofTable(Table):
    """A single degree of freedom in place of beam, mass and sensor: the paper's model, nondimensional."""

    natural_frequency: Annotated[float, Quantity(units.ANGULAR_FREQUENCY, POSITIVE)] = key(
        "of free motion, with its unit; 1 rad/s = nondimensional time", "1 rad/s", 1.0
    )
    damping_ratio: Annotated[float, Ratio] = key("β, of critical", 0.015)
