"""The kernels' libraries against numba's native code: cost of an impact, in turn and in one process.

    python tests/benchmarks/libraries.py [--rounds 200] [--out tests/benchmarks/results/libraries.json]

The DTU rig, neutral gap, 1 to 32 modes: 13 points from 14 to 17 Hz, 250 periods each from the settled motion. In each
round every level and numba run the same sweep, in an order of its own; ratios are of CPU times: the least over the
least, which a busy machine disturbs least, and the median of those of one round. Then the time of one call that does
nothing, and what it takes to load the libraries.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import vibeam
from vibeam.flight.engine import entries, loading
from vibeam.flight.engine.entries import ENTRIES, EntryPoint
from vibeam.flight.engine.loading import manifest

HERE = Path(__file__).parent

CASE = HERE.parents[1] / "cases" / "dtu_neutral.toml"

MODES = (1, 2, 8, 32)

READY = """
import time
begun = time.process_time()
import vibeam.flight.trajectory, vibeam.flight.solver, vibeam.flight.proof.certificate
imported = time.process_time()
from vibeam.flight.engine.entries import ENTRIES
for entry in ENTRIES:
    entry.function
print(imported - begun, time.process_time() - imported)
"""


def taken(level: str) -> Callable[[EntryPoint], Any]:
    """The functions of a level's libraries, or numba's."""
    if level == "numba":
        return lambda entry: entries.compiled(entry.module, entry.name)
    return lambda entry: loading.function_of(entry.library, entry.module, entry.name, level)


def use(functions: dict[EntryPoint, Any]) -> None:
    """Let the entry points be these functions."""
    for entry, function in functions.items():
        vars(entry)["function"] = function


def sweep(system: vibeam.ImpactSystem, amplitude: float) -> tuple[float, int]:
    """CPU time and impacts of the sweep."""
    grid, begun = 2 * np.pi * np.linspace(14, 17, 13), time.thread_time()
    found = vibeam.sweep(system, omega=grid, amplitude=amplitude, settle=200, hold=50)
    return time.thread_time() - begun, int(found.impacts.sum())


def measured(levels: list[str], functions: dict[str, dict[EntryPoint, Any]], rounds: int) -> list[dict[str, Any]]:
    """A row for each number of modes."""
    rows = []
    for modes in MODES:
        case = vibeam.load(CASE, set={"fidelity.beam.modes": modes, "beam.elements": 60})
        system, costs = case.system("beam"), {level: [] for level in levels}
        for turn in range(rounds + 1):
            for level in levels[turn % len(levels) :] + levels[: turn % len(levels)]:
                use(functions[level])
                seconds, impacts = sweep(system, case.base_amplitude)
                costs[level].append(1e9 * seconds / impacts)
        table = {level: np.array(cost[1:]) for level, cost in costs.items()}
        medians = {level: float(np.median(table[level] / table["numba"])) for level in levels}
        least = {level: float(table[level].min()) for level in levels}
        ratios = {level: least[level] / least["numba"] for level in levels}
        rows.append({"modes": modes, "impacts": impacts, "ns": least, "least over least": ratios, "median": medians})
        found = (f"{level} {least[level]:.0f} ns ({ratios[level]:.3f}, {medians[level]:.3f})" for level in levels)
        print(f"{modes:3} modes, {impacts} impacts:", *found)
    return rows


def calls(levels: list[str], functions: dict[str, dict[EntryPoint, Any]], count: int = 2000) -> dict[str, float]:
    """µs of CPU time of a call of ``move`` that does nothing, with the arrays of the call before."""
    from vibeam.flight import event_driven
    from vibeam.flight.solver import FlightSolver

    made = FlightSolver(vibeam.ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, restitution=0.9), 1.0)
    kept: list[Any] = []
    original = event_driven.unpaused

    def noted(move: Any, *given: Any) -> Any:
        kept[:] = given
        return original(move, *given)

    event_driven.unpaused = noted
    made.steady([2.0], 0.0, None, 1, 1, "contact")
    event_driven.unpaused = original
    given = [*kept[:5], 1e-300, *kept[6:]]
    least: dict[str, float] = dict.fromkeys(levels, np.inf)
    for _ in range(7):
        for level in levels:
            function = next(found for entry, found in functions[level].items() if entry.library == "flight")
            begun = time.thread_time()
            for _ in range(count):
                function(*given)
            least[level] = min(least[level], 1e6 * (time.thread_time() - begun) / count)
    return least


def ready() -> dict[str, float]:
    """CPU s of a fresh process to import the engines, and to open all libraries: the least of five."""
    found = []
    for _ in range(5):
        done = subprocess.run([sys.executable, "-c", READY], capture_output=True, text=True, check=True)
        found.append([float(each) for each in done.stdout.split()])
    imported, opened = np.min(found, axis=0)
    return {"import": float(imported), "open": float(opened)}


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=200)
    parser.add_argument("--out", type=Path, default=HERE / "results" / "libraries.json")
    arguments = parser.parse_args()
    here, load_before = loading.level_of_processor(), os.getloadavg()[0]
    levels = [level for level in ("numba", here, "x86-64-v2") if level]
    functions = {level: {entry: taken(level)(entry) for entry in ENTRIES} for level in dict.fromkeys(levels)}
    found = {
        "ready": ready(),
        "call": calls(list(functions), functions),
        "impact": measured(list(functions), functions, arguments.rounds),
        "rounds": arguments.rounds,
        "made with": manifest()["made_with"],
        "machine": {"processors": os.cpu_count(), "level": here, "load": [load_before, os.getloadavg()[0]]},
    }
    arguments.out.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(json.dumps({name: found[name] for name in ("ready", "call", "machine")}))


if __name__ == "__main__":
    main()
