"""Saltation: what the event that ends a segment does to disturbances (formulas: ``disturbance.tangent``)."""

from __future__ import annotations

from math import sin

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam.flight.kernels.tangents import layout as row
from vibeam.flight.kernels.tangents.layout import TangentPlan, TracedMotion
from vibeam_models.arrays import Array

TOP, BOTTOM = range(2)  # rows of work.lines: c·δη and c·δη'


@kernel
def pass_event(plan: TangentPlan, motion: TracedMotion, i: int, frame: Array) -> None:
    """Columns of ``frame`` (2n, c) past the end of segment i."""
    end, before, side = int(motion.trace[i, layout.END]), motion.trace[i, layout.BEFORE], side_of(motion.trace, i)
    if end == layout.CHATTER or end == layout.STUCK:
        settle(plan, frame)
    elif end == layout.IMPACT and before > 0.0 and plan.law[row.FAMILY] == regime_row.IMPULSIVE:
        impact(plan, motion, i, side, frame)
    elif end == layout.IMPACT and before > 0.0 and plan.law[row.FAMILY] == regime_row.LINEAR:
        along_row(plan, side, frame)
        for k in range(plan.contact.shape[1]):
            for j in range(frame.shape[1]):
                damped = plan.law[row.DAMPING] * plan.contact[side, k] * plan.work.lines[TOP, j]
                frame[plan.contact.shape[1] + k, j] -= damped


@kernel
def side_of(trace: Array, i: int) -> int:
    """The stop of segment i; the kernels of plain systems know one alone."""
    return int(trace[i, regime_row.AT_SIDE]) if trace.shape[1] > regime_row.AT_SIDE else 0


@kernel
def along_row(plan: TangentPlan, side: int, frame: Array) -> None:
    """c·δη and c·δη' of every column."""
    n, lines = plan.contact.shape[1], plan.work.lines
    for j in range(frame.shape[1]):
        lines[TOP, j], lines[BOTTOM, j] = 0.0, 0.0
    for k in range(n):
        for j in range(frame.shape[1]):
            lines[TOP, j] += plan.contact[side, k] * frame[k, j]
            lines[BOTTOM, j] += plan.contact[side, k] * frame[n + k, j]


@kernel
def project(plan: TangentPlan, frame: Array) -> None:
    """Displacement and velocity of the contact point taken out."""
    n, mobility, lines = plan.contact.shape[1], plan.law[row.MOBILITY], plan.work.lines
    along_row(plan, 0, frame)
    for k in range(n):
        share = plan.contact[0, k] / mobility
        for j in range(frame.shape[1]):
            frame[k, j] -= share * lines[TOP, j]
            frame[n + k, j] -= share * lines[BOTTOM, j]


@kernel
def settle(plan: TangentPlan, frame: Array) -> None:
    """The same where the contact comes to rest, and what its damping has given the others: P D c (c·δη)/S."""
    n, mobility, c = plan.contact.shape[1], plan.law[row.MOBILITY], plan.contact[0]
    project(plan, frame)
    along = 0.0
    for k in range(n):
        along += c[k] * braked(plan, 0, k) / mobility
    for k in range(n):
        share = (braked(plan, 0, k) - along * c[k]) / mobility
        for j in range(frame.shape[1]):
            frame[n + k, j] += share * plan.work.lines[TOP, j]


@kernel
def braked(plan: TangentPlan, side: int, k: int) -> float:
    """(D c)_k."""
    total = 0.0
    for j in range(plan.contact.shape[1]):
        total += plan.damper[k, j] * plan.contact[side, j]
    return total


@kernel
def impact(plan: TangentPlan, motion: TracedMotion, i: int, side: int, frame: Array) -> None:
    """Saltation of an impact with R and d(Rv)/dv at the speed before it."""
    n, mobility, lines = plan.contact.shape[1], plan.law[row.MOBILITY], plan.work.lines
    before = motion.trace[i, layout.BEFORE]
    turned, struck = (1.0 + motion.rebounds[i, 0]) / mobility, (1.0 + motion.rebounds[i, 1]) / mobility
    lean = struck * acceleration(plan, motion, i, side) / before
    along_row(plan, side, frame)
    for k in range(n):
        c = plan.contact[side, k]
        late = turned * braked(plan, side, k) + lean * c
        for j in range(frame.shape[1]):
            frame[k, j] -= turned * c * lines[TOP, j]
            frame[n + k, j] += late * lines[TOP, j] - struck * c * lines[BOTTOM, j]


@kernel
def acceleration(plan: TangentPlan, motion: TracedMotion, i: int, side: int) -> float:
    """The contact's acceleration towards the stop just before the event that ends segment i, without its force."""
    trace, pose, n = motion.trace, motion.poses[i + 1], plan.contact.shape[1]
    after = 0.0
    for k in range(n):
        after += plan.contact[side, k] * pose[1, k]
    impulse = (trace[i, layout.BEFORE] - after) / plan.law[row.MOBILITY]
    phase = plan.law[row.W] * (trace[i, layout.AT_CLOCK] + trace[i, layout.DURATION])
    base, total = plan.law[row.STRENGTH] * sin(phase), 0.0
    for k in range(n):
        pull = plan.load[k] * base + plan.static[k] - plan.spring[k] * pose[0, k]
        for j in range(n):
            pull -= plan.damper[k, j] * (pose[1, j] + plan.contact[side, j] * impulse)
        total += plan.contact[side, k] * pull
    return total
