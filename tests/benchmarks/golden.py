"""Numbers and texts of two checkouts, equal or not: what a rebuilding may change is nothing.

    python tests/benchmarks/golden.py BEFORE AFTER [--points 9] [--only cases/dtu]

BEFORE and AFTER are folders of checkouts. Compared are the texts of ``vibeam keys`` and ``vibeam new``, the JSON of the
commands that fly nothing, and every dataset and attribute of the results file of every case of BEFORE, run over at most
``--points`` of its frequencies (0: all of them), without what is measured or says where and when. The exit code is the
number of differences, 99 at most.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

import h5py
import numpy as np

TEXTS = (["keys", "--json"], ["keys", "--schema"], ["new", "new.toml"], ["new", "short.toml", "--short"])
ASKED = ("modes", "derive")
MEASURED = ("seconds", "checksum", "provenance", "key", "cpu", "whole", "shared", "code", "ns_each")

RUN = """
import sys, vibeam
file, out, points = sys.argv[1], sys.argv[2], int(sys.argv[3])
case = vibeam.load(file)
grid = [] if case.sweep is None else case.sweep.frequency.tolist()
few = grid if not points else grid[:: max(1, -(-len(grid) // points))]
short = {"sweep.frequency": few, "units": "SI"}
vibeam.run(vibeam.load(file, set=short) if few and few != grid else case, out=out, show=False)
"""


def main() -> int:
    """Compare; the number of differences."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--points", type=int, default=9)
    parser.add_argument("--only", default="cases")
    given = parser.parse_args()
    both = given.before.resolve(), given.after.resolve()
    files = sorted(file.relative_to(both[0]) for file in (both[0] / "cases").rglob("*.toml"))
    files = [file for file in files if str(file).startswith(given.only)]
    with ThreadPoolExecutor(2) as pool:
        rows = [f"{' '.join(words)}: differs" for words in TEXTS if len({text(each, words) for each in both}) > 1]
        for found in pool.map(lambda file: differences(both, file, given.points), files):
            rows += found
    print("\n".join(rows) or f"{len(files)} cases and {len(TEXTS)} texts are equal")
    return min(len(rows), 99)


def text(checkout: Path, words: list[str]) -> str:
    """What a command prints, and the file that it writes."""
    with TemporaryDirectory() as folder:
        done = called(checkout, ["-m", "vibeam", *words], Path(folder))
        return done.stdout + "".join(file.read_text(encoding="utf-8") for file in sorted(Path(folder).iterdir()))


def called(checkout: Path, words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Python with the packages of ``checkout``, in ``folder``."""
    places = os.pathsep.join(str(checkout / part) for part in ("", "models", "reductions"))
    environment = os.environ | {"PYTHONPATH": places, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    return subprocess.run([sys.executable, *words], cwd=folder, env=environment, capture_output=True, text=True)


def differences(both: tuple[Path, Path], file: Path, points: int) -> list[str]:
    """What differs of a case, a line each."""
    with TemporaryDirectory() as place:
        folders = [Path(place) / name for name in ("before", "after")]
        found = []
        for checkout, folder in zip(both, folders, strict=True):
            folder.mkdir()
            ended = called(checkout, ["-c", RUN, str(both[0] / file), "run.h5", str(points)], folder)
            numbers = dict(datasets(folder / "run.h5")) if ended.returncode == 0 else {"ended": ended.stderr[-300:]}
            found.append(numbers | answers(checkout, both[0] / file, folder))
        here, there = found
        names = sorted({*here, *there})
        return [f"{file}: {name}{size(here, there, name)}" for name in names if not same(here, there, name)]


def answers(checkout: Path, file: Path, folder: Path) -> dict[str, object]:
    """The JSON of the commands, without what is measured; a command that the case does not take, by its message."""
    found: dict[str, object] = {}
    for name in ASKED:
        done = called(checkout, ["-m", "vibeam", name, str(file), "--json"], folder)
        if done.returncode:
            found[f"vibeam {name}"] = done.stderr
            continue
        said = json.loads(done.stdout)
        rows = said["rows"] if isinstance(said, dict) else said
        found[f"vibeam {name}"] = json.dumps(without_measured(rows), sort_keys=True)
    return found


def without_measured(value: object) -> object:
    """JSON without the keys of measured values."""
    if isinstance(value, dict):
        return {key: without_measured(each) for key, each in value.items() if not is_measured(key)}
    return [without_measured(each) for each in value] if isinstance(value, list) else value


def is_measured(name: str) -> bool:
    """Whether a key, dataset or attribute holds a time, or says where a number comes from."""
    return any(word in name for word in MEASURED)


def datasets(file: Path) -> Iterator[tuple[str, object]]:
    """Datasets and attributes of a results file by their path."""
    with h5py.File(file, "r") as opened:
        every: list[tuple[str, h5py.Group | h5py.Dataset]] = []
        opened.visititems(lambda name, node: every.append((name, node)))
        for name, node in every:
            if is_measured(name) or name.startswith("case/"):
                continue
            if isinstance(node, h5py.Dataset):
                yield name, node[()]
            for key, value in node.attrs.items():
                if not is_measured(key) and key not in ("DIMENSION_LIST", "REFERENCE_LIST"):
                    yield f"{name}@{key}", value


def same(here: dict[str, object], there: dict[str, object], name: str) -> bool:
    """Whether both have it, to the bit; NaN is equal to itself."""
    if name not in here or name not in there:
        return False
    a, b = np.asarray(here[name]), np.asarray(there[name])
    return a.shape == b.shape and a.dtype == b.dtype and (a.tobytes() == b.tobytes() or bool(np.all(a == b)))


def size(here: dict[str, object], there: dict[str, object], name: str) -> str:
    """By how much numbers differ, relative to the largest."""
    if name not in here or name not in there:
        return f" is in {'the second' if name in there else 'the first'} alone"
    a, b = np.asarray(here[name]), np.asarray(there[name])
    if a.shape != b.shape or a.dtype.kind != "f" or b.dtype.kind != "f":
        return " differs"
    scale = np.nanmax(np.abs(a), initial=0.0) or 1.0
    return f" differs by {np.nanmax(np.abs(a - b), initial=0.0) / scale:.1e}"


if __name__ == "__main__":
    raise SystemExit(main())
