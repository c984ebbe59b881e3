"""The flow of a regime's blocks under a load: into it and out of it, derivatives at a node, a panel's trial end."""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.contacts import course as row
from vibeam.flight.kernels.contacts.course import Course
from vibeam.flight.kernels.contacts.load.phi import functions, step_over
from vibeam.flight.kernels.contacts.load_value import load_at
from vibeam.flight.kernels.layout import Regime
from vibeam_models.arrays import Array

FINEST = 2.0**-56  # share of a piece below which a panel is not halved


@kernel
def fitted(want: float, length: float) -> float:
    """The longest of a piece's length, half of it, … that is no longer than ``want``; for the steps kept."""
    h = length
    while h > want and h > FINEST * length:
        h *= 0.5
    return h


@kernel
def enter_blocks(regime: Regime, course: Course, pose: Array) -> None:
    """Set flow[Y] from ``pose``."""
    flow, n = course.flow, pose.shape[1]
    for k in range(regime.blocks.shape[1]):
        first, second = 0.0, 0.0
        for i in range(n):
            x, y = pose[0, i] - regime.held[i], pose[1, i]
            first += regime.into[2 * k, i] * x + regime.into[2 * k, n + i] * y
            second += regime.into[2 * k + 1, i] * x + regime.into[2 * k + 1, n + i] * y
        flow[row.Y, k], flow[row.Y + 1, k] = first, second


@kernel
def leave_blocks(regime: Regime, course: Course, pose: Array) -> None:
    """Set ``pose`` from flow[Y]."""
    flow, n = course.flow, pose.shape[1]
    for i in range(n):
        x, y = regime.held[i], 0.0
        for k in range(regime.blocks.shape[1]):
            x += regime.outof[i, 2 * k] * flow[row.Y, k] + regime.outof[i, 2 * k + 1] * flow[row.Y + 1, k]
            y += regime.outof[n + i, 2 * k] * flow[row.Y, k] + regime.outof[n + i, 2 * k + 1] * flow[row.Y + 1, k]
        pose[0, i], pose[1, i] = x, y


@joined
def set_load(course: Course, piece: int, clock: float) -> None:
    """The load and its derivatives at a node."""
    c, numbers = course.pieces, course.numbers
    numbers[row.U], numbers[row.U1] = load_at(course, piece, clock)
    numbers[row.U2], numbers[row.U3] = 2.0 * c[piece, 2] + 6.0 * c[piece, 3] * clock, 6.0 * c[piece, 3]


@joined
def set_load_after(course: Course, h: float) -> None:
    """u and u' at the panel's end."""
    u, u1, u2, u3 = course.numbers[row.U], course.numbers[row.U1], course.numbers[row.U2], course.numbers[row.U3]
    course.numbers[row.U_LAST] = u + h * (u1 + h * (0.5 * u2 + h * u3 * (1.0 / 6.0)))
    course.numbers[row.U1_LAST] = u1 + h * (u2 + h * 0.5 * u3)


@kernel
def differentiate(regime: Regime, course: Course, depth: int) -> None:
    """flow[RATE], and up to the ``depth``-th derivative, at the node: y^{(j+1)} = A y^{(j)} + l u^{(j)}; 4 ≤ depth."""
    b, flow, numbers = regime.blocks, course.flow, course.numbers
    for j in range(depth):
        u = numbers[row.U + j] if j < 4 else 0.0
        now, then = row.Y + 2 * j, row.Y + 2 * j + 2
        for k in range(b.shape[1]):
            first, second = flow[now, k], flow[now + 1, k]
            flow[then, k] = b[layout.A11, k] * first + b[layout.A12, k] * second + b[layout.LOAD1, k] * u
            flow[then + 1, k] = b[layout.A21, k] * first + b[layout.A22, k] * second + b[layout.LOAD2, k] * u
        if j == 0:
            for k in range(b.shape[1]):
                flow[then, k] += b[layout.CONSTANT1, k]
                flow[then + 1, k] += b[layout.CONSTANT2, k]


@kernel
def grow(regime: Regime, course: Course, slot: int, length: float, h: float) -> None:
    """flow[GROWTH], [TRIAL] and [TRIAL_RATE] over h from the node, whose rate is known."""
    step, flow, b = course.steps[slot, step_over(regime, course, slot, length, h)], course.flow, regime.blocks
    u1, u2, u3 = course.numbers[row.U1], course.numbers[row.U2], course.numbers[row.U3]
    set_load_after(course, h)
    u = course.numbers[row.U_LAST]
    for k in range(b.shape[1]):
        x, y = flow[row.RATE, k], flow[row.RATE + 1, k]
        first = step[row.STEP11, k] * x + step[row.STEP12, k] * y
        second = step[row.STEP21, k] * x + step[row.STEP22, k] * y
        first += u1 * step[row.FIRST_LOAD, k] + u2 * step[row.SECOND_LOAD, k] + u3 * step[row.THIRD_LOAD, k]
        second += (
            u1 * step[row.FIRST_LOAD + 1, k] + u2 * step[row.SECOND_LOAD + 1, k] + u3 * step[row.THIRD_LOAD + 1, k]
        )
        flow[row.GROWTH, k], flow[row.GROWTH + 1, k] = first, second
        first, second = first + flow[row.Y, k], second + flow[row.Y + 1, k]
        flow[row.TRIAL, k], flow[row.TRIAL + 1, k] = first, second
        rate = b[layout.A11, k] * first + b[layout.A12, k] * second + b[layout.LOAD1, k] * u
        flow[row.TRIAL_RATE, k] = rate + b[layout.CONSTANT1, k]
        rate = b[layout.A21, k] * first + b[layout.A22, k] * second + b[layout.LOAD2, k] * u
        flow[row.TRIAL_RATE + 1, k] = rate + b[layout.CONSTANT2, k]


@kernel
def accept(course: Course) -> None:
    """The trial end becomes the node."""
    flow = course.flow
    for k in range(flow.shape[1]):
        flow[row.Y, k], flow[row.Y + 1, k] = flow[row.TRIAL, k], flow[row.TRIAL + 1, k]
        flow[row.RATE, k], flow[row.RATE + 1, k] = flow[row.TRIAL_RATE, k], flow[row.TRIAL_RATE + 1, k]


@kernel
def move_on(regime: Regime, course: Course, tau: float) -> None:
    """The node a time τ on, within its piece; its rate is known."""
    pair, flow, phi, b, numbers = regime.pairs, course.flow, course.phi, regime.blocks, course.numbers
    for k in range(b.shape[1]):
        functions(pair, k, tau, phi)
        first, second = phi[2, k] * flow[row.RATE, k], phi[2, k] * flow[row.RATE + 1, k]
        low, high = phi[3, k] * flow[row.RATE, k], phi[3, k] * flow[row.RATE + 1, k]
        power = 1.0
        for j in range(1, 4):
            power *= tau
            u = numbers[row.U + j] * power
            first += phi[2 + 2 * j, k] * b[layout.LOAD1, k] * u
            second += phi[2 + 2 * j, k] * b[layout.LOAD2, k] * u
            low += phi[3 + 2 * j, k] * b[layout.LOAD1, k] * u
            high += phi[3 + 2 * j, k] * b[layout.LOAD2, k] * u
        flow[row.Y, k] += tau * (first + b[layout.A11, k] * low + b[layout.A12, k] * high)
        flow[row.Y + 1, k] += tau * (second + b[layout.A21, k] * low + b[layout.A22, k] * high)
