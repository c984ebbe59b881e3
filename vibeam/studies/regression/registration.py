"""Registration of two curves: frequency shift and amplitude error told apart by orthogonal distance regression.

A frequency error moves a resonance curve along its axis: on a flank it looks like an amplitude error of any size. So
the error is not read off point by point. With the model's curve C = {(f, a)} and the reference points P_j = (f_j, a_j),

    minimise over s, e   Σ_j ρ( |D (P_j − foot_j)|² ),   foot_j = nearest point of {(f/(1+s), a/(1+e))} to P_j,

D = diag(1/Δf, 1/a_max), Δf the width of the reference points in frequency, a_max their largest value,
ρ(z) = 2(√(1+z) − 1) of z in units of 2 %, which bounds the pull of points that no curve meets (Boggs, Byrd & Schnabel,
SIAM J. Sci. Stat. Comput. 8 (1987), orthogonal distance regression; Huber's ρ, smoothed). Then ``s`` =
f_model/f_reference − 1 and ``e`` = a_model/a_reference − 1. A curve that is only shifted has e = 0 and the residual 0;
one only scaled has s = 0.
Held fixed: the shape of the curve, one s and one e for all points, the scales D. The curve is cut where the motion
jumps or changes its kind: no segment spans a jump, and beyond an end the end itself is nearest.

Intervals are from the linearised problem and the scatter of the residuals (HC3), Student's t at 95 %: they hold if what
remains is noise, not if the curve has another shape. Where the
correlation of s and e is beyond 0.98 the points do not tell them apart (one flank alone, say), and it is said so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from vibeam_models.arrays import Array

Piece = tuple[Array, Array]  # frequency in Hz, value: neighbouring points of one kind of motion
LEAST = 5  # points below which nothing is told apart
ROBUST = 0.02  # scaled distance from which on points count less than by its square
TOGETHER = 0.98  # correlation from which on shift and amplitude error are not told apart
MOST = 2_000_000  # pairs of points and segments: of more points every second, third … is taken
SHIFTS = np.concatenate([-np.geomspace(0.2, 0.002, 12), [0.0], np.geomspace(0.002, 0.2, 12)])  # starts


@dataclass(frozen=True)
class CurveRegistration:
    """Error of the model's curve: relative ``shift`` in frequency, relative ``amplitude`` error, each ± 95 %.

    ``shift_hz``: the shift at the median frequency of the points. ``before`` and ``residual``: rms orthogonal distance
    relative to the largest value, as it is and after shift and amplitude error are taken out. ``separable``: whether
    the points tell the two apart.
    """

    shift: float
    shift_interval: float
    shift_hz: float
    amplitude: float
    amplitude_interval: float
    before: float
    residual: float
    separable: bool

    @property
    def sentence(self) -> str:
        """Errors of the model in words."""
        if not self.separable:
            return (
                f"distance of the curves {_percent(self.before)} of the largest value; the points do not tell a shift "
                f"in frequency from an error in amplitude: measure both sides of the peak"
            )
        side = "low" if self.shift < 0 else "high"
        shift = f"{abs(self.shift_hz):.3g} Hz ({_with(self.shift, self.shift_interval)}) too {side} in frequency"
        error = f"{_with(self.amplitude, self.amplitude_interval)} too {'low' if self.amplitude < 0 else 'high'}"
        left = f"{_percent(self.residual)} of the largest value remain, {_percent(self.before)} before"
        return f"the model's curve is {shift} and {error} in value; {left} (one shift, one factor for all points)"


def register(pieces: Sequence[Piece], frequency: Array, value: Array) -> CurveRegistration | None:
    """Register a model's curve, in ``pieces``, with reference points (n,); None with fewer than five, or no curve."""
    segments = _segments(pieces)
    if len(frequency) < LEAST or not len(segments) or np.ptp(frequency) == 0 or not np.max(np.abs(value)) > 0:
        return None
    from scipy.optimize import least_squares
    from scipy.stats import t

    scale = np.array([np.ptp(frequency), np.max(np.abs(value))])
    every = ceil(len(frequency) * len(segments) / MOST)
    frequency, value = frequency[::every], value[::every]
    points = np.column_stack([frequency, value]) / scale

    def vectors(errors: Array) -> Array:
        return _to_curve(points, segments / np.array([1 + errors[0], 1 + errors[1]]) / scale)

    def weighted(errors: Array) -> Array:
        found = vectors(errors)
        z = np.sum(found**2, axis=1) / ROBUST**2
        share = np.sqrt(2 * (np.sqrt(1 + z) - 1) / np.where(z > 1e-12, z, 1.0))
        return np.asarray((found * np.where(z > 1e-12, share, 1.0)[:, None]).ravel())

    start = min((np.array([shift, 0.0]) for shift in SHIFTS), key=lambda errors: float(np.sum(weighted(errors) ** 2)))
    found = least_squares(
        weighted, start, bounds=([-0.5, -0.95], [1.0, 20.0]), x_scale=[0.01, 0.1], xtol=1e-12, ftol=1e-12
    )
    free = max(len(points) - 2, 1)
    separable, spread = _spread(found.jac.reshape(-1, 2, 2), found.fun.reshape(-1, 2))
    shift, amplitude = found.x
    width = float(t.ppf(0.975, free))
    return CurveRegistration(
        shift=float(shift),
        shift_interval=width * spread[0],
        shift_hz=float(shift * np.median(frequency)),
        amplitude=float(amplitude),
        amplitude_interval=width * spread[1],
        before=_rms(vectors(np.zeros(2))),
        residual=_rms(vectors(found.x)),
        separable=separable,
    )


