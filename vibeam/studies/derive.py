"""SDOF parameters from geometry, each beside its finite-element value: the error of each assumption of the paper."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import pi, sqrt
from typing import TYPE_CHECKING, Any

from vibeam.case.source import of_source
from vibeam.case.study_plans import DerivePlan
from vibeam.system.labelled import ViewedTable
from vibeam_models.arrays import ValueRecord
from vibeam_models.base import Base
from vibeam_models.beam import assemble_with_space, structure_of
from vibeam_models.scene import AnyScene, Mass, Scene

if TYPE_CHECKING:
    from vibeam.studies.contact_time import ContactAtSpeed
    from vibeam_models.sdof import SdofModel


@dataclass(frozen=True)
class DerivedParameter:
    """Derived parameter: ``value`` by the paper's formula, ``reference`` of the finite-element model, both in ``unit``.

    ``assumption``: the cause of their difference.
    """

    name: str
    symbol: str
    unit: str
    value: float
    reference: float
    assumption: str

    @property
    def error(self) -> float:
        """value/reference − 1; 0 where both are zero."""
        return 0.0 if self.value == self.reference else self.value / self.reference - 1


@dataclass(frozen=True, eq=False, repr=False)
class DerivedTable(ValueRecord, ViewedTable):
    """Rows of the table, by order or by name; ``notes``: the rows left out, and why.

    ``contacts``: with a stop that yields, at three speeds.
    """

    rows: tuple[DerivedParameter, ...]
    notes: tuple[str, ...] = ()
    contacts: tuple[ContactAtSpeed, ...] = ()

    def __iter__(self) -> Iterator[DerivedParameter]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, name: str) -> DerivedParameter:
        for row in self.rows:
            if row.name == name:
                return row
        raise KeyError(f"no row {name!r}: there are {', '.join(row.name for row in self.rows)}")


@dataclass(frozen=True)
class _FirstMode:
    """First finite-element mode scaled to 1 at the sensor: contact value, N/m, kg, damping ratio, φᵀM1/φᵀMφ."""

    shape: float
    contact: float
    stiffness: float
    mass: float
    damping_ratio: float
    base_factor: float
    static_contact: float

    @property
    def omega(self) -> float:
        return sqrt(self.stiffness / self.mass)


@of_source
def derive(case_or_scene: Any, *, speed: float | str | None = None) -> DerivedTable:
    """Derive the paper's eq. 44–47 for a Scene (or an object with one as ``.scene``), with finite-element values.

    The reference is the first mode of bending of the finite-element model with all effects of the scene, on a base held
    still and scaled to 1 at the sensor. Mass and frequency come in steps: massless beam, with the beam's mass, and
    with the mass's rotary inertia where the scene gives one. On a platform, or where the base amplitude depends on the
    frequency otherwise, there is no one drive to be derived. A bare beam has the rows that no attached mass comes into,
    in its static deflection under a load at the contact; and where the beam outweighs the mass by far, those that
    neglect the beam have no meaning and are left out, as ``notes`` says. A stop that yields adds its ``contacts``.
    ``speed``: of an impact, in SI or with a unit, in place of the case's ``DerivePlan``. TypeError for another object;
    ValueError for a SdofScene: it *is* the SDOF model.

    >>> import vibeam
    >>> table = vibeam.derive("cases/dtu_neutral.toml")
    >>> round(table["stiffness"].value), round(table["stiffness"].error, 3)  # N/m, against finite elements
    (1219, -0.004)
    """
    from vibeam.casefile.tables.table import plan_with

    asked = getattr(case_or_scene, "asked", {}).get("derive") or DerivePlan()
    plan = plan_with(asked, {"speed": speed})
    scene = beam_of(case_or_scene)
    if structure_of(scene).modes(1).omega[0] == 0:
        return _with_contacts(DerivedTable((), (FREE_BODY,)), scene, plan)
    exact = _first_mode(scene)
    table = _bare(scene, exact) if scene.mass is None else _loaded(scene, scene.mass, exact)
    return _with_contacts(replace(table, rows=tuple(_explained(row, scene) for row in table)), scene, plan)


def beam_of(case_or_scene: Any) -> Scene:
    """Scene of a beam; errors as ``derive`` for anything else."""
    scene = getattr(case_or_scene, "scene", case_or_scene)
    if isinstance(scene, AnyScene) and scene.no_beam:
        raise ValueError(f"nothing to derive: {scene.no_beam} to derive it from")
    if not isinstance(scene, Scene):
        raise TypeError(f"derive takes a case or a scene, not {type(scene).__name__}")
    if scene.in_three_dimensions:
        raise ValueError("nothing to derive: closed forms are of a beam, and this is a solid: add a fidelity of one")
    return scene


def speed_of(scene: Scene, asked: float | None) -> float:
    """Speed of an impact, m/s: that ``asked`` for, the law's, or the usual one."""
    return asked or getattr(scene.stop.law, "velocity", None) or USUAL_SPEED


