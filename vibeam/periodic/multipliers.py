"""Stability: Floquet multipliers through the saltation matrix of the impact.

A disturbance (δη, δη') is carried over the span by the modes' propagator P and through the impact by

    δη⁺  = δη⁻ − s c (c·δη⁻),                                s = (1 + R)/S
    δη'⁺ = δη'⁻ − s c (c·δη'⁻) + s (2σ + a/v) c (c·δη⁻)

with a, v the contact's acceleration and velocity before (Aizerman & Gantmakher's saltation matrix 1 + U Vᵀ of this
impact). The monodromy matrix M = (1 + U Vᵀ) P has 2n multipliers and no trivial one: the drive's phase is no state, and
the map from impact to impact, in time and velocities, is M seen in other coordinates.

Since U Vᵀ has rank two, det(λ − M) = det(λ − P) D(λ) with a 2×2 determinant of sums over the modes

    D(λ) = (1 − k11)(1 + s t22) + s t12 k21 − (a/v) s t12,    T = P(λ − P)⁻¹, k as in ``sums.Transfer`` times s,

so that D(1) < 0 or D(−1) < 0 proves a real multiplier beyond 1 or −1 at a cost linear in n.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.periodic.pair import Pair, pair
from vibeam.periodic.sums import Transfer
from vibeam.system import ImpactSystem

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
CHUNK = 2048  # matrices built at a time


def real_crossing(system: ImpactSystem, transfer: Transfer, lean: Array) -> Array:
    """D(λ) at λ = 1 or −1, as ``transfer`` is; ``lean`` (points,) is a/v."""
    s = (1 + system.restitution) / float(system.contact @ system.contact)
    with np.errstate(invalid="ignore", over="ignore"):
        still = (1 - s * transfer.k11) * (1 + s * transfer.t22) + s * s * transfer.t12 * transfer.k21
        return np.asarray(still - lean * s * transfer.t12)


def monodromy(system: ImpactSystem, span: Array, lean: Array) -> Array:
    """M (points, 2n, 2n) on (η, η') just after the impact, for flights of ``span`` s (points,) that end with a/v."""
    flown = propagators(system, span)
    n, c, sigma = system.size, system.contact, system.zeta * system.omega
    s = (1 + system.restitution) / float(c @ c)
    rows = [np.concatenate([c * flown.p00, c * flown.p01], axis=1), np.concatenate([c * flown.p10, c * flown.p11], 1)]
    turned = s * (2 * sigma + lean[:, None]) * c
    matrix = np.empty((len(span), 2 * n, 2 * n))
    matrix[:, :n] = (-s * c)[None, :, None] * rows[0][:, None, :]
    matrix[:, n:] = turned[:, :, None] * rows[0][:, None, :] - (s * c)[None, :, None] * rows[1][:, None, :]
    k = np.arange(n)
    matrix[:, k, k] += flown.p00
    matrix[:, k, n + k] += flown.p01
    matrix[:, n + k, k] += flown.p10
    matrix[:, n + k, n + k] += flown.p11
    return matrix


def propagators(system: ImpactSystem, span: Array) -> Pair:
    """The modes' propagators, every field (points, n)."""
    each = [pair(own, zeta, span) for own, zeta in zip(system.omega, system.zeta, strict=True)]
    return Pair(*(np.stack(values, axis=1) for values in zip(*each, strict=True)))


def multipliers(system: ImpactSystem, span: Array, lean: Array) -> Complex:
    """The 2n Floquet multipliers (points, 2n), largest first; the modes' rows are scaled to one unit before."""
    scale = np.where(system.omega > 0, system.omega, 1.0)
    units = np.concatenate([scale, np.ones(system.size)])
    found = np.empty((len(span), 2 * system.size), dtype=complex)
    for first in range(0, len(span), CHUNK):
        here = slice(first, first + CHUNK)
        matrix = monodromy(system, span[here], lean[here]) * units[:, None] / units
        found[here] = np.linalg.eigvals(matrix)
    return np.take_along_axis(found, np.argsort(-np.abs(found), axis=1), axis=1)