def _spread(jacobian: Array, residual: Array) -> tuple[bool, tuple[float, float]]:
    """Test whether the two errors are told apart, and their standard deviations.

    ``jacobian`` (n, 2, 2) and ``residual`` (n, 2) of the points. The covariance is A⁻¹ Σ_j g_j g_jᵀ A⁻¹ with A = JᵀJ
    and g_j = J_jᵀ r_j / (1 − h_j), h_j the leverage (HC3 of MacKinnon & White, J. Econometrics 29 (1985)): points may
    scatter unequally, as they do where the noise is in proportion to the value.
    """
    curvature = np.einsum("nki,nkj->ij", jacobian, jacobian)
    one, other = curvature[0, 0], curvature[1, 1]
    if not (one > 0 and other > 0) or abs(curvature[0, 1]) > TOGETHER * np.sqrt(one * other):
        return False, (np.nan, np.nan)
    inverse = np.linalg.inv(curvature)
    leverage = np.einsum("nki,ij,nkj->n", jacobian, inverse, jacobian)
    score = np.einsum("nki,nk->ni", jacobian, residual) / np.maximum(1 - leverage, 0.1)[:, None]
    spread = np.sqrt(np.diag(inverse @ (score.T @ score) @ inverse))
    return True, (float(spread[0]), float(spread[1]))


def _segments(pieces: Sequence[Piece]) -> Array:
    """Segments (m, 2, 2): start and end of each in frequency and value; a point alone is one of no length."""
    found = []
    for frequency, value in pieces:
        points = np.column_stack([frequency, value])
        points = points[np.isfinite(points).all(axis=1)]
        if len(points):
            found.append(
                np.stack([points[:-1], points[1:]], axis=1) if len(points) > 1 else points[None].repeat(2, axis=1)
            )
    return np.concatenate(found) if found else np.empty((0, 2, 2))


def _to_curve(points: Array, segments: Array) -> Array:
    """Vectors (n, 2) from the nearest point of the segments to each point."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    length = np.maximum(np.sum(along**2, axis=1), 1e-300)
    away = points[:, None] - start  # (n, m, 2)
    share = np.clip(np.einsum("nmk,mk->nm", away, along) / length, 0.0, 1.0)
    vectors = away - share[..., None] * along
    nearest = np.argmin(np.sum(vectors**2, axis=2), axis=1)
    return np.asarray(vectors[np.arange(len(points)), nearest])


def _rms(vectors: Array) -> float:
    return float(np.sqrt(np.mean(np.sum(vectors**2, axis=1))))


def _percent(number: float) -> str:
    return f"{100 * number:.2g} %"


def _with(number: float, interval: float) -> str:
    return f"{100 * abs(number):.2g} % ± {100 * interval:.2g} %"
