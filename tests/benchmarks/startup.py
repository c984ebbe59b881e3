"""CPU and wall time of whole commands: help, a refusal, the main case with everything and with nothing left to do.

    python tests/benchmarks/startup.py [--rounds 7] [--out tests/benchmarks/results/startup.json]

And of what a small call costs beside its flight: a new system where the gap or the beam changed, a sweep of one point,
the periodic motions of eight modes. Every command runs in a process of its own, the files of the operating system
being warm; the least and the median of the rounds are kept.
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
}


def spent(words: list[str], folder: str) -> tuple[float, float]:
    """CPU and wall time of one command."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([sys.executable, "-m", "vibeam", *words], cwd=folder, capture_output=True, check=False)
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
    gaps = [vibeam.load(CASE, set={"stop.gap": 1e-6 * index}) for index in range(1, rounds + 1)]
    masses = [vibeam.load(CASE, set={"mass.mass": 0.2 + 1e-4 * index}) for index in range(1, rounds + 1)]

    def point(_: int) -> vibeam.FrequencyResponse:
        return vibeam.sweep(system, omega=[drive.omega], amplitude=drive.amplitude, settle=300, hold=50)

    flight = min(float(point(0).cpu_seconds[0]) for _ in range(rounds))
    found = {
        "a new system of eight modes: another gap": least(lambda index: gaps[index].system("beam"), rounds),
        "a new system of eight modes: another mass": least(lambda index: masses[index].system("beam"), rounds),
        "a sweep of one point, 350 periods": least(point, rounds),
        "its flight": flight,
        "`orbits()` of eight modes": least(lambda _: vibeam.orbits(system, drive), rounds),
    }
    return [{"name": name, "cpu": cpu} for name, cpu in found.items()]


def main() -> None:
    """Measure, print and store."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--out", type=Path, default=HERE / "results" / "startup.json")
    given = parser.parse_args()
    before = os.getloadavg()
    found = {"commands": commands(given.rounds), "calls": calls(3 * given.rounds), "rounds": given.rounds}
    found |= {"load": {"before": before, "after": os.getloadavg()}, "cores": os.cpu_count()}
    given.out.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    for row in found["commands"]:
        print(f"{row['name']:<42} {row['cpu']:.2f} s CPU (median {row['cpu_median']:.2f}), {row['wall']:.2f} s wall")
    for row in found["calls"]:
        print(f"{row['name']:<42} {1e3 * row['cpu']:.3f} ms")


if __name__ == "__main__":
    main()
