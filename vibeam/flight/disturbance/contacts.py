"""Tangent maps of motions with several contacts, as ``tangent`` has them for one.

Over a segment with rows W held a disturbance obeys δη'' = P (−K δη − D δη'), P = 1 − Wᵀ(W Wᵀ)⁻¹ W, linear stops that
push in K and D. At the root of a gap w, with velocity v = w·η' and the accelerations a⁻, a⁺ before and after,

    δt = −(w·δη⁻)/v,    δη⁺ = δη⁻ + (η'⁻ − η'⁺) δt,    δη'⁺ = G (δη'⁻ + a⁻ δt) − a⁺ δt

where G = 1 − (1 + ρ') d wᵀ/(w·d) of an impact, ρ(v) = R(v) v, d the direction in which held contacts let the struck one
go; of several impulses in one instant G is their product, in the order in which they were. Where contacts are held
after an impact their displacement and velocity end at their stops, but for the damping of the way that they have gone:
δη⁺ = P δη⁻, δη'⁺ = P (G δη'⁻ + D Wᵀ(W Wᵀ)⁻¹ W δη⁻). Where a force vanishes nothing jumps.

Instants in which another order of impulses is as near are corners of the motion: there the maps are those of the order
that was.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from vibeam.flight.contacts.readout import keys_of
from vibeam.flight.contacts.sets import ConstrainedSystem, ContactSet
from vibeam.flight.disturbance.tangent import TangentMaps, state_matrix
from vibeam.flight.equilibrium import Contacts, multipliers, one_sided
from vibeam.flight.event_driven import Segments
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.contacts.layout import MET_AT
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.readout import STRUCK, sides
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array

NEAR = 1e-4  # |σ² − ω²| t² below which a pair is next to critical damping


class ContactMaps(TangentMaps):
    """Tangent maps (2n, 2n) on (η, η') of the segments of a motion with several contacts."""

    def __init__(self, system: ImpactSystem, drive: Drive, segments: Segments, state: State) -> None:
        """``state``: at the end."""
        self.system, self.drive, self.contacts = system, drive, Contacts.of(system)
        self.trace, self.poses = segments.trace, segments.poses
        last = np.stack([state.displacement, state.velocity])
        self.ends = np.concatenate([self.poses[1:], last[None]])
        self.struck = sides(self.trace)
        self._keys, self._made = keys_of(self.trace, len(self.contacts.gaps)), dict[int, _Set]()

    def carried(self, columns: Array, first: int = 0, last: int | None = None) -> Array:
        """Disturbances (2n, c) from the begin of segment ``first`` carried to that of ``last``; None: to the end."""
        frame = np.array(columns, dtype=float)
        for i in range(first, len(self) if last is None else last):
            frame = self.over(i) @ frame
        return frame

    def over(self, i: int) -> Array:
        """Map over segment i and its end."""
        flow, jump = self.flow(i), self.jump(i)
        return flow if jump is None else np.asarray(jump @ flow)

    def flow(self, i: int) -> Array:
        """Map over segment i, its end left out."""
        duration = float(self.trace[i, layout.DURATION])
        return np.eye(2 * self.system.size) if duration == 0 else self._set(i).flow(duration)

    def steps(self, i: int, rate: float, decay: float) -> list[Array]:
        """The same and its end in factors, over none of which what decays at ``rate`` 1/s loses more than ``decay``."""
        duration = float(self.trace[i, layout.DURATION])
        parts = max(1, int(np.ceil(rate * duration / decay)))
        flow, jump = self._set(i).flow(duration / parts), self.jump(i)
        return [flow] * (parts - 1) + [flow if jump is None else np.asarray(jump @ flow)]

    @cached_property
    def fastest(self) -> float:
        """Fastest decay of the free modes, 1/s."""
        return float(-np.linalg.eigvals(state_matrix(self.system)).real.min())

    def jump(self, i: int) -> Array | None:
        """Map over the event that ends segment i, of an instant with several impulses over all; None: the identity."""
        met, n = int(self.trace[i, MET_AT]), self.system.size
        if not 0 <= met < len(self.contacts.gaps) or self.trace[i, layout.END] == layout.SPAN_END:
            return None
        last, turn, before = self._instant(i)
        speed = float(self.contacts.rows[met] @ before)
        after = self._set(last + 1) if last + 1 < len(self) else self._set(last)
        held = self.contacts.rows[list(after.held)] if self._stays(last) else np.zeros((0, n))
        if speed <= 0 or len(held):
            return self._onto(held, turn) if len(held) else None
        clock = self.trace[i, layout.AT_CLOCK] + self.trace[i, layout.DURATION]
        first, then = np.array([self.ends[i][0], before]), self.ends[last]
        late = -self.contacts.rows[met] / speed
        matrix = np.eye(2 * n)
        matrix[:n, :n] += np.outer(before - then[1], late)
        matrix[n:, n:] = turn
        change = turn @ self._set(i).acceleration(self.drive, first, clock)
        matrix[n:, :n] = np.outer(change - after.acceleration(self.drive, then, clock), late)
        return matrix

    def lost(self, i: int) -> int:
        """Number of directions that are lost, at least, in segment i and at its end."""
        return int(2 * self.system.size - self.kept(i).shape[1])

    def kept(self, i: int) -> Array:
        """Basis (2n, 2n − lost) of the disturbances that are left after segment i and its end."""
        still = i + 1 < len(self) and self._stays(i)
        held = self._set(i + 1 if still else i).held
        if not held:
            return np.eye(2 * self.system.size)
        rows = self.contacts.rows[list(held)]
        _, sizes, turned = np.linalg.svd(rows)
        across = turned[int(np.sum(sizes > 1e-10 * sizes[0])) :].T
        return np.asarray(np.kron(np.eye(2), across))

    def readings(self, i: int) -> tuple[Array, Array]:
        """Rows (2n,) that read time and velocity of the impulse that ends segment i off the disturbance before.

        That is the one before the whole instant; zero where its contact was not met with a velocity.
        """
        n, first = self.system.size, i
        while first > 0 and self.trace[first, layout.DURATION] == 0 and self.trace[first, MET_AT] < 0:
            first -= 1
        met, clock = int(self.trace[first, MET_AT]), self.trace[first, [layout.AT_CLOCK, layout.DURATION]].sum()
        _, _, before = self._instant(first)
        turn = self._instant(first, i)[1]
        speed = float(self.contacts.rows[met] @ before) if 0 <= met < len(self.contacts.gaps) else 0.0
        late = np.concatenate([-self.contacts.rows[met] / speed, np.zeros(n)]) if speed > 0 else np.zeros(2 * n)
        pull = self._set(first).acceleration(self.drive, np.array([self.ends[first][0], before]), clock)
        row = self.contacts.rows[self.struck[i]] @ turn
        return late, np.concatenate([np.zeros(n), row]) + float(row @ pull) * late

    def _set(self, i: int) -> _Set:
        key = int(self._keys[i])
        if key not in self._made:
            self._made[key] = _Set(self.contacts, key)
        return self._made[key]

    def _stays(self, i: int) -> bool:
        """True where an impulse leaves its contact held."""
        return int(self.trace[i, layout.END]) in (layout.CHATTER, layout.STUCK)

    def _instant(self, i: int, until: int | None = None) -> tuple[int, Array, Array]:
        """Last segment of the instant that segment i ends in, G of its impulses, all velocities before them.

        ``until``: G of the impulses before the one that ends that segment.
        """
        turn, before, last = np.eye(self.system.size), self.ends[i][1], i
        pressed: list[int] = list(self._set(i).held)
        for at in range(i, len(self)):
            rigid = not self.contacts.laws[self.struck[at]].yields
            if at == until or (at > i and (self.trace[at, layout.DURATION] > 0 or self.trace[at, MET_AT] >= 0)):
                break
            if int(self.trace[at, layout.END]) not in STRUCK or not rigid:
                break
            j, speed, last = int(self.struck[at]), float(self.trace[at, layout.BEFORE]), at
            direction, pressed = self._direction(j, pressed)
            along = float(self.contacts.rows[j] @ direction)
            law = self.contacts.laws[j]
            if at == i:
                back = speed + float(law.rebound(np.array([speed]))[0])
                before = self.ends[i][1] + direction * (back / along)
            slope = 1 + float(law.rebound_slope(np.array([speed]))[0])
            turn = turn - np.outer(direction, self.contacts.rows[j] @ turn) * (slope / along)
        return last, turn, before

    def _direction(self, j: int, pressed: list[int]) -> tuple[Array, list[int]]:
        """Change of the velocities by a unit impulse at contact j, less sign; those that it still presses."""
        row = self.contacts.rows[j]
        others = [each for each in pressed if each != j]
        if not others:
            return row, []
        answers = one_sided(self.contacts.rows[others], -row)
        kept = [each for each, answer in zip(others, answers, strict=True) if answer > 0]
        return np.asarray(row + answers @ self.contacts.rows[others]), kept

    def _onto(self, held: Array, turn: Array) -> Array:
        """Map onto motions with these rows held, after impulses of ``turn``."""
        n, each = self.system.size, multipliers(held)
        free = np.eye(n) - each.T @ held
        matrix = np.zeros((2 * n, 2 * n))
        matrix[:n, :n], matrix[n:, n:] = free, free @ turn
        matrix[n:, :n] = free @ self.contacts.damper @ each.T @ held
        return matrix


class _Set:
    """Linear motion of disturbances in one set of contacts."""

    def __init__(self, contacts: Contacts, key: int) -> None:
        which = ContactSet.of(key, len(contacts.gaps))
        self.system, self.held, n = ConstrainedSystem(contacts, which), which.held, contacts.system.size
        rows = contacts.rows[list(which.held)]
        self.free = np.eye(n) - multipliers(rows).T @ rows if len(rows) else np.eye(n)

    def flow(self, duration: float) -> Array:
        """Map over so much time: block by block e^{At} = e^{−σt} (C + S (A + σ)), C and S as in the kernels."""
        pairs, blocks, t = self._regime.pairs, self._regime.blocks, duration
        sigma, disc = pairs[layout.SIGMA], pairs[layout.DISC]
        root = np.sqrt(np.abs(disc))
        slow, fast = np.exp(-pairs[layout.DECAY] * t), np.exp(-(sigma + root) * t)
        turning, small = np.exp(-sigma * t), np.abs(disc) * t * t < NEAR
        even = np.where(disc < 0, turning * np.cos(root * t), (slow + fast) / 2)
        apart = np.where(small, 1.0, root)
        odd = np.where(disc < 0, turning * np.sin(root * t), (slow - fast) / 2) / apart
        odd = np.where(small, turning * t * (1 + disc * t * t / 6 * (1 + disc * t * t / 20)), odd)
        first, second = self._regime.into[0::2], self._regime.into[1::2]
        whole, into = np.empty_like(self._regime.into), [(each * sigma[:, None]) for each in (first, second)]
        along = blocks[layout.A11][:, None] * first + blocks[layout.A12][:, None] * second + into[0]
        across = blocks[layout.A21][:, None] * first + blocks[layout.A22][:, None] * second + into[1]
        whole[0::2] = even[:, None] * first + odd[:, None] * along
        whole[1::2] = even[:, None] * second + odd[:, None] * across
        return np.asarray(self._regime.outof @ whole)

    @cached_property
    def _regime(self) -> Regime:
        return self.system.regime(0)

    def acceleration(self, drive: Drive, pose: Array, clock: float) -> Array:
        """Acceleration of all modes (n,)."""
        base = drive.omega**2 * drive.amplitude * np.sin(drive.omega * clock)
        pull = self.system.contacts.system.load * base + self.system.static
        return np.asarray(self.free @ (pull - self.system.damper @ pose[1] - self.system.stiffness @ pose[0]))
