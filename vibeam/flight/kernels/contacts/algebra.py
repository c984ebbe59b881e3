"""Small linear algebra on some of the contacts: reactions along rows, in the metric of the mass or of 1/ω²."""

from __future__ import annotations

from math import sqrt

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam_models.arrays import Array, Index

NOISE = 16 * 2.220446049250313e-16  # share of the parts of a sum below which it is their round-off
DEPENDENT = 1e-14  # pivot, as a share of the diagonal, of a row that is a sum of those before it
WITHIN = 1e-10  # the same of its length
EPSILON = 2.220446049250313e-16


@kernel
def factor(gram: Array, picks: Index, count: int, lower: Array) -> None:
    """Cholesky factor of gram[picks, picks]; the pivot of a row that depends on those before it is 0."""
    for i in range(count):
        for j in range(i + 1):
            total = gram[picks[i], picks[j]]
            for at in range(j):
                total -= lower[i, at] * lower[j, at]
            if i > j:
                lower[i, j] = total / lower[j, j] if lower[j, j] > 0.0 else 0.0
            else:
                lower[i, i] = sqrt(total) if total > DEPENDENT * gram[picks[i], picks[i]] else 0.0


@kernel
def solve(lower: Array, count: int, values: Array) -> None:
    """Solve in place by the factor; rows that depend on others get 0."""
    for i in range(count):
        for j in range(i):
            values[i] -= lower[i, j] * values[j]
        values[i] = values[i] / lower[i, i] if lower[i, i] > 0.0 else 0.0
    for i in range(count - 1, -1, -1):
        for j in range(i + 1, count):
            values[i] -= lower[j, i] * values[j]
        values[i] = values[i] / lower[i, i] if lower[i, i] > 0.0 else 0.0


@kernel
def along(rows: Array, j: int, vector: Array) -> float:
    """row_j · vector."""
    total = 0.0
    for i in range(vector.shape[0]):
        total += rows[j, i] * vector[i]
    return total


@kernel
def size_along(rows: Array, j: int, vector: Array) -> float:
    """|row_j| · |vector|."""
    total = 0.0
    for i in range(vector.shape[0]):
        total += abs(rows[j, i]) * abs(vector[i])
    return total


@kernel
def without_rows(engine: ContactEngine, picks: Index, count: int, source: Array, target: Array) -> None:
    """``target``: the vector without its parts along the rows, whose Gram matrix is in ``engine.lower``."""
    found = engine.small[row.MULTIPLIER]
    for i in range(count):
        found[i] = along(engine.rows, picks[i], source)
    solve(engine.lower, count, found)
    for at in range(source.shape[0]):
        total = 0.0
        for i in range(count):
            total += found[i] * engine.rows[picks[i], at]
        target[at] = source[at] - total


@kernel
def invert(engine: ContactEngine, count: int) -> None:
    """``engine.inverse``: of the Gram matrix whose factor is in ``engine.lower``."""
    for j in range(count):
        values = engine.small[row.MULTIPLIER]
        for i in range(count):
            values[i] = 1.0 if i == j else 0.0
        solve(engine.lower, count, values)
        for i in range(count):
            engine.inverse[i, j] = values[i]


@kernel
def multiplier(engine: ContactEngine, picks: Index, count: int, place: int, vector: Array) -> float:
    """The ``place``-th reaction along the rows that takes their parts out of the vector; needs ``invert``."""
    total = 0.0
    for i in range(count):
        total += engine.inverse[place, i] * along(engine.rows, picks[i], vector)
    return total


@kernel
def multiplier_size(engine: ContactEngine, picks: Index, count: int, place: int, sizes: Array) -> float:
    """The sizes of its parts, added up mode by mode."""
    total = 0.0
    for at in range(sizes.shape[0]):
        each = 0.0
        for i in range(count):
            each += engine.inverse[place, i] * engine.rows[picks[i], at]
        total += abs(each) * sizes[at]
    return total


