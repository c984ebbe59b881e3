"""CPU and wall time of whole commands: help, a refusal, the main case with everything and nothing to do, its report.

    python tests/benchmarks/startup.py [--rounds 7] [--calls] [--out tests/benchmarks/results/startup.json]

And of what a small call costs beside its flight: a new system where the gap or the beam changed, a sweep of one point,
the periodic motions of eight modes. Every command runs in a process of its own, the files of the operating system
being warm and sources compiled to bytecode, as in an installation; the least and the median of the rounds are kept.
``--calls`` leaves the commands of that file as they are.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import vibeam

HERE = Path(__file__).parent

CASE = HERE.parents[1] / "cases" / "dtu_neutral.toml"

COMMANDS = {
    "`vibeam --help`": ["--help"],
    "`vibeam keys`": ["keys"],
    "a wrong case is refused": ["run", str(CASE), "--set", "stop.gap=1 Hz"],
    "`vibeam run`, everything to do": ["run", str(CASE), "--out", "new.h5", "--fresh"],
    "`vibeam run`, nothing to do": ["run", str(CASE), "--out", "done.h5"],
    "`vibeam check`, nothing to do": ["check", str(CASE), "--out", "done.h5"],
    "`vibeam report`": ["report", "done.h5"],
}

BEAMS = {  # key, start and step of what changes
    "a new system of eight modes: another mass": ("mass.mass", 0.2, 1e-4),
    "a new system of eight modes: another thickness": ("beam.thickness", 1.034e-3, 1e-6),
    "a new system of eight modes: another length": ("beam.length", 0.18, 1e-5),
    "a new system of eight modes: another place of the mass": ("mass.position", 0.132, 1e-5),
}


def spent(words: list[str], folder: str) -> tuple[float, float]:
    """CPU and wall time of one command."""
    surroundings = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    surroundings["PYTHONPYCACHEPREFIX"] = str(Path(folder) / "bytecode")
    command = [sys.executable, "-m", "vibeam", *words]
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(command, cwd=folder, env=surroundings, capture_output=True, check=False)
    after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter() - begun
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def commands(rounds: int) -> list[dict[str, Any]]:
    """Rows of the commands."""
    rows = []
    with TemporaryDirectory() as folder:
        spent(COMMANDS["`vibeam run`, nothing to do"], folder)
        for name, words in COMMANDS.items():
            spent(words, folder)
            cpu, wall = zip(*(spent(words, folder) for _ in range(rounds)), strict=True)
            rows.append({"name": name, "cpu": min(cpu), "cpu_median": median(cpu), "wall": min(wall)})
    return rows


def least(task: Callable[[int], object], rounds: int) -> float:
    """Least CPU time of ``task(0)``, ``task(1)`` …"""
    times = []
    for index in range(rounds):
        begun = time.thread_time()
        task(index)
        times.append(time.thread_time() - begun)
    return min(times)


def calls(rounds: int) -> list[dict[str, Any]]:
    """Rows of the calls."""
    case = vibeam.load(CASE)
    system, drive = case.system("beam"), vibeam.Drive(2 * np.pi * 15.3, float(case.amplitude_of("beam")))
    gaps = [vibeam.load(CASE, set={"units": "SI", "stop.gap": 1e-6 * index}) for index in range(1, rounds + 1)]
    beams = {
        name: [vibeam.load(CASE, set={"units": "SI", key: start + step * index}) for index in range(1, rounds + 1)]
        for name, (key, start, step) in BEAMS.items()
    }

    def point(_: int) -> vibeam.FrequencyResponse:
        return vibeam.sweep(system, omega=[drive.omega], amplitude=drive.amplitude, settle=300, hold=50)

    points, flights = pointwise(point, rounds)
    found = {
        "a new system of eight modes: another gap": least(lambda index: gaps[index].system("beam"), rounds),
        **{name: least(partial(_system, cases), rounds) for name, cases in beams.items()},
        "a sweep of one point, 350 periods": points,
        "its flight": flights,
        "`orbits()` of eight modes": least(lambda _: vibeam.orbits(system, drive), rounds),
    }
    return [{"name": name, "cpu": cpu} for name, cpu in found.items()]


def pointwise(point: Callable[[int], vibeam.FrequencyResponse], rounds: int) -> tuple[float, float]:
    """Least CPU time of a sweep of one point, and of the flight within these sweeps."""
    spans, flights = [], []
    for index in range(rounds):
        begun = time.thread_time()
        found = point(index)
        spans.append(time.thread_time() - begun)
        flights.append(float(found.cpu_seconds[0]))
    return min(spans), min(flights)


def _system(cases: list[vibeam.Case], index: int) -> vibeam.ImpactSystem:
    return cases[index].system("beam")


def main() -> None:
    """Measure, print and store."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--out", type=Path, default=HERE / "results" / "startup.json")
    parser.add_argument("--calls", action="store_true", help="measure the calls alone")
    given = parser.parse_args()
    before = os.getloadavg()
    if given.calls:
        found = json.loads(given.out.read_text(encoding="utf-8"))
    else:
        found = {"commands": commands(given.rounds), "rounds": given.rounds, "cores": os.cpu_count()}
        found["load"] = {"before": before, "after": os.getloadavg()}
    before = os.getloadavg()
    found |= {"calls": calls(3 * given.rounds), "rounds_of_calls": 3 * given.rounds}
    found["load_of_calls"] = {"before": before, "after": os.getloadavg()}
    given.out.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    for row in found["commands"]:
        print(f"{row['name']:<42} {row['cpu']:.2f} s CPU (median {row['cpu_median']:.2f}), {row['wall']:.2f} s wall")
    for row in found["calls"]:
        print(f"{row['name']:<42} {1e3 * row['cpu']:.3f} ms")


if __name__ == "__main__":
    main()
