"""Estimates by least squares: values with 95 % intervals, directions that the data do not fix.

With the Jacobian J of the data (in standard deviations) by the logarithms of the parameters, J = U diag(s) Vᵀ: along
v_k the parameters are known to a factor exp(± t/s_k). A direction with a factor beyond 2 is not determined. It is taken
to reach a factor of 1000 at most; a parameter that is then not known to a factor of 2 has no value, and the direction's
invariant is said: where ln p₁ and ln p₂ may change as 1 to r, p₂/p₁^r is fixed.

Without known uncertainties the scatter is taken from the residuals: equal for all points, or, by HC3 (MacKinnon and
White, J. Econometrics 29 (1985)), unequal, as where it is in proportion to the value.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import inf, log, nan

import numpy as np

from vibeam.studies.measured_panel import MeasuredCurve
from vibeam_models.arrays import Array

UNKNOWN = log(2.0)  # half-width of an interval in the logarithm from which on a direction is not determined
FURTHEST = log(1000.0)  # how far a direction that is not determined may reach
SAME = 0.005  # difference of an exponent from 1 that is none
TAKES_PART = 0.05  # share of a direction's largest part from which on a parameter takes part in it


@dataclass(frozen=True)
class Estimate:
    """Estimated quantity: ``value`` in ``unit``, 95 % interval ``low`` … ``high``; NaN where not determined."""

    name: str
    value: float
    low: float
    high: float
    unit: str

    @property
    def determined(self) -> bool:
        """Test whether the data fix the quantity."""
        return bool(np.isfinite(self.value))


@dataclass(frozen=True)
class Identification:
    """Result of an identification: ``rows`` of estimates; ``residual``: rms over the largest value of the data.

    ``directions``: what the data do not fix. ``method``: what was fitted to what. ``notes``: what limits the numbers.
    Of a file ``of``: ``"decay"``, ``"spectrum"``, ``"receptance"`` …, and ``why`` it is taken as one. ``orders``:
    frequency and damping ratio of each mode of a fit with 1, 2, … modes. ``shapes``: a table [modes] of several
    responses. ``stretch``: the part of a record that was fitted, in s. ``curve``: what was read, used and fitted.
    """

    rows: tuple[Estimate, ...]
    method: str
    points: int
    residual: float
    directions: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    of: str = ""
    why: str = ""
    orders: tuple[tuple[tuple[float, float], ...], ...] = ()
    shapes: str = ""
    stretch: tuple[float, float] | None = None
    curve: MeasuredCurve | None = field(default=None, compare=False, repr=False)

    @property
    def leading(self) -> tuple[Estimate, ...]:
        """Estimates for a sentence: of more than four the natural frequencies alone."""
        many = len(self.rows) > 4 and any(row.name.startswith("natural") for row in self.rows)
        return tuple(row for row in self.rows if not many or row.name.startswith("natural"))

    def __getitem__(self, name: str) -> Estimate:
        for row in self.rows:
            if row.name == name:
                return row
        raise KeyError(f"no estimate {name!r}: there are {', '.join(row.name for row in self.rows)}")


@dataclass(frozen=True)
class Spread:
    """Half-widths of 95 % intervals of the logarithms, ∞ where not determined, and the open directions in words."""

    half: Array
    directions: tuple[str, ...]


def spread_of(
    jacobian: Array, residual: Array | None, names: Sequence[str], *, equal: bool = False, parts: int = 1
) -> Spread:
    """Spread of the parameters ``names``, the first columns of ``jacobian`` (n, p), which is by their logarithms.

    Further columns are of parameters that are not asked for. ``residual`` None: rows are in known standard deviations.
    Otherwise (n,): the scatter is taken from it, the same at all points where ``equal``, else the larger of that and
    of one that differs. ``parts``: rows n/parts apart are of one point, such as a real and an imaginary part.
    """
    from scipy.stats import norm, t

    (count, size), named = jacobian.shape, len(names)
    free = max(count - size, 1)
    width, scaled = float(norm.ppf(0.975)), jacobian
    if residual is not None:
        width = float(t.ppf(0.975, free))
        scaled = jacobian / max(float(np.sqrt(np.sum(residual**2) / free)), 1e-300)
    singular, rows = directions_of(_without_others(scaled, named))
    unfixed = singular * UNKNOWN < width
    variance = np.sum((rows[~unfixed] / singular[~unfixed, None]) ** 2, axis=0)
    if residual is not None and not equal:
        variance = np.maximum(variance, np.diag(_hc3(jacobian, residual, parts))[:named])
    reach = np.minimum(width / np.maximum(singular[unfixed], 1e-300), FURTHEST)
    half = np.sqrt(width**2 * np.maximum(variance, 0.0) + np.sum((reach[:, None] * rows[unfixed]) ** 2, axis=0))
    half = np.where(half < UNKNOWN, half, inf)
    return Spread(half, tuple(in_words(row, names) for row in _simple(rows[unfixed])))


def directions_of(jacobian: Array) -> tuple[Array, Array]:
    """Singular values (p,), 0 where there are fewer rows, and right singular vectors (p, p) of ``jacobian`` (n, p).

    Those of the factor R of QR, so that memory grows by n p, not by the n² of all left singular vectors.
    """
    _, singular, rows = np.linalg.svd(np.linalg.qr(jacobian, mode="r"))
    return np.append(singular, np.zeros(len(rows) - len(singular))), rows


def _simple(directions: Array) -> Array:
    """Directions of the same span that each have few parts: reduced row echelon form."""
    left, row = directions.copy(), 0
    for column in range(left.shape[1]):
        if row == len(left):
            break
        pivot = row + int(np.argmax(np.abs(left[row:, column])))
        if abs(left[pivot, column]) < TAKES_PART:
            continue
        left[[row, pivot]] = left[[pivot, row]]
        left[row] /= left[row, column]
        others = np.arange(len(left)) != row
        left[others] -= np.outer(left[others, column], left[row])
        row += 1
    return left


def _without_others(jacobian: Array, named: int) -> Array:
    """Columns of the named parameters, less what the others can take over."""
    others = jacobian[:, named:]
    if not others.shape[1]:
        return jacobian
    basis = np.linalg.qr(others)[0]
    wanted = jacobian[:, :named]
    return np.asarray(wanted - basis @ (basis.T @ wanted))


def _hc3(jacobian: Array, residual: Array, parts: int) -> Array:
    """Covariance of parameters from the scatter of the residuals, which may differ from point to point."""
    inverse = np.linalg.pinv(jacobian.T @ jacobian)
    leverage = np.einsum("ni,ij,nj->n", jacobian, inverse, jacobian)
    score = jacobian * (residual / np.maximum(1 - leverage, 0.05))[:, None]
    score = np.sum(score.reshape(parts, -1, score.shape[1]), axis=0)
    return np.asarray(inverse @ (score.T @ score) @ inverse)


def in_words(direction: Array, names: Sequence[str]) -> str:
    """Meaning of a direction that is not fixed: parameters that may change together, and what of them is fixed."""
    part = np.flatnonzero(np.abs(direction) > TAKES_PART * np.max(np.abs(direction))).tolist()
    if len(part) == 1:
        return f"the data say nothing of {names[part[0]]}"
    change = direction[part] / direction[part[0]]
    if len(part) == 2:
        one, other, ratio = names[part[0]], names[part[1]], float(change[1])
        return f"{one} and {other} enter as {_product(one, other, ratio)} only: the data cannot separate them"
    parts = ", ".join(f"{names[at]} {each:+.3g} %" for at, each in zip(part, change, strict=True))
    return f"the data cannot separate {', '.join(names[at] for at in part)}: {parts} together leave them as they are"


def _product(one: str, other: str, ratio: float) -> str:
    """Combination in which two parameters enter, whose logarithms may change as 1 to ``ratio``."""
    if abs(abs(ratio) - 1) < SAME:
        return f"{other} / {one}" if ratio > 0 else f"{other} · {one}"
    if abs(ratio) < 1:
        one, other, ratio = other, one, 1 / ratio
    power = f"^{abs(ratio):.3g}"
    return f"{other} / {one}{power}" if ratio > 0 else f"{other} · {one}{power}"


def estimates(names: Sequence[str], values: Sequence[float], half: Array, units: Sequence[str]) -> tuple[Estimate, ...]:
    """Rows of parameters that keep their sign: value, and the interval in proportion; NaN where not determined."""
    rows = zip(names, values, half, units, strict=True)
    return tuple(
        Estimate(
            name,
            value,
            float(value * np.exp(-np.sign(value) * width)),
            float(value * np.exp(np.sign(value) * width)),
            unit,
        )
        if np.isfinite(width)
        else Estimate(name, nan, nan, nan, unit)
        for name, value, width, unit in rows
    )


def correlation(residual: Array) -> float:
    """Correlation of neighbours along the last axis; 0 where they are all the same."""
    one, other = (each - np.mean(each) for each in (residual[..., 1:], residual[..., :-1]))
    size = float(np.sqrt(np.sum(one**2) * np.sum(other**2)))
    return float(np.sum(one * other)) / size if size > 0 else 0.0


def by_logarithms(model: Callable[[Array], Array], values: Array, step: float = 1e-5) -> Array:
    """Jacobian (n, p) of a model by the logarithms of positive parameters, by central differences."""
    away = np.exp(step * np.eye(len(values)))
    return np.stack([(model(values * each) - model(values / each)) / (2 * step) for each in away], axis=1)
