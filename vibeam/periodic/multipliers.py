"""Stability of periodic motions: Floquet multipliers through the saltation matrix of the impact.

A disturbance (δη, δη') is carried over the span by the modes' propagator P and through the impact by

    δη⁺  = δη⁻ − s c (c·δη⁻),                                s = (1 + R)/S
    δη'⁺ = δη'⁻ − s c (c·δη'⁻) + s (2σ + a/v) c (c·δη⁻)

with a, v the contact's acceleration and velocity before (Aizerman & Gantmakher's saltation matrix 1 + U Vᵀ of this
impact). The monodromy matrix M = (1 + U Vᵀ) P has 2n multipliers and no trivial one: the drive's phase is no state, and
the map from impact to impact, in time and velocities, is M seen in other coordinates.

Since U Vᵀ has rank two, det(λ − M) = det(λ − P) D(λ) with a 2×2 determinant of sums over the modes

    D(λ) = (1 − k11)(1 + s t22) + s t12 k21 − (a/v) s t12,    T = P(λ − P)⁻¹, k as in ``modal_sums.Transfer`` times s,

so that D(1) < 0 or D(−1) < 0 proves a real multiplier beyond 1 or −1 at a cost linear in n.
"""

from __future__ import annotations

from functools import reduce

import numpy as np

from vibeam.flight.linear.propagator import propagators
from vibeam.periodic.modal_sums import Roots, Sums, Transfer
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Complex, Flags, Index

CHUNK = 2048  # matrices built at once
FEW = 200  # elements of all matrices, in fours, up to which eigenvalues cost less than powers
FADED = 1e-9  # share left of a mode after a span, below which the mode is dropped
SQUARED = 12  # squarings of a matrix, to its 4096th power
TOGETHER = 3  # squarings between two normalisations
CERTAIN = 1e8  # size of D(±1) up to which its sign is trusted


def real_crossing(system: ImpactSystem, transfer: Transfer, relative_acceleration: Array) -> Array:
    """D(λ) at λ = 1 or −1, as ``transfer`` is; ``relative_acceleration`` (points,) is a/v."""
    s = (1 + system.restitution) / system.mobility
    with np.errstate(invalid="ignore", over="ignore"):
        still = (1 - s * transfer.k11) * (1 + s * transfer.t22) + s * s * transfer.t12 * transfer.k21
        return np.asarray(still - relative_acceleration * s * transfer.t12)


def monodromy(system: ImpactSystem, span: Array, relative_acceleration: Array, modes: Index | None = None) -> Array:
    """Monodromy matrix (points, 2n, 2n) on (η, η') just after impact, for flights of ``span`` s that end with a/v.

    ``modes``: indices of the modes kept; the others are taken to have decayed by the impact.
    """
    kept = np.arange(system.size) if modes is None else modes
    natural, zeta, c = system.omega[kept], system.zeta[kept], system.contact[kept]
    flown = propagators(natural, zeta, span)
    n, sigma, s = len(kept), zeta * natural, (1 + system.restitution) / system.mobility
    rows = [np.concatenate([c * flown.p00, c * flown.p01], axis=1), np.concatenate([c * flown.p10, c * flown.p11], 1)]
    turned = s * (2 * sigma + relative_acceleration[:, None]) * c
    matrix = np.empty((len(span), 2 * n, 2 * n))
    matrix[:, :n] = (-s * c)[None, :, None] * rows[0][:, None, :]
    matrix[:, n:] = turned[:, :, None] * rows[0][:, None, :] - (s * c)[None, :, None] * rows[1][:, None, :]
    k = np.arange(n)
    matrix[:, k, k] += flown.p00
    matrix[:, k, n + k] += flown.p01
    matrix[:, n + k, k] += flown.p10
    matrix[:, n + k, n + k] += flown.p11
    return matrix


