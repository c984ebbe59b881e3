"""Modes of frequency responses: poles, residues and residual terms by least squares, and how many there are.

With s = iω, of an input and an output of which p time derivatives are measured (D. J. Ewins, Modal Testing, 2000, §4):

    H(s) = h₀ + s^p [ Σ_k r_k/(s² + 2ζ_k ω_k s + ω_k²) + l/s² + u ]

l and u stand for the modes below and above the band; of a spectrum r_k is r_k + q_k s. Fitted are complex
numbers or moduli, several responses with the same poles. The noise has two parts, one the same at all points, one in
proportion to |H|, whose ratio is that of the largest likelihood. One mode after the other is added, where it explains
most of what is left, as long as Schwarz' criterion (Ann. Statist. 6 (1978)) gets better; so are the residual terms.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from vibeam.studies.fit.linear_estimates import correlation
from vibeam_models.arrays import Array, Complex

MOST = 12  # modes
BETTER = 10.0  # by which the criterion falls for what is added
PLACES = 100  # evenly spread, and as many where most is left, at which a further mode is tried
DAMPED = (0.001, 0.004, 0.016, 0.06)  # ratios with which it is tried
RATIOS = (1e-7, 0.9)  # bounds of damping ratios
ALIKE = 0.5  # correlation of neighbouring residuals from which on they are no noise
FLOOR = 1e-9  # scatter of exact numbers, relative
EQUAL = np.geomspace(1e-4, 1e2, 25)  # scatter that is the same everywhere, over that in proportion where it is largest


@dataclass(frozen=True, eq=False)
class ModalResponses:
    """Measured responses: ``values`` (m, n), complex or moduli, at ``s`` = iω/ω₀; form ``power``, ``offset`` h₀.

    ``scatter`` (m, n): standard deviations, known; None: found with the fit. ``lower``: a lower residual may be.
    ``careful``: noise in proportion to the larger of model and values, where a model alone leads astray.
    """

    s: Any
    values: Any
    power: int = 0
    offset: float = 0.0
    scatter: Array | None = None
    lower: bool = True
    careful: bool = False

    @property
    def moduli(self) -> bool:
        """Test whether the phase is not known."""
        return not np.iscomplexobj(self.values)

    def parts(self, values: Any) -> Array:
        """Real numbers (parts, m, n) of values."""
        return np.stack([values.real, values.imag]) if np.iscomplexobj(values) else np.asarray(values[None], float)


@dataclass(frozen=True, eq=False)
class Fit:
    """A fit: ``poles`` (k, 2), logarithms of ω_k/ω₀ and ζ_k; ``weights`` (q, m) of the basis; residual ``terms``.

    ``terms``: powers of s besides ``power``, -2 of the lower, 0 of the upper one; ``twisted``: modes are complex.
    ``scatter`` (m, n) of each point, up to a factor where it was found.
    """

    data: ModalResponses
    poles: Array
    weights: Array
    scatter: Array
    terms: tuple[int, ...] = ()
    twisted: bool = False

    @property
    def model(self) -> Complex:
        """Responses (m, n) of the fit."""
        return np.asarray(self.data.offset + (self.basis @ self.weights).T)

    @property
    def basis(self) -> Complex:
        """Functions (n, q) that a response is a sum of: of each mode, of it times s where twisted, of the terms."""
        s, modes = self.data.s[:, None], self.data.s[:, None] ** self.data.power / self.below
        rest = [self.data.s[:, None] ** (self.data.power + each) for each in self.terms]
        return np.hstack([modes, *([s * modes] if self.twisted else []), *rest])

    @property
    def below(self) -> Complex:
        """Denominators (n, k)."""
        s, (omega, ratio) = self.data.s[:, None], np.exp(self.poles.T)
        return np.asarray(s**2 + 2 * ratio * omega * s + omega**2)

    def residual(self) -> Array:
        """Measured less fitted, over the scatter: (parts, m, n)."""
        shown = np.abs(self.model) if self.data.moduli else self.model
        return (self.data.parts(self.data.values) - self.data.parts(shown)) / self.scatter

    def jacobian(self) -> Array:
        """Derivatives of the fitted parts over the scatter, by poles and weights: (parts, m, n, parameters)."""
        k, basis, model = len(self.poles), self.basis, self.model
        (omega, ratio), s = np.exp(self.poles.T), self.data.s[:, None]
        by_ratio = -2 * ratio * omega * s / self.below
        slopes = np.stack([by_ratio - 2 * omega**2 / self.below, by_ratio], axis=2)
        count, size = self.weights.shape[1], self.weights.size
        made = np.zeros((count, len(self.data.s), 2 * k + size), dtype=complex)
        for row, each in enumerate(self.weights.T):
            modal = basis[:, :k] * each[:k] + (basis[:, k : 2 * k] * each[k : 2 * k] if self.twisted else 0)
            made[row, :, : 2 * k] = (modal[:, :, None] * slopes).reshape(len(basis), 2 * k)
            made[row, :, 2 * k + row :: count] = basis
        if self.data.moduli:
            made = (np.conj(model) / np.maximum(np.abs(model), 1e-300))[:, :, None] * made
            return np.asarray(made.real / self.scatter[:, :, None])[None]
        return self.data.parts(made) / self.scatter[:, :, None]

    @cached_property
    def misfit(self) -> float:
        """Minus twice the logarithm of the likelihood, less a constant."""
        left = self.residual()
        if self.data.scatter is not None:
            return float(np.sum(left**2))
        floor = float(np.mean((FLOOR * np.abs(self.data.values) / self.scatter) ** 2))
        spread = float(np.mean(left**2) + floor)
        return float(left.size * np.log(max(spread, 1e-300)) + 2 * len(left) * np.sum(np.log(self.scatter)))

    @property
    def criterion(self) -> float:
        """Schwarz' criterion, to be small, with a larger price where there are few points for the parameters."""
        size, count = self.data.parts(self.data.values).size, self.poles.size + self.weights.size
        return self.misfit + count * float(np.log(size)) * size / max(size - count - 2, 1)


