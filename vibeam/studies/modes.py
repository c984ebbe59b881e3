"""Modes of the whole beam or solid, the effect of truncation on the restitution, the structure's matrices."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import nan
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.beam_field import BeamField, Fields, fields, with_points
from vibeam.case.source import of_source
from vibeam.exchange.matrices.declaration import Arrays, write_arrays
from vibeam.exchange.vtu import Step, VtuPiece, centre_line, write_series, write_vtu
from vibeam.system.labelled import ViewedTable
from vibeam_models.arguments import whole
from vibeam_models.arrays import Array, ValueRecord
from vibeam_models.beam import structure_of
from vibeam_models.laws.restitution import first_mode_restitution, needed_restitution
from vibeam_models.registry import loaded
from vibeam_models.scene import AnyScene, RigScene, Scene
from vibeam_models.structure import Modes, Structure

if TYPE_CHECKING:
    from vibeam.case.case import Case


@dataclass(frozen=True)
class ModeRow:
    """One mass-normalised mode: Hz; ``contact``, ``sensor`` in kg^-½; ``load`` in the table's unit.

    ``share``: part of w M⁻¹ wᵀ carried by the modes up to this one. Truncated after this mode, mode 1 has
    ``first_mode_restitution`` and the contact has ``contact_restitution``: the case gives one of them, the other
    follows (above 1: no contact can do that). Both are NaN of a stop that yields, which has no coefficient.
    """

    number: int
    frequency: float
    damping_ratio: float
    contact: float
    sensor: float
    load: float
    share: float
    first_mode_restitution: float
    contact_restitution: float


@dataclass(frozen=True, eq=False, repr=False)
class ModeTable(ValueRecord, ViewedTable):
    """First modes of a beam, and their shapes: deflections (points, modes) at ``positions`` (points,) in m.

    Of a given structure no places are known: ``positions`` and ``shapes`` are empty.

    ``load_unit``: that of the rows' loads, per base acceleration, or per force or moment on the beam. ``notes``:
    limits of the numbers, in sentences. ``beams``: shapes of all beams by name, deflections and slopes (points, modes).
    ``bodies``: of a solid, by the modes; its beams are the means of its sections.
    """

    rows: tuple[ModeRow, ...]
    positions: Array
    shapes: Array
    notes: tuple[str, ...] = ()
    load_unit: str = "kg^½"
    beams: Fields = field(default_factory=dict)
    bodies: Mapping[str, Any] = field(default_factory=dict, compare=False)


LOAD_UNITS = {None: "kg^½", 0: "kg^-½", 1: "kg^-½ m^-1"}  #: of a base that moves, of a force, of a moment


@of_source
def modes(case: Case, count: int = 10, *, fidelity: str | None = None) -> ModeTable:
    """Compute the first ``count`` modes of a case's structure, of a ``fidelity`` its own: see ``mode_table``.

    >>> import vibeam
    >>> table = vibeam.modes("cases/dtu_neutral.toml", 2)
    >>> [round(row.frequency, 1) for row in table.rows]  # Hz
    [7.6, 101.1]
    """
    return mode_table(case.scene if fidelity is None else case.scene_of(fidelity), count)


def mode_table(scene: AnyScene, count: int = 10) -> ModeTable:
    """Compute the first ``count`` modes (all, if there are fewer) of the finite-element model with all effects.

    The base is fixed: a platform's own mode is not among them, because restitution refers to the beam's.

    ValueError for a SdofScene, which has no beam, or ``count`` < 1.
    """
    if scene.given_mode is not None:
        raise ValueError(f"no modes to show: {scene.no_beam}")
    if (whole(count) or 0) < 1:
        raise ValueError(f"count: {count!r}, there is a table from 1 mode on")
    rig: Any = scene
    pointed = with_points(scene) if isinstance(scene, Scene) else None
    structure: Structure = structure_of(rig if pointed is None else pointed)
    modes = structure.modes(min(int(count), structure.size))
    damping = np.diag(structure.modal_damping(modes)) / (2 * np.where(modes.omega > 0, modes.omega, np.inf))
    contact, sensor = structure.contact @ modes.shapes, structure.outputs["sensor"] @ modes.shapes
    mobility = structure.mobility(structure.contact)
    cut = np.cumsum(contact**2)
    load = [-structure.load @ shape for shape in modes.shapes.T]
    columns = np.array([modes.frequency, damping, contact, sensor, load, cut / mobility, cut])
    rows = [
        ModeRow(number, f, zeta, w, u, force, share, *restitutions(rig, float(contact[0]), cut_off))
        for number, (f, zeta, w, u, force, share, cut_off) in enumerate(columns.T.tolist(), 1)
    ]
    unit = LOAD_UNITS[None if rig.base.on_beam is None else rig.base.on_beam[1]]
    bodies = _bodies(scene, modes) if scene.in_three_dimensions else {}
    if pointed is None:  # the coordinates have no places along a beam
        return ModeTable(tuple(rows), np.zeros(0), np.zeros((0, 0)), _notes(rig, rows), unit, bodies=bodies)
    beams = {name: _shaped(rows_of, modes) for name, rows_of in fields(pointed, structure).items()}
    first = beams["beam"]
    return ModeTable(tuple(rows), first.positions, first.deflection, _notes(rig, rows), unit, beams, bodies)


def _bodies(scene: AnyScene, modes: Modes) -> dict[str, Any]:
    return {name: body.by(modes.shapes) for name, body in loaded(scene.spatial).solid_shapes(scene).items()}


def _shaped(beam: BeamField, modes: Modes) -> BeamField:
    """The deflections and slopes (points, modes) of a beam's modes, from rows on its coordinates."""
    return replace(beam, deflection=beam.deflection @ modes.shapes, slope=beam.slope @ modes.shapes)


