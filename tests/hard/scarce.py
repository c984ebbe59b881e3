"""Runs that lack something: room on the disk, size of files, address space, open files; then they have it again."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
from commands import (
    DISTURBED,
    Run,
    difference,
    fault_of_completion,
    fault_of_message,
    limited,
    undisturbed,
    usual_environment,
    vibeam,
    write_case,
)
from verdict import Verdict
from workers import Stage

MIB = 2**20
KINDS = ("room", "file size", "address space", "open files")
NO_COMPILER = {"VIBEAM_KERNELS": "library"}  # else a library that finds no room is compiled anew, for minutes

FULL = """
mount -t tmpfs -o size={size} none {folder} && cp {case} {folder} && cd {folder} || exit 99
{python} -m vibeam run {name}; code=$?
mount -o remount,size=64m . && {python} -m vibeam run {name} >&2 || exit 98
cp *.h5 {out}; ls -A > {out}/names; exit $code
"""


def judge(seed: int, number: int, stage: Stage) -> Verdict:
    """One case under one limit, then without."""
    rng = np.random.default_rng([seed, number])
    name, kind = str(rng.choice(list(DISTURBED))), KINDS[number % len(KINDS)]
    verdict = Verdict()
    stage(f"{name}, {kind}")
    if kind == "room" and not may_mount():
        verdict.count("no mount")
        return verdict
    with tempfile.TemporaryDirectory() as where:
        folder = Path(where)
        write_case(name, folder)
        if kind == "room":
            ran, fault = _without_room(name, folder, int(rng.uniform(0.05, 1.3) * len(undisturbed(name).content)))
        else:
            before, what = _limit(kind, name, rng)
            ran = vibeam(["run", f"{name}.toml"], folder, before=before, environment=usual_environment() | NO_COMPILER)
            fault = fault_of_message(ran, [0, 2])
            fault = f"{what}: {fault}" if fault else fault_of_completion(name, folder)
        verdict.count(f"{kind}, exit {ran.code}")
        verdict.hold(not fault, f"{name}, {kind}: {fault}")
    return verdict


def _limit(kind: str, name: str, rng: np.random.Generator) -> tuple[Callable[[], None], str]:
    if kind == "file size":
        most = int(10 ** rng.uniform(3, 7.5))
        return limited(resource.RLIMIT_FSIZE, most), f"files of {most} bytes"
    if kind == "open files":
        most = int(rng.integers(8, 24))
        return limited(resource.RLIMIT_NOFILE, most), f"{most} open files"
    most = int(rng.uniform(60, 900)) * MIB
    return limited(resource.RLIMIT_AS, most), f"{most // MIB} MiB"


@cache
def may_mount() -> bool:
    """Whether this user may mount a small file system of its own."""
    try:
        done = subprocess.run(
            ["unshare", "-m", "sh", "-c", "mount -t tmpfs none /mnt"], capture_output=True, check=False, timeout=60
        )
    except OSError:
        return False
    return done.returncode == 0


def _without_room(name: str, folder: Path, size: int) -> tuple[Run, str]:
    """On a file system of ``size`` bytes, which then grows."""
    inner = folder / "full"
    inner.mkdir()
    script = FULL.format(
        size=size, folder=inner, case=folder / f"{name}.toml", python=sys.executable, name=f"{name}.toml", out=folder
    )
    done = subprocess.run(
        ["unshare", "-m", "sh", "-c", script], capture_output=True, text=True, check=False, env=usual_environment()
    )
    ran = Run(done.returncode, done.stdout, done.stderr, 0.0)
    if fault := fault_of_message(ran, [0, 2]):
        return ran, f"{size} bytes: {fault}"
    left = set((folder / "names").read_text().split(os.linesep)) - {""} - undisturbed(name).files
    return ran, f"left behind: {', '.join(left)}" if left else difference(folder / f"{name}.h5", name)
