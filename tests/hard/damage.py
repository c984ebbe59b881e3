"""Damaged results: the run says so in one message, or ends with the data of an undisturbed run.

Of half a run the file or one of the blocks beside it is damaged.

Names and units for other programs are not data: vibeam does not read them back.
"""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from commands import DISTURBED, difference, undisturbed, vibeam, write_case
from limited import Limits, run_limited
from verdict import Verdict
from workers import Stage

from vibeam.cli.main import main
from vibeam.runs.store.file import read
from vibeam.store.errors import StoreError

KINDS = ("cut", "bits", "byte", "zeros", "noise", "moved", "appended", "holed")


def damaged(content: bytes, kind: str, rng: np.random.Generator) -> bytes:
    """The content with a piece lost, changed or moved."""
    at = int(rng.integers(len(content)))
    end = min(len(content), at + int(10 ** rng.uniform(0, 4)))
    changed = bytearray(content)
    if kind == "cut":
        del changed[at:]
    elif kind == "bits":
        for place in rng.integers(len(content), size=int(rng.integers(1, 6))):
            changed[place] ^= 1 << int(rng.integers(8))
    elif kind == "byte":
        changed[at] = int(rng.integers(256))
    elif kind == "zeros":
        changed[at:end] = bytes(end - at)
    elif kind == "noise":
        changed[at:end] = rng.bytes(end - at)
    elif kind == "moved":
        other = int(rng.integers(len(content) - (end - at) + 1))
        changed[at:end] = content[other : other + end - at]
    elif kind == "appended":
        changed += rng.bytes(end - at)
    else:
        del changed[at:end]
    return bytes(changed)


@cache
def half_done(name: str) -> dict[str, bytes]:
    """Files of a run that was killed with some of its points, by name."""
    with tempfile.TemporaryDirectory() as where:
        folder = Path(where)
        write_case(name, folder)
        for tenths in range(3, 10):
            if not (folder / f"{name}.h5").exists():
                vibeam(["run", f"{name}.toml"], folder, kill=(tenths / 10 * undisturbed(name).seconds, 9))
        return {str(file.relative_to(folder)): file.read_bytes() for file in folder.glob(f"{name}.h5*/**/*.npz")} | {
            f"{name}.h5": (folder / f"{name}.h5").read_bytes()
        }


def judge(seed: int, number: int, stage: Stage) -> Verdict:
    """One results file, whole or of half a run, damaged and then used."""
    rng = np.random.default_rng([seed, number])
    name, kind = str(rng.choice(list(DISTURBED))), KINDS[number % len(KINDS)]
    files = half_done(name) if rng.random() < 0.4 else {f"{name}.h5": undisturbed(name).content}
    verdict = Verdict()
    with tempfile.TemporaryDirectory() as where:
        folder = Path(where)
        write_case(name, folder)
        file, harmed = folder / f"{name}.h5", str(rng.choice(sorted(files)))
        for place, content in files.items():
            (folder / place).parent.mkdir(exist_ok=True)
            (folder / place).write_bytes(damaged(content, kind, rng) if place == harmed else content)
        stage(f"{name}, {kind}")
        ended = run_limited(lambda: _used(file), folder, Limits())
        fault = ended.fault(Limits()) or ("" if ended.code else _difference(file, name))
        verdict.count(f"{kind}, {'file' if harmed == file.name else 'block'}, exit {ended.code}")
        verdict.hold(not fault, f"{name}, {kind}: {fault}")
    return verdict


def _used(file: Path) -> None:
    """Read, as figures would; then continued, as a user would."""
    with contextlib.suppress(StoreError):
        read(file)
    os.environ["MPLBACKEND"] = "agg"
    sys.argv = ["vibeam", "run", file.with_suffix(".toml").name]
    main()


def _difference(file: Path, name: str) -> str:
    try:
        return difference(file, name, described=False)
    except (OSError, KeyError, RuntimeError, ValueError) as error:
        return f"a file that was taken cannot be read: {error}"
