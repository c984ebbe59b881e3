"""What two threads give over one: a batch, a map, a sweep of several fidelities, a fit, realisations of a record.

    python tests/benchmarks/threads.py [--rounds 3] [--share 1.0] [--only batch,map] [--out results/threads.json]

Each work is done by one thread on one core, by two threads on two cores, and by two processes at once, each of which
does all of it by one thread on a core of its own: what they lose is the machine's, shared memory and clock. The three
take turns. ``ratio``: wall time of one thread over that of two; ``processes``: twice the wall time of one over that of
both; median, least and largest of the rounds. ``cpu``: CPU time of two threads over that of one. ``tasks``: wall times
of batches of a few points, shared by two threads and not, and the least batch that two threads do sooner.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from threading import Event
from typing import Any

import numpy as np

import vibeam
from vibeam.runs.parallel import run_parallel

HERE = Path(__file__).parent
CASES = HERE.parents[1] / "cases"
POINTS = 200_000
FEW = (1, 2, 4, 8, 16, 32, 64, 128, 256)
Work = Callable[[], object]


def batch(share: float) -> Work:
    """Points of the paper's nominal oscillator over gap and frequency."""
    system, side = vibeam.load(CASES / "sdof_nominal.toml").system("sdof"), round((POINTS * share) ** 0.5)
    omega, gap = np.linspace(1.2, 3.2, side), np.linspace(-0.5e-3, 2.0e-3, side)[:, None]
    return lambda: vibeam.batch(system, omega, 0.5e-3, gap=gap, settle=100, hold=30)


def map_(share: float) -> Work:
    """Map of gap, voltage and frequency, states carried along frequency, in blocks on disk."""
    voltages = max(2, round(POINTS * share / 3 / 121))
    axes = [
        {"key": "stop.gap", "values": ["-0.1 mm", "0 mm", "0.1 mm"]},
        {"key": "drive.voltage", "from": "0.1 V", "to": "0.7 V", "points": voltages},
        {"key": "sweep.frequency", "from": "14 Hz", "to": "17 Hz", "points": 121},
    ]
    short = {"sweep.settle": 40, "sweep.hold": 10, "map.period.axes": axes, "map.period.fidelities": ["sdof"]}
    case = vibeam.load(CASES / "maps" / "fig18.toml", short)

    def work() -> None:
        with TemporaryDirectory() as folder:
            vibeam.run_map(case, "period", Path(folder) / "map.h5")

    return work


def sweep(share: float) -> Work:
    """Two ways of each of three fidelities, 1, 2 and 8 modes, states carried along."""
    case = vibeam.load(CASES / "dtu_neutral.toml", {"sweep.frequency.points": max(2, round(4000 * share))})
    return lambda: vibeam.run(case)


def fit(share: float) -> Work:
    """Four keys from 61 points of a response."""
    case = vibeam.load(CASES / "synthetic" / "fit.toml")
    return lambda: vibeam.fit(case)


def record(share: float) -> Work:
    """Realisations of a truck's floor at two levels, three fidelities each."""
    case = vibeam.load(CASES / "inputs" / "truck.toml", {"record.realisations": max(1, round(3 * share))})
    return lambda: vibeam.run(case)


WORKS: dict[str, Callable[[float], Work]] = {
    "batch": batch,
    "map": map_,
    "sweep": sweep,
    "fit": fit,
    "record": record,
}


def serve(name: str, share: float, cores: list[int]) -> None:
    """Do a work at each line of stdin, on these cores alone, and print its wall and CPU times."""
    os.sched_setaffinity(0, cores)
    work = WORKS[name](share)
    WORKS[name](min(share, 0.01))()  # libraries are loaded
    print("ready", flush=True)
    for _ in sys.stdin:
        wall, cpu = time.perf_counter(), time.process_time()
        work()
        print(json.dumps([time.perf_counter() - wall, time.process_time() - cpu]), flush=True)


