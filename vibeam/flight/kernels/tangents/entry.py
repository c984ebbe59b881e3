"""Entry point, which Python calls: disturbances carried along the segments of a motion."""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import entry, kernel
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam.flight.kernels.tangents import layout as row
from vibeam.flight.kernels.tangents.contact import begin_contact, pass_contact
from vibeam.flight.kernels.tangents.flow import propagate
from vibeam.flight.kernels.tangents.layout import Extent, TangentPlan, TracedMotion
from vibeam.flight.kernels.tangents.saltation import pass_event, project, side_of
from vibeam_models.arrays import Array


@entry
def carry(plan: TangentPlan, motion: TracedMotion, extent: Extent, frame: Array, kept: Array) -> tuple[int, int]:
    """Columns of ``frame`` (2n, c ≤ 2n) past the segments of ``extent``: factors kept, panels of integrated contact.

    Where ``kept`` (k, 2n, 2n) has room, every part is a factor of its own: the frame is kept and begun anew from 1.
    """
    count, panels = 0, 0
    for i in range(extent.first, extent.last):
        for part in range(extent.parts):
            if extent.what != row.END:
                panels += flow_over(plan, motion, i, part, extent.parts, frame)
            if extent.what != row.FLOW and part == extent.parts - 1:
                pass_event(plan, motion, i, frame)
            if kept.shape[0] > 0:
                keep(frame, kept[count])
                count += 1
    return count, panels


@kernel
def keep(frame: Array, kept: Array) -> None:
    """Copy the frame, and begin it anew from 1."""
    for i in range(frame.shape[0]):
        for j in range(frame.shape[1]):
            kept[i, j] = frame[i, j]
            frame[i, j] = 1.0 if i == j else 0.0


@kernel
def flow_over(plan: TangentPlan, motion: TracedMotion, i: int, part: int, parts: int, frame: Array) -> int:
    """Columns of ``frame`` over one of equal parts of segment i; panels of integrated contact."""
    what, side = motion.trace[i, layout.WHAT], side_of(motion.trace, i)
    duration = motion.trace[i, layout.DURATION] / parts
    if what == regime_row.CONTACT and plan.law[row.FAMILY] == regime_row.CURVED:
        if part == 0:
            begin_contact(plan, motion.poses[i], side)
        clock = motion.trace[i, layout.AT_CLOCK] + part * duration
        return pass_contact(plan, side, clock, duration, frame)
    if what == layout.RESTING:
        project(plan, frame)
    if what != layout.RESTING and what != regime_row.CONTACT:
        propagate(plan.free, frame, duration, plan.work)
    elif side == 0:
        propagate(plan.upper, frame, duration, plan.work)
    else:
        propagate(plan.lower, frame, duration, plan.work)
    return 0
