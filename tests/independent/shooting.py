"""Periodic motions by shooting in 25 digits, with stops of every law: a program of its own.

Flights are closed forms of each mode, x'' + 2ζωx' + ω²x = l Ω²B sin Ωt + s; while a stop is touched the modes are
integrated by Gauss' collocation (Butcher 1964; Hairer, Nørsett & Wanner I, II.7), in steps that double from the touch
and halve towards the release, since the force of Hertz' law is no smooth function there. Newton's method on the states
at one phase of the drive, with differences of whole flights, gives orbit and multipliers.

    python tests/independent/shooting.py        # writes orbits.json, some minutes
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mpmath import mp, mpf

mp.dps = 25
STAGES = 12
SMALL = mpf(10) ** -8  # share of a contact's time that first and last steps take
TINY = mpf(10) ** -12  # step of the differences: central ones, so that 24 digits are left
DEPTH = mpf(2) / 100  # that a power law's step is chosen by
HERE = Path(__file__).parent


@dataclass
class Rig:
    """Modes, drive and stops. ``laws``: "hard" (R), "linear" (k, c), "power" (k, exponent, a of F = kδᵖ(1 + aδ'))."""

    omega: list[Any]
    zeta: list[Any]
    contact: list[Any]
    load: list[Any]
    static: list[Any]
    gap: Any
    law: tuple[Any, ...]
    drive: tuple[Any, Any]  # Ω, B
    second_gap: Any = None
    phase: Any = 0  # drive periods at which states are taken: no stop is touched then
    impacts: list[tuple[Any, Any]] = field(default_factory=list)

    def __post_init__(self) -> None:
        for name in ("omega", "zeta", "contact", "load", "static", "drive"):
            setattr(self, name, [mpf(repr(each)) for each in getattr(self, name)])
        self.gap = mpf(repr(self.gap))
        self.second_gap = None if self.second_gap is None else mpf(repr(self.second_gap))
        self.law = (self.law[0], *(mpf(repr(each)) for each in self.law[1:]))
        self.nodes, self.weights, self.integrals = gauss(STAGES)

    @property
    def period(self) -> Any:
        return 2 * mp.pi / self.drive[0]

    @property
    def sides(self) -> list[tuple[int, Any]]:
        return [(1, self.gap)] + ([] if self.second_gap is None else [(-1, self.second_gap)])

    # flight ---------------------------------------------------------------------------------------------------------
    def steady(self, t: Any) -> list[tuple[Any, Any]]:
        """Response to drive and static force alone: displacement and velocity of each mode."""
        big, base = self.drive
        out = []
        for w, z, load, push in zip(self.omega, self.zeta, self.load, self.static, strict=True):
            h = load * big**2 * base / (w**2 - big**2 + 2j * z * w * big)
            turned = h * mp.expj(big * t)
            out.append((turned.imag + push / w**2, big * turned.real))
        return out

    def flown(self, y: list[Any], t: Any, span: Any) -> list[Any]:
        """State (x…, v…) a time ``span`` after ``t`` without contact."""
        n = len(self.omega)
        now, then = self.steady(t), self.steady(t + span)
        x, v = [], []
        for i, (w, z) in enumerate(zip(self.omega, self.zeta, strict=True)):
            a, b = y[i] - now[i][0], y[n + i] - now[i][1]
            own, sigma = w * mp.sqrt(1 - z**2), z * w
            c, s, decay = mp.cos(own * span), mp.sin(own * span) / own, mp.exp(-sigma * span)
            x.append(then[i][0] + decay * (a * c + (b + sigma * a) * s))
            v.append(then[i][1] + decay * (b * c - (w**2 * a + sigma * b) * s))
        return x + v

    def depth(self, y: list[Any], side: int, gap: Any) -> tuple[Any, Any]:
        """Penetration and its rate."""
        n = len(self.omega)
        return (
            side * mp.fdot(self.contact, y[:n]) - gap,
            side * mp.fdot(self.contact, y[n:]),
        )

    # contact --------------------------------------------------------------------------------------------------------
    def force(self, depth: Any, speed: Any) -> Any:
        if self.law[0] == "linear":
            return self.law[1] * depth + self.law[2] * speed
        _, k, exponent, a = self.law
        return k * max(depth, mpf(0)) ** exponent * (1 + a * speed)

    def rate(self, y: list[Any], t: Any, side: int, gap: Any) -> list[Any]:
        n, (big, base) = len(self.omega), self.drive
        push, sine = side * self.force(*self.depth(y, side, gap)), big**2 * base * mp.sin(big * t)
        return y[n:] + [
            load * sine + s - 2 * z * w * y[n + i] - w**2 * y[i] - c * push
            for i, (w, z, c, load, s) in enumerate(
                zip(self.omega, self.zeta, self.contact, self.load, self.static, strict=True)
            )
        ]

    def step(self, y: list[Any], t: Any, h: Any, side: int, gap: Any) -> list[Any]:
        """One step of Gauss' collocation, its stages by iteration."""
        slopes = [self.rate(y, t, side, gap)] * STAGES
        last = mp.inf
        for _ in range(200):
            stages = [
                [y[j] + h * mp.fdot(row, [k[j] for k in slopes]) for j in range(len(y))] for row in self.integrals
            ]
            new = [self.rate(each, t + c * h, side, gap) for each, c in zip(stages, self.nodes, strict=True)]
            change = max(abs(a - b) for k, m in zip(new, slopes, strict=True) for a, b in zip(k, m, strict=True))
            slopes = new
            if change == 0 or (change >= last and change < mpf(10) ** -20):
                break
            last = change
        return [y[j] + h * mp.fdot(self.weights, [k[j] for k in slopes]) for j in range(len(y))]

    def touched(self, y: list[Any], t: Any, end: Any, side: int, gap: Any) -> tuple[list[Any], Any]:
        """Through a contact to its release, or to ``end``."""
        if self.law[0] == "hard":
            n = len(self.omega)
            speed, square = self.depth(y, side, gap)[1], mp.fdot(self.contact, self.contact)
            push = (1 + self.law[1]) * speed / square
            return y[:n] + [v - side * c * push for v, c in zip(y[n:], self.contact, strict=True)], t
        longest, begun = self.longest(), t
        smallest = SMALL * longest
        while t < end:
            depth, speed = self.depth(y, side, gap)
            grown = max(t - begun, smallest) if self.law[0] == "power" else longest
            h = min(longest, grown, end - t)
            if self.law[0] == "power":
                if speed < 0:
                    if -depth / speed < smallest:
                        last = -depth / speed
                        return self.flown(y, t, last), t + last
                    h = min(h, -depth / (2 * speed))
                y, t = self.step(y, t, h, side, gap), t + h
                continue
            after = self.step(y, t, h, side, gap)
            if self.force(*self.depth(after, side, gap)) < 0:

                def pull(part: Any, y: list[Any] = y, t: Any = t) -> Any:
                    return self.force(*self.depth(self.step(y, t, part, side, gap), side, gap))

                h = mp.findroot(pull, (h / 2, h), solver="secant", tol=mpf(10) ** -44, verify=False)
                y, t = self.step(y, t, h, side, gap), t + h
                return self.retreat(y, t, side, gap)
            y, t = after, t + h
        return y, t

    def retreat(self, y: list[Any], t: Any, side: int, gap: Any) -> tuple[list[Any], Any]:
        """From the release of a damped stop, which does not pull, to the gap's opening."""
        depth, speed = self.depth(y, side, gap)
        if depth <= 0:
            return y, t
        out = mp.findroot(lambda s: self.depth(self.flown(y, t, s), side, gap)[0], -depth / speed)
        return self.flown(y, t, out), t + out

    def longest(self) -> Any:
        """Step within a contact: a sixth of half a turn of the stiffest contact, of a power law at ``DEPTH``."""
        stiff = self.law[1] * (1 if self.law[0] == "linear" else DEPTH ** (self.law[2] - 1))
        return mp.pi / mp.sqrt(stiff * mp.fdot(self.contact, self.contact) + max(self.omega) ** 2) / 6

    # motion ---------------------------------------------------------------------------------------------------------
    def motion(self, y: list[Any], periods: int) -> list[Any]:
        """State after so many drive periods from ``phase``; ``impacts`` are its touches: time, velocity."""
        self.impacts = []
        t = mpf(repr(self.phase)) * self.period
        end = t + periods * self.period
        if any(self.depth(y, side, gap)[0] > 0 for side, gap in self.sides):
            raise ArithmeticError("a stop is touched at the phase at which states are taken")
        while t < end:
            hit = self.next_touch(y, t, end)
            if hit is None:
                return self.flown(y, t, end - t)
            span, side, gap = hit
            y, t = self.flown(y, t, span), t + span
            self.impacts.append((t, self.depth(y, side, gap)[1]))
            y, t = self.touched(y, t, end, side, gap)
        return y

    def next_touch(self, y: list[Any], t: Any, end: Any) -> tuple[Any, int, Any] | None:
        """Time to the next touch, by steps of a fortieth of the fastest turn."""
        h = 2 * mp.pi / max(*self.omega, self.drive[0]) / 40
        before, s = [(-1, mpf(0))] * len(self.sides), mpf(0)
        while t + s < end:
            s = min(s + h, end - t)
            there = self.flown(y, t, s)
            for k, (side, gap) in enumerate(self.sides):
                depth, _ = self.depth(there, side, gap)
                if depth > 0 and before[k][0] < 0:
                    low, high = max(before[k][1], mpf(10) ** -20), s
                    root = mp.findroot(
                        lambda x, side=side, gap=gap: self.depth(self.flown(y, t, x), side, gap)[0],
                        (low, high),
                        solver="anderson",
                        tol=mpf(10) ** -46,
                        verify=False,
                    )
                    return root, side, gap
                before[k] = (-1 if depth <= 0 else 1, s)
        return None

    def orbit(self, y: list[Any], periods: int) -> tuple[list[Any], Any]:
        """Fixed point near ``y`` and the matrix of its map, by Newton's method with central differences."""
        y = [mpf(each) for each in y]
        for _ in range(12):
            after = self.motion(y, periods)
            columns = []
            for j in range(len(y)):
                sides = []
                for sign in (1, -1):
                    moved = list(y)
                    moved[j] += sign * TINY
                    sides.append(self.motion(moved, periods))
                columns.append([(a - b) / (2 * TINY) for a, b in zip(*sides, strict=True)])
            matrix = mp.matrix(columns).T
            residual = mp.matrix([a - b for a, b in zip(after, y, strict=True)])
            step = mp.lu_solve(matrix - mp.eye(len(y)), residual)
            y = [a - b for a, b in zip(y, step, strict=True)]
            if max(abs(each) for each in step) < mpf(10) ** -20:
                break
        else:
            raise ArithmeticError("no orbit")
        self.motion(y, periods)
        return y, matrix


def gauss(stages: int) -> tuple[list[Any], list[Any], list[list[Any]]]:
    """Nodes on 0 … 1, weights, and the integrals of the Lagrange polynomials to each node."""
    with mp.workdps(60):
        nodes = [(1 + root(stages, k)) / 2 for k in range(stages, 0, -1)]
        inverse = mp.matrix([[node**k for node in nodes] for k in range(stages)]) ** -1
        rows = [list(inverse * mp.matrix([to ** (k + 1) / (k + 1) for k in range(stages)])) for to in (*nodes, mpf(1))]
    return nodes, rows[-1], rows[:-1]


def root(n: int, k: int) -> Any:
    """Root k of the Legendre polynomial Pₙ, the largest first."""
    guess = mp.cos(mp.pi * (4 * k - 1) / (4 * n + 2))
    return mp.findroot(lambda x: mp.legendre(n, x), (guess, guess + mpf(10) ** -6))


def settled(rig: Rig, settle: int) -> list[Any]:
    """Start near a stable motion: flights in few digits."""
    y = [mpf(0)] * (2 * len(rig.omega))
    with mp.workdps(16):
        for _ in range(settle):
            y = rig.motion(y, 1)
    return y


ONE = ([1.0], [0.05], [1.0], [1.0])  # ω, ζ, contact, load
TWO = ([1.0, 4.7], [0.04, 0.03], [1.0, 0.45], [1.0, 0.3])
NONE = [0.0, 0.0]
FROM = {
    "Hertz, one mode, beside period 6": "Hertz, one mode",
    "Hertz, one mode, unstable": "Hertz, one mode, beside period 6",
}
RIGS: dict[str, tuple[Any, ...]] = {  # modes, static force, phase of the states, gaps, law, drive
    "hard, two modes": (TWO, NONE, 0.175, (0.05,), ("hard", 0.7), (2.1, 0.12)),
    "hard, both sides, two modes": (TWO, NONE, 0.7, (0.2, 0.25), ("hard", 0.6), (1.17, 0.4)),
    "linear, one mode": (ONE, NONE[:1], 0.85, (0.1,), ("linear", 30.0, 0.0), (1.6, 0.3)),
    "linear with damping, two modes": (TWO, NONE, 0.2, (0.03,), ("linear", 80.0, 1.2), (2.05, 0.15)),
    "linear, both sides, one mode": (ONE, NONE[:1], 0.5, (0.3, 0.3), ("linear", 40.0, 0.3), (1.2, 0.5)),
    "linear, preloaded, two modes": (TWO, [0.1, 0.02], 0.15, (0.05,), ("linear", 60.0, 0.0), (1.9, 0.2)),
    "Hertz, one mode": (ONE, NONE[:1], 0.225, (0.1,), ("power", 50.0, 1.5, 0.0), (2.0, 0.2)),
    "Hertz, one mode, beside period 6": (ONE, NONE[:1], 0.225, (0.1,), ("power", 50.0, 1.5, 0.0), (2.2, 0.2)),
    "Hertz, one mode, unstable": (ONE, NONE[:1], 0.225, (0.1,), ("power", 50.0, 1.5, 0.0), (2.35, 0.2)),
    "Hertz, two modes": (TWO, NONE, 0.225, (0.05,), ("power", 200.0, 1.5, 0.0), (2.1, 0.12)),
    "Hunt–Crossley, two modes": (TWO, NONE, 0.225, (0.05,), ("power", 150.0, 1.5, 0.4), (2.1, 0.12)),
    "Hertz, both sides, one mode": (ONE, NONE[:1], 0.525, (0.3, 0.35), ("power", 60.0, 1.5, 0.0), (1.2, 0.5)),
}


def values_of(modes: tuple[list[float], ...], static: list[float], phase: float, *rest: Any) -> dict[str, Any]:
    """Inputs of ``Rig`` by name."""
    (gap, *second), law, drive = rest
    rows = dict(zip(("omega", "zeta", "contact", "load"), modes, strict=True))
    found = rows | {"static": static, "gap": gap, "law": law, "drive": drive, "phase": phase}
    return found | ({"second_gap": second[0]} if second else {})


def main() -> None:
    """Write ``orbits.json``: what it does not hold yet."""
    file = HERE / "orbits.json"
    found: dict[str, Any] = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    for name, row in RIGS.items():
        if name in found:
            continue
        values = values_of(*row)
        rig = Rig(**values)
        near = found.get(FROM.get(name, ""))
        state, matrix = rig.orbit(near["state"] if near else settled(rig, 60), 1)
        multipliers = sorted(mp.eig(matrix)[0], key=abs, reverse=True)
        found[name] = {
            "rig": values, "state": [mp.nstr(each, 20) for each in state],
            "impacts": [[mp.nstr(each, 18) for each in row] for row in rig.impacts],
            "multipliers": [[mp.nstr(mp.re(each), 16), mp.nstr(mp.im(each), 16)] for each in multipliers],
        }  # fmt: skip
        print(name, found[name]["impacts"], mp.nstr(multipliers[0], 8), flush=True)
        file.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
