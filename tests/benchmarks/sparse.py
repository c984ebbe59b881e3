"""Cost of a case of sparse matrices: read from its files, reduced to 20 modes and to the static mode.

    python tests/benchmarks/sparse.py [--out tests/benchmarks/results/sparse.json]

A net of knots between springs, its edge fixed, whose frequencies are known in closed form (``error``: of the twenty);
each row in a process of its own, CPU time and the largest memory of which are kept. Of the smallest net the same is
done with full matrices too.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from scipy.io import mmwrite
from scipy.sparse import csc_array, diags_array, eye_array, kron

import vibeam
import vibeam.casefile.matrices

HERE = Path(__file__).parent

MODES = 20

STIFFNESS, MASS = 1e4, 0.3

NETS = {
    "900, full matrices": (30, 30),
    "900": (30, 30),
    "5 041": (71, 71),
    "20 022": (141, 142),
    "50 176": (224, 224),
    "19 683, a lattice in space": (27, 27, 27),
}

CASE = """\
[matrices]
units = "SI"
mass = "M.mtx"
stiffness = "K.mtx"
damping_ratio = 0.02
contact = {contact}
sensor = {sensor}
base = "all"
[stop]
gap = "1 mm"
restitution = 0.7
[drive]
amplitude = "0.1 mm"
[sweep]
frequency = ["1 Hz"]
settle = 20
hold = 10
[fidelity.sdof]
reduction = "static_mode"
[fidelity.beam]
reduction = "modal"
modes = {modes}
"""


def written(folder: Path, *knots: int) -> Path:
    """The net, or a lattice in space, as a case with its files."""
    size, K = int(np.prod(knots)), csc_array((int(np.prod(knots)),) * 2)
    for axis, n in enumerate(knots):
        chain = diags_array([-np.ones(n - 1), 2 * np.ones(n), -np.ones(n - 1)], offsets=[-1, 0, 1])
        before, after = int(np.prod(knots[:axis])), int(np.prod(knots[axis + 1 :]))
        K = K + STIFFNESS * csc_array(kron(kron(eye_array(before), chain), eye_array(after)))
    mmwrite(folder / "K.mtx", K, symmetry="symmetric")
    mmwrite(folder / "M.mtx", csc_array(MASS * eye_array(size)), symmetry="symmetric")
    (folder / "net.toml").write_text(CASE.format(contact=size // 3, sensor=size // 5, modes=MODES))
    return folder / "net.toml"


def lowest(*knots: int) -> np.ndarray:
    """ω² of the lowest modes in closed form: each chain adds 4k/m sin² iπ/2(n+1)."""
    squared = np.zeros(1)
    for n in knots:
        squared = np.add.outer(squared, np.sin(np.arange(1, n + 1) * np.pi / (2 * (n + 1))) ** 2).ravel()
    return np.sort(4 * STIFFNESS / MASS * squared)[:MODES]


def measured(name: str) -> dict[str, Any]:
    """One row, in this process."""
    knots = NETS[name]
    if name == "900":
        vibeam.casefile.matrices.DENSE = 0
    with TemporaryDirectory() as folder:
        path = written(Path(folder), *knots)
        clock = [time.process_time()]
        case = vibeam.load(path)
        clock.append(time.process_time())
        system = case.system("beam")
        clock.append(time.process_time())
        case.system("sdof")
        clock.append(time.process_time())
    off = float(np.max(np.abs(np.sort(system.omega**2) / lowest(*knots) - 1)))
    parts = dict(zip(("read", "modes", "static"), np.diff(clock).tolist(), strict=True))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {"name": name, "coordinates": int(np.prod(knots)), **parts, "error": off, "megabytes": peak}


def main() -> None:
    """Measure, print and store."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=HERE / "results" / "sparse.json")
    parser.add_argument("--row", choices=NETS, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.row:
        print(json.dumps(measured(given.row)))
        return
    before, found = os.getloadavg(), []
    for name in NETS:
        command = [sys.executable, __file__, "--row", name]
        found.append(json.loads(subprocess.run(command, capture_output=True, check=True, text=True).stdout))
        row = found[-1]
        print(f"{name:<26} read {row['read']:.2f} s, modes {row['modes']:.2f} s, static {row['static']:.2f} s")
    full, sparse = (row["modes"] + row["static"] for row in found[:2])
    print(f"full over sparse, {found[0]['coordinates']} coordinates: {full / sparse:.1f}")
    load = {"before": before, "after": os.getloadavg()}
    given.out.write_text(json.dumps({"rows": found, "load": load}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
