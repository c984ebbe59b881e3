"""Write loaded.json: motions under random records to 30 digits, for the tests of the flight under a load.

    python tests/independent/make_loaded.py [--out FILE]

200 entries, of every kind of stop that ``loaded.py`` knows; loads of steps, lines and cubics, with and without jumps;
one to five modes, free, undamped, overdamped and stiff ones among them; scales of time and length from MEMS to towers.
All inputs are doubles, exact as printed. A draw is thrown away where the motion forgets its start, or has no event.
About 80 s of CPU time.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from events import Extremes, as_mpf
from loaded import Flight, Loaded, Stop
from mpmath import mpf

SEED, DIGITS = 20321123, 44
NUDGE = mpf(10) ** -20  # of the load: how far the second run is from the first
MOST_GROWTH = 1e3  # of that, in times over the duration and speeds over the largest
FEW, MANY = 1, 60  # events
WEAK = 1e-3  # of the fastest impact: slower ones of an accumulation are not listed
KINDS = {
    "hard": 40, "two hard": 24, "coupled": 16, "linear": 24, "linear damped": 24, "two linear": 16, "rests": 24,
    "held": 8, "several": 24,
}  # fmt: skip
LOADS = ("steps", "lines", "cubic", "jumps")
SCALES = ((1.0, 1.0), (1.0, 1e-3), (1e-6, 1e-6), (50.0, 1.0), (1e-3, 1e3), (1e-2, 1e-4))  # of time and length
ABOUT = (
    "Motions by Taylor series in 44 digits, remade by: python tests/independent/make_loaded.py.",
    "eta'' + D eta' + omega^2 eta = load u(t) + static - sum row F, D = diag(2 zeta omega) or coupling; u(t) = "
    "sum_j pieces[i][j] (t - knots[i])^j, zero outside; stops: restitution, or F = max(0, stiffness d + damping d').",
    "events: kind, stop, time, speed toward the stop just before; of accumulations the impacts above 1e-3 of the "
    "fastest. end: displacement and velocity at t_end; extremes: least and greatest of the first stop's row.eta; "
    "work: of the load. growth: of a relative change of the load by 1e-20, in times and speeds.",
)


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description="Write motions under random records.")
    parser.add_argument("--out", type=Path, default=Path(__file__).with_name("loaded.json"))
    out = parser.parse_args().out
    mpmath.mp.dps = DIGITS
    rng, entries = np.random.default_rng(SEED), []
    for kind, count in KINDS.items():
        for k in range(count):
            entry = None
            while entry is None:
                entry = flown(draw(rng, kind, k))
            entries.append(entry)
        print(kind, sum(len(each["events"]) for each in entries), flush=True)
    lines = ",\n".join(json.dumps(entry) for entry in entries)
    out.write_text(f'{{"about": {json.dumps(ABOUT)},\n"entries": [\n{lines}\n]}}\n', encoding="utf-8")


def draw(rng: np.random.Generator, kind: str, k: int) -> dict[str, Any]:
    """Inputs of one entry."""
    n = (1, 1, 2, 3, 5)[k % 5] if kind not in ("coupled", "several") else (2, 3, 2, 5)[k % 4]
    omega = np.sort(10 ** rng.uniform(0.0, (0.3, 1.3)[n > 1], n))
    zeta = 10 ** rng.uniform(-2.5, -0.5, n)
    if k % 7 == 3:
        zeta[0] = (0.0, 1.0, 1.7, 0.0)[k // 7 % 4]
        omega[0] *= (1.0, 1.0, 1.0, 0.0)[k // 7 % 4]
    if k % 11 == 5 and n > 1:
        omega[-1] *= 20
    rows, load = rng.normal(size=(2, n)) / np.arange(1, n + 1), rng.normal(size=n)
    knots, pieces, end = record(rng, LOADS[k % 4], float(rng.uniform(6, 18)))
    own: dict[str, Any] = {"kind": kind, "omega": omega, "zeta": zeta, "load": load, "static": np.zeros(n)}
    own |= {"knots": knots, "pieces": pieces, "t_end": end, "stops": stops(rng, kind, rows)}
    own |= {"displacement": np.zeros(n), "velocity": np.zeros(n), "held": False}
    if kind == "coupled":
        root = rng.normal(size=(n, n))
        own["coupling"] = np.tril(0.05 * root @ root.T + np.diag(0.02 * omega))
    if kind in ("rests", "held"):
        own["static"] = float(rng.uniform(0.5, 2.0)) * rows[0]
        own["stops"][0]["gap"] = 0.0 if kind == "held" else 0.1
        own["held"] = kind == "held"
    return scaled(own, *SCALES[k % len(SCALES)])


def stops(rng: np.random.Generator, kind: str, rows: np.ndarray) -> list[dict[str, Any]]:
    """The stops of a kind, with numbers of their own."""
    gap, second = rng.uniform(0.05, 0.6, 2)
    restitution = rng.uniform(0.2, 0.6) if kind == "rests" else rng.uniform(0.3, 1.0)
    stiffness = 10 ** rng.uniform(1.0, 3.0)
    soft = {"stiffness": stiffness, "damping": rng.uniform(0.05, 1.5) * np.sqrt(stiffness)}
    if kind == "linear" or (kind == "two linear" and rng.random() < 0.5):
        soft["damping"] = 0.0
    first = soft if "linear" in kind else {"restitution": restitution}
    found = [{"row": rows[0], "gap": gap, **first}]
    if kind.startswith("two"):
        found.append({"row": -rows[0], "gap": second, **first})
    if kind == "several":
        found.append({"row": rows[1], "gap": second, **(soft if rng.random() < 0.6 else {"restitution": 0.5})})
    return found


def record(rng: np.random.Generator, kind: str, end: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Knots and pieces of a load that ends a little before the motion, or well after it."""
    count = int(rng.integers(1, 25))
    steps = rng.uniform(0.2, 1.0, count) if rng.random() < 0.5 else np.ones(count)
    knots = np.concatenate([[0.0], np.cumsum(steps)]) * end / steps.sum() * rng.choice([0.8, 1.0, 1.2])
    values, pieces = 3.0 * rng.normal(size=count + 1), np.zeros((count, 4))
    length = np.diff(knots)
    pieces[:, 0] = values[:-1]
    if kind == "lines":
        pieces[:, 1] = np.diff(values) / length
    elif kind == "cubic":
        pieces[:, 2], pieces[:, 3] = 3 * np.diff(values) / length**2, -2 * np.diff(values) / length**3
    elif kind == "jumps":
        pieces[:, 1:] = 2.0 * rng.normal(size=(count, 3)) / length[:, None] ** [1, 2, 3]
    return knots, pieces, end


