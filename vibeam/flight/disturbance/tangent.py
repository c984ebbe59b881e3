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
  and where d' < −1/a it is zero before: it is continuous everywhere and nothing jumps. In between the variational
  equations δη'' + D δη' + Λ δη = −c (∂F/∂d c·δη + ∂F/∂d' c·δη') are integrated along the contact;
- a completed accumulation of impacts, which ends at rest on the stop: whatever the contact point's disturbance was,
  its displacement and velocity end at the stop's, while impulses along c leave all that is orthogonal to c alone:
  δη⁺ = (1 − c cᵀ/S) δη⁻, δη'⁺ likewise, to the order of the last impact velocity computed. Two directions are lost.
- release from rest, where the force is zero: nothing jumps.

An impact with R = 0 loses one direction: the contact point leaves from the stop, whatever came before.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from vibeam.flight.disturbance.derivatives import stop_of
from vibeam.flight.disturbance.variations import variations
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.linear.propagator import Pair, propagators
from vibeam.flight.linear.regimes import damper_of
from vibeam.flight.readout import sides
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.flight.event_driven import Segments
    from vibeam.system.impact_system import Drive, ImpactSystem
    from vibeam.system.state import State

LOST_AT_REST = 2  # directions: displacement and velocity of the contact point


def tangent_fault(system: ImpactSystem) -> str:
    """Reason why the tangent maps of a system's motions are not known; empty where they are."""
    if system.further is not None:
        return "several contacts: an impact of one may release another, and the saltation of that is not known here"
    law = system.contact_law
    if not (law.yields or law.has_slope):
        return f'the contact law "{law.name}": let the law have rebound_slope, or its contact give a table'
    return ""