def _notes(scene: RigScene, rows: list[ModeRow]) -> tuple[str, ...]:
    """Notes on what is assumed, and on an impossible restitution at the end of the table."""
    from vibeam.runs.summary import beyond, ill_posed

    if scene.stop.law is not None:
        return scene.assumed
    below = next((row for row in rows if row.first_mode_restitution < 0 or row.contact_restitution > 1), None)
    if below is None:
        return scene.assumed
    where = f"from {below.number} modes on"
    if below.contact_restitution > 1:
        return (*scene.assumed, beyond(where, below.contact_restitution, scene))
    return (*scene.assumed, *ill_posed({where: below.first_mode_restitution}, scene))


def restitutions(scene: RigScene, first: float, mobility: float) -> tuple[float, float]:
    """First mode's and contact's coefficient, whichever of them is given; NaN of a stop that yields."""
    if scene.stop.law is not None and scene.stop.law.compliant:
        return nan, nan
    given = scene.stop.usual_restitution
    if scene.stop.restitution_of == "contact":
        return first_mode_restitution(given, first, mobility), given
    return given, needed_restitution(given, first, mobility)


def write_shapes(table: ModeTable, path: Path) -> None:
    """Write the modes' shapes as lines along x that bend along z, of a solid its cells; the largest of each mode 1 m.

    A ``.vtu`` file has the first beam or the solid, with a vector field of each mode; a ``.pvd`` file is a series with
    a step for each mode, every beam and the solid a piece, with the fields of ``shape_steps``.

    ValueError where there is none: the coordinates of given matrices have no places.
    """
    if not (table.beams or table.bodies):
        raise ValueError("no shapes to draw: the case gives no places of its coordinates")
    if path.suffix == ".pvd":
        write_series(shape_steps(table), path)
        return
    body, data = next(iter(table.bodies.values()), None), dict[str, Array]()
    for index, row in enumerate(table.rows):
        name = f"mode {row.number:02} ({f'{row.frequency:.4g} Hz' if row.frequency else 'rigid body'})"
        if body is not None:
            data[name] = _moved(table, body, index)
            continue
        drawn = _fields(table, "beam", index)
        data |= {name: drawn["displacement"], f"{name}, rotation": drawn["rotation"]}
    if body is None:
        write_vtu(VtuPiece(_line(table.beams["beam"]), data), path)
    else:
        write_vtu(VtuPiece(body.points, data, body.cells), path)


