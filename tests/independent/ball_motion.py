"""The motion of an ``ImpactSystem`` in one regime, in ball arithmetic, from its equations alone.

    η'' + D η' + Λ η = load Ω²B sin φ + static + reaction

Flight of modes by themselves: every mode in closed form. Everything else (damping that couples the modes, the push of
a linear stop, rest on a hard one) as one linear system y' = A y + constant + forced sin φ, by the eigenvalues of A,
which python-flint encloses. Pushed by stop c·η = Δ the reaction is −c (k d + b d'), d = c·η − Δ; held on it, the
reaction is −c F with F = c·(load Ω²B sin φ + static − D η' − Λ η)/S, and the mode of the largest c follows from the
others.
"""

from __future__ import annotations

import numpy as np
from ball_signal import Signal
from flint import acb, acb_mat, arb

FLIGHT, REST, PUSH, RETREAT = 0, 1, 2, 3  # kinds of a segment


class Equations:
    """The numbers of a system under a drive, as balls; regimes are solved once."""

    def __init__(self, system, drive):
        self.n, self.w = system.size, arb(drive.omega)
        self.turn = acb(0, self.w)
        self.strength = self.w * self.w * arb(drive.amplitude)
        self.omega, self.zeta = balls(system.omega), balls(system.zeta)
        self.load, self.static = balls(system.load), balls(system.static)
        self.stops = [(balls(system.contact), arb(system.gap))]
        if system.second_gap is not None:
            self.stops.append((balls(-system.contact), arb(system.second_gap)))
        self.mobility = sum((c * c for c in self.stops[0][0]), arb(0))
        self.coupled = system.coupling is not None
        if self.coupled:
            self.damper = [balls(row) for row in system.coupling]
        else:
            diagonal = [2 * z * o for z, o in zip(self.zeta, self.omega, strict=True)]
            self.damper = [[d if i == k else arb(0) for k in range(self.n)] for i, d in enumerate(diagonal)]
        self.spring, self.damping = arb(getattr(system.law, "stiffness", 0)), arb(getattr(system.law, "damping", 0))
        self._solved = {}

    def motion(self, kind, side, pose, clock):
        """η (n signals) from a state (2, n) of doubles at a drive time."""
        if kind in (FLIGHT, RETREAT) and not self.coupled:
            phase = self.w * arb(clock)
            return [mode_signal(self, k, arb(pose[0, k]), arb(pose[1, k]), phase) for k in range(self.n)]
        regime = (kind, side) if kind in (REST, PUSH) else (FLIGHT, 0)
        if regime not in self._solved:
            self._solved[regime] = Linear(self, *regime)
        return self._solved[regime].motion(pose, self.w * arb(clock))

    def gap(self, motion, side):
        """Δ − c·η."""
        row, gap = self.stops[side]
        found = Signal(gap)
        for c, x in zip(row, motion, strict=True):
            found.add(-c, x)
        return found

    def force(self, motion, side, kind, clock):
        """The force of a stop that holds; or with which it pushes, or would."""
        row, gap = self.stops[side]
        if kind != REST:
            found = Signal(-self.spring * gap)
            for c, x in zip(row, motion, strict=True):
                found.add(c * self.spring, x)
                found.add(c * self.damping, x.rate())
            return found
        found = Signal(sum((c * s for c, s in zip(row, self.static, strict=True)), arb(0)) / self.mobility)
        along = sum((c * x for c, x in zip(row, self.load, strict=True)), arb(0)) * self.strength / self.mobility
        if along != 0:
            found.waves.append((along * sine(self.w * arb(clock)), self.turn))
        for k, x in enumerate(motion):
            braked = sum((row[i] * self.damper[i][k] for i in range(self.n)), arb(0))
            found.add(-braked / self.mobility, x.rate())
            found.add(-row[k] * self.omega[k] ** 2 / self.mobility, x)
        return found


def balls(values):
    """Doubles as balls, to the bit."""
    return [arb(float(value)) for value in values]


def sine(phase):
    """The phasor C with Re(C e^{iwt}) = sin(phase + wt)."""
    return acb(phase.cos(), phase.sin()) * acb(0, -1)


def mode_signal(own, k, x0, v0, phase):
    """One mode by itself: x'' + 2ζω x' + ω² x = force sin(phase + wt) + static."""
    omega, zeta, found = own.omega[k], own.zeta[k], Signal()
    sigma, force, static = zeta * omega, own.load[k] * own.strength, own.static[k]
    if omega == 0:
        found.bend += static / 2
    elif static != 0:
        found.constant += static / omega**2
        x0 -= static / omega**2
    if force != 0:
        lam = own.turn
        if sigma == 0 and omega == own.w:
            part = sine(phase) * force / (2 * lam)  # t e^{iwt}: resonance
            found.ramps.append((part, lam))
            v0 -= part.real
        else:
            part = sine(phase) * force / (acb(omega**2 - own.w**2) + 2 * sigma * lam)
            found.waves.append((part, lam))
            x0, v0 = x0 - part.real, v0 - (part * lam).real
    if omega == 0:
        found.constant += x0
        found.slope += v0
    elif zeta == 1:
        found.waves.append((acb(x0), acb(-sigma)))
        found.ramps.append((acb(v0 + sigma * x0), acb(-sigma)))
    else:
        root = acb(omega**2 * (zeta - 1) * (zeta + 1)).sqrt()
        first, second = -sigma + root, -sigma - root
        share = (v0 - second * x0) / (first - second)
        if zeta < 1:
            found.waves.append((2 * share, first))  # the other one's conjugate
        else:
            found.waves += [(share, first), (x0 - share, second)]
    return found


