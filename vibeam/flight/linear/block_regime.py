"""A linear regime, free, pushed by a linear stop or held on a stop, in 2×2 blocks: the arrays of the block flow.

Its pairs come with propagators and phasors tabulated over dyadic panel lengths. Panels are 2^top, 2^(top−1), … seconds
long: powers of two are hardly ever an integer fraction of a drive period (at 8 Hz they are), so roots of periodic
motions do not sit on panel ends, and one table serves every drive.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vibeam.flight.engine.entries import tabulate
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import APART, RESOLVED, Regime
from vibeam.flight.linear.blocks import pair_constants, planes
from vibeam.flight.linear.eigenpairs import LinearSystem
from vibeam_models.arrays import Array

SMALLEST = 1e-300  # rad/s: slower is as good as free
FURTHEST = 128  # binary orders by which the unit of time is moved at most


def regime(omega: Array, sigma: Array, disc: Array, top: int) -> tuple[Array, Array, Array]:
    """``pairs``, ``table`` (TABLE_ROWS, levels, n) and ``levels`` of pairs sorted by ``rates``; panels of 2^top s."""
    pairs = np.zeros((layout.PAIR_ROWS, len(omega)))
    over = sigma + np.sqrt(np.maximum(disc, 0.0))
    pairs[layout.OMEGA], pairs[layout.SIGMA], pairs[layout.DISC] = omega, sigma, disc
    pairs[layout.KAPPA] = rates(omega, sigma)
    pairs[layout.INVERSE] = _inverse(omega, over, disc)
    pairs[layout.DECAY] = np.where(disc < 0, sigma, omega**2 / np.where(over > 0, over, 1.0))
    slow = omega * (omega / np.where(over > 0, over, 1.0))
    apart = (disc > APART * sigma**2) & (slow > 0)
    pairs[layout.SLOW], pairs[layout.JOIN] = np.where(apart, slow, 0.0), apart
    pairs[layout.TILT] = np.where(apart, -over, 1.0)
    levels = np.zeros((layout.LEVEL_ROWS, layout.LEVELS))
    levels[layout.STEP] = np.ldexp(1.0, top - np.arange(layout.LEVELS))
    levels[layout.COUNT] = np.sum(pairs[layout.KAPPA][None, :] * levels[layout.STEP][:, None] <= RESOLVED, axis=1)
    table = np.zeros((layout.TABLE_ROWS, layout.LEVELS, len(omega)))
    tabulate(pairs, levels, table)
    return pairs, table, levels


def _inverse(omega: Array, over: Array, disc: Array) -> Array:
    """Factor of x' with which the norm of (x, x') bounds |x| for all later times.

    1/ω by the energy. With decays a ≤ b, P00 lies in [0, 1] and P01 in [0, 1/b], so |x| + |x'|/b bounds it too, which
    the octagon's norm does where x' counts 1 + √2 times; and |P01^(j)| ≤ (b^j − a^j)/(b − a) ≤ κ^j/b, so that the bound
    holds for derivatives as the energy's does. Far beyond critical damping it is smaller by 2ζ.
    """
    energy = np.where(omega > SMALLEST, 1.0 / np.where(omega > SMALLEST, omega, 1.0), 0.0)
    with np.errstate(over="ignore"):  # hardly any decay bounds nothing
        decay = np.where(disc > 0, (1 + np.sqrt(2)) / np.where(over > 0, over, 1.0), np.inf)
    return np.asarray(np.minimum(energy, decay))


def rates(omega: Array, sigma: Array) -> Array:
    """κ = σ + √(σ² + ω²): every time derivative grows at most by it, in the energy norm (ωx, x')."""
    with np.errstate(over="ignore"):  # an infinite rate is refused
        return np.asarray(sigma + np.sqrt(sigma**2 + omega**2))


@dataclass(frozen=True)
class SignalRow:
    """A signal: (at·(η − held) + rate·η') / over + constant + load Ω²B sin φ."""

    at: Array
    rate: Array
    constant: float = 0.0
    load: float = 0.0
    over: float = 1.0


def free_regime(linear: LinearSystem, static: Array, load: Array, top: int) -> Regime:
    """z'' + Dz' + Λz = static + load Ω²B sin φ, pushed by the stop of ``linear`` or not; longest panel 2^top s."""
    return _in_blocks(linear, np.zeros(len(static)), static, load, top)


def held_regime(linear: LinearSystem, static: Array, load: Array, gap: float, top: int) -> tuple[Regime, SignalRow]:
    """The same with contact·η = gap held, and the contact force F = contact·(f − Dη' − Λη)/S as a signal of it."""
    contact, mobility = linear.contact, float(linear.contact @ linear.contact)
    held = contact * (gap / mobility)  # the least displacement
    constant = static - linear.spring * held
    along, across = float(contact @ constant) / mobility, float(contact @ load) / mobility
    found = _in_blocks(linear, held, constant - contact * along, load - contact * across, top)
    braking = contact * np.diag(linear.damper) if linear.uncoupled else contact @ linear.damper
    return found, SignalRow(-contact * linear.spring, -braking, along, across, mobility)


def with_signals(found: Regime, rows: Sequence[SignalRow]) -> Regime:
    """The regime with these signals, in the order of ``layout``."""
    filled, columns = np.zeros((layout.SIGNALS, found.outof.shape[1] + 2)), np.asfortranarray(found.outof)
    for place, row in enumerate(rows):
        filled[place, :-2] = np.concatenate([row.at, row.rate]) @ columns / row.over
        filled[place, -2:] = row.constant, row.load
    return found._replace(signals=filled)


def set_output(found: Regime, row: Array) -> None:
    """Make row·η the regime's output."""
    constant = 0.0
    for weight, place in zip(row.tolist(), found.held.tolist(), strict=True):
        constant += weight * place
    found.signals[layout.OUTPUT_SIGNAL, :-2] = row @ found.outof[: len(row)]
    found.signals[layout.OUTPUT_SIGNAL, -2:] = constant, 0.0


def derivative_signal(blocks: Array, outof: Array, row: Array, order: int, base: float) -> Array:
    """row·η' (``order`` 1), or row·η'' + base·b̈ with b̈ = −Ω²B sin φ, as a signal: weights on y, constant, load.

    η'' follows from the regime's own y' = Ay + constant + load Ω²B sin φ, so that it has the force of a stop that
    holds or pushes.
    """
    weights = row @ outof[len(row) :]
    if order == 1:
        return np.append(weights, [0.0, 0.0])
    first, second = weights[0::2], weights[1::2]
    rate = np.empty(len(weights))
    rate[0::2] = first * blocks[layout.A11] + second * blocks[layout.A21]
    rate[1::2] = first * blocks[layout.A12] + second * blocks[layout.A22]
    constant = first @ blocks[layout.CONSTANT1] + second @ blocks[layout.CONSTANT2]
    return np.append(rate, [constant, first @ blocks[layout.LOAD1] + second @ blocks[layout.LOAD2] - base])


@dataclass(frozen=True)
class SortedPlanes:
    """y = ``into`` (η, η'), (η, η') = ``outof`` y with y' = A y in ``blocks`` (m, 2, 2), each with σ, ω and σ² − ω²."""

    into: Array
    outof: Array
    blocks: Array
    omega: Array
    sigma: Array
    disc: Array


def sorted_planes(linear: LinearSystem) -> SortedPlanes:
    """Blocks sorted by rate, made in a unit of time of the system's own.

    The unit is a power of two, so that other units of time change no digit.
    """
    unit, n = _own_unit(linear), len(linear.spring)
    own = replace(
        linear, spring=linear.spring / unit**2, damper=linear.damper / unit, stiffness=linear.stiffness / unit**2,
        damping=linear.damping / unit,
    )  # fmt: skip
    found, sizes = planes(own), np.concatenate([own.scale, np.full(n, 1.0 / unit)])
    omega, sigma, disc = pair_constants(found.blocks)
    order = np.argsort(rates(omega, sigma), kind="stable")
    pick = np.stack([2 * order, 2 * order + 1], axis=1).ravel()
    return SortedPlanes(
        found.inverse[pick] * sizes, found.columns[:, pick] / sizes[:, None], found.blocks[order] * unit,
        omega[order] * unit, sigma[order] * unit, disc[order] * unit**2,
    )  # fmt: skip


def _in_blocks(linear: LinearSystem, held: Array, constant: Array, load: Array, top: int) -> Regime:
    found, n = sorted_planes(linear), len(held)
    into, outof, m = found.into, found.outof, len(found.omega)
    blocks = np.zeros((layout.BLOCK_ROWS, m))
    blocks[layout.A11 : layout.A11 + 4] = found.blocks.reshape(m, 4).T
    blocks[[layout.CONSTANT1, layout.CONSTANT2]] = (into[:, n:] @ constant).reshape(m, 2).T
    blocks[[layout.LOAD1, layout.LOAD2]] = (into[:, n:] @ load).reshape(m, 2).T
    blocks[layout.MODE] = lone_modes(outof)
    pairs, table, levels = regime(found.omega, found.sigma, found.disc, top)
    return Regime(
        pairs, table, levels, np.zeros(layout.SIGNAL_ROWS), np.zeros((layout.ATTACHED_ROWS, m)), blocks,
        np.ascontiguousarray(into), np.ascontiguousarray(outof), held, np.zeros((layout.SIGNALS, 2 * m + 2)),
        np.zeros((2, 2 * m + 2, 2 + n)),
    )  # fmt: skip


def lone_modes(outof: Array) -> Array:
    """The mode whose displacement and velocity alone a block (2n, 2m) is, (m,); −1 where it moves several."""
    n, m = len(outof) // 2, outof.shape[1] // 2
    parts = outof.reshape(2, n, m, 2) != 0
    alone = (parts[0, :, :, 0].sum(axis=0) == 1) & (parts[0, :, :, 0] == parts[1, :, :, 1]).all(axis=0)
    alone &= ~(parts[0, :, :, 1] | parts[1, :, :, 0]).any(axis=0)
    return np.where(alone, parts[0, :, :, 0].argmax(axis=0), -1.0)


def _own_unit(linear: LinearSystem) -> float:
    """The power of two next above the fastest of the system's rates."""
    fastest = max(float(np.sqrt(np.max(linear.spring))), float(np.max(np.diag(linear.damper))) / 2)
    return float(np.ldexp(1.0, np.clip(np.frexp(fastest)[1], -FURTHEST, FURTHEST)))