@contextmanager
def served(name: str, share: float, cores: list[int]) -> Iterator[subprocess.Popen[str]]:
    """Process that serves a work."""
    words = [sys.executable, __file__, "--share", str(share), "--serve", name, *map(str, cores)]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        yield process
        assert process.stdin is not None
        process.stdin.close()


def timed(*processes: subprocess.Popen[str]) -> list[list[float]]:
    """Wall and CPU time of each of some processes that work at once."""
    for process in processes:
        assert process.stdin is not None
        process.stdin.write("go\n")
        process.stdin.flush()
    return [json.loads(process.stdout.readline()) for process in processes if process.stdout is not None]


def compared(name: str, share: float, rounds: int) -> dict[str, Any]:
    """One thread, two threads and two processes in turn."""
    first, second = sorted(os.sched_getaffinity(0))[:2]
    found: dict[str, list[float]] = {"one": [], "ratio": [], "processes": [], "cpu": []}
    with (
        served(name, share, [first]) as one,
        served(name, share, [second]) as other,
        served(name, share, [first, second]) as both,
    ):
        for _ in range(rounds):
            ((alone, cpu),) = timed(one)
            ((shared, together),) = timed(both)
            aside = timed(one, other)
            found["one"].append(alone)
            found["ratio"].append(alone / shared)
            found["cpu"].append(together / cpu)
            found["processes"].append(2 * alone / max(wall for wall, _ in aside))
    spread = {key: [median(values), min(values), max(values)] for key, values in found.items()}
    return {"what": (WORKS[name].__doc__ or "").rstrip("."), **spread}


def tasks(rounds: int = 40) -> dict[str, Any]:
    """Cost of a call of ``run_parallel``, and wall times of few points by one thread and shared by two, µs."""
    system = vibeam.load(CASES / "sdof_nominal.toml").system("sdof")

    def least(work: Work, count: int = rounds) -> float:
        times = []
        for _ in range(count):
            begun = time.perf_counter()
            work()
            times.append(time.perf_counter() - begun)
        return 1e6 * min(times)

    def nothing(item: int, stop: Event) -> None:
        """No work."""

    def of(count: int, threads: int) -> Work:
        parts = np.array_split(np.linspace(1.8, 2.2, count), min(threads, count))

        def fly(omega: Any, stop: Event) -> object:
            return vibeam.batch(system, omega, 0.5e-3, threads=1)

        return lambda: run_parallel(fly, parts, threads) if threads > 1 else fly(parts[0], Event())

    few = {str(count): [least(of(count, 1)), least(of(count, 2))] for count in FEW}
    wins = next((count for count in FEW if few[str(count)][1] < few[str(count)][0]), None)
    call = least(lambda: run_parallel(nothing, [0, 1], 2), 10 * rounds)
    return {"call": call, "points": few, "from": wins, "a point": few[str(FEW[-1])][0] / FEW[-1]}


def main() -> None:
    """Measure, print and store."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--share", type=float, default=1.0, help="of the size of every work")
    parser.add_argument("--only", default=",".join(WORKS))
    parser.add_argument("--out", type=Path, default=HERE / "results" / "threads.json")
    parser.add_argument("--serve", nargs="+", metavar="NAME CORE", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.serve:
        serve(given.serve[0], given.share, list(map(int, given.serve[1:])))
        return
    before = os.getloadavg()
    works = {name: compared(name, given.share, given.rounds) for name in given.only.split(",")}
    found = {"rounds": given.rounds, "share": given.share, "works": works, "tasks": tasks()}
    found["load"] = {"before": before, "after": os.getloadavg()}
    given.out.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    for name, row in works.items():
        print(f"{name:<8}" + "  ".join(f"{key} {row[key][0]:.2f} ({row[key][1]:.2f} … {row[key][2]:.2f})" for key in (
            "one", "ratio", "processes", "cpu")))  # fmt: skip
    print(json.dumps(found["tasks"]))


if __name__ == "__main__":
    main()
