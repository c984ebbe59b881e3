"""What the tables of effects say together with the rest of a case."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Annotated

from vibeam.case.faults import Complaint, KeyPath
from vibeam.casefile import quantities as units
from vibeam.casefile.fields import NOT_NEGATIVE, POSITIVE, Quantity, Range, Word
from vibeam.casefile.tables.table import Frequency, Ratio, Table, key


def effect_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the effects that a beam's case names; an effect that is absent is None there."""
    if case.gravity is not None:
        yield from _gravity(case.gravity)
    if case.torsion is not None:
        yield from _torsion(case)
    if case.platform is not None:
        yield from _platform(case.platform)
    if case.shaker is not None:
        yield from _shaker(case)


def platform_output(case: SimpleNamespace, path: KeyPath, output: str | None) -> Iterator[Complaint]:
    """A complaint where the motion of a platform is asked for that is not there, or is prescribed."""
    if output == "platform" and (case.platform is None or case.platform.coupling == "one-way"):
        yield path, 'the platform has no motion of its own: add [platform] with coupling = "two-way"'


def _gravity(gravity: SimpleNamespace) -> Iterator[Complaint]:
    downwards = gravity.direction in ("hanging", "standing")
    if downwards and gravity.acceleration is not None and gravity.acceleration < 0:
        other = "standing" if gravity.direction == "hanging" else "hanging"
        yield ("gravity", "acceleration"), f'is negative: for the other way up write direction = "{other}"'


def _torsion(case: SimpleNamespace) -> Iterator[Complaint]:
    torsion, width = case.torsion, case.beam.width
    path = ("torsion", "poissons_ratio")
    given = [name for name in ("poissons_ratio", "shear_modulus") if getattr(torsion, name) is not None]
    if len(given) == 2:
        yield path, "shear_modulus says it already: keep one of the two"
    elif not given:
        yield path, "missing (or shear_modulus): write poissons_ratio = 0.3"
    elif torsion.poissons_ratio is not None and torsion.poissons_ratio > 0.5:
        yield path, f"{torsion.poissons_ratio:g} is above 0.5, where the volume grows under pressure"
    if torsion.eccentricity is not None and width is not None and abs(torsion.eccentricity) > width / 2:
        yield ("torsion", "eccentricity"), f"{torsion.eccentricity:g} m is beside the beam: beam.width is {width:g} m"


def _platform(platform: SimpleNamespace) -> Iterator[Complaint]:
    path = ("platform", "frequency")
    if platform.frequency is not None and platform.stiffness is not None:
        yield path, "platform.stiffness says it already: keep one of the two"
    elif platform.frequency is None and platform.stiffness is None:
        yield path, 'missing (or stiffness): write frequency = "3.25 Hz"'


def _shaker(case: SimpleNamespace) -> Iterator[Complaint]:
    if case.platform is None:
        yield ("shaker",), "drives a platform: add [platform], or take [shaker] away"
    elif case.platform.coupling == "two-way" and case.shaker.inductance:
        yield (
            ("shaker", "inductance"),
            "with two-way coupling the coil's current would be a state of its own, half a mode, which no solver "
            'carries: leave inductance out, or write coupling = "one-way"',
        )


class ClampTable(Table):
    """Effect: the clamp yields when it is turned; absent = it does not."""

    stiffness: Annotated[float, Quantity(units.TURNING_STIFFNESS, POSITIVE)] = key(
        "moment per rotation of the clamp", "500 N m/rad"
    )


class GravityTable(Table):
    """Effect: weight along the beam stiffens or softens it, weight across bends it; absent = no weight.

    The gap is counted from the straight beam.
    """

    direction: Annotated[str, Word(("hanging", "standing", "transverse"))] = key(
        "the clamp is above, or below; or the axis is level and the weight draws toward the stop", "hanging"
    )
    acceleration: Annotated[float, Quantity(units.ACCELERATION)] = key(
        "of free fall; negative, for transverse alone: away from the stop", "9.80665 m/s^2", 9.80665
    )


class TorsionTable(Table):
    """Effect: the stop meets the beam off its axis and twists it; absent = on the axis.

    The modes of torsion count among the beam's, for damping ratios and for fidelities.
    """

    eccentricity: Annotated[float, Quantity(units.LENGTH)] = key("of the contact, across the beam", "1 mm")
    polar_inertia: Annotated[float, Quantity(units.INERTIA, POSITIVE)] = key(
        "of the attached mass about the beam's axis", "2.988e-5 kg m^2"
    )
    poissons_ratio: Annotated[float | None, Quantity(units.RATIO, Range(0, 1))] = key(
        "of the beam, gives its shear modulus; or say that", 0.3, None
    )
    shear_modulus: Annotated[float | None, Quantity(units.PRESSURE, POSITIVE)] = key(
        "of the beam, instead of Poisson's ratio", "80 GPa", None, written=False
    )


class PlatformTable(Table):
    """Effect: clamp and stop stand on a sprung platform, and the drive is a force on it; absent = the base's motion
    is prescribed.
    """

    mass: Annotated[float, Quantity(units.MASS, POSITIVE)] = key("of the platform without the beam", "5 kg")
    frequency: Annotated[float | None, Frequency] = key("natural, of the platform without the beam", "3.25 Hz", None)
    stiffness: Annotated[float | None, Quantity(units.STIFFNESS, POSITIVE)] = key(
        "of its springs, instead of its frequency", "2000 N/m", None, written=False
    )
    damping_ratio: Annotated[float, Ratio] = key("of the platform without the beam", 0.05)
    coupling: Annotated[str, Word(("one-way", "two-way"))] = key(
        "the platform filters the drive alone, or the beam and its impacts push back too", "one-way"
    )
    calibrated_at: Annotated[float | None, Frequency] = key(
        "drive frequency at which the drive's amplitude, or voltage and gain, hold", "15.5 Hz", None
    )


class ShakerTable(Table):
    """Effect: an electrodynamic exciter drives the platform by its voltage; absent = the force is prescribed."""

    resistance: Annotated[float, Quantity(units.RESISTANCE, POSITIVE)] = key("of the coil", "4 ohm")
    force_factor: Annotated[float, Quantity(units.FORCE_FACTOR, POSITIVE)] = key("Bl, force per current", "20 N/A")
    inductance: Annotated[float, Quantity(units.INDUCTANCE, NOT_NEGATIVE)] = key(
        "of the coil; one-way coupling alone knows it", "0 H", 0.0
    )
