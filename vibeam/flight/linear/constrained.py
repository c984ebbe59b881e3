"""The system held on the stop, in 2×2 blocks, for any damping."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.layout import A11, A12, A21, A22, BLOCK_ROWS, CONSTANT1, CONSTANT2, LOAD1, LOAD2, ROW1, ROW2
from vibeam.flight.kernels.roots.levels import rates
from vibeam.flight.linear.blocks import pair_constants, planes
from vibeam.flight.linear.eigenpairs import Linear

Array = NDArray[np.float64]

FURTHEST = 128  # binary orders by which the unit of time is moved at most


@dataclass(frozen=True)
class Constrained:
    """n − 1 blocks sorted by rate (see ``layout`` for ``blocks``) and the maps between modal and block coordinates.

    The contact force is force + force_load Ω²B sin φ + Σ row·y; η = held + …, with contact·held = gap.
    """

    omega: Array
    sigma: Array
    disc: Array
    blocks: Array
    to_blocks: Array
    from_blocks: Array
    held: Array
    force: float
    force_load: float


def constrained(omega: Array, sigma: Array, contact: Array, load: Array, static: Array, gap: float) -> Constrained:
    """The system with contact·η = gap held and contact force F = contact·(f − Dη' − Λη)/S.

    It is made in a unit of time of the system's own, a power of two, so that other units of time change no digit.
    """
    fastest = max(float(omega.max()), float(sigma.max()))
    unit = float(np.ldexp(1.0, np.clip(np.frexp(fastest)[1], -FURTHEST, FURTHEST)))
    own = _in_own_time(omega / unit, sigma / unit, contact, load, static / unit**2, gap)
    n = len(omega)
    blocks, into, out = own.blocks.copy(), own.to_blocks.copy(), own.from_blocks.copy()
    blocks[[A11, A12, A21, A22, CONSTANT1, CONSTANT2]] *= unit
    blocks[[ROW1, ROW2]] *= unit**2
    blocks[[LOAD1, LOAD2]] /= unit
    into[:, n:] /= unit
    out[n:] *= unit
    return replace(
        own, omega=own.omega * unit, sigma=own.sigma * unit, disc=own.disc * unit**2, blocks=blocks,
        to_blocks=into, from_blocks=out, force=own.force * unit**2,
    )  # fmt: skip


def _in_own_time(omega: Array, sigma: Array, contact: Array, load: Array, static: Array, gap: float) -> Constrained:
    """The same in the units that are given: η = contact·gap/S + z with contact·z = 0, z in ``planes``."""
    n, mobility = len(omega), float(contact @ contact)
    stiffness, damping, held = omega**2, 2 * sigma, contact * (gap / mobility)
    system = Linear(stiffness, np.diag(damping), contact, inf)
    found, sizes = planes(system), np.concatenate([system.scale, np.ones(n)])
    order = np.argsort(rates(*pair_constants(found.blocks)[:2]), kind="stable")
    pick = np.stack([2 * order, 2 * order + 1], axis=1).ravel()
    into, out, a = found.inverse[pick] * sizes, found.columns[:, pick] / sizes[:, None], found.blocks[order]
    row = -np.concatenate([contact * stiffness, contact * damping]) @ out / mobility
    constant = static - stiffness * held
    along, across = float(contact @ constant) / mobility, float(contact @ load) / mobility
    blocks = np.zeros((BLOCK_ROWS, n - 1))
    blocks[A11 : A11 + 4] = a.reshape(n - 1, 4).T
    blocks[[ROW1, ROW2]] = row.reshape(n - 1, 2).T
    blocks[[CONSTANT1, CONSTANT2]] = (into[:, n:] @ (constant - contact * along)).reshape(n - 1, 2).T
    blocks[[LOAD1, LOAD2]] = (into[:, n:] @ (load - contact * across)).reshape(n - 1, 2).T
    both = np.ascontiguousarray(into), np.ascontiguousarray(out)
    return Constrained(*pair_constants(a), blocks, *both, held, along, across)
