"""The case file, declared once: the parser, its messages, the reference table and the template all read this.

A table is a class, a key a field: its annotation says what it may hold, ``key`` what it means and what to write.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from vibeam import units
from vibeam.entries import (
    NOT_NEGATIVE,
    POSITIVE,
    Count,
    Each,
    Flag,
    Options,
    Quantity,
    Range,
    Several,
    TableOr,
    Text,
    Word,
)
from vibeam.observe.filters import FAMILIES, HIGHEST_ORDER
from vibeam.settings import Names, Settings, Value
from vibeam.show import KINDS, LIMITS, READ
from vibeam.solvers import NAMES as SOLVERS

DIRECTIONS = ("up", "down", "both")
QUANTITIES = ("amplitude", "reach", "maximum", "minimum", "impact_velocity", "impacts_per_period", "period")
EXTENTS = ("peak", "peak_frequency", "period_one_from", "period_one_to")  # of a whole branch
OF_INFLUENCE = (*EXTENTS, "ringing", "ringing_frequency", "apparent_restitution")
OUTPUTS = ("sensor", "contact", "tip", "platform")
ACCURATE = ("amplitude", "reach", "maximum", "minimum", "impact_velocity")  # what an accuracy can be asked of
REDUCTIONS = ("static_mode", "modal", "full")
LAWS = ("restitution", "velocity restitution", "linear", "hertz", "hunt-crossley")
MOST_ELEMENTS = 2000
MOST_POINTS = 1_000_000

Length = Place = Quantity(units.LENGTH, POSITIVE)
Ratio = Quantity(units.RATIO, NOT_NEGATIVE)
Unity = Quantity(units.RATIO, Range(0, 1))
Within = Quantity(units.RATIO, Range(1e-4, 1))
Frequency = Quantity(units.FREQUENCY, POSITIVE)
Speed = Quantity(units.SPEED, POSITIVE)
Periods = Count(0, MOST_POINTS)


def key(meaning: str, example: Any = None, default: Any = ..., *, written: bool = True) -> Any:
    """A key: what it means, an example for the template (there as a comment unless ``written``), its default."""
    return Field(default, description=meaning, examples=[example], json_schema_extra={"written": written})


class Table(BaseModel):
    """What all tables share: no unknown keys, never changed."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class BeamTable(Table):
    """The beam: a uniform cantilever of rectangular section, clamped at 0."""

    length: Annotated[float, Length] = key("free length, clamp to tip", "180 mm")
    width: Annotated[float, Length] = key("width of the section", "20 mm")
    thickness: Annotated[float, Length] = key("thickness of the section, in the direction of motion", "1.034 mm")
    youngs_modulus: Annotated[float, Quantity(units.PRESSURE, POSITIVE)] = key("modulus of elasticity", "210 GPa")
    density: Annotated[float, Quantity(units.DENSITY, POSITIVE)] = key("mass per volume", "7850 kg/m^3")
    damping_ratio: Annotated[tuple[float, ...] | None, Several(Ratio, alone=True)] = key(
        "of the first mode; two of them, modes 1 and 2, for rayleigh; none where damping is a list", 0.017, None
    )
    damping: Annotated[str | tuple[float, ...], Several(Ratio, words=("constant", "stiffness", "rayleigh"))] = key(
        "every mode alike, proportional to stiffness, to mass and stiffness, or the ratios mode by mode",
        "constant",
        "constant",
    )
    elements: Annotated[int, Count(1, MOST_ELEMENTS)] = key("finite elements along the beam", 36, 36)
    massless: Annotated[bool, Flag()] = key(
        "effect: the beam's own mass is neglected, as in the paper's m ≫ ρAL", True, False, written=False
    )


