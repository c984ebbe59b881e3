"""Modes of the whole finite-element beam, and the effect of truncation on the restitution."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import nan
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.whole_files import write_whole
from vibeam_models.any_scene import AnyScene, RigScene
from vibeam_models.arguments import whole
from vibeam_models.beam import assemble_with_space
from vibeam_models.laws.restitution import first_mode_restitution
from vibeam_models.scene import Scene
from vibeam_models.space import BeamSpace
from vibeam_models.structure import Modes

if TYPE_CHECKING:
    from vibeam.case.case import Case


Array = NDArray[np.float64]


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


@dataclass(frozen=True)
class ModeTable:
    """First modes of a beam, and their shapes: deflections (points, modes) at ``positions`` (points,) in m.

    Of a given structure no places are known: ``positions`` and ``shapes`` are empty.

    ``load_unit``: that of the rows' loads, per base acceleration, or per force or moment on the beam. ``notes``:
    limits of the numbers, in sentences.
    """

    rows: tuple[ModeRow, ...]
    positions: Array
    shapes: Array
    notes: tuple[str, ...] = ()
    load_unit: str = "kg^½"


LOAD_UNITS = {None: "kg^½", 0: "kg^-½", 1: "kg^-½ m^-1"}  #: of a base that moves, of a force, of a moment


def modes(case: Case, count: int = 10) -> ModeTable:
    """Compute the first ``count`` modes of a case's finite-element beam: see ``mode_table``."""
    return mode_table(case.scene, count)


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
    structure, space = assemble_with_space(scene) if isinstance(scene, Scene) else (rig.structure(), None)
    modes = structure.modes(min(int(count), structure.size))
    damping = np.diag(structure.congruent("C", modes.shapes)) / (2 * np.where(modes.omega > 0, modes.omega, np.inf))
    contact, sensor = structure.contact @ modes.shapes, structure.outputs["sensor"] @ modes.shapes
    mobility = structure.mobility(structure.contact)
    cut = np.cumsum(contact**2)
    rows = [
        ModeRow(
            number=i + 1,
            frequency=float(modes.frequency[i]),
            damping_ratio=float(damping[i]),
            contact=float(contact[i]),
            sensor=float(sensor[i]),
            load=float(-structure.load @ modes.shapes[:, i]),
            share=float(cut[i]) / mobility,
            first_mode_restitution=_restitutions(rig, contact, cut[i])[0],
            contact_restitution=_restitutions(rig, contact, cut[i])[1],
        )
        for i in range(len(modes.omega))
    ]
    unit = LOAD_UNITS[None if rig.base.on_beam is None else rig.base.on_beam[1]]
    drawn = _NOWHERE if space is None else _drawn(space, modes)
    return ModeTable(tuple(rows), *drawn, _notes(rig, rows), unit)


_NOWHERE = np.zeros(0), np.zeros((0, 0))  # shapes of a structure whose coordinates have no places


def _notes(scene: RigScene, rows: list[ModeRow]) -> tuple[str, ...]:
    """Notes on an impossible restitution at the end of the table."""
    from vibeam.run.remarks import ill_posed

    if scene.stop.law is not None:
        return ()
    below = next((row for row in rows if row.first_mode_restitution < 0), None)
    return tuple(ill_posed({f"from {below.number} modes on": below.first_mode_restitution})) if below else ()


def _restitutions(scene: RigScene, contact: Array, mobility: float) -> tuple[float, float]:
    """First mode's and contact's coefficient, whichever of them is given; NaN of a stop that yields."""
    if scene.stop.law is not None and scene.stop.law.compliant:
        return nan, nan
    given, first = scene.stop.usual_restitution, float(contact[0])
    if scene.stop.restitution_of == "contact":
        return float(first_mode_restitution(given, first, mobility)), given
    return given, float((1 + given) * mobility / first**2 - 1)


def _drawn(space: BeamSpace, modes: Modes) -> tuple[Array, Array]:
    """Positions along the beam: four an element, so that a shape looks as smooth as its cubics are."""
    nodes = space.nodes
    parts = [np.linspace(a, b, 4, endpoint=False) for a, b in pairwise(nodes)]
    positions = np.concatenate([*parts, nodes[-1:]])
    return positions, space.rows(positions) @ modes.shapes


def write_shapes(table: ModeTable, path: Path) -> None:
    """Write the beam's centre line as line cells to a VTU file, one vector field (deflection along z) a mode.

    ValueError where there is no beam: the coordinates of given matrices have no places.
    """
    count = len(table.positions)
    if not count:
        raise ValueError("no shapes to draw: the case gives no places of its coordinates")
    import meshio

    points = np.column_stack((table.positions, np.zeros((count, 2))))
    lines = np.column_stack((np.arange(count - 1), np.arange(1, count)))
    names = [f"mode {row.number:02} ({row.frequency:.4g} Hz)" for row in table.rows]
    fields = {name: _vector(table.shapes[:, i]) for i, name in enumerate(names)}
    with TemporaryDirectory() as folder:  # meshio writes to a path alone
        place = Path(folder) / "shapes.vtu"
        meshio.Mesh(points, [("line", lines)], point_data=fields).write(place)
        write_whole(path, place.read_bytes())


def _vector(shape: Array) -> Array:
    largest = np.abs(shape).max()
    deflection = shape / largest if largest > 0 else shape  # a mode of torsion does not bend
    return np.column_stack((np.zeros_like(shape), np.zeros_like(shape), deflection))