def _with_contacts(table: DerivedTable, scene: Scene, plan: DerivePlan) -> DerivedTable:
    """Table with the contacts of a stop that yields, and what is doubtful about them."""
    from vibeam.studies.contact_time import contacts, doubts

    found = contacts(scene, speed_of(scene, plan.speed))
    return replace(table, contacts=found, notes=(*table.notes, *(doubts(scene, found) if found else ())))


def _loaded(scene: Scene, mass: Mass, exact: _FirstMode) -> DerivedTable:
    """Table of a beam with an attached mass."""
    from vibeam_models.sdof import sdof_model

    paper = sdof_model(scene)
    masses = _masses(scene, mass, paper)
    share, notes = masses[MASSLESS] / masses[WITH_BEAM], []
    if share < LEAST_SHARE:
        del masses[MASSLESS]
        notes.append(f"{NEGLECTED}: the attached mass is {100 * share:.2g} % of what moves, and eq. 45 needs m ≫ ρAL")
    rows = [
        DerivedParameter("shape at the mass", "φ(L_m)", "1", paper.shape, exact.shape, STATIC_SHAPE),
        DerivedParameter("stiffness", "K_S", "N/m", paper.stiffness, exact.stiffness, STATIC_SHAPE),
        *_inertial_rows(masses, paper.stiffness, exact, _LEFT_OUT),
        *_error_rows(masses, paper.stiffness),
        *_scaling_rows(scene, paper, exact, MASSLESS in masses),
    ]
    return DerivedTable(tuple(rows), tuple(notes))


def _bare(scene: Scene, exact: _FirstMode) -> DerivedTable:
    """Table of a beam without an attached mass."""
    from vibeam.runs.summary import BARE, yielding
    from vibeam_models.static_shape import static_shape_of

    static = static_shape_of(scene.shaped_beam, scene.stop.position, scene.sensor.position)
    mass = static.beam_mass(scene.carrier)
    rows = [DerivedParameter("stiffness", "K_S", "N/m", static.stiffness, exact.stiffness, STATIC_SHAPE)]
    notes = [f"{OF_A_MASS}: there is no attached mass"]
    if mass:
        gap = scene.stop.gap / scene.beam.length
        gap /= static.at(scene.stop.position) if scene.stop.gap_at == "contact" else 1.0
        rows += _inertial_rows({WITH_BEAM: mass}, static.stiffness, exact, {WITH_BEAM: STATIC_SHAPE})
        rows.append(_gap_row(scene, gap, exact))
        notes += [f"{BARE}\n{yielding(scene)}"] if scene.stop.law is None else []
    return DerivedTable(tuple(rows), tuple(notes))


USUAL_SPEED = 0.1  # m/s of an impact
LEAST_SHARE = 0.1  # smallest share of the attached mass in the moving one for which the beam may be neglected
FREE_BODY = "left out: all rows of eq. 43–47: the beam can move as a rigid body and has no static deflection"
NEGLECTED = "left out: rows with a massless beam and the damping ratio that goes with them"
OF_A_MASS = "left out: shape at the mass, rows with a massless beam, damping ratio, base factor and drive"
MASSLESS, WITH_BEAM, WITH_INERTIA = "massless beam", "with the beam's mass", "with beam mass and rotary inertia"


def _masses(scene: Scene, mass: Mass, paper: SdofModel) -> dict[str, float]:
    """Equivalent mass M_S in kg, by the number of mass terms kept."""
    from vibeam_models.static_shape import static_shape_of

    static = static_shape_of(scene.shaped_beam, mass.position, scene.sensor.position)
    masses = {MASSLESS: paper.mass, WITH_BEAM: paper.mass + static.beam_mass(scene.carrier)}
    for effect in scene.named("mass.rotary_inertia"):
        turning = effect.rotary_inertia * static.slope(mass.position) ** 2
        masses[WITH_INERTIA] = masses[WITH_BEAM] + turning
    return masses


def _first_mode(scene: Scene) -> _FirstMode:
    import numpy as np

    from vibeam_reductions.static_shapes import static_mode

    structure, space = assemble_with_space(replace(scene, base=Base()))  # the base factor is of a base that moves
    modes = structure.modes()
    observed = np.abs(structure.outputs["sensor"] @ modes.shapes)
    first = int(np.argmax(observed > 1e-9 * np.max(observed)))  # a beam that twists first has its bending after that
    shape = modes.shapes[:, first] / float(structure.outputs["sensor"] @ modes.shapes[:, first])
    mass, stiffness = (float(shape @ matrix @ shape) for matrix in (structure.M, structure.K))
    return _FirstMode(
        shape=float(space.row(scene.stop.position if scene.mass is None else scene.mass.position) @ shape),
        contact=float(structure.contact @ shape),
        stiffness=stiffness,
        mass=mass,
        damping_ratio=float(shape @ structure.C @ shape) / (2 * mass * float(modes.omega[first])),
        base_factor=-float(structure.load @ shape) / mass,
        static_contact=float(static_mode(structure).structure.contact[0]),
    )


