"""Bounds of the time that an accumulation of impacts, completed by its limit, still takes.

The last impact computed throws the contact off at u₀, with its acceleration a towards the stop. A flight that starts at
u with a in [a⁻, a⁺] lasts 2u/a⁺ to 2u/a⁻ and comes back at u/ρ to uρ, ρ² = a⁺/a⁻. With R in [r, R], Rρ < 1:

    (2u₀/a⁺) / (1 − r/ρ)  ≤  T  ≤  (2u₀/a⁻) / (1 − Rρ)

Where R = 1 − κv^b, b < 1, tends to 1, ρ must do so too: a changes by J 2u/a⁻ at most over a flight, J a bound of the
jerk, so ρ ≤ 1 + θu with θ = J/a⁻². Then launch velocities fall by κ'u^{1+b} to κ''u^{1+b}, κ', κ'' = κ ∓ θu₀^{1−b}, and

    (1 − κ''u₀^b)^b u₀^{1−b}/(κ''(1 − b))  ≤  Σ u  ≤  u₀^{1−b}/(κ'(1 − b)),     2 Σu/a⁺ ≤ T ≤ 2 Σu/a⁻

a stays within |j| T + ½ √S E T² of its value, j the jerk and E = √(Σ ω²η'''² + η''''²), which grows at most by the
drive; and the impulses to come, P in all, change it by √(|Dc|² + Σ ω²c²) √S P at most, since no motion without drive
gains in the norm √(Σ ω²x² + x'²). All of that holds by induction from impact to impact as soon as the T and P assumed
are larger than those that follow. u₀ and a are known as well as doubles can tell them: bounds are wider by that.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vibeam.flight.disturbance.derivatives import FREE, RegimeDerivatives, stop_of
from vibeam.flight.kernels import layout
from vibeam.flight.linear.regimes import damper_of
from vibeam.flight.proof.errors import endless, responses
from vibeam.flight.proof.watched import WatchedMotion
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Index

if TYPE_CHECKING:
    from vibeam_models.laws.mechanics import StopLaw

ROOM = 2.0  # times the first estimate: what T and P are assumed to be at most
MARGIN = 1e-9  # for the rounding of all this
DOUBTFUL = 0.5  # the largest doubt in u₀ and a for which its bounds mean something
SLACK = 64 * float(np.finfo(float).eps)  # share of the parts of a velocity or pull by which doubles may miss it


class TailStart(NamedTuple):
    """State after the last impacts computed, (k,) each."""

    speed: Array  # u₀
    pull: Array  # a
    jerk: Array  # |j|
    fourth: Array  # E
    doubt: Array  # shares of u₀ and of a that may be round-off, together


class TailRange(NamedTuple):
    """Bounds that hold while an accumulation goes on, (k,) each."""

    least: Array  # a⁻
    most: Array  # a⁺
    jerk: Array  # J


def tails_of(motion: WatchedMotion) -> Array:
    """(k, 3): segment that ends with an accumulation, least and most time that it still takes.

    Most inf: no bound; both inf: none, as R → 1 it has no end.
    """
    which = np.flatnonzero(motion.trace[:-1, layout.END] == layout.CHATTER)
    found = np.zeros((len(which), 3))
    found[:, 0] = which
    unending = endless(motion.trace)[which]
    found[unending, 1:] = np.inf
    which, bounded = which[~unending], found[~unending]
    for side in np.unique(motion.sides[which]):
        mine = motion.sides[which] == side
        bounded[mine, 1:] = np.stack(_bounds(motion, int(side), which[mine]), axis=1)
    found[~unending] = bounded
    return found


def _bounds(motion: WatchedMotion, side: int, which: Index) -> tuple[Array, Array]:
    system, drive, start = motion.system, motion.drive, _after_impact(motion, side, which)
    push = float(np.linalg.norm(system.load)) * drive.omega**5 * abs(drive.amplitude)
    return bounds_of(system, (system.contact_law, system.contact), start, np.full(len(which), push))


def bounds_of(system: ImpactSystem, stop: tuple[StopLaw, Array], start: TailStart, push: Array) -> tuple[Array, Array]:
    """Least and most time (k,) that accumulations at a ``stop``, law and row (n,), still take.

    ``push``: |load u'''| at most meanwhile, (k,).
    """
    law, row = stop
    mobility = float(row @ row)
    with np.errstate(all="ignore"):
        share = law.accumulation_loss(start.speed)
        time = ROOM * 2 * start.speed / (start.pull * share)
        change = ROOM * 2 * start.speed / share  # S P
        kept = _range(system, row, start, time, (change / np.sqrt(mobility), push))
        least, most, changed = law.accumulation(start.speed, kept.least, kept.most, kept.jerk)
        sure = (kept.least > 0) & (share > 0) & (most < time) & (changed < change)
        sure &= (least > 0) & (start.doubt < DOUBTFUL)
        doubt = MARGIN + start.doubt
        return np.where(sure, least * (1 - doubt), 0.0), np.where(sure, most * (1 + doubt), np.inf)


def _after_impact(motion: WatchedMotion, side: int, which: Index) -> TailStart:
    """Taken back from the rest that follows, whose contact velocity was taken out by the least impulse."""
    system, drive, row = motion.system, motion.drive, stop_of(motion.system, side).row
    speed = system.contact_law.rebound(motion.trace[which, layout.BEFORE])
    poses = motion.poses[which + 1].copy()
    poses[:, 1] -= speed[:, None] * (row / float(row @ row))
    found = RegimeDerivatives(system, drive, FREE, side, poses, motion.trace[which + 1, layout.AT_CLOCK])
    _, _, second, third = (each.value for each in found.gap(side))
    norm = np.sqrt(np.sum((system.omega * found.known[3].value) ** 2 + found.known[4].value ** 2, axis=1))
    driven, static = responses(system, drive)
    reach = np.abs(poses[:, 0]) + driven + static
    parts = (np.abs(poses[:, 1]) + system.omega * reach + drive.omega * driven) @ np.abs(row)
    push = np.abs(system.static) + np.abs(system.load) * drive.omega**2 * abs(drive.amplitude)
    braked = np.abs(poses[:, 1]) @ np.abs(damper_of(system)).T
    pulls = (system.omega**2 * reach + braked + push) @ np.abs(row)
    with np.errstate(divide="ignore", invalid="ignore"):
        doubt = 2 * SLACK * (parts / speed + pulls / np.abs(second))
    return TailStart(speed, -second, np.abs(third), norm, doubt)


def _range(system: ImpactSystem, row: Array, start: TailStart, time: Array, moved: tuple[Array, Array]) -> TailRange:
    """``moved``: P √S, the most by which impulses may move the modes, and the load's third derivative."""
    (pushed, push), size, damper = moved, float(np.linalg.norm(row)), damper_of(system)
    fourth = size * (start.fourth + time * push)
    braked, bent = float(np.linalg.norm(damper @ row)), float(np.linalg.norm(system.omega * row))
    sway = np.hypot(braked, bent) * pushed
    rate = float(np.max(system.omega)) + float(np.sum(np.abs(damper)))
    shift = start.jerk * time + fourth * time**2 / 2 + sway
    return TailRange(start.pull - shift, start.pull + shift, start.jerk + fourth * time + 2 * rate * sway)
