"""A map by one process and by 64 parts that are killed at random: to the bit, CPU times, files, the price beforehand.

    nice python tests/benchmarks/parts.py --points 4e6              # one process, then parts: both files compared
    nice python tests/benchmarks/parts.py --points 1e8 --alone 100  # parts; so many blocks computed here and compared
    python tests/benchmarks/parts.py --rounds   # the share of other computations that parts take over, a minute

Points of one mode, each from rest over ``PERIODS`` drive periods. First the command says its price, and that of ten
times as many points. Then one process computes the map, if it is to, and 64 processes, one after the other, its parts;
some of them are killed by a signal at a random instant and run again. Each process writes the CPU time of every block
to a file (``timed_blocks``), so that what is not spent in the blocks that are kept (starting, writing, what a kill
loses, blocks computed twice, gathering) is known, whatever else slows the machine: ``beside`` is that over the blocks'
time, and the overhead of parts is (1 + that of parts)/(1 + that of one process) − 1.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from math import isqrt
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp
from typing import Any

import h5py
import numpy as np

import vibeam
from vibeam.maps.run import work_of
from vibeam.report.declaration import STUDIES
from vibeam.runs.transient.run import run_record
from vibeam.store.long_work import LongWork
from vibeam.store.parts import take_part
from vibeam.store.shares import Sharing, sharing

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PARTS, PERIODS = 64, 16
CASE = """[sdof]
natural_frequency = "1 rad/s"
damping_ratio = 0.02
[stop]
gap = 0
restitution = 0.7
[drive]
amplitude = 1.0
[sweep]
frequency = ["0.2 Hz"]
settle = {settle}
hold = 8
[fidelity.one]
[map.m]
axes = [
  {{ key = "stop.gap", from = -1, to = 2, points = {side} }},
  {{ key = "sweep.frequency", from = "0.2 Hz", to = "0.5 Hz", points = {side} }},
]
direction = "apart"
quantities = ["amplitude", "period"]
"""


class Command:
    """Commands in a folder, with the CPU s of all their processes and of their blocks; ``name``: of the map's file."""

    def __init__(self, folder: Path, name: str) -> None:
        self.folder, self.name, self.cpu, self.processes = folder, name, 0.0, 0
        self.path = folder / name
        self.times = folder / f"{name}.times"

    def __call__(self, *words: str, kill: tuple[float, int] | None = None) -> tuple[int, str]:
        """Exit code of a command and what it says; ``kill``: a signal after so many seconds."""
        paths = os.pathsep.join(map(str, (HERE, ROOT, ROOT / "models", ROOT / "reductions")))
        given = {**os.environ, "PYTHONPATH": paths, "OMP_NUM_THREADS": "1", "TIMED_BLOCKS": str(self.times)}
        line = [sys.executable, "-m", "vibeam", "--load", "timed_blocks", "map", "case.toml", "--out", self.name]
        with (self.folder / "said").open("w+b") as said:
            process = subprocess.Popen([*line, *words], cwd=self.folder, env=given, stdout=said, stderr=said)
            if kill is not None:
                time.sleep(kill[0])
                os.kill(process.pid, kill[1])  # not reaped before it is waited for
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            said.seek(0)
            text = said.read().decode()
        self.cpu += used.ru_utime + used.ru_stime
        self.processes += 1
        return process.returncode, text

    def done(self, *words: str) -> str:
        """What a command says that must end well."""
        code, text = self(*words)
        if code:
            raise SystemExit(f"{words}: exit code {code}\n{text}")
        return text

    def blocks(self) -> dict[str, float]:
        """CPU s of the blocks, each once, and what was spent on those computed again."""
        rows = [line.split() for line in self.times.read_text(encoding="utf-8").splitlines()]
        once = {(first, last): float(seconds) for first, last, seconds in rows}
        every = sum(float(row[2]) for row in rows)
        return {"number": len(once), "once": sum(once.values()), "again": every - sum(once.values())}

    def found(self) -> dict[str, Any]:
        """CPU s of all processes and of the blocks."""
        blocks = self.blocks()
        return {"cpu": self.cpu, "processes": self.processes, "blocks": blocks, "beside": self.cpu / blocks["once"] - 1}