class MassTable(Table):
    """The mass attached to the beam."""

    mass: Annotated[float, Quantity(units.MASS, POSITIVE)] = key("attached mass", "0.2 kg")
    position: Annotated[float, Place] = key("distance from the clamp, in (0, length]", "132 mm")
    rotary_inertia: Annotated[float | None, Quantity(units.INERTIA, POSITIVE)] = key(
        "effect: about the axis of bending; absent = a point mass", "2.988e-5 kg m^2", None
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
        "effect: of the contact, from the clamp; absent = at the mass", "132 mm", None, written=False
    )
    law: Annotated[str | None, Word(LAWS)] = key(
        "effect: what the stop does; absent = restitution, the same at every velocity", "linear", None, written=False
    )
    stiffness: Annotated[float | None, Quantity(units.STIFFNESS, POSITIVE)] = key(
        "of a linear stop: force over penetration", "1e6 N/m", None, written=False
    )
    damping: Annotated[float | None, Quantity(units.VISCOUS, NOT_NEGATIVE)] = key(
        "of a linear stop; absent = what gives a free mass 1/S the restitution", "10 N s/m", None, written=False
    )
    hertz_stiffness: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of hertz and hunt-crossley, N/m^exponent", 1e9, None, written=False
    )
    exponent: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of the penetration, absent = 1.5; of the velocity in R = R0 (v/v0)^-n, absent = 0.25", 1.5, None, written=False
    )
    velocity: Annotated[float | None, Speed] = key(
        "at which the restitution holds, for hunt-crossley and velocity restitution", "0.1 m/s", None, written=False
    )
    speeds: Annotated[tuple[float, ...] | None, Several(Speed, ascending=True)] = key(
        "of a table of restitutions, instead of restitution and velocity", ["0.02 m/s", "0.2 m/s"], None, written=False
    )
    restitutions: Annotated[tuple[float, ...] | None, Several(Unity)] = key(
        "at the speeds", [0.8, 0.6], None, written=False
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
        "of the beam, for its shear modulus; or say that", 0.3, None
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

    voltage: Annotated[float | None, Quantity(units.VOLTAGE, NOT_NEGATIVE)] = key("of the shaker", "0.6 V", None)
    gain: Annotated[float | None, Quantity(units.PER_VOLT, POSITIVE)] = key("γ of eq. 46, 1/V", 5.16e-4, None)
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


class GridTable(Table):
    """Evenly spaced drive frequencies."""

    from_: Annotated[float, Frequency] = Field(alias="from", description="first frequency", examples=["14 Hz"])
    to: Annotated[float, Frequency] = key("last frequency, itself included", "17 Hz")
    points: Annotated[int, Count(1, MOST_POINTS)] = key("how many", 121)


FrequencyGrid = TableOr(GridTable, Several(Frequency, limit=MOST_POINTS, ascending=True))


class SweepTable(Table):
    """The sweep that every fidelity runs: drive frequencies and, at each, periods to settle and to hold."""

    frequency: Annotated[GridTable | tuple[float, ...], FrequencyGrid] = key(
        "from, to and points, or an ascending list", {"from": "14 Hz", "to": "17 Hz", "points": 121}
    )
    direction: Annotated[str, Word(DIRECTIONS)] = key("which way the frequencies are run", "both", "both")
    settle: Annotated[int, Periods] = key("drive periods left out before the reading", 300)
    hold: Annotated[int, Count(1, MOST_POINTS)] = key("drive periods read", 50)
    output: Annotated[str, Word(OUTPUTS)] = key("whose displacement is read", "sensor", "sensor")


class FidelityTable(Table):
    """A fidelity, one table each: which model of the rig is swept."""

    reduction: Annotated[str, Word(REDUCTIONS)] = key(
        "the static deflection alone, so many modes, or all of the finite elements", "static_mode"
    )
    modes: Annotated[int | None, Count(1, 2 * MOST_ELEMENTS)] = key("how many, for modal alone", 8, None)
    solver: Annotated[str, Word(SOLVERS)] = key("how its motion is found", "flight", "flight")
    options: Annotated[dict[str, str | float], Options()] = key(
        "of the solver, by name; absent = its own defaults", None, {}, written=False
    )
    set: Annotated[dict[str, Any], Settings()] = key(
        "physics that is this fidelity's own: dotted keys and their values",
        {"stop.restitution": 0.6},
        {},
        written=False,
    )
    without: Annotated[tuple[str, ...], Names("dotted keys")] = key(
        "optional keys, or whole optional tables, of the physics that it leaves out",
        ["mass.rotary_inertia"],
        (),
        written=False,
    )


class ReferenceTable(Table):
    """A curve that a fidelity is checked against, one table each."""

    file: Annotated[str, Text()] = key("CSV file, from the case file's folder", "references/dtu_neutral_sdof.csv")
    fidelity: Annotated[str, Text()] = key("the fidelity that must meet it", "sdof")
    quantity: Annotated[str, Word(QUANTITIES)] = key("the column compared", "amplitude")
    tolerance: Annotated[float, Quantity(units.RATIO, POSITIVE)] = key("largest relative difference", "0.0001 %")
    direction: Annotated[str | None, Word(DIRECTIONS)] = key(
        "the branches compared; absent = all that are swept", "both", None, written=False
    )


class ExpectTable(Table):
    """A number that a fidelity is checked against, by itself or against another fidelity, one table each."""

    fidelity: Annotated[str, Text()] = key("the fidelity that must meet it", "sdof")
    quantity: Annotated[str, Word(QUANTITIES + EXTENTS + LIMITS + READ)] = key(
        "what is compared; of those after largest_gap: that of a figure, with show", "amplitude"
    )
    frequency: Annotated[float | None, Frequency] = key(
        "where, one of the sweep's (of a limit or a figure anywhere); none for the peak, the range of period 1, modes",
        "15.3 Hz",
        None,
    )
    show: Annotated[str | None, Text()] = key(
        "the [show.NAME] that the quantity is read off, its mean unless number chooses one",
        "ringing",
        None,
        written=False,
    )
    number: Annotated[float | None, Ratio] = key(
        "of the mode, or order of the harmonic, with show", 2, None, written=False
    )
    against: Annotated[str | None, Text()] = key(
        "another fidelity: the value is then the relative difference to it", "beam", None
    )
    value: Annotated[float, Value()] = key("the number expected, in SI units (frequencies in Hz)", "34 %")
    tolerance: Annotated[float, Quantity(units.RATIO, POSITIVE)] = key(
        "largest difference: relative to the value, or, with against or where the value is 0, of the number itself",
        "1 %",
    )
    direction: Annotated[str | None, Word(DIRECTIONS)] = key(
        "the branches compared; absent = all that are swept", "up", None
    )


class ShowTable(Table):
    """A further figure beside the frequency-response curves, one table each."""

    kind: Annotated[str, Word(tuple(KINDS))] = key(
        "; ".join(f"{name}: {kind.meaning}" for name, kind in KINDS.items()), "portrait"
    )
    fidelities: Annotated[tuple[str, ...], Names("fidelities")] = key("whose; absent = all", ["sdof"], ())
    frequency: Annotated[tuple[float, ...] | None, Several(Frequency, alone=True, limit=12)] = key(
        "drive frequency, or several, a panel each", "15.3 Hz", None
    )
    periods: Annotated[int | None, Count(1, MOST_POINTS)] = key(
        "drive periods shown; absent = as many as the kind needs", 4, None
    )
    settle: Annotated[int | None, Periods] = key("drive periods left out before; absent = the sweep's", 500, None)
    quantity: Annotated[str | None, Word(QUANTITIES + LIMITS)] = key(
        "of a curve one of the response's, of boundaries one of the last two", "reach", None
    )
    output: Annotated[str | None, Word(OUTPUTS)] = key(
        "whose displacement; absent = the sweep's output", "contact", None, written=False
    )
    near: Annotated[float | None, Frequency] = key(
        "of ringing: where it is looked for; modes below two thirds of it are taken off", "101 Hz", None, written=False
    )
    highest: Annotated[int | None, Count(1, 100)] = key(
        "of harmonics: the last order; absent = 8", 8, None, written=False
    )
    subdivision: Annotated[int | None, Count(1, 64)] = key(
        "of harmonics: 2 shows orders ½, 1, 1½ …; absent = 1, whole orders", 2, None, written=False
    )


class MeasurementTable(Table):
    """The measuring chain through which histories, portraits, spectra, ringing and restitution are seen; absent = they
    are exact. Velocities are central differences of the record.
    """

    sampling: Annotated[float, Frequency] = key("samples a second", "5 kHz")
    low_pass: Annotated[str | None, Word(FAMILIES)] = key(
        "analog filter before sampling; absent = none", "bessel", None
    )
    order: Annotated[int | None, Count(1, HIGHEST_ORDER)] = key("of the filter", 4, None)
    cut_off: Annotated[float | None, Frequency] = key(
        "of the filter: gain 1/√2, or of an elliptic one where it leaves the ripple", "500 Hz", None
    )
    ripple: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "dB, of an elliptic filter's pass band; absent = 0.1", 0.1, None, written=False
    )
    attenuation: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "dB, of an elliptic filter's stop band; absent = 60", 60, None, written=False
    )
    quantisation: Annotated[float | None, Length] = key("step of the converter; absent = none", "1 µm", None)
    noise: Annotated[float | None, Length] = key("rms, white, on the samples; absent = none", "1 µm", None)
    seed: Annotated[int | None, Count(0, 2**31 - 1)] = key("of the noise, which needs one", 1, None)


