"""Maps killed at random instants and continued: the final file is that of an undisturbed run, bit by bit.

What was stored before a kill is there after it, is found by the next run, and is not computed again: no file of a
block changes, and the run says how many points it found.
"""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from functools import cache
from pathlib import Path

import numpy as np
from commands import BEAM, Undisturbed, data_of, fault_of_message, usual_environment, vibeam
from verdict import Verdict
from workers import Stage

from vibeam.store.steps import scanned

CASE = (
    BEAM
    + """[map.plane]
fidelities = ["sdof"]
axes = [
  { key = "drive.voltage", from = "0.2 V", to = "0.7 V", points = 100 },
  { key = "sweep.frequency", from = "14 Hz", to = "17 Hz", points = 20 },
]
direction = "both"
settle = 200
hold = 16
[map.starts]
picture = "basins"
fidelities = ["sdof"]
axes = [{ key = "drive.voltage", from = "0.2 V", to = "0.7 V", points = 40 },
  { key = "sweep.frequency", from = "14 Hz", to = "17 Hz", points = 6 }]
starts = 6
spread = "1 mm"
settle = 400
hold = 16
"""
)

COMMAND = ("--load", "small_blocks", "map", "rig.toml")

NAMES = ("plane", "starts")

FOUND = re.compile(r"continuing: (\d+) of (\d+) points")


@cache
def undisturbed(name: str) -> Undisturbed:
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "rig.toml").write_text(CASE, encoding="utf-8")
        ran = vibeam([*COMMAND, name], Path(folder))
        assert ran.code == 0, ran.err
        file = Path(folder, f"rig_{name}.h5")
        names = frozenset(path.name for path in Path(folder).iterdir())
        return Undisturbed(data_of(file), file.read_bytes(), names, ran.seconds)


def judge(seed: int, number: int, stage: Stage) -> Verdict:
    """One map, killed one to three times at any instant, then computed to its end."""
    rng = np.random.default_rng([seed, number])
    name, verdict = str(rng.choice(NAMES)), Verdict()
    with tempfile.TemporaryDirectory() as where:
        folder = Path(where)
        (folder / "rig.toml").write_text(CASE, encoding="utf-8")
        stored: dict[str, bytes] = {}
        for _ in range(min(3, int(rng.geometric(0.5)))):
            stage(f"{name}, killed")
            verdict.count("SIGKILL")
            if rng.random() < 0.7:
                killed_with(int(rng.integers(1, 60)), folder, name)
                stored = checked(verdict, folder, name, stored)
                continue
            ran = vibeam([*COMMAND, name], folder,
                         kill=(float(rng.uniform(0, undisturbed(name).seconds)), signal.SIGKILL))  # fmt: skip
            verdict.hold(not (fault := fault_of_message(ran, [0, -signal.SIGKILL])), f"{name}: {fault}")
            stored = checked(verdict, folder, name, stored)
        stage(f"{name}, continued")
        verdict.count("blocks stored before the last run", len(stored))
        verdict.hold(not (fault := completed(name, folder, bool(stored))), f"{name}: {fault}")
    return verdict


def killed_with(more: int, folder: Path, name: str) -> None:
    """Run the map until so many ``more`` blocks are stored, then kill it."""
    there = len(blocks(folder, name))
    process = subprocess.Popen(
        [sys.executable, "-m", "vibeam", *COMMAND, name], cwd=folder, env=usual_environment(),
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    while process.poll() is None and len(blocks(folder, name)) < there + more:
        time.sleep(0.002)
    process.kill()
    process.wait()


def checked(verdict: Verdict, folder: Path, name: str, before: dict[str, bytes]) -> dict[str, bytes]:
    """Blocks that are stored now; none of those before was written again, unless the map is finished."""
    now = blocks(folder, name)
    if not (folder / f"rig_{name}.h5").exists():
        verdict.hold(all(now.get(each) == mark for each, mark in before.items()), f"{name}: a block was redone")
    return now


def blocks(folder: Path, name: str) -> dict[str, bytes]:
    """Whole blocks that are stored, each by its file and place there, with what is there."""
    found = {}
    for path in (folder / f"rig_{name}.h5.parts").glob("[!.]*.steps"):
        with suppress(OSError):  # the map is finished meanwhile
            content = path.read_bytes()
            stored = scanned(path, content[: content.index(b"\n") + 1] if b"\n" in content else b"?")
            for number, (start, length) in stored.places.items():
                found[f"{path.name} {number} {start}"] = content[start : start + length]
    return found


def completed(name: str, folder: Path, stored: bool) -> str:
    """Continue the map: it ends well, finds what was stored, has the same data, leaves no other files."""
    whole = (folder / f"rig_{name}.h5").exists()
    ran = vibeam([*COMMAND, name], folder)
    if fault := fault_of_message(ran, [0]):
        return f"continued: {fault}"
    if stored and not whole and not FOUND.search(ran.err) and "are there already" not in ran.err:
        return f"stored blocks were not found: {ran.err[:200]}"
    found, wanted = data_of(folder / f"rig_{name}.h5"), undisturbed(name).data
    differing = sorted(key for key in found.keys() | wanted.keys() if found.get(key) != wanted.get(key))
    if differing:
        return f"continued: {len(differing)} data differ: {', '.join(differing[:4])}"
    more = sorted({path.name for path in folder.iterdir()} - undisturbed(name).files)
    return f"left behind: {', '.join(more)}" if more else ""
