"""Flights among several contacts anew, in any number of digits: rigid stops in turn, linear ones beside them.

Each set of linear stops that push makes y' = A y + f + g sin Ωt, y = (η, η'): eigenvalues of A by mpmath, every signal
a sum of exponentials. Its first root is bracketed by doubles on a fine grid and found by bisection in all digits.
Contacts that are held are not known here: motions that come to that are left out. Nothing is shared with the solvers.
"""

from __future__ import annotations

from typing import Any

import mpmath as mp
import numpy as np

PLACES = 60  # of the grid in a turn of the fastest pair
MOST = 400  # events


class Linear:
    """y' = A y + f + g sin Ωt with some linear stops pushing, from a state at a time."""

    def __init__(self, rig: Any, pushing: frozenset[int]) -> None:
        n = len(rig.omega)
        A, f, g = mp.zeros(2 * n), mp.zeros(2 * n, 1), mp.zeros(2 * n, 1)
        for i in range(n):
            A[i, n + i], A[n + i, i], A[n + i, n + i] = 1, -(rig.omega[i] ** 2), -2 * rig.zeta[i] * rig.omega[i]
            f[n + i], g[n + i] = rig.static[i], rig.load[i] * rig.drive**2 * rig.amplitude
            for j in pushing:
                stiffness, damping = rig.springs[j]
                f[n + i] += rig.rows[j][i] * stiffness * rig.gaps[j]
                for k in range(n):
                    A[n + i, k] -= stiffness * rig.rows[j][i] * rig.rows[j][k]
                    A[n + i, n + k] -= damping * rig.rows[j][i] * rig.rows[j][k]
        self.values, self.vectors = mp.eig(A)
        self.inverse, self.drive = self.vectors**-1, rig.drive
        self.phasor = mp.lu_solve(mp.mpc(0, 1) * rig.drive * mp.eye(2 * n) - A, g)
        self.offset = mp.lu_solve(-A, f)

    def enter(self, state: Any, time: Any) -> None:
        """Start from a state at a time."""
        turn = mp.expjpi(self.drive * time / mp.pi)
        left = state - self.offset - (self.phasor * turn).apply(mp.im)
        self.time, self.left = time, self.inverse * left

    def at(self, after: Any) -> Any:
        """State a time later."""
        turn = mp.expjpi(self.drive * (self.time + after) / mp.pi)
        grown = mp.matrix([c * mp.exp(v * after) for c, v in zip(self.left, self.values, strict=True)])
        return (self.vectors * grown).apply(mp.re) + self.offset + (self.phasor * turn).apply(mp.im)

    def grid(self, after: Any) -> Any:
        """States (m, 2n) in doubles at times (m,) later."""
        values, left = np.array(self.values, dtype=complex), np.array(list(self.left), dtype=complex)
        vectors = np.array(self.vectors.tolist(), dtype=complex)
        phasor = np.array(list(self.phasor), dtype=complex)
        free = ((np.exp(np.outer(after, values)) * left) @ vectors.T).real
        turn = np.exp(1j * float(self.drive) * (float(self.time) + after))
        return free + np.array(list(self.offset), dtype=float) + (turn[:, None] * phasor).imag