class SdofMeasurementTable(MeasurementTable):
    """The measuring chain of the single degree of freedom."""

    quantisation: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "step of the converter, in the unit of the motion; absent = none", 1e-6, None
    )
    noise: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "rms, white, on the samples, in the unit of the motion; absent = none", 1e-6, None
    )


class CostTable(Table):
    """What vibeam cost does; absent = what the defaults say."""

    frequency: Annotated[tuple[float, ...] | None, Several(Frequency, limit=MOST_POINTS, ascending=True)] = key(
        "drive frequencies; absent = nine of the sweep's", ["14 Hz", "15 Hz", "16 Hz"], None, written=False
    )
    settle: Annotated[int | None, Periods] = key(
        "drive periods left out; absent = the sweep's, 100 at most", 100, None, written=False
    )
    hold: Annotated[int | None, Count(1, MOST_POINTS)] = key(
        "drive periods read; absent = the sweep's, 10 at most", 10, None, written=False
    )
    solvers: Annotated[tuple[str, ...] | None, Each(Word(SOLVERS))] = key(
        "those compared; absent = all", ["flight", "orbit", "direct"], None, written=False
    )
    modes: Annotated[tuple[int, ...] | None, Each(Count(1, 2 * MOST_ELEMENTS))] = key(
        "the finest fidelity cut off after so many modes, each; absent = 1, 2, 4, 8 … below its own",
        [1, 2, 4, 8],
        None,
        written=False,
    )
    reference: Annotated[str | None, Text()] = key(
        "the [reference.NAME] whose amplitudes are the truth; absent = the finest fidelity",
        "exact",
        None,
        written=False,
    )
    repeats: Annotated[int, Count(1, 1000)] = key("how often a run is timed, where that is short", 3, 3)
    budget: Annotated[float, Quantity(units.TIME, POSITIVE)] = key("CPU time of the runs compared", "60 s", 60.0)