def multipliers(
    system: ImpactSystem, flights: Array, relative_acceleration: Array, modes: Index | None = None
) -> Complex:
    """Compute the 2n Floquet multipliers (points, 2n), largest first; modes are scaled to one unit first.

    Of motions with one impact a span, ``flights`` (points,) s, or with m, (points, m) in the order of time. Each ends
    at an impact with ``relative_acceleration``, of the shape of ``flights``; ``modes`` as in ``monodromy``.
    """
    kept = np.arange(system.size) if modes is None else modes
    scale = np.where(system.omega[kept] > 0, system.omega[kept], 1.0)
    units = np.concatenate([scale, np.ones(len(kept))])
    flown, ends = (np.atleast_2d(each.T).T for each in (flights, relative_acceleration))
    found = np.empty((len(flights), len(units)), dtype=complex)
    for first in range(0, len(flights), CHUNK):
        chunk = slice(first, first + CHUNK)
        maps = (
            monodromy(system, flown[chunk, k], ends[chunk, k], kept) * units[:, None] / units
            for k in range(flown.shape[1])
        )
        found[chunk] = np.linalg.eigvals(reduce(lambda whole, each: each @ whole, maps))
    return np.take_along_axis(found, np.argsort(-np.abs(found), axis=1), axis=1)


def largest(system: ImpactSystem, span: Array, relative_acceleration: Array) -> Array:
    """Upper bound (points,) on the largest multiplier: ‖Mᴺ‖^(1/N), the mean decay of a disturbance.

    By squaring M twelve times, at a tenth of the cost of all multipliers. Too large by κ^(1/N) at most, where κ is how
    far M is from a normal matrix: 1e3 makes 0.2 %. Modes that die out within a span are left out. Where matrices are
    few the multipliers themselves are cheaper.
    """
    if len(span) * system.size**2 < FEW:
        return np.asarray(np.abs(multipliers(system, span, relative_acceleration)[:, 0]))
    fast = system.omega * (system.zeta + np.sqrt(np.maximum(system.zeta**2 - 1, 0.0)))
    slow = np.where(system.zeta > 1, system.omega**2 / np.where(fast > 0, fast, 1.0), fast)
    lasting = np.flatnonzero(np.exp(-slow * span.min()) > FADED)
    chunks = [slice(first, first + CHUNK) for first in range(0, len(span), CHUNK)]
    return np.concatenate([_mean_decay(system, span[chunk], relative_acceleration[chunk], lasting) for chunk in chunks])


def _mean_decay(system: ImpactSystem, span: Array, relative_acceleration: Array, modes: Index) -> Array:
    scale = np.where(system.omega[modes] > 0, system.omega[modes], 1.0)
    units = np.concatenate([scale, np.ones(len(modes))])
    power, log = monodromy(system, span, relative_acceleration, modes) * (units[:, None] / units), np.zeros(len(span))
    with np.errstate(divide="ignore"):
        for _ in range(SQUARED // TOGETHER):
            size = np.sqrt(np.einsum("pij,pij->p", power, power))
            log, power = log + np.log(size), power / np.where(size > 0, size, 1.0)[:, None, None]
            for _ in range(TOGETHER):
                log, power = 2 * log, power @ power
        log += np.log(np.sqrt(np.einsum("pij,pij->p", power, power)))
    return np.asarray(np.exp(log / 2**SQUARED))


def stability(system: ImpactSystem, total: Sums, found: Roots, asked: Flags) -> Flags:
    """Stability of the motions marked by ``asked`` (points, 2); False for the others."""
    open_ = asked.copy()
    for side in (total.plus, total.minus):
        for k in (0, 1):
            open_[:, k] &= ~proven(real_crossing(system, side, found.relative_acceleration[:, k]))
    stable = np.zeros(open_.shape, dtype=bool)
    rows, _ = np.nonzero(open_)
    values = multipliers(system, total.span[rows], found.relative_acceleration[open_])
    stable[open_] = np.abs(values[:, 0]) < 1
    return stable


def proven(beyond: Array) -> Flags:
    """Test for D < 0 beyond doubt: near the double pole of an undamped mode its sign is round-off."""
    return (beyond < 0) & (beyond > -CERTAIN)