def in_parts(command: Command, kills: int, rng: random.Random) -> dict[str, Any]:
    """All parts, in random order, some of them killed at a random instant and run again, and the gathering."""
    order = rng.sample(range(1, PARTS + 1), PARTS)
    doomed, killed, took = set(rng.sample(order, kills)), {"SIGKILL": 0, "SIGTERM": 0}, [1.0]
    for part in order:
        words, code = ("--part", f"{part}/{PARTS}"), -1
        if part in doomed:
            by = rng.choice([signal.SIGKILL, signal.SIGTERM])
            code, text = command(*words, kill=(rng.uniform(0.5, max(took)), by))
            if code not in (0, -by, 128 + by):
                raise SystemExit(f"part {part}: exit code {code} after {by.name}\n{text}")
            killed[by.name] += code != 0
        if code:
            begun = time.monotonic()
            command.done(*words)
            took.append(time.monotonic() - begun)
        print(f"part {part}: {took[-1]:.0f} s", flush=True)
    files = len(list((command.folder / f"{command.name}.parts").iterdir()))
    size = sum(file.stat().st_size for file in (command.folder / f"{command.name}.parts").iterdir())
    before = command.cpu
    command.done("--gather")
    return {"killed": killed, "files": files, "bytes": size, "gathering": command.cpu - before}


def alike(one: Path, other: Path) -> bool:
    """Test whether all datasets of two files are the same to the bit, CPU times aside."""
    with h5py.File(one) as here, h5py.File(other) as there:
        names: list[str] = []
        here.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        names = [name for name in names if not name.startswith("provenance") and not name.endswith("seconds")]
        if "one/period" not in names or "one/amplitude" not in names:
            raise SystemExit(f"{one}: has {names}")
        return all(_same(here[name], there[name]) for name in names)


def _same(one: h5py.Dataset, other: h5py.Dataset) -> bool:
    if one.shape != other.shape or one.dtype != other.dtype:
        return False
    if not one.shape or one.dtype.kind not in "fiu":
        return bool(np.array_equal(one[()], other[()]))
    rows = range(0, one.shape[0], 1) if one.ndim > 2 else range(0, one.shape[0], 500)
    return all(
        one[row : row + rows.step].tobytes() == other[row : row + rows.step].tobytes() for row in rows
    )  # fmt: skip


def priced(command: Command, points: int) -> dict[str, Any]:
    """Price of a map of so many points, said in advance."""
    side = isqrt(points)
    (command.folder / "case.toml").write_text(CASE.format(side=side, settle=PERIODS - 8), encoding="utf-8")
    said = command.done("--price", "--json")
    found: dict[str, Any] = json.loads(said[said.index("{") :])["maps"][0]
    kept = ("seconds", "error", "points", "bytes", "files", "steps", "sampled")
    return {name: found[name] for name in kept}


def measured(folder: Path, points: int, kills: int, seed: int, alone: int) -> dict[str, Any]:
    """Prices, the map by one process unless its parts are ``alone``, by parts, and whether all is the same."""
    load = [os.getloadavg()[0]]
    ten = priced(Command(folder, "price.h5"), 10 * points)
    price = priced(Command(folder, "price.h5"), points)
    print(json.dumps([price, ten]), flush=True)
    one, parts = Command(folder, "one.h5"), Command(folder, "parts.h5")
    if not alone:
        one.done()
        load.append(os.getloadavg()[0])
        print(json.dumps(one.found()), flush=True)
    shared = in_parts(parts, kills, random.Random(seed))
    load.append(os.getloadavg()[0])
    found = {
        "points": price["points"], "periods": PERIODS, "of": PARTS, "price": price, "price of ten times": ten,
        "parts": parts.found() | shared, "file": parts.path.stat().st_size, "load": load, "processors": os.cpu_count(),
    }  # fmt: skip
    if alone:
        return found | {"compared": alone, "same": blocks_alike(folder, parts.path, alone, random.Random(seed))}
    over = (1 + found["parts"]["beside"]) / (1 + one.found()["beside"]) - 1
    return found | {"one": one.found(), "overhead": over, "same": alike(one.path, parts.path)}