@kernel
def is_within(engine: ContactEngine, picks: Index, count: int, j: int) -> bool:
    """True where row j is a sum of the rows, to round-off; needs ``engine.lower``. ``vectors[DIRECTION]`` is used."""
    if count == 0:
        return False
    left, whole = 0.0, engine.gram[j, j]
    without_rows(engine, picks, count, engine.rows[j], engine.vectors[row.DIRECTION])
    for at in range(engine.rows.shape[1]):
        left += engine.vectors[row.DIRECTION, at] ** 2
    return bool(left <= WITHIN * WITHIN * whole)


@kernel
def one_sided(engine: ContactEngine, picks: Index, count: int, vector: Array, sign: float) -> None:
    """small[TRIAL]: μ ≥ 0 that minimises |sign · vector − Σ μ_i row_i|: Lawson & Hanson 1974, ch. 23.

    The rows count by their directions, so that their units do not matter.
    """
    small, gram, chosen = engine.small, engine.gram, engine.picks[row.CHOSEN]
    found, gradient, scale = small[row.TRIAL], small[row.GRADIENT], small[row.SCALE]
    size = 0.0
    for at in range(vector.shape[0]):
        size += vector[at] * vector[at]
    tolerance = 10 * max(count, vector.shape[0]) * EPSILON * column_size(engine, picks, count) * sqrt(size)
    for i in range(count):
        scale[i] = sqrt(gram[picks[i], picks[i]])
        gradient[i] = sign * along(engine.rows, picks[i], vector) / scale[i]
        found[i] = 0.0
    for i in range(small.shape[1]):
        chosen[i] = 0
    if count == 1:
        found[0] = max(sign * along(engine.rows, picks[0], vector), 0.0) / gram[picks[0], picks[0]]
        return
    for _ in range(3 * count + 3):
        best = row.NONE
        for i in range(count):
            if chosen[i] == 0 and gradient[i] > tolerance and (best < 0 or gradient[i] > gradient[best]):
                best = i
        if best < 0:
            break
        chosen[best] = 1
        inner(engine, picks, count, vector, sign)
        for i in range(count):
            gradient[i] = sign * along(engine.rows, picks[i], vector)
            for j in range(count):
                gradient[i] -= gram[picks[i], picks[j]] * found[j] / scale[j]
            gradient[i] /= scale[i]
    for i in range(count):
        found[i] /= scale[i]


@kernel
def column_size(engine: ContactEngine, picks: Index, count: int) -> float:
    """The largest sum of |entries| of a row, as a share of its length."""
    most = 0.0
    for i in range(count):
        total = 0.0
        for at in range(engine.rows.shape[1]):
            total += abs(engine.rows[picks[i], at])
        most = max(most, total / sqrt(engine.gram[picks[i], picks[i]]))
    return most


@kernel
def inner(engine: ContactEngine, picks: Index, count: int, vector: Array, sign: float) -> None:
    """small[TRIAL] to the least squares of the rows chosen, leaving out those that would pull."""
    small, chosen, some = engine.small, engine.picks[row.CHOSEN], engine.picks[row.LIST]
    found, trial, scale = small[row.TRIAL], small[row.MULTIPLIER], small[row.SCALE]
    for _ in range(count + 1):
        number = 0
        for i in range(count):
            if chosen[i] > 0:
                some[number] = picks[i]
                trial[number] = sign * along(engine.rows, picks[i], vector)
                number += 1
        factor(engine.gram, some, number, engine.lower)
        solve(engine.lower, number, trial)
        step, at = 2.0, 0
        for i in range(count):
            if chosen[i] > 0:
                trial[at] *= scale[i]
                if trial[at] <= 0.0:
                    step = min(step, share(found[i], trial[at]))
                at += 1
        at = 0
        for i in range(count):
            if chosen[i] > 0:
                out = trial[at] <= 0.0 and share(found[i], trial[at]) <= step
                found[i] = 0.0 if out else trial[at] if step > 1.0 else found[i] + step * (trial[at] - found[i])
                chosen[i] = 0 if out else 1
                at += 1
        if step > 1.0:
            return


@kernel
def share(value: float, beyond: float) -> float:
    """Share of the way from ``value`` ≥ 0 to ``beyond`` ≤ 0 on which it is not negative."""
    return value / (value - beyond) if value > beyond else 0.0
