"""The φ-functions of a block, and the step under a load that they make.

For y' = A y + c + l u(t) with u a cubic, exactly (y', u', u'', u''' at the start):

    y(τ) = y + τ φ₁(Aτ) y' + τ² φ₂(Aτ) l u' + τ³ φ₃(Aτ) l u'' + τ⁴ φ₄(Aτ) l u''',     φ_j(z) = Σ z^i / (i + j)!

A² = −2σA − ω², so every φ_j(Aτ) is p + qA. Where |A|τ ≤ 1 φ₄ comes from its series and the others from φ_j = 1/j! +
z φ_{j+1}; then τ is doubled by φ_j(2z) = 2^{−j} (e^z φ_j(z) + Σ φ_i(z)/(j − i)!). Nothing cancels for slow, rigid or
stiff modes (Skaflestad & Wright 2009; Niesen & Wright 2012).
"""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import course as row
from vibeam.flight.kernels.contacts.course import Course
from vibeam.flight.kernels.layout import FORGOTTEN, Regime
from vibeam.flight.kernels.roots.pair import propagator
from vibeam_models.arrays import Array

TERMS = 22  # of φ₄ where |A|τ ≤ 1: 1/26! = 2e-27
INVERSE = np.array([1.0, 1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0])  # 1/j!
MOST_DOUBLINGS = 60
NOTHING = -1.0  # length of a step that was not made


@kernel
def functions(pairs: Array, k: int, tau: float, out: Array) -> None:
    """Set out[2j, k], out[2j + 1, k] to p, q of φ_j(Aτ) = p + qA of block k, j = 0 … 4."""
    sigma, omega, h, doublings = pairs[layout.SIGMA, k], pairs[layout.OMEGA, k], tau, 0
    while (omega + 2.0 * sigma) * h > 1.0 and doublings < MOST_DOUBLINGS:
        h *= 0.5
        doublings += 1
    series(2.0 * sigma * h, (omega * h) * (omega * h), out, k)
    for _ in range(doublings):
        double(pairs, k, h, out)
        h *= 2.0
    for j in range(5):
        out[2 * j + 1, k] *= tau
    if doublings > 0:
        even, odd = exponential(pairs, k, tau)
        out[0, k], out[1, k] = even, odd


@kernel
def exponential(pairs: Array, k: int, tau: float) -> tuple[float, float]:
    """p, q of e^{Aτ} = p + qA."""
    if pairs[layout.DECAY, k] * tau >= 10.0 * FORGOTTEN:
        return 0.0, 0.0
    even, odd, _, _ = propagator(pairs[layout.SIGMA, k], pairs[layout.OMEGA, k], pairs[layout.DISC, k], tau)
    return even, odd


@kernel
def series(damp: float, square: float, out: Array, k: int) -> None:
    """φ₄ … φ₀ of z with z² = −damp z − square, as p + q z."""
    even, odd, p, q, factor = 1.0, 0.0, 0.0, 0.0, INVERSE[4]
    for i in range(TERMS):
        p += even * factor
        q += odd * factor
        even, odd = -square * odd, even - damp * odd
        factor /= i + 5.0
    out[8, k], out[9, k] = p, q
    for j in range(3, -1, -1):
        p, q = INVERSE[j] - square * q, p - damp * q
        out[2 * j, k], out[2 * j + 1, k] = p, q


@kernel
def double(pairs: Array, k: int, h: float, out: Array) -> None:
    """From the φ_j of z = Ah, as p + q z, to those of 2z, as p + q (2z); φ₀ by its closed form."""
    damp, square = 2.0 * pairs[layout.SIGMA, k] * h, (pairs[layout.OMEGA, k] * h) * (pairs[layout.OMEGA, k] * h)
    even, odd = exponential(pairs, k, h)
    odd /= h
    share = 1.0
    for _ in range(4):
        share *= 0.5
    for j in range(4, 0, -1):
        p, q = out[2 * j, k], out[2 * j + 1, k]
        p, q = even * p - square * odd * q, even * q + odd * p - damp * odd * q
        for i in range(1, j + 1):
            p += out[2 * i, k] * INVERSE[j - i]
            q += out[2 * i + 1, k] * INVERSE[j - i]
        out[2 * j, k], out[2 * j + 1, k] = share * p, 0.5 * share * q
        share *= 2.0


@kernel
def fill_step(regime: Regime, course: Course, tau: float, step: Array) -> None:
    """Set ``step`` (STEP_ROWS, n) to the blocks' step over τ."""
    blocks, phi = regime.blocks, course.phi
    for k in range(blocks.shape[1]):
        functions(regime.pairs, k, tau, phi)
        p, q = tau * phi[2, k], tau * phi[3, k]
        step[row.STEP11, k], step[row.STEP12, k] = p + q * blocks[layout.A11, k], q * blocks[layout.A12, k]
        step[row.STEP21, k], step[row.STEP22, k] = q * blocks[layout.A21, k], p + q * blocks[layout.A22, k]
        l1, l2 = blocks[layout.LOAD1, k], blocks[layout.LOAD2, k]
        a1 = blocks[layout.A11, k] * l1 + blocks[layout.A12, k] * l2
        a2 = blocks[layout.A21, k] * l1 + blocks[layout.A22, k] * l2
        power = tau
        for j in range(2, 5):
            power *= tau
            at = row.FIRST_LOAD + 2 * (j - 2)
            step[at, k] = power * (phi[2 * j, k] * l1 + phi[2 * j + 1, k] * a1)
            step[at + 1, k] = power * (phi[2 * j, k] * l2 + phi[2 * j + 1, k] * a2)


@kernel
def step_over(regime: Regime, course: Course, slot: int, length: float, h: float) -> int:
    """The place in course.steps[slot] of the step over h, a part of a piece of that length; made where it is not."""
    grades, grade, reach = course.grades[slot], 0, h
    bank = bank_of(grades, length)
    while reach < length and grade < row.GRADES:
        reach *= 2.0
        grade += 1
    if reach != length or grade >= row.GRADES:
        if grades[row.ANY] != h:
            fill_step(regime, course, h, course.steps[slot, row.BANKS * row.GRADES])
            grades[row.ANY] = h
        return row.BANKS * row.GRADES
    place = bank * row.GRADES + grade
    if grades[bank * row.BANK + 1 + grade] == 0.0:
        fill_step(regime, course, h, course.steps[slot, place])
        grades[bank * row.BANK + 1 + grade] = 1.0
    return place


@kernel
def bank_of(grades: Array, length: float) -> int:
    """The bank of steps of pieces of that length; the oldest where there is none yet."""
    for bank in range(row.BANKS):
        if grades[bank * row.BANK] == length:
            return bank
    bank = int(grades[row.NEXT])
    for i in range(row.BANK):
        grades[bank * row.BANK + i] = 0.0
    grades[bank * row.BANK], grades[row.NEXT] = length, (bank + 1) % row.BANKS
    if grades[row.ANY] == 0.0:
        grades[row.ANY] = NOTHING
    return bank