STATIC_SHAPE = "the static deflection of a uniform strip as mode shape"


BARE_SHAPE = "the static deflection of the bare beam as mode shape"
ADDED = "added masses left out"


def _explained(row: DerivedParameter, scene: Scene) -> DerivedParameter:
    """The row with the cause that holds for this beam: not every one is a strip, and one may carry added masses."""
    from vibeam_models.beams.shapes import Rectangle

    beam = scene.shaped_beam
    strip = beam.is_uniform_cantilever and isinstance(beam.shape, Rectangle)
    said = row.assumption if strip else row.assumption.replace(STATIC_SHAPE, BARE_SHAPE)
    lacks = row.symbol in ("M_S", "ω_n", "f_n") and not row.name.startswith("error of")
    added = any(effect.carried_by == "beam" for effect in scene.named("added_mass"))
    return replace(row, assumption=f"{said}, {ADDED}" if lacks and added else said)


_LEFT_OUT = {MASSLESS: "massless beam, point mass", WITH_BEAM: "point mass", WITH_INERTIA: STATIC_SHAPE}
_ERRORS = {"massless beam": (MASSLESS, WITH_BEAM), "point mass": (WITH_BEAM, WITH_INERTIA)}


def _inertial_rows(
    masses: Mapping[str, float], stiffness: float, exact: _FirstMode, why: Mapping[str, str]
) -> list[DerivedParameter]:
    """Rows of the masses, then of their frequencies, each with ``why`` it is off."""
    rows = [
        DerivedParameter(f"mass, {kept}", "M_S", "kg", mass, exact.mass, why[kept]) for kept, mass in masses.items()
    ]
    units = {"circular frequency": ("ω_n", "rad/s", 1.0), "frequency": ("f_n", "Hz", 2 * pi)}
    for kept, mass in masses.items():
        omega = sqrt(stiffness / mass)
        rows += [
            DerivedParameter(f"{name}, {kept}", symbol, unit, omega / turn, exact.omega / turn, why[kept])
            for name, (symbol, unit, turn) in units.items()
        ]
    return rows


def _error_rows(masses: Mapping[str, float], stiffness: float) -> list[DerivedParameter]:
    """Error of one assumption at a time: f_n with it against f_n without it, all else equal."""
    f = {kept: sqrt(stiffness / mass) / (2 * pi) for kept, mass in masses.items()}
    return [
        DerivedParameter(f"error of the {why}", "f_n", "Hz", f[one], f[other], why)
        for why, (one, other) in _ERRORS.items()
        if one in f and other in f
    ]


def _scaling_rows(scene: Scene, paper: SdofModel, exact: _FirstMode, massless: bool) -> list[DerivedParameter]:
    """Rows of the scaling: β_S where a massless beam is meaningful, base factor, γ or B, and Δ."""
    ratio = exact.damping_ratio / exact.omega * paper.omega
    why, base = _LEFT_OUT[MASSLESS], (1 / paper.shape, exact.base_factor)
    damping = DerivedParameter("damping ratio", "β_S", "1", ratio, exact.damping_ratio, "the same D, the ω_n of eq. 45")
    return [
        *([damping] if massless else []),
        DerivedParameter("base factor", "φᵀM1/φᵀMφ", "1", *base, why),
        *_drive_rows(scene, paper, exact, why),
        _gap_row(scene, paper.gap, exact),
    ]


def _gap_row(scene: Scene, gap: float, exact: _FirstMode) -> DerivedParameter:
    carried = scene.stop.gap * (exact.static_contact if scene.stop.gap_at == "sensor" else 1.0)
    return DerivedParameter("gap", "Δ", "1", gap, carried / (exact.contact * scene.beam.length), STATIC_SHAPE)


def _drive_rows(scene: Scene, paper: SdofModel, exact: _FirstMode, why: str) -> list[DerivedParameter]:
    from vibeam_models.base import is_constant
    from vibeam_models.base_motion import base_amplitude

    span, gain = scene.beam.length, scene.base.gain
    if scene.platform is not None or scene.base == scene.base.place:
        return []  # the base motion depends on the frequency there, or is a record
    rows = []
    if is_constant(scene.base):
        amplitude = base_amplitude(scene)
        rows = [DerivedParameter("drive", "B", "1", paper.gain(amplitude), amplitude * exact.base_factor / span, why)]
    if gain is not None:
        base = paper.base_per_volt(gain)
        rows.append(DerivedParameter("gain", "γ", "1/V", gain, base * exact.base_factor / span, why))
    return rows
