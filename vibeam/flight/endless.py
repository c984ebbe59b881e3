"""What is left out where impacts that lose next to nothing (R → 1) are taken as rest: a bound by energy.

Pressed on with acceleration a, a flight takes 2v/a; damping takes a share of the velocity that falls with it: for one
mode vₙ₊₁ = vₙ − κvₙ², κ = 4σ/3a, from ∫ 2σ d'² dt = 2σ · 2v³/3a over the flight. So vₙ → 1/κn, flights of 2/(aκn), and
their sum (2/aκ) ln n has no limit: with R = 1 the accumulation is endless, and impacts grow as e^{2σt/3} in number.

So it is left at a velocity u, not completed, and the contact held from there. Let z be what the true motion, impacts
and all, has beyond the held one, E = ½ Σ (z_k'² + ω_k² z_k²), g ≥ 0 the gap, f > 0 the force by which the contact is
held. An impact with R ≤ 1 does no positive work on z, damping neither, and −f does −∫ f dg = −[fg] + ∫ g df. Hence

    W = E + f g:     dW/dt ≤ g df/dt ≤ W (d ln f/dt)⁺,     W ≤ W₀ exp ∫ (d ln f)⁺,     W₀ = ½ u²/S

for any number of modes, damping, coupled or not, and drive, as long as f presses: the gap is W/f at most, no mode's
velocity nor ω times its displacement off by more than √2W.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.linear.regimes import damper_of
from vibeam.flight.rebound import rebound
from vibeam.observe.motion import Path
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.flight.event_driven import Segments


PLACES = 512  # at which the force is read off over a rest


class ExactMotion(Path, Protocol):
    """A motion whose flights and rests are known."""

    @property
    def segments(self) -> Segments:
        """Flights and rests, one after another."""
        ...


def endless(trace: Array) -> NDArray[np.bool_]:
    """Which segments (m,) end with an endless accumulation that was taken as rest."""
    return np.asarray((trace[:, layout.END] == layout.CHATTER) & np.isinf(trace[:, layout.REMAINDER]))


def left_out_of(path: ExactMotion) -> Array:
    """(m, 3): when each endless accumulation was taken as rest, s; W₀; most that W is until that rest's end, J."""
    trace = path.segments.trace
    which = np.flatnonzero(endless(trace))
    energy = rebound(path.system, trace[which, layout.BEFORE]) ** 2 / (
        2 * float(path.system.contact @ path.system.contact)
    )
    rises = np.array([_rise(path, int(i) + 1) for i in which])
    return np.stack(
        [trace[which, layout.START] + trace[which, layout.DURATION], energy, energy * rises], axis=1
    ).reshape(-1, 3)


def _rise(path: ExactMotion, rest: int) -> float:
    """exp ∫ (d ln f)⁺ over a rest, by the force at ``PLACES``."""
    trace = path.segments.trace
    if rest >= len(trace) or trace[rest, layout.WHAT] != layout.RESTING:
        return 1.0
    times = np.linspace(trace[rest, layout.START], trace[rest, layout.START] + trace[rest, layout.DURATION], PLACES)
    force = np.maximum(_force(path, np.clip(times, path.t_start, path.t_end)), 0.0)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        growth = np.where(force[1:] > force[:-1], force[1:] / force[:-1], 1.0)
        return float(np.prod(growth))


def _force(path: ExactMotion, times: Array) -> Array:
    """c·(load Ω²B sin φ + static − Dη' − ω²η)/S at ``times``: what holds the contact, either stop."""
    system, drive = path.system, path.drive
    poses = path.modes_at(times)
    place = poses[:, 0] @ system.contact
    far = np.inf if system.second_gap is None else np.abs(place + system.second_gap)
    push = np.outer(np.sin(drive.omega * times), system.load) * drive.omega**2 * drive.amplitude + system.static
    pull = push - poses[:, 1] @ damper_of(system) - system.omega**2 * poses[:, 0]
    side = np.where(np.abs(place - system.gap) <= far, 1.0, -1.0)
    return np.asarray(side * (pull @ system.contact) / float(system.contact @ system.contact))