def scaled(own: dict[str, Any], time: float, length: float) -> dict[str, Any]:
    """The same with other units, rounded to few digits: from then on the numbers are exact."""
    force = length / time**2
    own |= {"omega": own["omega"] / time, "knots": own["knots"] * time, "t_end": own["t_end"] * time}
    own |= {"pieces": own["pieces"] * force / time ** np.arange(4), "static": own["static"] * force}
    if "coupling" in own:
        own["coupling"] = own["coupling"] / time
    for stop in own["stops"]:
        stop["gap"] *= length
        if "stiffness" in stop:
            stop |= {"stiffness": stop["stiffness"] / time**2, "damping": stop["damping"] / time}
    return {name: few_digits(value) for name, value in own.items()}


def few_digits(value: Any) -> Any:
    """Rounded to five digits, in lists."""
    if isinstance(value, dict):
        return {name: few_digits(each) for name, each in value.items()}
    if isinstance(value, list | np.ndarray):
        return [few_digits(each) for each in value]
    return float(f"{value:.5g}") if isinstance(value, float) else value


def flight(own: dict[str, Any], digits: int = DIGITS, nudge: mpf | int = 0) -> Flight:
    """The motion of an entry at its start."""
    n = len(own["omega"])
    damper = [[2 * mpf(z) * mpf(w) if i == k else 0 for k in range(n)] for i, (z, w) in enumerate(_both(own))]
    if "coupling" in own:
        low = own["coupling"]
        damper = [[low[max(i, k)][min(i, k)] for k in range(n)] for i in range(n)]
    pieces = [[mpf(a) * (1 + nudge) for a in piece] for piece in own["pieces"]]
    walls = [Stop(**stop) for stop in own["stops"]]
    system = Loaded(own["omega"], damper, own["load"], own["static"], walls, own["knots"], pieces)
    held = 0 if own["held"] else None
    return Flight(system, own["displacement"], own["velocity"], held=held, digits=digits, ledger=True)


def _both(own: dict[str, Any]) -> Any:
    return zip(own["zeta"], own["omega"], strict=True)


def flown(own: dict[str, Any]) -> dict[str, Any] | None:
    """The entry with its motion, or None for a draw that is thrown away."""
    try:
        motion, other = flight(own), flight(own, nudge=NUDGE)
        motion.trackers = [Extremes(own["stops"][0]["row"])]
        motion.run(own["t_end"], most=2000)
        other.run(own["t_end"], most=2000)
    except ArithmeticError:
        return None
    listed, again = told(motion), told(other)
    wanted = own["kind"] not in ("rests", "held") or {"rest", "release"} & {event[0] for event in listed}
    if not (FEW <= len(listed) <= MANY and wanted) or [e[:2] for e in listed] != [e[:2] for e in again]:
        return None
    growth = _growth(listed, again, own["t_end"])
    if growth > MOST_GROWTH:
        return None
    reach = [as_mpf(motion.trackers[0].minimum), as_mpf(motion.trackers[0].maximum)]
    end = {"displacement": _text(map(as_mpf, motion.x)), "velocity": _text(map(as_mpf, motion.v))}
    found = [[kind, stop, *_text([time, speed])] for kind, stop, time, speed in listed]
    work = _text([as_mpf(motion.work["load"])])[0]
    return own | {"growth": float(f"{growth:.3g}"), "events": found, "end": end, "extremes": _text(reach), "work": work}


def told(motion: Flight) -> list[Any]:
    """Events without the weak impacts of accumulations."""
    fastest = max((event.speed for event in motion.events), default=0)
    weak = WEAK * fastest if any(event.kind == "rest" for event in motion.events) else 0
    return [event for event in motion.events if event.kind != "impact" or event.speed > weak]


def _growth(listed: list[Any], again: list[Any], end: float) -> float:
    fastest = max(event.speed for event in listed) or mpf(1)
    off = [abs(a.time - b.time) / end for a, b in zip(listed, again, strict=True)]
    off += [abs(a.speed - b.speed) / fastest for a, b in zip(listed, again, strict=True)]
    return float(max(off) / NUDGE)


def _text(values: Any) -> list[str]:
    return [mpmath.nstr(value, 30) for value in values]


if __name__ == "__main__":
    main()