class InfluenceTable(Table):
    """What vibeam influence does; absent = what the defaults say."""

    fidelity: Annotated[str | None, Text()] = key(
        "whose effects are taken away; absent = the one with most modes", "beam", None, written=False
    )
    quantities: Annotated[tuple[str, ...], Each(Word(OF_INFLUENCE))] = key(
        "what must stay as it is", ["peak", "peak_frequency"], OF_INFLUENCE, written=False
    )
    frequency: Annotated[float | None, Frequency] = key(
        "where ringing and apparent restitution are read; absent = at the peak, each model's own", "15.3 Hz", None,
        written=False,
    )  # fmt: skip
    tolerance: Annotated[float, Quantity(units.RATIO, POSITIVE)] = key(
        "relative, of the peak, the ringing and its frequency", "1 %", 0.01
    )
    frequency_tolerance: Annotated[float, Frequency] = key(
        "of the peak's frequency and the ends of period 1", "0.1 Hz", 0.1
    )
    restitution_tolerance: Annotated[float, Quantity(units.RATIO, POSITIVE)] = key(
        "of the apparent restitution", 0.01, 0.01
    )
    points: Annotated[int, Count(3, MOST_POINTS)] = key(
        "drive frequencies, of the sweep's, at most; peaks and ends are then narrowed down between them", 31, 31
    )
    settle: Annotated[int | None, Periods] = key(
        "drive periods left out; absent = the sweep's", 300, None, written=False
    )
    hold: Annotated[int | None, Count(1, MOST_POINTS)] = key(
        "drive periods read; absent = the sweep's", 50, None, written=False
    )
    repeats: Annotated[int, Count(1, 1000)] = key("how often a sweep is timed", 3, 3)


