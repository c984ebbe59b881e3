"""Rigs as solids by the second program: a strip with steps, plates or blocks, a rigid zone with its mass, a patch.

x along the beam, y across, z the direction of motion. Frequencies are those symmetric in y; lateral bending and twist
are found too, since the body is whole, and left out by their shapes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import eigsh, splu
from tetrahedra import lattice, matrices, mean_over_patch, rigid_zone


@dataclass(frozen=True)
class Part:
    """A box x × y × z of lengths in m, each (from, to), with modulus in Pa, Poisson's ratio, density."""

    x: tuple[float, float]
    y: tuple[float, float]
    z: tuple[float, float]
    material: tuple[float, float, float]

    def holds(self, x, y, z):
        """Which places lie in it."""
        sides = ((self.x, x), (self.y, y), (self.z, z))
        return np.all([(low < at) & (at < high) for (low, high), at in sides], axis=0)


@dataclass(frozen=True)
class Rig:
    """``parts`` joined where they touch, clamped at ``clamps``; ``zone`` (from, to, centre, mass, (Jx, Jy, Jz)).

    ``patch``: x and y range on the face at z = ``face`` that the stop meets; ``bend``: of the nodes of the lattice.
    """

    parts: tuple[Part, ...]
    clamps: tuple[float, ...]
    patch: tuple[tuple[float, float], tuple[float, float]]
    face: float
    zone: tuple | None = None
    bend: Callable | None = None


@dataclass(frozen=True)
class Answer:
    """Natural frequencies in Hz of symmetric modes, contact's flexibility in m/N and its slopes of each mode, 1/√kg."""

    frequencies: np.ndarray
    flexibility: float
    contact: np.ndarray
    load: np.ndarray
    mass: float


def answer(rig, sizes, count=3, found=14):
    """The first ``count`` of ``found`` modes of the rig meshed with cells of about ``sizes`` (3,) m at most."""
    lines = [_lines(rig, axis, sizes[axis]) for axis in range(3)]
    mesh = lattice(*lines, inside=lambda *at: np.any([part.holds(*at) for part in rig.parts], 0))
    material = np.zeros((3, len(mesh.cells)))
    for part in rig.parts:
        material[:, part.holds(*mesh.middles.T)] = np.array(part.material)[:, None]
    x, y, z = mesh.nodes.T
    on = np.isclose(z, rig.face) & _within(x, rig.patch[0]) & _within(y, rig.patch[1])
    clamp = np.any([np.isclose(x, at) for at in rig.clamps], axis=0)
    straight = mesh.nodes
    if rig.bend is not None:
        mesh = type(mesh)(rig.bend(mesh.nodes), mesh.cells)
    stiff, inertia = matrices(mesh, *material)
    row = mean_over_patch(mesh, on, (0, 0, 1))
    kept = np.repeat(~clamp, 3)
    lift = np.tile([0.0, 0, 1], len(mesh.nodes))
    tied, carried = sparse.identity(len(kept), format="csc"), np.zeros((0, 0))
    if rig.zone is not None:
        low, high, centre, mass, turning = rig.zone
        mask = _within(x, (low, high))
        tied, carried = rigid_zone(mesh, mask, (centre, 0, 0), mass, turning)
        kept = np.append(kept[np.repeat(~mask, 3)], np.ones(6, bool))
        lift = np.append(lift[np.repeat(~mask, 3)], [0, 0, 1, 0, 0, 0])
    stiff, inertia = (tied.T @ each @ tied for each in (stiff, inertia))
    empty = inertia.shape[0] - len(carried)
    inertia = inertia + sparse.block_diag([sparse.csc_matrix((empty, empty)), sparse.csc_matrix(carried)])
    base = inertia @ lift
    whole = float(lift @ base)
    chosen = np.flatnonzero(kept)
    stiff, inertia = (each.tocsc()[chosen][:, chosen] for each in (stiff, inertia))
    free = tied[:, chosen]
    return _solved(stiff.tocsc(), inertia.tocsc(), free, free.T @ row, base[chosen], whole, straight, (count, found))


def _solved(stiff, inertia, free, row, base, whole, places, counts):
    squared, shapes = eigsh(stiff, counts[1], inertia, sigma=0.0, v0=np.ones(stiff.shape[0]))
    order = np.argsort(squared)
    motion = (free @ shapes[:, order]).reshape(len(places), 3, -1)
    key = np.round(places / np.ptp(places, axis=0) * 1e6).astype(int)
    mirrored = {tuple(each): number for number, each in enumerate(key)}
    other = np.array([mirrored[a, -b, c] for a, b, c in key])
    even = motion + motion[other] * np.array([1, -1, 1])[:, None]
    kept = np.flatnonzero((even**2).sum((0, 1)) > 2 * (motion**2).sum((0, 1)))[: counts[0]]
    shapes = shapes[:, order][:, kept]
    contact = row @ shapes
    return Answer(
        np.sqrt(squared[order][kept]) / (2 * np.pi),
        float(row @ splu(stiff).solve(row)),
        np.abs(contact),
        np.where(contact < 0, -1.0, 1.0) * (base @ shapes),
        whole,
    )


def _within(at, ends):
    slack = 1e-9
    return (at > ends[0] - slack) & (at < ends[1] + slack)


def _lines(rig, axis, size):
    """Planes across ``axis``: every face of a part, of the zone and of the patch, and between them equal steps."""
    marks = [end for part in rig.parts for end in (part.x, part.y, part.z)[axis]]
    marks += list(rig.patch[axis]) if axis < 2 else []
    marks += list(rig.zone[:2]) if axis == 0 and rig.zone is not None else []
    marks = np.unique(np.round(marks, 12))
    steps = np.maximum(np.ceil(np.diff(marks) / size - 1e-9), 1).astype(int)
    pieces = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(marks[:-1], marks[1:], steps, strict=True)]
    return np.append(np.concatenate(pieces), marks[-1])
