"""Blocks of a plain system held on its stop as numbers, and whether the roots of one equation give them.

Held modes are the roots of Σ w²/(λ² + dλ + Λ) = 0. A page finds these by itself, at any damping, where every held mode
oscillates and no two modes coincide; of any other system it is given the blocks.
"""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.linear.blocks import proportional
from vibeam.flight.linear.eigenpairs import LinearSystem
from vibeam.flight.linear.packing import pack
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array

TURNING = 0.1  # least 2 Im λ / |λ| of a held mode that is found by its root
APART = 1e-6  # least relative distance of two modes' frequencies between which one is looked for


def held_planes(system: ImpactSystem) -> dict[str, Array]:
    """``into`` (2m, 2n), ``outof`` (2n, 2m), ``blocks`` (4, m): A11 … A22, ``mode`` (m,) as the kernels have them.

    ValueError where modes coincide so closely that there are none.
    """
    rest = pack(system, 0.0).engine.rest
    rows = slice(layout.A11, layout.A22 + 1)
    return {"into": rest.into, "outof": rest.outof, "blocks": rest.blocks[rows], "mode": rest.blocks[layout.MODE]}


def roots_serve(system: ImpactSystem) -> bool:
    """Test whether the blocks follow from roots: held modes that oscillate, of modes well apart."""
    order = np.argsort(system.omega, kind="stable")
    order = order[system.contact[order] != 0]
    omega, zeta = system.omega[order], system.zeta[order]
    if len(omega) < 2:
        return True
    if np.any(np.diff(omega) <= APART * omega[1:]):
        return False
    linear = LinearSystem(omega**2, np.diag(2 * zeta * omega), system.contact[order])
    return proportional(linear) or _all_turn(system)


def _all_turn(system: ImpactSystem) -> bool:
    """Test whether every held mode that moves several oscillates."""
    try:
        found = held_planes(system)
    except ValueError:
        return False
    a, b, c, d = found["blocks"][:, found["mode"] < 0]
    turn = -(((a - d) / 2) ** 2) - b * c
    return bool(np.all(4 * turn > TURNING**2 * (a * d - b * c)))