def fitted(data: ModalResponses, most: int = MOST, terms: bool = True, twisted: bool = False) -> tuple[Fit, ...]:
    """As ``_path``; where it leaves what is no noise, the better one of it and of one that goes on carefully."""
    path = _path(data, most, terms, twisted)
    if data.moduli or abs(correlation(path[-1].residual())) < ALIKE:
        return path
    *begun, last = _path(replace(data, careful=True), most, terms, twisted)
    other = (*begun, _with_scatter(_least_squares(_with_scatter(replace(last, data=data)))))
    return min(path, other, key=lambda each: each[-1].criterion)


def _path(data: ModalResponses, most: int, terms: bool, twisted: bool) -> tuple[Fit, ...]:
    """Fits with 1, 2, … modes, complex ones where ``twisted``; the best one is last."""
    begun = data.scatter if data.scatter is not None else np.full(data.values.shape, np.max(np.abs(data.values)))
    none = Fit(data, np.empty((0, 2)), np.zeros((0, len(data.values))), begun, twisted=twisted)
    beside = replace(none, terms=data.lower * (-2,) + (0,), weights=np.zeros((1 + data.lower, len(data.values))))
    starts = [none] if data.moduli or not terms else [none, replace(beside, weights=_linear(beside))]
    path = [_best((each for start in starts for each in _with_mode(start)), none)]
    for _ in range(4 * most):
        best = path[-1]
        ways = [_best(_with_terms(best), best)] if terms else [best]
        if not _better(ways[0], best) and len(best.poles) < most:
            ways.append(_best((each for each in _with_mode(best) if _plain(each)), best))
        if not _better(ways[-1], best):
            break
        path = [*path[: len(ways[-1].poles) - 1], ways[-1]]
    return tuple(path)


def _best(fits: Iterable[Fit], other: Fit) -> Fit:
    return min(fits, key=lambda each: each.criterion, default=other)


def _better(one: Fit, other: Fit) -> bool:
    return other.criterion - one.criterion > BETTER


def _plain(fit: Fit) -> bool:
    """Test whether all modes lie in the band, and none is noise that is flat or a line of its own."""
    (omega, ratio), band = np.exp(fit.poles.T), np.abs(fit.data.s)
    apart = np.diff(np.sort(fit.poles[:, 0]))
    inside = (omega > band.min() * 0.98) & (omega < band.max() * 1.02) & (ratio < 0.3)
    lines = ratio * omega > 0.1 * np.median(np.diff(band)) * np.ones_like(omega)
    return bool(inside.all() and lines.all() and (apart > 1e-7).all())


def _with_terms(fit: Fit) -> Iterator[Fit]:
    """Fits with other residual terms, begun at the poles and weights of this one."""
    k, count = (fit.twisted + 1) * len(fit.poles), fit.weights.shape[1]
    kept = dict(zip(fit.terms, fit.weights[k:], strict=True))
    for terms in ((-2, 0), (-2,), (0,), ()):
        if terms != fit.terms and (fit.data.lower or -2 not in terms):
            rest = [kept.get(each, np.zeros(count))[None] for each in terms]
            yield _solved(replace(fit, terms=terms, weights=np.vstack([fit.weights[:k], *rest])))


def _with_mode(fit: Fit) -> Iterator[Fit]:
    """Fits with one more mode, begun where it explains most of what is left."""
    k, count = len(fit.poles), fit.weights.shape[1]
    rows = fit.twisted + 1
    for pole, weight in _places(fit):
        for sign in (1.0, -1.0) if fit.data.moduli and (k or fit.data.offset) else (1.0,):
            modes = np.insert(fit.weights[:k], k, sign * weight, axis=0)
            twists = [np.vstack([fit.weights[k : 2 * k], np.full((1, count), 0.5 * weight)])] if rows > 1 else []
            rest = fit.weights[rows * k :]
            yield _solved(replace(fit, poles=np.vstack([fit.poles, pole]), weights=np.vstack([modes, *twists, rest])))


