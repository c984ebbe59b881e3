"""The kernels of web pages in node against the native libraries: the same calls, in turn.

    python tests/benchmarks/webassembly.py [--rounds 9] [--out tests/benchmarks/results/webassembly.json]

Motions of two and eight modes, response curves of 121 frequencies, 100 periods settled and 20 held. The whole of a
page's memory is noted before every call, so that node makes the very same ones. CPU time of these calls, the least
of all rounds, once node has optimised the functions.
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
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import vibeam
from vibeam.flight.engine.browser import FIRST, LIBRARIES
from vibeam.flight.engine.entries import ENTRIES, EntryPoint
from vibeam.flight.engine.loading import WASM, file_of, manifest
from vibeam.flight.points.points import PlainPoints, PointSettings, compute

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "support"))
import wasm_kernels  # noqa: E402
from javascript import NODE  # noqa: E402

OMEGA = 47.7 * np.array([1, 6.27, 17.55, 34.4, 56.8, 84.9, 118.6, 157.9])
FREQUENCIES = np.linspace(60.0, 140.0, 121)  # rad/s
LEAST = 300  # ms of a sample in node
PERIODS = {"settle": 100, "hold": 20}

IN_NODE = """
import { readFileSync } from "node:fs";
import { gunzipSync } from "node:zlib";
const { first, libraries, calls, least } = JSON.parse(readFileSync(0, "utf8"));
const memory = new WebAssembly.Memory({ initial: first / 65536 }), functions = {};
const spent = () => { const { user, system } = process.threadCpuUsage(); return (user + system) / 1000; };
for (const file of libraries) {
  const module = await WebAssembly.compile(gunzipSync(readFileSync(file)));
  Object.assign(functions, (await WebAssembly.instantiate(module, { env: { memory } })).exports);
}
function run(given, count, called) {
  const before = spent();
  for (let i = 0; i < count; i += 1)
    for (const [entry, bytes] of given) {
      new Uint8Array(memory.buffer).set(bytes, first);
      if (called && entry(first)) throw Error("a kernel failed");
    }
  return (spent() - before) / count;
}
const times = {};
for (const [name, images] of Object.entries(calls)) {
  const given = images.map(([entry, file]) => [functions[entry], readFileSync(file)]);
  const more = first + Math.max(...given.map(([, bytes]) => bytes.length)) - memory.buffer.byteLength;
  if (more > 0) memory.grow(Math.ceil(more / 65536));
  const count = Math.ceil(least / (run(given, 3, true) + 0.1));  // the system counts in steps of 4 ms
  run(given, count, true);
  times[name] = run(given, count, true) - run(given, count, false);
}
console.log(JSON.stringify(times));
"""


def system(modes: int, restitution: float) -> vibeam.ImpactSystem:
    """The first modes of a slender beam with its stop near the tip."""
    turn = np.arange(modes)
    return vibeam.ImpactSystem.from_modes(
        OMEGA[:modes], 0.01, contact=2 * (-1.0) ** turn, load=0.5 / (1 + turn), gap=1e-4, restitution=restitution
    )


def motion(modes: int) -> Callable[[], int]:
    """A motion of 15 s; the number of its impacts."""
    made = system(modes, 0.2)
    return lambda: len(vibeam.simulate(made, vibeam.Drive(95.0, 1e-3), 15.0).impact_times)


def curve(modes: int, restitution: float) -> Callable[[], int]:
    """A response curve, its points side by side; the number of its impacts while they are held."""
    one = np.ones(len(FREQUENCIES))
    points = PlainPoints(
        [system(modes, restitution)], np.zeros(len(one), np.int64), FREQUENCIES, 1e-3 * one, 1e-4 * one,
        restitution * one,
    )  # fmt: skip
    settings = PointSettings(**PERIODS, output="contact", strobes=0, elastic=False, most_modes=modes)
    return lambda: sum(int(part.response.impacts.sum()) for _, part in compute(points, settings))


WORK = {
    "motion, 2 modes": motion(2),
    "motion, 8 modes": motion(8),
    "curve, 1 mode, R 0.7": curve(1, 0.7),
    "curve, 2 modes, R 0.2": curve(2, 0.2),
    "curve, 2 modes, R 0.72": curve(2, 0.72),
}


def noted(folder: Path) -> dict[str, list[list[str]]]:
    """The calls of each piece of work: entry point, and the file with the page's memory before it."""
    found: dict[str, list[list[str]]] = {}
    wasm_kernels.take()
    for number, (name, work) in enumerate(WORK.items()):
        work()  # what is packed once
        with wasm_kernels.noted() as calls:
            work()
        found[name] = [[entry, str(folder / f"{number}-{index}")] for index, (entry, _, _) in enumerate(calls)]
        for (_, file), (_, before, _) in zip(found[name], calls, strict=True):
            Path(file).write_bytes(before)
    wasm_kernels.give_back()
    return found


def native(work: Callable[[], int], repeats: int) -> float:
    """Least CPU time of the calls alone, ms."""
    spent, called = [0.0], [each for each in ENTRIES if each.name in LIBRARIES.get(each.library, ())]

    def timed(entry: EntryPoint) -> Callable[..., Any]:
        function = entry.function

        def call(*given: Any) -> Any:
            begun = time.thread_time()
            found = function(*given)
            spent[-1] += 1e3 * (time.thread_time() - begun)
            return found

        return call

    for each in called:
        vars(each)["function"] = timed(each)
    for _ in range(repeats):
        spent.append(0.0)
        work()
    wasm_kernels.give_back()
    return min(spent[1:])


def measured(rounds: int, repeats: int = 7) -> list[dict[str, Any]]:
    """Least times of each piece of work, ms."""
    rows = {name: {"name": name, "impacts": work(), "native": np.inf, "wasm": np.inf} for name, work in WORK.items()}
    with TemporaryDirectory() as folder:
        given = {
            "first": FIRST, "calls": noted(Path(folder)), "least": LEAST,
            "libraries": [str(file_of(library, WASM)) for library in LIBRARIES],
        }  # fmt: skip
        command = [str(NODE), "--input-type=module", "--eval", IN_NODE]
        for _ in range(rounds):
            done = subprocess.run(command, input=json.dumps(given), capture_output=True, text=True, check=True)
            for name, spent in json.loads(done.stdout).items():
                row = rows[name]
                row["wasm"] = min(row["wasm"], spent)
                row["native"] = min(row["native"], native(WORK[name], repeats))
    return list(rows.values())


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--out", type=Path, default=HERE / "results" / "webassembly.json")
    arguments = parser.parse_args()
    before = os.getloadavg()[0]
    found = {
        "rows": measured(arguments.rounds),
        "rounds": arguments.rounds,
        "node": subprocess.run([NODE, "--version"], capture_output=True, text=True, check=True).stdout.strip(),
        "made with": manifest()["made_with"],
        "machine": {"processors": os.cpu_count(), "load": [before, os.getloadavg()[0]]},
    }
    arguments.out.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(found["rows"]))


if __name__ == "__main__":
    main()
