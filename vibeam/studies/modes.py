"""Modes of the whole finite-element beam, and the effect of truncation on the restitution."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.whole_files import write_whole
from vibeam_models.arguments import whole
from vibeam_models.beam import assemble_with_space
from vibeam_models.laws.restitution import first_mode_restitution
from vibeam_models.scene import Scene, SdofScene
from vibeam_models.space import BeamSpace
from vibeam_models.structure import Modes

if TYPE_CHECKING:
    from vibeam.case.case import Case


Array = NDArray[np.float64]


@dataclass(frozen=True)
class ModeRow:
    """One mass-normalised mode: Hz; ``contact``, ``sensor`` in kg^-½; ``load`` in kg^½.

    ``share``: part of w M⁻¹ wᵀ carried by the modes up to this one. Truncated after this mode, mode 1 has
    ``first_mode_restitution`` and the contact has ``contact_restitution``: the case gives one of them, the other
    follows (above 1: no contact can do that).
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

    ``notes``: limits of the numbers, in sentences.
    """

    rows: tuple[ModeRow, ...]
    positions: Array
    shapes: Array
    notes: tuple[str, ...] = ()


def modes(case: Case, count: int = 10) -> ModeTable:
    """Compute the first ``count`` modes of a case's finite-element beam: see ``mode_table``."""
    return mode_table(case.scene, count)


def mode_table(scene: Scene | SdofScene, count: int = 10) -> ModeTable:
    """Compute the first ``count`` modes (all, if there are fewer) of the finite-element model with all effects.

    The base is fixed: a platform's own mode is not among them, because restitution refers to the beam's.

    ValueError for a SdofScene, which has no beam, or ``count`` < 1.
    """
    if isinstance(scene, SdofScene):
        raise ValueError("no modes to show: this case gives the SDOF model directly, there is no beam")
    if (whole(count) or 0) < 1:
        raise ValueError(f"count: {count!r}, there is a table from 1 mode on")
    structure, space = assemble_with_space(scene)
    modes = structure.modes(min(int(count), structure.size))
    damping = np.einsum("ni,nm,mi->i", modes.shapes, structure.C, modes.shapes) / (2 * modes.omega)
    contact, sensor = structure.contact @ modes.shapes, structure.outputs["sensor"] @ modes.shapes
    mobility = float(structure.contact @ np.linalg.solve(structure.M, structure.contact))
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
            first_mode_restitution=_restitutions(scene, contact, cut[i])[0],
            contact_restitution=_restitutions(scene, contact, cut[i])[1],
        )
        for i in range(len(modes.omega))
    ]
    return ModeTable(tuple(rows), *_drawn(space, modes), _notes(scene, rows))


def _notes(scene: Scene, rows: list[ModeRow]) -> tuple[str, ...]:
    """Notes on an impossible restitution at the end of the table."""
    from vibeam.run.remarks import ill_posed

    if scene.stop.law is not None:
        return ()
    below = next((row for row in rows if row.first_mode_restitution < 0), None)
    return tuple(ill_posed({f"from {below.number} modes on": below.first_mode_restitution})) if below else ()


def _restitutions(scene: Scene, contact: Array, mobility: float) -> tuple[float, float]:
    """First mode's and contact's coefficient, whichever of them is given."""
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
    """Write the beam's centre line as line cells to a VTU file, one vector field (deflection along z) a mode."""
    import meshio

    count = len(table.positions)
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
