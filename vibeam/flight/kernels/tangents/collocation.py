"""Force of an integrated contact at the nodes of a panel, by collocation and Newton's method; its smoothness."""

from __future__ import annotations

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.tangents import layout as row
from vibeam.flight.kernels.tangents.layout import TangentPlan
from vibeam_models.arrays import Array

NEWTON, ROUND_OFF, STALLED = 12, 1e-14, 1e-12
UNSOLVED = 1e300


@kernel
def respond(plan: TangentPlan, i: int, j: int) -> None:
    """Responses of d and d' at node i to what pushes at node j: of the stop kept, of load and static force added up."""
    work, blocks, gains = plan.work, plan.free.blocks, plan.work.gains
    ahead, back, rest, m = work.powers[0, i], work.powers[2, j], work.powers[1, i], blocks.shape[1]
    other, by_push, by_push_rate = work.powers[3, j], 0.0, 0.0
    load, load_rate, static, static_rate = 0.0, 0.0, 0.0, 0.0
    for k in range(m):
        even = ahead[k] * back[k] + rest[k] * other[k] * blocks[row.DISC, k]
        odd = rest[k] * back[k] + ahead[k] * other[k]
        by_push += even * gains[row.C_PUSH, k] + odd * gains[row.S_PUSH, k]
        by_push_rate += even * gains[row.C_PUSH_RATE, k] + odd * gains[row.S_PUSH_RATE, k]
        load += even * gains[row.C_LOAD, k] + odd * gains[row.S_LOAD, k]
        load_rate += even * gains[row.C_LOAD_RATE, k] + odd * gains[row.S_LOAD_RATE, k]
        static += even * gains[row.C_STATIC, k] + odd * gains[row.S_STATIC, k]
        static_rate += even * gains[row.C_STATIC_RATE, k] + odd * gains[row.S_STATIC_RATE, k]
    share = plan.rule.inner[i, j] * work.vectors[row.WEIGHT, j]
    base = work.vectors[row.BASE, j]
    work.squares[0, i, j], work.squares[1, i, j] = share * by_push, share * by_push_rate
    work.vectors[row.DEEP, i] += share * (load * base + static)
    work.vectors[row.RATE, i] += share * (load_rate * base + static_rate)


@kernel
def press(plan: TangentPlan) -> float:
    """The force at the nodes by Newton's method; its last coefficients and its derivatives', as shares of the largest.

    ``work.squares[2]`` is then 1 + ∂F/∂d G + ∂F/∂d' G', factored by ``factor``. Infinite where it does not converge.
    """
    work, count = plan.work, plan.work.vectors.shape[1]
    vectors, matrix = work.vectors, work.squares[2]
    for i in range(count):
        vectors[row.FORCE, i] = 0.0
    for newton in range(NEWTON):
        largest, change = 0.0, 0.0
        for i in range(count):
            deep, rate = vectors[row.DEEP, i], vectors[row.RATE, i]
            for j in range(count):
                deep -= work.squares[0, i, j] * vectors[row.FORCE, j]
                rate -= work.squares[1, i, j] * vectors[row.FORCE, j]
            pressed, by_deep, by_rate = force_of(plan.law, deep, rate)
            vectors[row.CHANGE, i] = pressed - vectors[row.FORCE, i]
            vectors[row.BY_DEEP, i], vectors[row.BY_RATE, i] = by_deep, by_rate
            for j in range(count):
                matrix[i, j] = by_deep * work.squares[0, i, j] + by_rate * work.squares[1, i, j]
            matrix[i, i] += 1.0
            largest = max(largest, pressed)
            work.peaks[row.DEEPEST] = max(work.peaks[row.DEEPEST], deep if newton > 0 else 0.0)
        factor(matrix)
        substitute(matrix, vectors[row.CHANGE])
        for i in range(count):
            vectors[row.FORCE, i] += vectors[row.CHANGE, i]
            change = max(change, abs(vectors[row.CHANGE, i]))
        if change <= ROUND_OFF * max(largest, work.peaks[0]) or (2 * newton > NEWTON and change <= STALLED * largest):
            return tail_of(plan)
    return UNSOLVED


@kernel
def force_of(law: Array, deep: float, rate: float) -> tuple[float, float, float]:
    """F = k d^p (1 + a d') where it pushes, ∂F/∂d and ∂F/∂d'."""
    pushed = 1.0 + law[row.DAMPING] * rate
    if deep <= 0.0 or pushed <= 0.0:
        return 0.0, 0.0, 0.0
    lower = law[row.STIFFNESS] * deep ** (law[row.EXPONENT] - 1.0)
    return lower * deep * pushed, law[row.EXPONENT] * lower * pushed, law[row.DAMPING] * lower * deep


@kernel
def tail_of(plan: TangentPlan) -> float:
    """The last two coefficients of F, ∂F/∂d and ∂F/∂d' as shares of the largest of each so far."""
    work, worst = plan.work, 0.0
    for which in range(3):
        values, last, before = work.vectors[row.FORCE + which], 0.0, 0.0
        for i in range(len(values)):
            last += plan.rule.tails[1, i] * values[i]
            before += plan.rule.tails[0, i] * values[i]
            work.peaks[which] = max(work.peaks[which], abs(values[i]))
        if work.peaks[which] > 0.0:
            worst = max(worst, (abs(last) + abs(before)) / work.peaks[which])
    return worst


@kernel
def factor(matrix: Array) -> None:
    """L U = matrix in its place, without exchange of rows: it is 1 and responses over a panel, which are small."""
    count = matrix.shape[0]
    for k in range(count):
        for i in range(k + 1, count):
            matrix[i, k] /= matrix[k, k]
            share = matrix[i, k]
            for j in range(k + 1, count):
                matrix[i, j] -= share * matrix[k, j]


@kernel
def substitute(matrix: Array, right: Array) -> None:
    """Solution of L U x = right (N,), in its place."""
    count = matrix.shape[0]
    for i in range(count):
        for k in range(i):
            right[i] -= matrix[i, k] * right[k]
    for i in range(count - 1, -1, -1):
        for k in range(i + 1, count):
            right[i] -= matrix[i, k] * right[k]
        right[i] /= matrix[i, i]


@kernel
def substitute_columns(matrix: Array, right: Array, columns: int) -> None:
    """The same for the first columns of right (N, c)."""
    count = matrix.shape[0]
    for i in range(count):
        for k in range(i):
            for j in range(columns):
                right[i, j] -= matrix[i, k] * right[k, j]
    for i in range(count - 1, -1, -1):
        for k in range(i + 1, count):
            for j in range(columns):
                right[i, j] -= matrix[i, k] * right[k, j]
        for j in range(columns):
            right[i, j] /= matrix[i, i]