class TangentMaps:
    """Tangent maps (2n, 2n) on (η, η') of the segments of a motion."""

    def __init__(self, system: ImpactSystem, drive: Drive, segments: Segments, state: State) -> None:
        """``state``: at the end. ValueError where they are not known, see ``tangent_fault``."""
        if reason := tangent_fault(system):
            raise ValueError(f"tangent maps are not known for {reason}")
        self.system, self.drive = system, drive
        self.trace, self.poses = segments.trace, segments.poses
        last = np.stack([state.displacement, state.velocity])
        self.ends = np.concatenate([self.poses[1:], last[None]])
        self.sides = sides(segments.trace)

    def __len__(self) -> int:
        return len(self.trace)

    def flow(self, i: int) -> Array:
        """Map over segment i, its end left out."""
        return self.flows(i, 1)[0]

    def flows(self, i: int, parts: int) -> list[Array]:
        """Maps over so many equal ``parts`` of segment i, one after another, its end left out."""
        what, duration = self.trace[i, layout.WHAT], float(self.trace[i, layout.DURATION]) / parts
        if what == layout.RESTING:
            return [np.asarray(_exponential(self._held * duration)) @ self.projection()] * parts
        if what != regime_layout.CONTACT:
            return [self._free(i, duration, parts)] * parts
        if self.system.contact_law.integrated:
            return variations(self.system, self.drive, self.trace[i], self.poses[i], int(self.sides[i]), parts)
        return [_exponential(self._pushed(self.sides[i]) * duration)] * parts

    def over(self, i: int) -> Array:
        """Map over segment i and its end."""
        flow, jump = self.flow(i), self.jump(i)
        return flow if jump is None else np.asarray(jump @ flow)

    def steps(self, i: int, rate: float, decay: float) -> list[Array]:
        """The same in factors, over none of which anything that decays at ``rate`` 1/s loses more than ``decay``."""
        parts = max(1, int(np.ceil(rate * float(self.trace[i, layout.DURATION]) / decay)))
        *flows, last = self.flows(i, parts)
        jump = self.jump(i)
        return [*flows, last if jump is None else np.asarray(jump @ last)]

    @cached_property
    def fastest(self) -> float:
        """Fastest decay of the free modes, 1/s."""
        return float(-np.linalg.eigvals(state_matrix(self.system)).real.min())

    def jump(self, i: int) -> Array | None:
        """Map over the event that ends segment i; None where that is the identity."""
        end = int(self.trace[i, layout.END])
        if end in (layout.CHATTER, layout.STUCK):
            return self.projection()
        if end != layout.IMPACT or not self.trace[i, layout.BEFORE] > 0:
            return None
        if self.system.contact_law.integrated:
            return None
        return self._entry(i) if self.system.contact_law.yields else self._saltation(i)

    def lost(self, i: int) -> int:
        """Number of directions that are lost, at least, in segment i and at its end."""
        if self.trace[i, layout.WHAT] == layout.RESTING or self.trace[i, layout.END] in (layout.CHATTER, layout.STUCK):
            return LOST_AT_REST
        struck = self.trace[i, layout.END] == layout.IMPACT and self.trace[i, layout.BEFORE] > 0
        return int(struck and not self.system.contact_law.yields and self._restitution[i] == 0)

    def kept(self, i: int) -> Array:
        """Basis (2n, 2n − lost) of the disturbances that are left after segment i and its end."""
        n, c, lost = self.system.size, self.system.contact, self.lost(i)
        across = np.linalg.svd(c[None, :])[2][1:].T
        whole = across if lost == LOST_AT_REST else np.eye(n)
        if not lost:
            return np.eye(2 * n)
        none = np.zeros((n, whole.shape[1]))
        return np.block([[across, none], [np.zeros((n, n - 1)), whole]])

    def acceleration(self, i: int) -> float:
        """The contact's acceleration towards the stop just before the event that ends segment i."""
        return float(self._accelerations[i])

    @cached_property
    def _rows(self) -> Array:
        """Row of the stop of each segment, (m, n)."""
        stops = [stop_of(self.system, side).row for side in range(1 if self.system.second_gap is None else 2)]
        return np.array(stops)[self.sides]

    @cached_property
    def _accelerations(self) -> Array:
        """Accelerations of the contact towards its stop at the ends of the segments, (m,)."""
        system, trace, rows = self.system, self.trace, self._rows
        velocity = (
            self.ends[:, 1]
            + rows * ((trace[:, layout.BEFORE] - _dots(rows, self.ends[:, 1])) / _dots(rows, rows))[:, None]
        )
        phase = self.drive.omega * (trace[:, layout.AT_CLOCK] + trace[:, layout.DURATION])
        push = np.outer(self.drive.omega**2 * self.drive.amplitude * np.sin(phase), system.load) + system.static
        return _dots(rows, push - self._damped(velocity) - system.omega**2 * self.ends[:, 0])

    def projection(self) -> Array:
        """Displacement and velocity of the contact point taken out."""
        c = self.system.contact
        still = np.eye(self.system.size) - np.outer(c, c) / (c @ c)
        return np.asarray(np.kron(np.eye(2), still), dtype=float)

    def _damped(self, velocity: Array) -> Array:
        if self.system.coupling is None:
            return np.asarray(2 * self.system.zeta * self.system.omega * velocity)
        return np.asarray((self.system.coupling @ velocity[..., None])[..., 0])

    def _free(self, i: int, duration: float, parts: int) -> Array:
        if self.system.coupling is not None:
            return _exponential(state_matrix(self.system) * duration)
        p = self._flights
        if parts > 1:
            p, i = propagators(self.system.omega, self.system.zeta, np.array([duration])), 0
        matrix, mode = np.zeros((2, self.system.size, 2, self.system.size)), np.arange(self.system.size)
        matrix[:, mode, :, mode] = np.array([[p.p00[i], p.p01[i]], [p.p10[i], p.p11[i]]]).transpose(2, 0, 1)
        return matrix.reshape(2 * self.system.size, -1)

    @cached_property
    def _flights(self) -> Pair:
        durations = np.ascontiguousarray(self.trace[:, layout.DURATION])
        return propagators(self.system.omega, self.system.zeta, durations)

    @cached_property
    def _held(self) -> Array:
        """State matrix while the contact is held: accelerations without their part along its row."""
        n, c, matrix = self.system.size, self.system.contact, state_matrix(self.system)
        matrix[n:] -= np.outer(c, c @ matrix[n:]) / (c @ c)
        return matrix

    def _pushed(self, side: int) -> Array:
        """State matrix while a linear stop pushes."""
        spring, n, row = self.system.contact_law.spring, self.system.size, stop_of(self.system, side).row
        assert spring is not None
        matrix = state_matrix(self.system)
        matrix[n:, :n] -= spring.stiffness * np.outer(row, row)
        matrix[n:, n:] -= spring.damping * np.outer(row, row)
        return matrix

    def _entry(self, i: int) -> Array:
        spring, n, row = self.system.contact_law.spring, self.system.size, stop_of(self.system, self.sides[i]).row
        assert spring is not None
        matrix = np.eye(2 * n)
        matrix[n:, :n] -= spring.damping * np.outer(row, row)
        return matrix

    @cached_property
    def _speeds(self) -> Array:
        """Speeds of the impacts that end the segments, (m,); 1 where none does."""
        speeds = self.trace[:, layout.BEFORE]
        return np.where(speeds > 0, speeds, 1.0)

    @cached_property
    def _restitution(self) -> Array:
        return np.asarray(self.system.contact_law.rebound(self._speeds) / self._speeds)

    @cached_property
    def _shares(self) -> Array:
        """(1 + R)/S, (1 + ρ')/S and a/v of the impacts that end the segments, (3, m)."""
        turned, struck = 1 + self._restitution, 1 + self.system.contact_law.rebound_slope(self._speeds)
        mobility = _dots(self._rows, self._rows)
        return np.array([turned / mobility, struck / mobility, self._accelerations / self._speeds])

    def _saltation(self, i: int) -> Array:
        n, row, (turned, struck, lean) = self.system.size, self._rows[i], self._shares[:, i].tolist()
        matrix, square = np.eye(2 * n), np.outer(row, row)
        matrix[:n, :n] -= turned * square
        matrix[n:, n:] -= struck * square
        matrix[n:, :n] = np.outer(turned * self._damped(row) + struck * lean * row, row)
        return matrix


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


def _exponential(matrix: Array) -> Array:
    from scipy.linalg import expm

    return np.asarray(expm(matrix))
