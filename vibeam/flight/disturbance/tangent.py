"""Tangent maps of a motion: how a small disturbance of (η, η') goes along it, segment by segment.

Over a segment a disturbance obeys the segment's own linear system: the free modes, the modes with the contact held, or
with a linear stop in touch. At the event that ends it, it passes a saltation matrix (Aizerman & Gantmakher 1958; Leine
& Nijmeijer 2004, eq. 7.54). With c the contact's row, S = c·c, D the modal damping, v and a the contact's velocity and
acceleration before an impact, and ρ(v) = R(v) v the velocity after it:

    δη⁺  = δη⁻ − c (1 + R)/S (c·δη⁻)
    δη'⁺ = δη'⁻ − c (1 + ρ')/S (c·δη'⁻) + [(1 + R)/S Dc + (1 + ρ')/S (a/v) c] (c·δη⁻)

- entry of a linear stop with damping b, where the force jumps by b v: δη'⁺ = δη'⁻ − b c (c·δη⁻); at its release the
  force is zero and nothing jumps;
- entry and release of a stop with F = max(0, k d^p (1 + a d')), Hertz' or Hunt and Crossley's: F goes to zero with d,
  and where d' < −1/a it is zero before: it is continuous everywhere and nothing jumps. In between go the variational
  equations δη'' + D δη' + Λ δη = −c (∂F/∂d c·δη + ∂F/∂d' c·δη'), see ``kernels.tangents.contact``;
- an impact that ends at rest on the stop, plastic or the last one of a completed accumulation: whatever the contact
  point's disturbance was, its displacement and velocity end at the stop's, while impulses along c leave all that is
  orthogonal to c alone but for the damping of the way that the contact point has gone: with P = 1 − c cᵀ/S,
  δη⁺ = P δη⁻, δη'⁺ = P (δη'⁻ + Dc (c·δη⁻)/S), of an accumulation to second order of the last impact velocity
  computed. Two directions are lost.
- release from rest, where the force is zero: nothing jumps.

An impact with R = 0 loses one direction: the contact point leaves from the stop, whatever came before. Compiled code
(``kernels.tangents``) carries all columns at once.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from vibeam.flight.disturbance.derivatives import stop_of
from vibeam.flight.disturbance.packing import plan_of
from vibeam.flight.engine.entries import carry_frame
from vibeam.flight.engine.threads import pause
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.tangents.layout import DISC, END, FLOW, SIGMA, WHOLE, Extent, TracedMotion
from vibeam.flight.linear.regimes import damper_of
from vibeam.flight.readout import sides
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.flight.event_driven import Segments
    from vibeam.system.impact_system import Drive, ImpactSystem
    from vibeam.system.state import State

LOST_AT_REST = 2  # directions: displacement and velocity of the contact point
PIECE = 64_000  # segments carried along between two pauses, over the square of modes and a few
NONE = np.zeros((0, 0, 0))


class TangentMaps:
    """Tangent maps (2n, 2n) on (η, η') of the segments of a motion with contact at one place."""

    def __init__(self, system: ImpactSystem, drive: Drive, segments: Segments, state: State) -> None:
        """``state``: at the end."""
        self.system, self.drive, self.trace = system, drive, segments.trace
        last = np.array([[state.displacement, state.velocity]])
        self._motion = TracedMotion(segments.trace, np.concatenate([segments.poses, last]), self._rebounds())
        self.poses, self.ends = self._motion.poses[:-1], self._motion.poses[1:]
        touched = bool(np.any(self.trace[:, layout.WHAT] != layout.FREE))
        self._plan = plan_of(system, drive, touched and not system.contact_law.integrated)

    def __len__(self) -> int:
        return len(self.trace)

    def product(self) -> Array:
        """Map over the whole motion."""
        return self.carried(np.eye(2 * self.system.size))

    def carried(self, columns: Array, first: int = 0, last: int | None = None) -> Array:
        """Disturbances (2n, c ≤ 2n) from the begin of segment ``first`` carried to that of ``last``, None: the end."""
        frame, end = np.array(columns, dtype=float, order="C"), len(self) if last is None else last
        piece = 1 + PIECE // (self.system.size + 8) ** 2
        for begin in range(first, end, piece):
            pause()
            carry_frame(self._plan, self._motion, Extent(begin, min(begin + piece, end), 1, WHOLE), frame, NONE)
        return frame

    def flow(self, i: int) -> Array:
        """Map over segment i, its end left out."""
        return self._part(i, FLOW)

    def over(self, i: int) -> Array:
        """Map over segment i and its end."""
        return self._part(i, WHOLE)

    def steps(self, i: int, rate: float, decay: float) -> list[Array]:
        """The same in factors, over none of which anything that decays at ``rate`` 1/s loses more than ``decay``."""
        parts = max(1, int(np.ceil(rate * float(self.trace[i, layout.DURATION]) / decay)))
        whole = 2 * self.system.size
        found = np.empty((parts, whole, whole))
        carry_frame(self._plan, self._motion, Extent(i, i + 1, parts, WHOLE), np.eye(whole), found)
        return list(found)

    def jump(self, i: int) -> Array | None:
        """Map over the event that ends segment i; None where that is the identity."""
        end = int(self.trace[i, layout.END])
        jumps = end == layout.IMPACT and self.trace[i, layout.BEFORE] > 0 and not self.system.contact_law.integrated
        return self._part(i, END) if jumps or end in (layout.CHATTER, layout.STUCK) else None

    def _part(self, i: int, what: int) -> Array:
        frame = np.eye(2 * self.system.size)
        carry_frame(self._plan, self._motion, Extent(i, i + 1, 1, what), frame, NONE)
        return frame

    @cached_property
    def fastest(self) -> float:
        """Fastest decay of the free modes, 1/s."""
        blocks = self._plan.free.blocks
        return float(np.max(blocks[SIGMA] + np.sqrt(np.maximum(blocks[DISC], 0.0))))

    def lost(self, i: int) -> int:
        """Number of directions that are lost, at least, in segment i and at its end."""
        if self.trace[i, layout.WHAT] == layout.RESTING or self.trace[i, layout.END] in (layout.CHATTER, layout.STUCK):
            return LOST_AT_REST
        struck = self.trace[i, layout.END] == layout.IMPACT and self.trace[i, layout.BEFORE] > 0
        return int(struck and not self.system.contact_law.yields and self._motion.rebounds[i, 0] == 0)

    def kept(self, i: int) -> Array:
        """Basis (2n, 2n − lost) of the disturbances that are left after segment i and its end."""
        n, c, lost = self.system.size, self.system.contact, self.lost(i)
        across = np.linalg.svd(c[None, :])[2][1:].T
        whole = across if lost == LOST_AT_REST else np.eye(n)
        if not lost:
            return np.eye(2 * n)
        none = np.zeros((n, whole.shape[1]))
        return np.block([[across, none], [np.zeros((n, n - 1)), whole]])

    def readings(self, i: int) -> tuple[Array, Array]:
        """Rows (2n,) that read time and velocity of the impact that ends segment i off the disturbance before it."""
        still, row, speed = np.zeros(self.system.size), self.system.contact, self.trace[i, layout.BEFORE]
        late = np.zeros(2 * len(still))  # without a speed the contact was there already
        if speed > 0:
            late[: len(still)] = -row / speed
        return late, np.concatenate([still, row]) + float(self._accelerations[i]) * late

    @cached_property
    def _accelerations(self) -> Array:
        """Accelerations of the contact towards its stop at the ends of the segments, (m,)."""
        system, trace = self.system, self.trace
        stops = [stop_of(system, side).row for side in range(1 if system.second_gap is None else 2)]
        rows, velocity = np.array(stops)[sides(trace)], self.ends[:, 1]
        velocity = velocity + rows * ((trace[:, layout.BEFORE] - _dots(rows, velocity)) / system.mobility)[:, None]
        phase = self.drive.omega * (trace[:, layout.AT_CLOCK] + trace[:, layout.DURATION])
        push = np.outer(self.drive.omega**2 * self.drive.amplitude * np.sin(phase), system.load) + system.static
        return _dots(rows, push - velocity @ damper_of(system) - system.omega**2 * self.ends[:, 0])

    def _rebounds(self) -> Array:
        """R and d(Rv)/dv of the impacts that end the segments, (m, 2)."""
        law, speeds = self.system.contact_law, self.trace[:, layout.BEFORE]
        if law.yields:
            return np.zeros((len(speeds), 2))
        speeds = np.where(speeds > 0, speeds, 1.0)
        return np.stack([law.rebound(speeds) / speeds, law.rebound_slope(speeds)], axis=1)


def _dots(rows: Array, others: Array) -> Array:
    """Scalar products of rows, (m,)."""
    return np.asarray((rows[:, None, :] @ others[:, :, None])[:, 0, 0])


def state_matrix(system: ImpactSystem) -> Array:
    """State matrix (2n, 2n) of the free modes, coupled by damping or not."""
    n = system.size
    matrix = np.zeros((2 * n, 2 * n))
    matrix[:n, n:] = np.eye(n)
    matrix[n:, :n] = -np.diag(system.omega**2)
    matrix[n:, n:] = -damper_of(system)
    return matrix
