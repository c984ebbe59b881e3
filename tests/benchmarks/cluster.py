"""Two local Dask workers against one local process without Dask: wall and CPU times of one map.

    python tests/benchmarks/cluster.py [--rounds 2] [--settle 120000] [--out tests/benchmarks/results/cluster.json]

Scheduler and workers are processes of one thread each. The sides take turns; of each the round of the least wall time
is kept. On a machine with other work the speed-up says little; the overhead does: CPU time of scheduler, workers and
client over that of one local thread, beside that of two local threads, which share the processor's caches alike. Then
``BLOCKS`` blocks of next to no work: what one costs the client and the scheduler bounds how many cores they can feed.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import psutil  # type: ignore[import-untyped]

import vibeam
from vibeam.maps import evaluate as grids
from vibeam.maps.cluster import Cluster, connected

HERE = Path(__file__).parent

ROOT = HERE.parents[1]

AXES = [
    {"key": "stop.gap", "from": 0.0, "to": 1e-4, "points": 48},
    {"key": "sweep.frequency", "from": "14 Hz", "to": "17 Hz", "points": 30},
]

BLOCKS = 600


def case_of(settle: int) -> vibeam.Case:
    """A case with the map."""
    table = {"axes": AXES, "fidelities": ["sdof"], "direction": "both", "settle": settle, "hold": 50}
    return vibeam.load(ROOT / "cases/dtu_neutral.toml", set={"units": "SI", "map": {"m": table}})


def handed_over(folder: Path, processes: list[psutil.Process], cluster: Cluster) -> dict[str, float]:
    """Wall and CPU s a block where a block is one line of two points and one period each."""
    axes = [AXES[0] | {"points": BLOCKS}, AXES[1] | {"points": 2}]
    table = {"axes": axes, "fidelities": ["sdof"], "direction": "apart", "settle": 1, "hold": 1}
    case = vibeam.load(ROOT / "cases/dtu_neutral.toml", set={"units": "SI", "map": {"m": table}})
    kept = grids.SECONDS, grids.LEAST
    grids.SECONDS, grids.LEAST = 0.0, 1
    try:
        found = timed(case, folder, processes, cluster=cluster)
    finally:
        grids.SECONDS, grids.LEAST = kept
    return {name: value / BLOCKS for name, value in found.items()}


@contextmanager
def workers(folder: Path, count: int) -> Iterator[tuple[str, list[psutil.Process]]]:
    """A scheduler and its workers: the scheduler's file, and the processes."""
    file = folder / "scheduler.json"
    paths = os.pathsep.join(map(str, (ROOT, ROOT / "models", ROOT / "reductions", os.environ.get("PYTHONPATH", ""))))
    given: Any = {
        "env": os.environ | {"PYTHONPATH": paths, "OMP_NUM_THREADS": "1"}, "cwd": folder,
        "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL,
    }  # fmt: skip
    start = [sys.executable, "-m"]
    known = ["--no-dashboard", "--scheduler-file", str(file)]
    begun = [subprocess.Popen([*start, "distributed.cli.dask_scheduler", "--port", "0", *known], **given)]
    options = ["--nthreads", "1", "--no-nanny", *known]
    begun += [subprocess.Popen([*start, "distributed.cli.dask_worker", *options], **given) for _ in range(count)]
    try:
        while not file.exists():
            time.sleep(0.1)
        yield str(file), [psutil.Process(each.pid) for each in begun]
    finally:
        for process in begun:
            process.kill()
            process.wait()


@contextmanager
def both(file: str) -> Iterator[Cluster]:
    """The cluster, once both workers have come: two blocks in flight for each."""
    for _ in range(100):
        with connected(file) as cluster:
            if cluster.blocks == 4:
                yield cluster
                return
        time.sleep(0.2)
    raise SystemExit("two workers did not come")


def cpu_of(processes: list[psutil.Process]) -> float:
    """CPU s of some processes so far."""
    return sum(sum(process.cpu_times()[:2]) for process in processes)


def timed(case: vibeam.Case, folder: Path, others: list[psutil.Process], **more: Any) -> dict[str, float]:
    """Wall and CPU s of one run of the map."""
    every = {"client": [psutil.Process()], "scheduler": others[:1], "workers": others[1:]}
    wall, cpu = time.perf_counter(), {name: cpu_of(each) for name, each in every.items()}
    vibeam.run_map(case, "m", folder / "m.h5", fresh=True, **more)
    used = {name: cpu_of(each) - cpu[name] for name, each in every.items()}
    return {"wall": time.perf_counter() - wall, "cpu": sum(used.values())} | used


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--settle", type=int, default=120_000)
    parser.add_argument("--out", type=Path, default=HERE / "results" / "cluster.json")
    arguments = parser.parse_args()
    case = case_of(arguments.settle)
    sides: dict[str, list[dict[str, float]]] = {"one thread": [], "two threads": [], "two workers": []}
    load = [os.getloadavg()[0]]
    with tempfile.TemporaryDirectory() as where, workers(Path(where), 2) as (file, processes):
        folder = Path(where)
        with both(file) as cluster:
            timed(case_of(20), folder, processes, cluster=cluster)  # every process has its libraries open
            for _ in range(arguments.rounds):
                sides["one thread"].append(timed(case, folder, [], workers=1))
                sides["two threads"].append(timed(case, folder, [], workers=2))
                sides["two workers"].append(timed(case, folder, processes, cluster=cluster))
            block = handed_over(folder, processes, cluster)
    load.append(os.getloadavg()[0])
    best = {name: min(rounds, key=lambda each: each["wall"]) for name, rounds in sides.items()}
    least = {name: min(each["cpu"] for each in rounds) for name, rounds in sides.items()}
    found = {
        "speed-up": best["one thread"]["wall"] / best["two workers"]["wall"],
        "CPU over that of one thread": {name: value / least["one thread"] for name, value in least.items()},
        **sides,
        "a block of no work": block,
        "machine": {"processors": os.cpu_count(), "load": load},
    }
    arguments.out.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(found))


if __name__ == "__main__":
    main()
