"""Plain systems with other gaps and restitutions as arrays for the kernels: one packed system serves them all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from vibeam.flight.equilibrium import products
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import ELASTIC, Engine
from vibeam.flight.linear.block_regime import set_output
from vibeam.flight.linear.packing import PackedSystem, pack
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array


def packed(system: ImpactSystem, omega: float, elastic: bool, output: str) -> tuple[PackedSystem, Engine]:
    """The system packed for drives of ``omega`` rad/s, its output set; ``elastic``: for R next to 1, or for any other.

    How it is packed depends on R no further: see ``linear.packing.lay_out``.
    """
    if elastic != (1.0 - system.restitution < ELASTIC):
        system = replace(system, restitution=1.0 if elastic else 0.5)
    made = pack(system, omega)
    engine = made.engine_for(np.inf)
    set_output(engine.rest, made.inward(system.output(output)))
    return made, engine


def stacked(engines: Sequence[Any]) -> Any:
    """Tuples of arrays as one tuple, each array with an axis more in front; those of one engine are not copied."""
    first = engines[0]
    if isinstance(first, np.ndarray):
        return np.ascontiguousarray(np.stack(engines)) if len(engines) > 1 else first[None]
    return type(first)(*(stacked([each[i] for each in engines]) for i in range(len(first))))


def blank(engine: Any, copies: int) -> Any:
    """Arrays of as many engines of that size."""
    if isinstance(engine, np.ndarray):
        return np.zeros((copies, *engine.shape[1:]))
    return type(engine)(*(blank(each, copies) for each in engine))


def held(engine: Engine, row: Array, gaps: Array) -> tuple[Array, Array, Array]:
    """Numbers of the system held on the stop that depend on the gap, for each of ``gaps`` (m,).

    Displacements (m, n), constants (m, 2, blocks), constants (m, 2) of contact force and output: to the bit those of
    ``linear.block_regime``, whose products these are, one gap after the other.
    """
    modes, contact, n = engine.modes, np.ascontiguousarray(engine.modes[layout.CONTACT]), engine.modes.shape[1]
    mobility = float(engine.drive[layout.MOBILITY])
    at = contact * (gaps / mobility)[:, None]
    constant = modes[layout.STATIC] - engine.pairs[layout.OMEGA] ** 2 * at
    along = products(constant, contact) / mobility
    pushed = constant - contact * along[:, None]
    found = (engine.rest.into[:, n:] @ pushed[:, :, None])[:, :, 0]
    constants = np.ascontiguousarray(found.reshape(len(gaps), -1, 2).swapaxes(1, 2))
    output = np.zeros(len(gaps))
    for k in range(n):
        output = output + row[k] * at[:, k]
    return at, constants, np.stack([along, output], axis=1)