def blocks_alike(folder: Path, path: Path, count: int, rng: random.Random) -> bool:
    """Test whether blocks that are computed here, drawn at random, are in a map's file to the bit."""
    case = vibeam.load(folder / "case.toml")
    work = work_of(case, case.maps["m"], path)
    with h5py.File(path) as file:
        return all(
            file["one"][name][:, step.first : step.last].tobytes() == np.moveaxis(values, 1, 0).tobytes()
            for step in rng.sample(list(work.every), count)
            for name, values in work.evaluate(step).items()
        )


def studies() -> dict[str, tuple[str, Callable[[], Any]]]:
    """Computations that hand over rounds, by command, each of a case."""
    truck, uncertain = "inputs/truck.toml", "uncertain/neutral.toml"
    few = {"record.realisations": 4, "record.duration": "2 s", "uncertain": {"stop.restitution": "± 0.02"}}
    noise = vibeam.load(ROOT / "cases" / truck, few)
    gaps = {"stop.gap": [0.0, 1e-4, 2e-4]}
    return {
        "uncertainty": (uncertain, lambda: vibeam.uncertainty(ROOT / "cases" / uncertain, samples=64)),
        "uncertainty, of a record": (truck, lambda: vibeam.uncertainty(noise, samples=16)),
        "map, of a record": (truck, lambda: vibeam.studies.record_map(noise, gaps)),
        "run, of a record": (truck, lambda: run_record(noise, None, lambda *_: None, False, print, show=False)),
        "fit": ("synthetic/fit.toml", lambda: vibeam.fit(ROOT / "cases/synthetic/fit.toml")),
        "fit, no closed form": (
            "synthetic/linear_stop.toml", lambda: vibeam.fit(ROOT / "cases/synthetic/linear_stop.toml"),
        ),
    }  # fmt: skip


def rounds() -> dict[str, Any]:
    """CPU s of each computation, and of its rounds, by name."""
    found = {}
    for name, (case, compute) in studies().items():
        taken: dict[str, float] = {}

        def take(work: LongWork, _: object, taken: dict[str, float] = taken) -> None:
            begun = time.process_time()
            take_part(work)
            what = next(iter(work.steps))
            taken[what] = taken.get(what, 0.0) + time.process_time() - begun

        with TemporaryDirectory() as folder, sharing(Sharing(Path(folder) / "out", take)):
            begun = time.process_time()
            compute()
            found[name] = {"case": case, "cpu": time.process_time() - begun, "rounds": taken}
        print(name, found[name], flush=True)
    assert {name.partition(",")[0] for name, each in STUDIES.items() if each.parts} <= set(found)
    return found


def main(words: Sequence[str] | None = None) -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=float, default=4e6)
    parser.add_argument("--alone", type=int, default=0, metavar="BLOCKS")
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rounds", action="store_true")
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--out", type=Path, default=HERE / "results" / "parts.json")
    asked = parser.parse_args(words)
    known = json.loads(asked.out.read_text(encoding="utf-8")) if asked.out.exists() else {}
    if asked.rounds:
        found = {"rounds": rounds(), "load of rounds": os.getloadavg()[0]}
    else:
        folder = Path(mkdtemp(dir=asked.folder))
        try:
            made = measured(folder, int(asked.points), asked.kills, asked.seed, asked.alone)
            found = {"alone" if asked.alone else "whole": made}
        finally:
            shutil.rmtree(folder)
    asked.out.write_text(json.dumps(known | found, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(found))


if __name__ == "__main__":
    main()