def _places(fit: Fit) -> list[tuple[Array, Array]]:
    """Poles, and weights (m,), with which one more mode takes most of the squares that are left: the best two."""
    data, size = fit.data, np.abs(fit.data.s)
    left = np.sum(fit.residual() ** 2, axis=(0, 1))
    spread = np.linspace(0, len(size) - 1, PLACES).astype(int)
    places = np.unique(np.r_[spread, np.argsort(left)[-PLACES:]])
    places = places[size[places] > 0]
    found = []
    for ratio in DAMPED:
        for place in places:
            pole = np.array([np.log(size[place]), np.log(ratio)])
            one = replace(fit, poles=pole[None], terms=(), twisted=False).basis[:, 0]
            gain, weight = (_of_moduli if data.moduli else _of_parts)(fit, one)
            found.append((gain, pole, weight))
    found.sort(key=lambda each: -each[0])
    best = found[0]
    other = next((each for each in found if abs(each[1][0] - best[1][0]) > 0.02), None)
    return [each[1:] for each in (best, other) if each is not None]


def _of_parts(fit: Fit, one: Complex) -> tuple[float, Array]:
    """Squares that ``one`` (n,) more explains of complex responses, and its real weights (m,)."""
    left = (fit.data.values - fit.model) / fit.scatter
    shape = one / fit.scatter
    product, own = np.sum(np.conj(shape) * left, axis=1), np.sum(np.abs(shape) ** 2, axis=1)
    return float(np.sum(np.abs(product) ** 2 / own)), np.real(product) / own


def _of_moduli(fit: Fit, one: Complex) -> tuple[float, Array]:
    """As ``_of_parts`` of moduli: |h + c b|² = |h|² + 2c Re(h* b) + c² |b|², with c and c² on their own."""
    model = fit.model
    weight = 1 / (fit.scatter * np.maximum(np.maximum(np.abs(model), fit.data.values), 1e-12))
    left, square = weight * (fit.data.values**2 - np.abs(model) ** 2), weight * np.abs(one) ** 2
    cross = weight * 2 * np.real(np.conj(model) * one)
    gain, sizes = 0.0, []
    for row in range(len(left)):
        basis = np.stack([square[row], cross[row]], axis=1)
        found = np.linalg.lstsq(basis[:, : 1 + bool(cross[row].any())], left[row], rcond=None)[0]
        gain += float(np.sum(left[row] ** 2) - np.sum((left[row] - basis[:, : len(found)] @ found) ** 2))
        sizes.append(np.sqrt(max(found[0], 0.0)) or abs(found[-1]))
    return gain, np.array(sizes)


def _solved(fit: Fit) -> Fit:
    """Least squares from where a fit begins, with the scatter of the largest likelihood in turn."""
    for _ in range(1 if fit.data.scatter is not None else 3):
        fit = _with_scatter(_least_squares(fit))
    return fit


def _with_scatter(fit: Fit) -> Fit:
    """The same fit with the ratio of the two parts of the noise that is most likely."""
    if fit.data.scatter is not None:
        return fit
    model = np.maximum(np.abs(fit.model), np.abs(fit.data.values) if fit.data.careful else 0.0)
    top = np.max(model, axis=1, keepdims=True)
    return min(
        (replace(fit, scatter=np.maximum(np.hypot(each * top, model) / (1 + each), 1e-12)) for each in EQUAL),
        key=lambda each: each.misfit,
    )


def _least_squares(fit: Fit) -> Fit:
    from scipy.optimize import least_squares

    k, data = len(fit.poles), fit.data
    band = np.abs(data.s)
    if not data.moduli:
        fit = replace(fit, weights=_linear(fit))
    low, high = np.log(band.min() / 10), np.log(10 * band.max())
    bounds = np.tile([[low, np.log(RATIOS[0])], [high, np.log(RATIOS[1])]], k)
    free = np.full(fit.weights.size, np.inf)

    def at(p: Array) -> Fit:
        return replace(fit, poles=p[: 2 * k].reshape(k, 2), weights=p[2 * k :].reshape(fit.weights.shape))

    found = least_squares(
        lambda p: -at(p).residual().ravel(), np.r_[fit.poles.ravel(), fit.weights.ravel()],
        jac=lambda p: at(p).jacobian().reshape(-1, 2 * k + fit.weights.size),
        bounds=(np.r_[bounds[0], -free], np.r_[bounds[1], free]), x_scale="jac", max_nfev=80,
        xtol=1e-14, ftol=1e-14, gtol=1e-14,
    )  # fmt: skip
    return at(found.x)


def _linear(fit: Fit) -> Array:
    """The best weights (q, m) of complex responses with these poles."""
    basis, rows = fit.basis, []
    for values, scatter in zip(fit.data.values - fit.data.offset, fit.scatter, strict=True):
        shape, wanted = basis / scatter[:, None], values / scatter
        both = np.vstack([shape.real, shape.imag])
        rows.append(np.linalg.lstsq(both, np.r_[wanted.real, wanted.imag], rcond=None)[0])
    return np.stack(rows, axis=1)