class ContactRig:
    """Modes with k contacts: rigid with a coefficient of restitution, or linear with stiffness and damping."""

    def __init__(self, system: Any, drive: Any) -> None:
        """``system``: of vibeam, read for its numbers alone."""
        own = [system, *system.further]
        laws = [each.contact_law.spring for each in own]
        self.omega, self.zeta, self.load, self.static = (
            [mp.mpf(x) for x in row] for row in (system.omega, system.zeta, system.load, system.static)
        )
        self.rows = [[mp.mpf(x) for x in row] for row in [system.contact, *(each.row for each in system.further)]]
        self.gaps = [mp.mpf(each.gap) for each in own]
        self.restitution = [mp.mpf(each.restitution) for each in own]
        self.springs = [None if law is None else (mp.mpf(law.stiffness), mp.mpf(law.damping)) for law in laws]
        self.drive, self.amplitude = mp.mpf(drive.omega), mp.mpf(drive.amplitude)
        self.made: dict[frozenset[int], Linear] = {}

    def fly(self, end: float) -> tuple[list[tuple[Any, int, Any]], Any]:
        """Impacts and entries (time, contact, velocity before) from rest at zero, and the state at the end."""
        n, hits = len(self.omega), []
        time, state, pushing, inside = mp.mpf(0), mp.zeros(2 * n, 1), frozenset[int](), frozenset[int]()
        for _ in range(MOST):
            if pushing not in self.made:
                self.made[pushing] = Linear(self, pushing)
            flow = self.made[pushing]
            flow.enter(state, time)
            met, after = self.first(flow, pushing, inside, mp.mpf(end) - time)
            state, time = flow.at(after), time + after
            if met is None:
                return hits, state
            speed = self.rate(met, state)
            if met in pushing:
                pushing, inside = pushing - {met}, inside | ({met} if self.springs[met][1] > 0 else frozenset())
            elif met in inside:
                inside -= {met}
            elif self.springs[met] is not None:
                hits.append((time, met, speed))
                pushing |= {met}
            else:
                hits += [(time, *each) for each in self.strike(state, pushing, met)]
        raise ValueError("too many events")

    def rate(self, j: int, state: Any) -> Any:
        """Velocity toward the stop."""
        return sum(w * state[len(self.omega) + i] for i, w in enumerate(self.rows[j]))

    def signal(self, j: int, state: Any, pushing: frozenset[int], inside: frozenset[int]) -> Any:
        """The force of a stop that pushes, the penetration of one that does not push yet or no more, else the gap."""
        deep = sum(w * state[i] for i, w in enumerate(self.rows[j])) - self.gaps[j]
        if j in pushing:
            return self.springs[j][0] * deep + self.springs[j][1] * self.rate(j, state)
        return deep if j in inside else -deep

    def first(self, flow: Linear, pushing: Any, inside: Any, span: Any) -> tuple[int | None, Any]:
        """The first contact whose signal passes zero, and when."""
        fastest = max(abs(v) for v in flow.values)
        places = np.linspace(0, float(span), max(4, int(PLACES * float(fastest * span) / 6.28)))
        states, n, best = flow.grid(places), len(self.omega), (None, span)
        for j in range(len(self.rows)):
            row = np.array(self.rows[j], dtype=float)
            deep, rate = states[:, :n] @ row - float(self.gaps[j]), states[:, n:] @ row
            value = -deep
            if j in pushing:
                value = float(self.springs[j][0]) * deep + float(self.springs[j][1]) * rate
            elif j in inside:
                value = deep
            slope = np.gradient(value, places)
            dips = (slope[:-1] < 0) & (slope[1:] > 0) & (np.minimum(value[:-1], value[1:]) < 1e-3 * np.abs(value).max())
            crossed = np.flatnonzero(((value[:-1] > 0) & (value[1:] <= 0)) | (dips & (value[1:] < 0)))
            crossed = crossed[crossed > 0] if abs(value[0]) < 1e-12 * np.abs(value).max() else crossed
            if len(crossed) and places[crossed[0]] < best[1]:
                low, high = mp.mpf(places[crossed[0]]), mp.mpf(places[crossed[0] + 1])
                for _ in range(int(3.4 * mp.mp.dps) + 10):
                    middle = (low + high) / 2
                    below = self.signal(j, flow.at(middle), pushing, inside) <= 0
                    low, high = (low, middle) if below else (middle, high)
                best = (j, high) if high < best[1] else best
        return best

    def strike(self, state: Any, pushing: Any, met: int) -> list[tuple[int, Any]]:
        """Impulses in turn, the fastest first, at the rigid contact met."""
        n, found = len(self.omega), []
        touched = [
            j
            for j in range(len(self.rows))
            if self.springs[j] is None
            and abs(self.signal(j, state, pushing, frozenset())) < mp.mpf(10) ** (-mp.mp.dps / 2)
        ]
        if met not in touched:
            raise ValueError("the contact met is not at its stop")
        while True:
            speeds = [self.rate(j, state) for j in touched]
            fastest = max(range(len(touched)), key=lambda i: speeds[i])
            if speeds[fastest] <= mp.mpf(10) ** (-mp.mp.dps / 2):
                return found
            j, speed = touched[fastest], speeds[fastest]
            mobility = sum(w * w for w in self.rows[j])
            for i, w in enumerate(self.rows[j]):
                state[n + i] -= w * (1 + self.restitution[j]) * speed / mobility
            found.append((j, speed))
