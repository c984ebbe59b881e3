"""Damping said by modal ratios, as a matrix."""

from __future__ import annotations

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Damping
from vibeam_models.structure import Structure

COUNTS = {"constant": 1, "stiffness": 1, "rayleigh": 2}


def damped(structure: Structure, damping: Damping) -> Structure:
    """The structure with C = MΦ diag(2ζ_iω_i) ΦᵀM, diagonal in its modes Φ whatever the kind.

    To be applied last: the ratios are those of the whole structure's modes. ValueError as ``modal_ratios``.
    """
    modes = structure.modes()
    momenta = structure.M @ modes.shapes
    return structure.with_(C=(momenta * (2 * modal_ratios(damping, modes.omega) * modes.omega)) @ momenta.T)


def modal_ratios(damping: Damping, omega: Array) -> Array:
    """Damping ratio (n,) of every mode, ``omega`` (n,) rad/s ascending: the elastic ones are counted, at 0 it is 0.

    ``"stiffness"`` is the paper's C = D K: ζ_i = ½Dω_i, D = 2ζ₁/ω₁; ``"rayleigh"`` C = αM + DK: ζ_i = ½(α/ω_i + Dω_i).
    ValueError for the wrong number of ratios, a negative ratio, given or implied, or an unknown kind.
    """
    given = np.array(damping.ratios, dtype=float)
    _check(damping, given)
    ratios, elastic = np.zeros(len(omega)), omega > 0
    ratios[elastic] = _ratios(damping.kind, given, omega[elastic])
    if np.any(ratios < 0):
        worst = int(np.argmin(ratios)) + 1
        raise ValueError(f"damping {damping.kind!r} of {damping.ratios} makes mode {worst} negative")
    return ratios


def _ratios(kind: str, given: Array, omega: Array) -> Array:
    n = len(omega)
    if kind == "stiffness":
        return np.asarray(given[0] * omega / omega[:1])
    if kind == "rayleigh" and n > 1:
        terms = 0.5 * np.column_stack([1 / omega, omega])
        return np.asarray(terms @ np.linalg.solve(terms[:2], given))
    return np.asarray(given[np.minimum(np.arange(n), len(given) - 1)] if kind == "list" else np.full(n, given[0]))


def _check(damping: Damping, given: Array) -> None:
    if damping.kind not in {*COUNTS, "list"}:
        raise ValueError(f"damping: unknown kind {damping.kind!r}, there are {', '.join([*COUNTS, 'list'])}")
    wanted = COUNTS.get(damping.kind, max(len(given), 1))
    if len(given) != wanted:
        raise ValueError(f"damping {damping.kind!r} takes {wanted} ratio(s), not {len(given)}")
    if not np.all(np.isfinite(given) & (given >= 0)):
        raise ValueError(f"damping: every ratio must be finite and ≥ 0, not {damping.ratios}")