class SdofTable(Table):
    """A single degree of freedom in place of beam, mass and sensor: the paper's model, nondimensional."""

    natural_frequency: Annotated[float, Quantity(units.ANGULAR_FREQUENCY, POSITIVE)] = key(
        "of free motion, with its unit; 1 rad/s = nondimensional time", "1 rad/s", 1.0
    )
    damping_ratio: Annotated[float, Ratio] = key("β", 0.015)


class SdofStopTable(Table):
    """The stop of the single degree of freedom."""

    gap: Annotated[float, Quantity(units.RATIO)] = key("Δ, in the unit of the motion", 0.0)
    restitution: Annotated[float | None, Unity] = key("speed after over speed before an impact", 0.9, None)
    law: Annotated[str | None, Word(LAWS)] = key(
        "effect: what the stop does; absent = restitution, the same at every velocity", "linear", None, written=False
    )
    stiffness: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of a linear stop, force over mass and penetration", 400, None, written=False
    )
    damping: Annotated[float | None, Quantity(units.RATIO, NOT_NEGATIVE)] = key(
        "of a linear stop, force over mass and velocity; absent = what gives the restitution", 2.5, None, written=False
    )
    hertz_stiffness: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of hertz and hunt-crossley, force over mass and penetration^exponent", 1e4, None, written=False
    )
    exponent: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of the penetration, absent = 1.5; of the velocity in R = R0 (v/v0)^-n, absent = 0.25", 1.5, None, written=False
    )
    velocity: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "at which the restitution holds, for hunt-crossley and velocity restitution", 0.01, None, written=False
    )
    speeds: Annotated[tuple[float, ...] | None, Several(Quantity(units.RATIO, POSITIVE), ascending=True)] = key(
        "of a table of restitutions, instead of restitution and velocity", [0.002, 0.02], None, written=False
    )
    restitutions: Annotated[tuple[float, ...] | None, Several(Unity)] = key(
        "at the speeds", [0.8, 0.6], None, written=False
    )
    second_gap: Annotated[float | None, Quantity(units.RATIO)] = key(
        "effect: gap to a second stop on the other side; absent = none", 0.01, None, written=False
    )
    drift_frequency: Annotated[tuple[float, ...] | None, Several(Frequency, ascending=True)] = key(
        "effect: drive frequencies between which the gap drifts; absent = it stays",
        ["1.5 rad/s", "2.5 rad/s"],
        None,
        written=False,
    )
    drift: Annotated[tuple[float, ...] | None, Several(Quantity(units.RATIO))] = key(
        "what is added to the gap at these frequencies, linear between them", [0.0, 1e-4], None, written=False
    )
    wear: Annotated[float | None, Quantity(units.RATIO, NOT_NEGATIVE)] = key(
        "effect: what each impact adds to the gap, from point to point; absent = none", 1e-8, None, written=False
    )


class SdofDriveTable(Table):
    """The base motion of the single degree of freedom."""

    amplitude: Annotated[float, Ratio] = key("B, in the unit of the motion", 0.5e-3)


class SdofSweepTable(SweepTable):
    """The sweep of the single degree of freedom."""

    output: Annotated[str, Word(("sensor", "contact"))] = key("both are the one motion", "sensor", "sensor")