def shape_steps(table: ModeTable) -> list[Step]:
    """A step for each mode, its time the mode's number: ``displacement`` and ``rotation`` (k, 3), ``thickness``,
    ``frequency`` (Hz) and ``damping_ratio`` (k,) of every beam; of a solid without rotation and thickness."""
    steps: list[Step] = []
    for index, row in enumerate(table.rows):
        pieces = {}
        for name, beam in table.beams.items():
            data = _fields(table, name, index) | {"thickness": beam.height} | _constant(row, len(beam.positions))
            pieces[name] = VtuPiece(_line(beam), data)
        for name, body in table.bodies.items():
            data = {"displacement": _moved(table, body, index), **_constant(row, len(body.points))}
            pieces[f"solid {name}"] = VtuPiece(body.points, data, body.cells)
        steps.append((float(row.number), pieces))
    return steps


def _constant(row: ModeRow, count: int) -> dict[str, Array]:
    return {name: np.full(count, getattr(row, name)) for name in ("frequency", "damping_ratio")}


def _line(beam: BeamField) -> Array:
    return np.column_stack((beam.positions, np.zeros((len(beam.positions), 2))))


def _fields(table: ModeTable, name: str, index: int) -> dict[str, Array]:
    """Fields of one mode of a beam, over its largest displacement."""
    beam, scale = table.beams[name], _largest(table, index)
    return centre_line(beam.positions, 0.0, beam.deflection[:, index] / scale, beam.slope[:, index] / scale)


def _moved(table: ModeTable, body: Any, index: int) -> Array:
    """Displacement (k, 3) of a solid in one mode, over its largest."""
    return np.asarray(body.displacement(np.eye(len(table.rows))[index]) / _largest(table, index))


def _largest(table: ModeTable, index: int) -> float:
    """Largest displacement of a mode, of all beams, or of the solid; 1 where none is, as of torsion of a beam."""
    if table.bodies:
        mode = np.eye(len(table.rows))[index]
        return max(float(np.linalg.norm(each.displacement(mode), axis=1).max()) for each in table.bodies.values())
    return max(float(np.abs(beam.deflection[:, index]).max()) for beam in table.beams.values()) or 1.0


@of_source
def export_matrices(case: Case | AnyScene, path: str | PathLike[str]) -> str:
    """Write M, C and K of the whole model and its rows to ``path``; returns the [matrices] table that reads them.

    One file (.npz, .h5, .mat), or one for each array with its name (.mtx, .npy). SI units, on a base held still: a
    platform is not in them. The rows are those of contact, sensor and further displacements, and, as ``base``, the r of
    the load −M r; or, as ``force``, that of the place which a force or a moment drives, whose amplitude in N or N m is
    then drive.force. ValueError for another ending, and for matrices that stay sparse.

    >>> import vibeam
    >>> print(vibeam.export_matrices("cases/dtu_neutral.toml", "rig.npz").splitlines()[1])
    mass = { file = "rig.npz", name = "M" }
    """
    given: Any = case
    scene: AnyScene = getattr(given, "scene", given)
    places = write_arrays(arrays_of(scene), Path(path))
    keys = {"mass": "M", "stiffness": "K", "damping_matrix": "C", "contact": "contact"}
    keys |= {name: name for name in ("base", "force") if name in places}
    rows = {name: name for name in places if name not in keys.values()}
    keys |= {"sensor": rows.pop("sensor")} if "sensor" in rows else {}
    lines = [f"{key} = {_said(*places[name])}" for key, name in keys.items()]
    further = ", ".join(f"{name} = {_said(*places[name])}" for name in rows)
    return "\n".join(["[matrices]", *lines, 'units = "SI"', *([f"outputs = {{ {further} }}"] if further else []), ""])


def arrays_of(scene: AnyScene) -> Arrays:
    """The matrices and rows by name; ValueError for sparse ones, which would become full."""
    structure = structure_of(scene)
    if not isinstance(structure.M, np.ndarray):
        raise ValueError(f"{structure.size} coordinates stay sparse, in the files that the case names")
    found = {"M": structure.M, "C": structure.C, "K": structure.K, "contact": structure.contact, **_driven(scene)}
    return found | {name: row for name, row in structure.outputs.items() if structure.units.get(name, "m") == "m"}


def _driven(scene: Any) -> Arrays:
    """The row of what drives the structure: of the base's motion, or of the place of a force."""
    structure = structure_of(scene)
    if scene.base.on_beam is not None:
        return {"force": -structure.load}
    return {"base": np.asarray(np.linalg.solve(structure.M, -structure.load), dtype=np.float64)}


def _said(file: Path, name: str) -> str:
    return f'{{ file = "{file.name}", name = "{name}" }}' if name else f'"{file.name}"'
