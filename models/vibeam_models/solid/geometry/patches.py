"""Patches: parts of a body's surface by name, as facets of its mesh, and the places along x that they begin and end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vibeam_models.arrays import Index

NEAR = 1e-9  # of the body's length by which a facet may stand out of its patch


@dataclass(frozen=True)
class Patch:
    """From ``start`` to ``end`` m along x, from ``left`` to ``right`` m in y, on the ``side`` above (1) or below (−1).

    ``edges``: half-widths (m) that need mesh lines of their own, inside the section.
    """

    name: str
    start: float
    end: float
    left: float
    right: float
    side: float
    edges: tuple[float, ...] = ()

    def facets(self, mesh: Any) -> Index:
        """Facets (k,) of the outer surface on its side that lie in it, of a half body those of y ≥ 0."""
        outer = mesh.boundary_facets()
        corners = mesh.p[:, mesh.facets[:, outer]]
        middle = corners.mean(axis=1)
        inside = mesh.p[:, mesh.t[:, mesh.f2t[0, outer]]].mean(axis=1)
        near = NEAR * float(np.ptp(mesh.p[0]))
        level = np.ptp(corners[0], axis=0) > near
        level &= np.ptp(corners[1], axis=0) > near
        outward = self.side * (middle[2] - inside[2])
        facing = level & (outward > 0) & (self.side * middle[2] > 0)
        here = (middle[0] > self.start) & (middle[0] < self.end) & (middle[1] > self.left) & (middle[1] < self.right)
        return np.asarray(outer[facing & here])


def plane(mesh: Any, x: float) -> Index:
    """Facets (k,) in the end plane at ``x`` m."""
    outer = mesh.boundary_facets()
    near = NEAR * float(np.ptp(mesh.p[0]))
    return np.asarray(outer[np.all(np.abs(mesh.p[0][mesh.facets[:, outer]] - x) <= near, axis=0)])
