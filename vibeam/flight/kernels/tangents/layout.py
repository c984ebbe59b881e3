"""Layout of the arrays that tangent maps are made of."""

from __future__ import annotations

from typing import NamedTuple

from vibeam_models.arrays import Array

# blocks (BLOCK_ROWS, m) of a flow y' = A y: the 2×2 blocks of A, with σ, ω and σ² − ω² of each
A11, A12, A21, A22, SIGMA, OMEGA, DISC = range(7)
BLOCK_ROWS = 7

# law (LAW_ROWS,): which family, as ``regimes.layout`` has it, its numbers, whether damping couples the modes, c·c
FAMILY, STIFFNESS, DAMPING, EXPONENT, COUPLED, MOBILITY, W, STRENGTH = range(8)
LAW_ROWS = 8

# what of a segment is carried along: the flow and its end, the flow alone, the end alone
WHOLE, FLOW, END = range(3)

# vectors (VECTOR_ROWS, N) at the nodes of a panel: time, weight, the base's Ω²B sin φ, d and d' without the stop, its
# force, ∂F/∂d and ∂F/∂d', Newton's correction
TIME, WEIGHT, BASE, DEEP, RATE, FORCE, BY_DEEP, BY_RATE, CHANGE = range(9)
VECTOR_ROWS = 9

# weights (WEIGHT_ROWS, 2m) in the coordinates y: d and d' as rows, each also times A + σ; the push of the stop, the
# load and the static force as columns
ROW, ROW_RATE, ROW_NEXT, ROW_RATE_NEXT, PUSH, LOAD, STATIC = range(7)
WEIGHT_ROWS = 7

# gains (GAIN_ROWS, m) of each block: of C and of S in the response of d and of d' to a push, the load, the static force
C_PUSH, S_PUSH, C_PUSH_RATE, S_PUSH_RATE, C_LOAD, S_LOAD, C_LOAD_RATE, S_LOAD_RATE = range(8)
C_STATIC, S_STATIC, C_STATIC_RATE, S_STATIC_RATE = range(8, 12)
GAIN_ROWS = 12

# powers (POWER_ROWS, N, m): C and S of each block over the time to a node, and back over it
COSINE, SINE, COSINE_BACK, SINE_BACK = range(4)
POWER_ROWS = 4

# peaks (PEAK_ROWS,): largest F, ∂F/∂d, ∂F/∂d' and d so far, the size of what d is the sum of
DEEPEST, SIZE = 3, 4
PEAK_ROWS = 5


class Flow(NamedTuple):
    """A linear regime: y = into (η, η'), (η, η') = outof y; without rows the modes by themselves."""

    blocks: Array  # (BLOCK_ROWS, m)
    into: Array  # (2m, 2n), or (0, 2n): y = (η_1, η_1', η_2, …)
    outof: Array  # (2n, 2m)


class Collocation(NamedTuple):
    """Gauss' N nodes in (0, 1)."""

    nodes: Array  # (N,)
    weights: Array  # (N,)
    inner: Array  # (N, N): integrals from 0 to node i of the polynomial that is 1 at node j and 0 at the others
    tails: Array  # (2, N): the last two coefficients in Legendre's polynomials


class Workspace(NamedTuple):
    """Arrays that are written to."""

    frame: Array  # (2n, 2n) in the coordinates of a flow
    lines: Array  # (2, 2n)
    state: Array  # (2, 2m)
    weights: Array  # (WEIGHT_ROWS, 2m)
    gains: Array  # (GAIN_ROWS, m)
    powers: Array  # (POWER_ROWS, N, m)
    whole: Array  # (2, m): C and S of each block over a panel
    vectors: Array  # (VECTOR_ROWS, N)
    squares: Array  # (3, N, N): responses of d and of d' at node i to the force at node j; Newton's matrix
    wide: Array  # (2, N, 2n): rows at the nodes in y; then the disturbance of the force there
    peaks: Array  # (PEAK_ROWS,)


class TangentPlan(NamedTuple):
    """One system under a drive, all that its tangent maps need."""

    free: Flow
    upper: Flow  # at the first stop: held by it or pushed by a linear one; no blocks where no motion comes there
    lower: Flow
    law: Array  # (LAW_ROWS,)
    contact: Array  # (2, n) towards either stop
    gaps: Array  # (2,)
    damper: Array  # (n, n)
    spring: Array  # (n,) ω²
    load: Array
    static: Array
    rule: Collocation
    work: Workspace


class TracedMotion(NamedTuple):
    """A motion: its segments, and at each end of them the pose after it, and R and d(Rv)/dv of an impact."""

    trace: Array  # (s, columns)
    poses: Array  # (s + 1, 2, n)
    rebounds: Array  # (s, 2)


class Extent(NamedTuple):
    """The segments ``first`` to ``last`` − 1, each in ``parts``; what of them, see ``WHOLE``."""

    first: int
    last: int
    parts: int
    what: int
