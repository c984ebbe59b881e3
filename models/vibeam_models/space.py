"""BeamSpace: finite elements of a beam on one mesh, with what its constraints have left free; the bare beam in it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.elements import BeamElements, hermite_elements
from vibeam_models.structure import Structure

GIVES_WAY = 0.25  # share of a uniform element within which a uniform node gives way to an inserted one
SAME = 1e-9  # share of the length within which two inserted nodes are one
KEPT = 256  # rows of spaces
MESHES = 32  # clamped spaces, each of a mesh of its own
BEAMS = 16  # beams without what they carry
NEAR = 1e-3  # share of the length: a node at a load must be this far from those of mass and rigid zone
UNDAMPED = Damping("constant", (0.0,))


def nodes(length: float, elements: int, inserted: Iterable[float] = ()) -> Array:
    """Ascending node positions (k,) in m: ``elements`` uniform ones on [0, length] and every ``inserted`` one.

    A uniform node nearer than a quarter element to an inserted one is left out, so that no element is needlessly
    short; both ends stay. ValueError for ``elements`` < 1 or an inserted node outside [0, length].
    """
    if elements < 1:
        raise ValueError(f"elements: {elements}, a mesh needs at least 1")
    kept = [0.0, length]
    for position in inserted:
        if not 0 <= position <= length:
            raise ValueError(f"no node can stand at {position} m: the beam ends at {length} m")
        if min(abs(position - other) for other in kept) > SAME * length:
            kept.append(float(position))
    uniform = np.linspace(0.0, length, elements + 1)[1:-1]
    clear = np.abs(uniform[:, None] - np.array(kept)).min(axis=1) > GIVES_WAY * length / elements
    return np.sort(np.concatenate([kept, uniform[clear]]))


@dataclass(frozen=True, eq=False)
class BeamSpace:
    """Elements of a beam, deflection and slope at each node first, and the constraints upon them.

    ``elements``: on their mesh; ``constraint`` (dofs, size): dofs = constraint @ x, x the free coordinates.
    """

    elements: BeamElements
    constraint: Array

    @classmethod
    def held(cls, elements: BeamElements, fixed: Iterable[int]) -> BeamSpace:
        """The space of ``elements`` with the degrees of freedom ``fixed`` held."""
        return _held(elements, tuple(sorted(fixed)))

    @property
    def nodes(self) -> Array:
        """Node positions (k,) in m."""
        return self.elements.nodes

    @property
    def size(self) -> int:
        """Number of free coordinates."""
        return int(self.constraint.shape[1])

    @cached_property
    def free(self) -> NDArray[np.intp]:
        """The degrees of freedom, ascending, that any coordinate moves."""
        return np.flatnonzero(np.any(self.constraint, axis=1))

    @cached_property
    def is_plain(self) -> bool:
        """True where every coordinate is one degree of freedom, in their order."""
        free = self.free
        if not len(free) == self.size == np.count_nonzero(self.constraint):
            return False
        return bool(np.all(self.constraint[free, np.arange(self.size)] == 1))

    def widened(self, count: int) -> BeamSpace:
        """The same space with ``count`` further coordinates that bend nothing."""
        return self.constrained(np.eye(self.size, self.size + count))

    def constrained(self, further: Array) -> BeamSpace:
        """The same space with x = further @ y: ``further`` (size, fewer)."""
        return replace(self, constraint=self.constraint @ further)

    def within(self, matrix: Array) -> Array:
        """A matrix (dofs, dofs) of all degrees of freedom in the free coordinates (size, size)."""
        if self.is_plain:
            return np.ascontiguousarray(matrix[self.free][:, self.free])
        return np.asarray(self.constraint.T @ matrix @ self.constraint)

    def base_load(self, mass: Array) -> Array:
        """Force (size,) per unit acceleration of the base, −M r, of ``mass`` (dofs, dofs).

        The supports move along: r is 1 for the deflection of every node, 0 for all else.
        """
        rows = mass[self.free] if self.is_plain else self.constraint.T @ mass
        translation = np.zeros(self.elements.count)
        translation[: 2 * len(self.nodes) : 2] = 1.0
        return np.asarray(-(rows @ translation))

    def row(self, x: float, derivative: int = 0) -> Array:
        """Row (size,) that reads the deflection (``derivative`` 0, m), slope (1) or curvature (2, 1/m) at ``x`` m."""
        return _row(self, float(x), derivative)

    def rows(self, positions: ArrayLike, derivative: int = 0) -> Array:
        """``row`` of many positions (k,) at once: (k, size). ValueError for a position off the beam."""
        x = np.atleast_1d(np.asarray(positions, dtype=float))
        end = float(self.nodes[-1])
        if np.any((x < 0) | (x > end)):
            raise ValueError(f"positions must lie in [0, {end}] m: {x[(x < 0) | (x > end)]}")
        if derivative not in (0, 1, 2):
            raise ValueError(f"derivative: {derivative}, beam elements offer 0, 1 and 2")
        rows = self.elements.rows(x, derivative)
        return np.ascontiguousarray(rows[:, self.free]) if self.is_plain else rows @ self.constraint


@lru_cache(maxsize=MESHES)
def _held(elements: BeamElements, fixed: tuple[int, ...]) -> BeamSpace:
    return BeamSpace(elements, np.delete(np.eye(elements.count), fixed, axis=1))


@lru_cache(maxsize=KEPT)
def _row(space: BeamSpace, x: float, derivative: int) -> Array:
    row: Array = space.rows([x], derivative)[0]
    row.setflags(write=False)
    return row


def bare_beam(beam: Beam, inserted: Iterable[float] = ()) -> tuple[Structure, BeamSpace]:
    """The undamped beam alone on its supports, and its space, with extra mesh nodes at ``inserted`` (m).

    Contact and the only output, ``"tip"``, are the deflection at the far end. The load is −M r with the supports moving
    along: r is 1 there too.
    """
    return _bare_beam(replace(beam, damping=UNDAMPED), tuple(inserted))


@lru_cache(maxsize=BEAMS)  # the arrays of a Structure are never written to
def _bare_beam(beam: Beam, inserted: tuple[float, ...]) -> tuple[Structure, BeamSpace]:
    elements = _elements(beam, nodes(beam.length, beam.elements, (*inserted, *beam.breaks)))
    space = BeamSpace.held(elements, _fixed(beam, elements.nodes))
    (mass, stiffness), tip = elements.matrices(beam), space.row(beam.length)
    structure = Structure(
        M=space.within(mass),
        C=np.zeros((space.size, space.size)),
        K=space.within(stiffness),
        load=space.base_load(mass),
        static=np.zeros(space.size),
        contact=tip,
        outputs={"tip": tip},
        units={"tip": "m"},
    )
    return _sprung(structure, space, beam), space


def _elements(beam: Beam, places: Array) -> BeamElements:
    """Elements by the beam's theory."""
    if not beam.shear:
        return hermite_elements(places)
    from vibeam_models.timoshenko import TimoshenkoElements

    return TimoshenkoElements.of(beam, places)


def _fixed(beam: Beam, places: Array) -> list[int]:
    """Degrees of freedom that rigid supports hold: deflection 2i, slope 2i + 1 of node i."""
    return [
        2 * int(np.argmin(np.abs(places - support.position))) + which
        for support in beam.held
        for which, stiffness in enumerate(support.each)
        if stiffness == inf
    ]


def _sprung(structure: Structure, space: BeamSpace, beam: Beam) -> Structure:
    """The structure with K + k wᵀw for every spring of the supports, w its deflection or slope."""
    stiffness = structure.K
    for support in beam.held:
        for derivative, spring in enumerate(support.each):
            if 0 < spring < inf:
                row = space.row(support.position, derivative)
                stiffness = stiffness + spring * np.outer(row, row)
    return structure if stiffness is structure.K else structure.with_(K=stiffness)