class SdofFidelityTable(Table):
    """A fidelity of the single degree of freedom, which is one mode already; the table may be empty."""

    reduction: Annotated[str, Word(("static_mode",))] = key("one mode", "static_mode", "static_mode")
    solver: Annotated[str, Word(SOLVERS)] = key("how its motion is found", "flight", "flight")
    options: Annotated[dict[str, str | float], Options()] = key(
        "of the solver, by name; absent = its own defaults", None, {}, written=False
    )
    set: Annotated[dict[str, Any], Settings()] = key(
        "physics that is this fidelity's own: dotted keys and their values",
        {"stop.restitution": 0.6},
        {},
        written=False,
    )
    without: Annotated[tuple[str, ...], Names("dotted keys")] = key(
        "optional keys, or whole optional tables, of the physics that it leaves out",
        ["mass.rotary_inertia"],
        (),
        written=False,
    )


class BeamCase(Table):
    """A beam on the bench."""

    title: Annotated[str, Text()] = key(
        "what the case is; absent = the name of its file", "DTU impacting beam, neutral gap, 0.6 V", ""
    )
    source: Annotated[str, Text()] = key("where it comes from", "Rebouças, Santos & Thomsen 2018, Fig. 31(b)", "")
    accuracy: Annotated[float | None, Within] = key(
        "relative error allowed, of the finest fidelity's: vibeam run then takes what is cheapest, place by place",
        "1 %",
        None,
        written=False,
    )
    accuracy_of: Annotated[tuple[str, ...] | None, Each(Word(ACCURATE))] = key(
        "the quantities that this holds for; absent = the amplitude alone", ["amplitude", "reach"], None, written=False
    )
    beam: BeamTable
    mass: MassTable
    added_mass: tuple[AddedMassTable, ...] = key("further point masses", None, (), written=False)
    clamp: ClampTable | None = None
    gravity: GravityTable | None = None
    torsion: TorsionTable | None = None
    stop: StopTable
    sensor: SensorTable
    drive: DriveTable
    platform: PlatformTable | None = None
    shaker: ShakerTable | None = None
    measurement: MeasurementTable | None = None
    sweep: SweepTable
    fidelity: dict[str, FidelityTable]
    reference: dict[str, ReferenceTable] = key("curves to check against", None, {}, written=False)
    expect: dict[str, ExpectTable] = key("numbers to check against", None, {}, written=False)
    show: dict[str, ShowTable] = key("further figures", None, {}, written=False)
    cost: CostTable = key("what vibeam cost does", None, CostTable(), written=False)
    influence: InfluenceTable = key("what vibeam influence does", None, InfluenceTable(), written=False)


class SdofCase(Table):
    """A single degree of freedom by itself."""

    title: Annotated[str, Text()] = key(
        "what the case is; absent = the name of its file", "single degree of freedom", ""
    )
    source: Annotated[str, Text()] = key("where it comes from", "Rebouças, Santos & Thomsen 2018, eq. 1", "")
    accuracy: Annotated[float | None, Within] = key(
        "relative error allowed, of the finest fidelity's: vibeam run then takes what is cheapest, place by place",
        "1 %",
        None,
        written=False,
    )
    accuracy_of: Annotated[tuple[str, ...] | None, Each(Word(ACCURATE))] = key(
        "the quantities that this holds for; absent = the amplitude alone", ["amplitude", "reach"], None, written=False
    )
    sdof: SdofTable
    stop: SdofStopTable
    drive: SdofDriveTable
    measurement: SdofMeasurementTable | None = None
    sweep: SdofSweepTable
    fidelity: dict[str, SdofFidelityTable]
    reference: dict[str, ReferenceTable] = key("curves to check against", None, {}, written=False)
    expect: dict[str, ExpectTable] = key("numbers to check against", None, {}, written=False)
    show: dict[str, ShowTable] = key("further figures", None, {}, written=False)
    cost: CostTable = key("what vibeam cost does", None, CostTable(), written=False)
