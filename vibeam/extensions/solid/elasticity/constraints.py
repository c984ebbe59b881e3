"""Constraints of a solid: held components and rigid zones, as coordinates y of which the displacement is u = Z y."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np

from vibeam.extensions.solid.elasticity.rows import NEAR, SolidRows, X, Y, Z
from vibeam_models.arrays import Array, Flags
from vibeam_models.beams.beam import Beam, Support, end_supports
from vibeam_models.structure import elimination

HALF = 3  # rigid motions of a half body: along, up, slope


@dataclass(frozen=True, eq=False)
class RigidPart:
    """Nodes (k,) of a body that move as one about ``centre`` (3,) m; ``name``: for messages."""

    name: str
    nodes: Flags
    centre: Array

    def motions(self, points: Array, half: bool) -> Any:
        """Displacements (3 k, 3 or 6), sparse, of its nodes by its coordinates.

        Displacement of the centre along x and z, slope −∂u_x/∂z; of a whole body also displacement along y, turn about
        z and twist about x.
        """
        from scipy.sparse import csc_array

        at = np.flatnonzero(self.nodes)
        x, y, z = points[:, at] - self.centre[:, None]
        one = np.ones(len(at))
        entries = [(X, 0, one), (Z, 1, one), (X, 2, -z), (Z, 2, x)]
        entries += [] if half else [(Y, 3, one), (X, 4, -y), (Y, 4, x), (Y, 5, -z), (Z, 5, y)]
        rows = np.concatenate([3 * at + component for component, _, _ in entries])
        columns = np.repeat([column for _, column, _ in entries], len(at))
        values = np.concatenate([values for _, _, values in entries])
        return csc_array((values, (rows, columns)), shape=(points.size, HALF if half else 2 * HALF))


@dataclass(frozen=True, eq=False)
class SolidCoordinates:
    """Coordinates y (n,) of a body: u = ``basis`` y, ``basis`` Z (3 k, n) sparse.

    ``inner`` (3 k, n): T⁻¹ Z where displacements are counted from those of other nodes, u = T v, else Z.
    ``parts`` (3 or 6, n): rows that read the motions of each rigid part, in the order of ``RigidPart.motions``.
    """

    basis: Any
    inner: Any
    parts: tuple[Array, ...]

    @classmethod
    def of(
        cls, points: Array, half: bool, held: Flags, parts: Sequence[RigidPart], relative: Any = None
    ) -> SolidCoordinates:
        """The coordinates of a body at ``points`` (3, k) whose components ``held`` (3, k) do not move.

        ``relative``: T; what is held of a node is held of that which it is counted from. ValueError where a support or
        another rigid part holds some of a rigid part.
        """
        from scipy.sparse import eye_array, hstack

        fixed = held.copy()
        if half:
            fixed[Y, np.abs(points[Y]) <= NEAR * np.ptp(points[X])] = True
        gone = fixed.T.ravel()
        for part in parts:
            own = np.repeat(part.nodes, 3)
            if (held[:, part.nodes].any()) or (gone[own].reshape(-1, 3)[:, [X, Z]]).any():
                raise ValueError(f"{part.name}: a support or another rigid body holds part of it")
            gone |= own
        free = np.flatnonzero(~gone)
        each = HALF if half else 2 * HALF
        identity = eye_array(len(gone), format="csc")
        back = identity if relative is None else 2 * identity - relative  # T = 1 + E with E² = 0
        inner = hstack([identity[:, free], *(back @ part.motions(points, half) for part in parts)], format="csc")
        reading = (np.eye(each, inner.shape[1], len(free) + each * number) for number in range(len(parts)))
        return cls(inner if relative is None else relative @ inner, inner, tuple(reading))

    def tied(self, rows: Sequence[Array]) -> SolidCoordinates:
        """The same where ``rows`` (3 k,) read nothing."""
        if not rows:
            return self
        further = elimination(np.stack([row @ self.basis for row in rows]))
        parts = tuple(part @ further for part in self.parts)
        return SolidCoordinates(self.basis @ further, self.inner @ further, parts)


def holding(rows: SolidRows, beam: Beam, sliding: bool, bedded: bool = False) -> tuple[Flags, list[Array]]:
    """Components (3, k) that the supports of ``beam`` hold, and rows (3 k,) that they hold besides.

    A clamped end is held in all directions, where ``sliding`` along the beam and as a whole; a pinned one, and a rigid
    support between, as a whole: on a line, a solid would yield ever more the finer its mesh is. A guided end is held
    along the beam, and so is the mean of the first support where no end is. Springs leave their own direction free
    alone. ``bedded``: the clamp at x = 0 does not hold it along x.
    """
    points = rows.elements.points
    near = NEAR * float(np.ptp(points[X]))
    held, tied = np.zeros(points.shape, dtype=bool), []
    supports = _together([*end_supports(beam.ends, beam.length), *beam.supports])
    along = bedded or any(each.rotational_stiffness == inf for each in supports)
    for support in sorted(supports, key=lambda each: each.position):
        face = np.abs(points[X] - support.position) <= near
        clamped = support.rotational_stiffness == inf
        held[X] |= face & (clamped and not (bedded and support.position == 0))
        if clamped and support.stiffness == inf and not sliding:
            held[Y:] |= face
        else:
            tied += _as_a_whole(rows, support, not along)
        along = True
    return held, tied


def _together(supports: Iterable[Support]) -> list[Support]:
    """The supports, those at one place as one by the stiffer of each kind."""
    found: dict[float, Support] = {}
    for each in supports:
        other = found.get(each.position, each)
        both = (max(pair) for pair in zip(each.each, other.each, strict=True))
        found[each.position] = Support(each.position, *both)
    return list(found.values())


def _as_a_whole(rows: SolidRows, support: Support, along: bool) -> list[Array]:
    """Mean motions of a section that its support holds, those that a body can have, its mean ``along`` the beam too."""
    forth, up, _, lateral, turn, twist = rows.section(support.position)
    found = [up] if support.stiffness == inf else []
    if not rows.body.half:
        found += [lateral, twist] if support.stiffness else []
        found += [turn] if 0 < support.rotational_stiffness < inf else []
    return [*found, forth] if along else found
