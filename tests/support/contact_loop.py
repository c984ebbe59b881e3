"""Several rigid contacts by plain integration, an independent reference: it shares no code and no method with vibeam.

Between events scipy's DOP853 integrates M = 1 coordinates under Lagrange multipliers; which contacts are held is found
by trying every subset; impulses are dealt out one at a time. An accumulation of impacts is cut off at a velocity.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

import numpy as np
from bounded import Bound
from scipy.integrate import solve_ivp

from vibeam_models.arrays import Array


@dataclass
class Rig:
    """x'' + D x' + K x = load · strength sin Ωt + static, rows · x ≤ gaps."""

    K: Array
    D: Array
    load: Array
    static: Array
    rows: Array
    gaps: Array
    restitutions: Array
    omega: float
    strength: float
    slow: float = 1e-6  # velocity below which a contact stays
    hits: list[tuple[float, int, float]] = field(default_factory=list)
    releases: list[tuple[float, int]] = field(default_factory=list)

    def free(self, t: float, x: Array, v: Array) -> Array:
        """Acceleration without contacts."""
        return self.load * self.strength * np.sin(self.omega * t) + self.static - self.D @ v - self.K @ x

    def forces(self, t: float, x: Array, v: Array, held: tuple[int, ...]) -> Array:
        """Forces of the held contacts."""
        w = self.rows[list(held)]
        return np.linalg.solve(w @ w.T, w @ self.free(t, x, v))

    def acceleration(self, t: float, x: Array, v: Array, held: tuple[int, ...]) -> Array:
        """Acceleration with the contacts held."""
        a = self.free(t, x, v)
        return a - self.forces(t, x, v, held) @ self.rows[list(held)] if held else a

    def choose(self, t: float, x: Array, v: Array, at_rest: list[int]) -> tuple[int, ...]:
        """The subset with forces that push and accelerations that do not enter."""
        best, worst = (), np.inf
        for size in range(len(at_rest) + 1):
            for held in combinations(at_rest, size):
                force = self.forces(t, x, v, held) if held else np.zeros(0)
                a = self.rows @ self.acceleration(t, x, v, held)
                wrong = max([*(-force), *(a[j] for j in at_rest if j not in held), 0.0])
                if wrong < worst - 1e-12:
                    best, worst = held, wrong
        return best

    def struck(self, t: float, v: Array, at: list[int], pressed: list[int]) -> Array:
        """Velocities after all impulses of one instant."""
        pressed, first = list(pressed), max(float(np.max(self.rows[at] @ v)), 0.0)
        for _ in range(10_000):
            speeds = {j: float(self.rows[j] @ v) for j in at if j not in pressed}
            j = max(speeds, key=lambda each: (speeds[each], -each), default=-1)
            if j < 0 or speeds[j] <= 1e-12 * first or speeds[j] <= 0:
                return v
            answer = self._answer(j, pressed)
            self.hits.append((t, j, speeds[j]))
            v = v - answer * ((1 + self.restitutions[j]) * speeds[j] / float(self.rows[j] @ answer))
            pressed = [h for h in pressed if float(self.rows[h] @ answer) <= 1e-12]
        raise AssertionError("impulses of one instant without end")

    def _answer(self, j: int, pressed: list[int]) -> Array:
        """Direction of the velocity jump: the held contacts that are pressed stay."""
        for size in range(len(pressed), -1, -1):
            for held in combinations(pressed, size):
                w = self.rows[list(held)]
                share = np.linalg.solve(w @ w.T, -w @ self.rows[j]) if held else np.zeros(0)
                answer = self.rows[j] + (share @ w if held else 0.0)
                if np.all(share >= 0) and all(float(self.rows[h] @ answer) >= -1e-12 for h in pressed):
                    return np.asarray(answer)
        raise AssertionError

    def run(self, x: Array, v: Array, end: float) -> tuple[Array, Array]:
        """The state at ``end``."""
        t, held, brief = 0.0, tuple[int, ...](), np.inf
        within = Bound()
        while within(t < end):
            leg = min(end, t + 2 * brief)  # the next impact may come soon: short steps at first
            t, x, v, which = self._fly(t, x, v, held, leg, min(0.002, brief / 4))
            brief = np.inf
            if which is None:
                continue
            open_ = [j for j in range(len(self.gaps)) if j not in held]
            if which < len(open_):
                at = sorted({*held, open_[which]})
                v = self._slowed(self.struck(t, v, at, list(held)), at)
            else:
                at = [j for j in held if j != held[which - len(open_)]]
                self.releases.append((t, held[which - len(open_)]))
            held = self.choose(t, x, v, [j for j in at if abs(float(self.rows[j] @ v)) < self.slow])
            a = self.rows @ self.acceleration(t, x, v, held)
            brief = min((-2 * float(self.rows[j] @ v) / a[j] for j in at if j not in held and a[j] > 0), default=np.inf)
        return x, v

    def _slowed(self, v: Array, at: list[int]) -> Array:
        """The velocities without those at contacts that are next to none."""
        for j in at:
            if 0 < -float(self.rows[j] @ v) < self.slow:
                v = v - self.rows[j] * float(self.rows[j] @ v) / float(self.rows[j] @ self.rows[j])
        return v

    def _fly(
        self, t: float, x: Array, v: Array, held: tuple[int, ...], end: float, step: float
    ) -> tuple[float, Array, Array, int | None]:
        """To the first event or to ``end``: which one, of the gaps of open contacts and the forces of held ones."""
        n = len(x)

        def flow(s: float, y: Array) -> Array:
            return np.concatenate([y[n:], self.acceleration(s, y[:n], y[n:], held)])

        events: list[Any] = [
            lambda s, y, j=j: self.gaps[j] - self.rows[j] @ y[:n] for j in range(len(self.gaps)) if j not in held
        ]
        events += [lambda s, y, i=i: self.forces(s, y[:n], y[n:], held)[i] for i in range(len(held))]
        for event in events:
            event.terminal, event.direction = True, -1
        found = solve_ivp(
            flow, (t, end), np.concatenate([x, v]), "DOP853", events=events, rtol=1e-12, atol=1e-16, max_step=step
        )
        y = found.y[:, -1]
        which = next((i for i, times in enumerate(found.t_events) if len(times)), None)
        return float(found.t[-1]), y[:n].copy(), y[n:].copy(), which
