"""Memory that a run under a record takes, so that a large one is confirmed before it is taken.

Of a record of K pieces 40 K bytes, and as many for its course, one for all motions under it; of a motion under way the
samples of its signals, the bins of its histories where they are kept, and its states at a block of samples; of each
motion that is known its outlines and spectra. The coefficients are measured.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from vibeam.case.case import plan_of_record
from vibeam.exchange.faults import CaseError
from vibeam.flight.engine.threads import cores
from vibeam.runs.transient.motions import SCALED
from vibeam.runs.transient.samples import A_PERIOD, PLENTY, count_of
from vibeam.system.record_pieces import BLOCK
from vibeam_models.arguments import counted
from vibeam_models.memory import check_room

if TYPE_CHECKING:
    from vibeam.runs.transient.motions import MotionMaker, Realisation

A_PIECE = 40.0  # bytes of a record, and as many of its course
BLOCKS = 4e7  # of what a motion under way takes by blocks whatever its size
A_SAMPLE, A_BIN = 62.0, 55.0  # of a signal at one time, and in one bin of its history
A_STATE = 30.0  # of a mode in a block of states
A_MOTION = 28_000.0  # of a signal of a motion that is known
CURE = "take a lower drive.rate or record.rate, a shorter record.duration, fewer outputs or realisations"


def require_room(makers: Mapping[str, MotionMaker], motions: Sequence[Realisation]) -> None:
    """CaseError where the ``motions`` take more memory than is free, or 2 GiB and that is not confirmed."""
    maker = makers[motions[0].fidelity]
    size = len(maker.load(motions[0].value, motions[0].seed).coefficients)
    what = f"{counted(len(motions), 'motion')} under {counted(size, 'piece')} of a record"
    try:
        check_room(what, needed(makers, motions, size), CURE)
    except ValueError as refusal:
        raise CaseError([maker.case.fault("record", message=str(refusal))]) from None


def needed(makers: Mapping[str, MotionMaker], motions: Sequence[Realisation], size: int) -> float:
    """Bytes that ``motions`` under a record of ``size`` pieces take at most, beside those of the process itself."""
    at_once = min(cores(), len(motions))
    largest = sorted(_of_motion(makers[each.fidelity], each.shown) for each in motions)[-at_once:]
    known = sum(len(makers[each.fidelity].signals) for each in motions) * A_MOTION
    return _of_records(makers[motions[0].fidelity], size, at_once) + sum(largest) + known


def _of_motion(maker: MotionMaker, shown: bool) -> float:
    """Bytes of one motion while it is under way."""
    count = count_of(maker.system(0)[0], maker.duration, A_PERIOD if maker.exact else PLENTY)
    signals = len(maker.signals) * (count * A_SAMPLE + shown * maker.bins_of(maker.duration) * A_BIN)
    return BLOCKS + signals + min(count, BLOCK) * maker.system(0)[0].size * A_STATE


def _of_records(maker: MotionMaker, size: int, at_once: int) -> float:
    """Bytes of the record as the case gives it, and of those of other sizes or seeds that are run at once."""
    plan = plan_of_record(maker.case)
    others = max(len(plan.seeds), 1) * (len(plan.values) if plan.over in SCALED else 1)
    own = 2 * min(at_once, others) if others > 1 or (plan.over in SCALED and plan.values != (1.0,)) else 1
    return (1 + own) * size * A_PIECE