class Linear:
    """One regime as y' = A y + constant + forced sin φ, y the displacements and velocities that are free."""

    def __init__(self, own, kind, side):
        self.own, self.kind = own, kind
        self.row, self.stop = own.stops[side]
        pivot = int(np.argmax([abs(float(c.mid())) for c in self.row])) if kind == REST else -1
        self.kept, self.pivot = [k for k in range(own.n) if k != pivot], pivot
        self.rates, self.left, self.right, self.steady, self.turning = [], None, None, [], []
        if self.kept:
            self._solve()

    def _acceleration(self, x, v, at, forced):
        """η'' of displacements and velocities; ``at`` 1: with what is constant, ``forced`` 1: where sin φ is 1."""
        own, row = self.own, self.row
        free = [
            at * own.static[i] + forced * own.load[i] * own.strength - own.omega[i] ** 2 * x[i]
            - sum((own.damper[i][k] * v[k] for k in range(own.n)), arb(0))
            for i in range(own.n)
        ]  # fmt: skip
        if self.kind == REST:
            force = sum((c * f for c, f in zip(row, free, strict=True)), arb(0)) / own.mobility
        elif self.kind == PUSH:
            deep = sum((c * each for c, each in zip(row, x, strict=True)), arb(0)) - at * self.stop
            force = own.spring * deep + own.damping * sum((c * each for c, each in zip(row, v, strict=True)), arb(0))
        else:
            force = arb(0)
        return [f - c * force for f, c in zip(free, row, strict=True)]

    def _whole(self, y, at):
        """All displacements and velocities from those that are kept."""
        m, x, v = len(self.kept), [arb(0)] * self.own.n, [arb(0)] * self.own.n
        for place, k in enumerate(self.kept):
            x[k], v[k] = y[place], y[m + place]
        if self.pivot >= 0:
            own = self.row[self.pivot]
            x[self.pivot] = (at * self.stop - sum((self.row[k] * x[k] for k in self.kept), arb(0))) / own
            v[self.pivot] = -sum((self.row[k] * v[k] for k in self.kept), arb(0)) / own
        return x, v

    def _rate(self, y, at, forced):
        """y' of the kept coordinates."""
        x, v = self._whole(y, at)
        found = self._acceleration(x, v, at, forced)
        return [v[k] for k in self.kept] + [found[k] for k in self.kept]

    def _solve(self):
        """Eigenvalues and vectors, and the steady responses to what is constant and to sin φ."""
        size = 2 * len(self.kept)
        units = [[arb(int(i == j)) for i in range(size)] for j in range(size)]
        columns = [self._rate(unit, 0, 0) for unit in units]
        matrix = acb_mat([[acb(columns[j][i]) for j in range(size)] for i in range(size)])
        nothing = [arb(0)] * size
        constant, forced = self._rate(nothing, 1, 0), self._rate(nothing, 0, 1)
        self.rates, self.left, self.right = matrix.eig(left=True, right=True)
        self.steady = solved(matrix, [-c for c in constant])
        turn = acb_mat([[self.own.turn if i == j else acb(0) for j in range(size)] for i in range(size)])
        self.turning = solved(turn - matrix, forced)

    def motion(self, pose, phase):
        """η (n signals) from a state at a drive phase."""
        m, turn = len(self.kept), sine(phase)
        values = [Signal() for _ in range(self.own.n)]
        if m:
            start = [arb(pose[0, k]) for k in self.kept] + [arb(pose[1, k]) for k in self.kept]
            rest = [
                acb(y) - c - acb((turn * t).real)
                for y, c, t in zip(start, self.steady, self.turning, strict=True)
            ]  # fmt: skip
            shares = self.left * acb_mat([[each] for each in rest])
            for place, k in enumerate(self.kept):
                waves = [(self.right[place, j] * shares[j, 0], rate) for j, rate in enumerate(self.rates)]
                waves = [(2 * c if rate.imag > 0 else c, rate) for c, rate in waves if not rate.imag < 0]
                if self.turning[place] != 0:
                    waves.append((turn * self.turning[place], self.own.turn))
                values[k] = Signal(self.steady[place].real, 0, 0, waves)
        if self.pivot >= 0:
            held = Signal(self.stop / self.row[self.pivot])
            for k in self.kept:
                held.add(-self.row[k] / self.row[self.pivot], values[k])
            values[self.pivot] = held
        return values


def solved(matrix, right):
    """The solution of a linear system; zero where the right side is, whatever the matrix."""
    if all(each == 0 for each in right):
        return [acb(0)] * len(right)
    found = matrix.solve(acb_mat([[acb(each)] for each in right]))
    return [found[i, 0] for i in range(len(right))]
