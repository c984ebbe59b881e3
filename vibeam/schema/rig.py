"""The tables of the rig: beam, mass, stop, base, and the optional effects on them."""

from __future__ import annotations

from typing import Annotated

from vibeam import units
from vibeam.entries.lists import Several
from vibeam.entries.range import NOT_NEGATIVE, POSITIVE, Range
from vibeam.entries.single import Count, Flag, Quantity, Word
from vibeam.schema.table import Table, key
from vibeam.schema.words import (
    LAWS,
    MOST_ELEMENTS,
    Frequency,
    Length,
    Place,
    Ratio,
    Speed,
    Unity,
)


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
    massless: Annotated[bool, Flag()] = key(
        "effect: the beam's own mass is neglected, as in the paper's m ≫ ρAL", True, False, written=False
    )


class MassTable(Table):
    """The mass attached to the beam; absent = a bare beam."""

    mass: Annotated[float, Quantity(units.MASS, POSITIVE)] = key("attached mass", "0.2 kg")
    position: Annotated[float, Place] = key("distance from the clamp, in (0, length]", "132 mm")
    rotary_inertia: Annotated[float | None, Quantity(units.INERTIA, POSITIVE)] = key(
        "effect: moment of inertia about the axis of bending; absent = a point mass", "2.988e-5 kg m^2", None
    )
    rigid_half_width: Annotated[float | None, Length] = key(
        "effect: the beam is rigid this far on either side of the mass; absent = nowhere", "11.7 mm", None
    )


class StopTable(Table):
    """The stop: what it is depends on its law; keys of other laws are refused."""

    gap: Annotated[float, Quantity(units.LENGTH)] = key(
        "gap at rest; negative = the beam is pressed against the stop", "0 mm"
    )
    gap_at: Annotated[str, Word(("contact", "sensor"))] = key(
        "where the gap was measured: at the contact, or as grazing amplitude at the sensor", "contact", "contact"
    )
    restitution: Annotated[float | None, Unity] = key("speed after over speed before an impact", 0.72, None)
    restitution_of: Annotated[str, Word(("contact", "first mode"))] = key(
        "whose it is: the contact's, or mode 1's (each fidelity's own is then derived)", "contact", "contact"
    )
    position: Annotated[float | None, Place] = key(
        "effect: of the contact, from the clamp; absent = at the mass, if there is one",
        "132 mm",
        None,
        written=False,
    )
    law: Annotated[str | None, Word(LAWS)] = key(
        "effect: what the stop does; absent = restitution, the same at every velocity", "linear", None, written=False
    )
    stiffness: Annotated[float | None, Quantity(units.STIFFNESS, POSITIVE)] = key(
        "of law linear: force over penetration", "1e6 N/m", None, written=False
    )
    damping: Annotated[float | None, Quantity(units.VISCOUS, NOT_NEGATIVE)] = key(
        "of law linear: force over velocity; absent = what gives the restitution to a free mass 1/S, S the contact's "
        "mobility",
        "10 N s/m",
        None,
        written=False,
    )
    hertz_stiffness: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of laws hertz and hunt-crossley: force over penetration^exponent, in N/m^exponent", 1e9, None, written=False
    )
    exponent: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of the penetration, absent = 1.5; in velocity restitution the n of R = R0 (v/v0)^-n, absent = 0.25",
        1.5,
        None,
        written=False,
    )
    velocity: Annotated[float | None, Speed] = key(
        "of impact, v0, at which the restitution holds; for laws hunt-crossley and velocity restitution",
        "0.1 m/s",
        None,
        written=False,
    )
    speeds: Annotated[tuple[float, ...] | None, Several(Speed, ascending=True)] = key(
        "of impact, of a table for law velocity restitution, instead of restitution and velocity",
        ["0.02 m/s", "0.2 m/s"],
        None,
        written=False,
    )
    restitutions: Annotated[tuple[float, ...] | None, Several(Unity)] = key(
        "at these speeds, monotone cubics between them", [0.8, 0.6], None, written=False
    )
    second_gap: Annotated[float | None, Quantity(units.LENGTH)] = key(
        "effect: gap to a second stop on the other side; absent = none", "1 mm", None, written=False
    )
    drift_frequency: Annotated[tuple[float, ...] | None, Several(Frequency, ascending=True)] = key(
        "effect: drive frequencies between which the gap drifts; absent = it stays",
        ["14 Hz", "17 Hz"],
        None,
        written=False,
    )
    drift: Annotated[tuple[float, ...] | None, Several(Quantity(units.LENGTH))] = key(
        "what is added to the gap at these frequencies, linear between them", ["0 mm", "0.02 mm"], None, written=False
    )
    wear: Annotated[float | None, Quantity(units.LENGTH, NOT_NEGATIVE)] = key(
        "effect: what each impact adds to the gap at the contact, from point to point; absent = none",
        "0.1 nm",
        None,
        written=False,
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


class SensorTable(Table):
    """Where the displacement is measured."""

    position: Annotated[float, Place] = key("distance from the clamp, in (0, length]", "100 mm")


class AddedMassTable(Table):
    """Effect: a further point mass, an accelerometer say; one table for each."""

    mass: Annotated[float, Quantity(units.MASS, POSITIVE)] = key("added mass", "2.4 g")
    position: Annotated[float, Place] = key("distance from the clamp, in (0, length]", "90 mm")


class DriveTable(Table):
    """The base motion amplitude · sin Ωt: say either voltage and gain, or amplitude; with [platform] also force, with
    [shaker] voltage alone.
    """

    voltage: Annotated[float | None, Quantity(units.VOLTAGE, NOT_NEGATIVE)] = key(
        "amplitude of the shaker's voltage", "0.6 V", None
    )
    gain: Annotated[float | None, Quantity(units.PER_VOLT, POSITIVE)] = key(
        "γ of eq. 46: base amplitude over mode shape at the mass, length and voltage", 5.16e-4, None
    )
    amplitude: Annotated[float | None, Quantity(units.LENGTH, NOT_NEGATIVE)] = key(
        "of the base, instead of voltage and gain", "0.05 mm", None, written=False
    )
    force: Annotated[float | None, Quantity(units.FORCE, NOT_NEGATIVE)] = key(
        "on the platform, instead of all of these; needs [platform]", "5 N", None, written=False
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
