"""Batches: points in lanes against points alone, what Python adds, threads, whole maps and basins.

    python tests/benchmarks/batches.py [--rounds 5] [--basins 1000] [--out tests/benchmarks/results/batches.json]

Ratios are of CPU times of one process, the two sides in turn; the least of the rounds is kept of each.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import vibeam
from vibeam.flight.points import points as compiled
from vibeam.system.state import State

HERE = Path(__file__).parent

CASES = HERE.parents[1] / "cases"

SETTLE, HOLD, MEAN = 350, 50, 50


def nominal() -> vibeam.ImpactSystem:
    """The paper's nominal oscillator."""
    return vibeam.load(CASES / "sdof_nominal.toml").system("sdof")


def rig(modes: int) -> vibeam.ImpactSystem:
    """The DTU rig in that many modes."""
    case = vibeam.load(CASES / "dtu_neutral.toml", set={"fidelity.beam.modes": modes})
    return case.system("beam" if modes > 1 else "sdof")


def jobs() -> dict[str, Callable[[bool, int | None], vibeam.BatchResponse]]:
    """Batches by name, in lanes or alone, in so many threads."""
    one, eight = nominal(), rig(8)
    calm, wide = np.linspace(1.5, 2.2, 100), np.linspace(1.2, 3.2, 100)
    gaps, share = np.linspace(-0.5e-3, 2.0e-3, 100)[:, None], np.linspace(0.9, 0.7, 100)[:, None]
    hertz, volts = 2 * np.pi * np.linspace(14.0, 17.0, 61), np.linspace(0.5e-4, 2e-4, 61)[:, None]

    def of(system: Any, omega: Any, amplitude: Any, **more: Any) -> Callable[[bool, int | None], vibeam.BatchResponse]:
        return lambda lanes, threads: vibeam.batch(
            system, omega, amplitude, settle=SETTLE, hold=HOLD, lanes=lanes, threads=threads, **more
        )

    return {
        "period-1 points, one mode": of(one, calm, 0.5e-3, restitution=share),
        "nominal map, one mode": of(one, wide, 0.5e-3, gap=gaps),
        "as Fig. 18, one mode": of(replace(rig(1), gap=1e-4), hertz, volts),
        "as Fig. 18, eight modes": of(replace(eight, gap=1e-4), hertz, volts),
    }


def measured(job: Callable[[bool, int | None], vibeam.BatchResponse], rounds: int) -> dict[str, Any]:
    """Least CPU times in lanes and alone, and of these what the kernels took."""
    spent: dict[bool, list[tuple[float, float]]] = {True: [], False: []}
    for _ in range(rounds):
        for lanes in (True, False):
            begun, inside = time.process_time(), _Clock()
            found = inside.around(lambda lanes=lanes: job(lanes, 1))
            spent[lanes].append((time.process_time() - begun, inside.seconds))
    lanes, alone = (min(times) for times in (spent[True], spent[False]))
    return {
        "points": int(found.ended.size), "lanes": lanes[0], "alone": alone[0], "ratio": alone[0] / lanes[0],
        "kernels in lanes": lanes[1] / lanes[0], "kernels alone": alone[1] / alone[0],
        "irregular": float(np.mean(found.period == 0)), "period 1": float(np.mean(found.period == 1)),
        "complete": float(np.mean(found.ended == 0)),
    }  # fmt: skip


class _Clock:
    """CPU time within the kernels' entry point."""

    def __init__(self) -> None:
        self.seconds = 0.0

    def around(self, task: Callable[[], vibeam.BatchResponse]) -> vibeam.BatchResponse:
        """Run ``task``, and add up."""
        entry = compiled.run_points

        def timed(*given: Any) -> Any:
            begun = time.thread_time()
            try:
                return entry(*given)
            finally:
                self.seconds += time.thread_time() - begun

        compiled.run_points = timed  # type: ignore[assignment]
        try:
            return task()
        finally:
            compiled.run_points = entry


def threaded(job: Callable[[bool, int | None], vibeam.BatchResponse], rounds: int) -> dict[str, float]:
    """Least wall times of one and two threads."""
    walls: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(rounds):
        for threads, times in walls.items():
            begun = time.perf_counter()
            job(True, threads)
            times.append(time.perf_counter() - begun)
    return {"one": min(walls[1]), "two": min(walls[2]), "ratio": min(walls[1]) / min(walls[2])}


def exponents(rounds: int) -> dict[str, float]:
    """CPU time of largest Lyapunov exponents over the nominal map, and of every 97th point one by one in Python."""
    system, omega, gap = nominal(), np.linspace(1.2, 3.2, 100), np.linspace(-0.5e-3, 2.0e-3, 100)[:, None]
    spent: dict[int, list[float]] = {0: [], MEAN: []}
    for _ in range(rounds):
        for periods, times in spent.items():
            begun = time.process_time()
            found = vibeam.batch(system, omega, 0.5e-3, gap=gap, settle=SETTLE, hold=HOLD, lyapunov=periods, threads=1)
            times.append(time.process_time() - begun)
    every = np.arange(0, found.ended.size, 97)
    begun = time.process_time()
    for at in every.tolist():
        state = State(found.state[at // 100, at % 100, :1], found.state[at // 100, at % 100, 1:])
        own = replace(system, gap=float(gap[at // 100, 0]))
        vibeam.lyapunov(own, vibeam.Drive(omega[at % 100], 0.5e-3), state, settle=0, periods=MEAN, count=1)
    alone = (time.process_time() - begun) / len(every)
    more = (min(spent[MEAN]) - min(spent[0])) / found.ended.size
    return {"batch": min(spent[0]), "with exponents": min(spent[MEAN]), "a point": more, "a point in Python": alone}


def basins(side: int) -> dict[str, float]:
    """Starts on a grid of ``side`` by ``side``, 200 periods each, where motions coexist."""
    place, velocity = np.meshgrid(np.linspace(-5e-3, 0.0, side), np.linspace(-5e-3, 5e-3, side), indexing="ij")
    begun, cpu = time.perf_counter(), time.process_time()
    system = replace(nominal(), gap=1e-3)
    found = vibeam.batch(
        system, 2.6, 0.5e-3, state=np.stack([place, velocity], axis=-1), settle=180, hold=20, strobes=1
    )
    return {
        "points": side * side, "wall": time.perf_counter() - begun, "cpu": time.process_time() - cpu,
        "periods": [int(each) for each in np.unique(found.period)],
    }  # fmt: skip


def main() -> None:
    """Measure, print and store."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--basins", type=int, default=1000)
    parser.add_argument("--out", type=Path, default=HERE / "results" / "batches.json")
    given, before = parser.parse_args(), os.getloadavg()
    made = jobs()
    rows = {name: measured(job, given.rounds) for name, job in made.items()}
    found: dict[str, Any] = {"rounds": given.rounds, "rows": rows, "settle": SETTLE, "hold": HOLD}
    found["threads"] = threaded(made["nominal map, one mode"], given.rounds)
    found["exponents"] = exponents(given.rounds)
    found["basins"] = basins(given.basins)
    found["load"] = {"before": before, "after": os.getloadavg()}
    given.out.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
