"""Runs killed at random instants and continued: the final file has the data of an undisturbed run, bit by bit."""

from __future__ import annotations

import signal
import tempfile
from pathlib import Path

import numpy as np
from commands import DISTURBED, fault_of_completion, fault_of_message, undisturbed, vibeam, write_case
from verdict import Verdict
from workers import Stage

from vibeam.runs.store.file import read
from vibeam.store.errors import StoreError

SIGNALS = (signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
INTERRUPTED = 130


def judge(seed: int, number: int, stage: Stage) -> Verdict:
    """One case, killed one to three times at any instant, then run to its end."""
    rng = np.random.default_rng([seed, number])
    name = str(rng.choice(list(DISTURBED)))
    verdict = Verdict()
    with tempfile.TemporaryDirectory() as where:
        folder = Path(where)
        write_case(name, folder)
        for _ in range(min(3, int(rng.geometric(0.6)))):
            by = SIGNALS[int(rng.integers(len(SIGNALS)))]
            stage(f"{name}, {by.name}")
            verdict.count(by.name)
            fault = _killed(name, folder, by, float(rng.uniform(0, undisturbed(name).seconds)))
            verdict.hold(not fault, f"{name}, {by.name}: {fault}")
        stage(f"{name}, continued")
        fault = fault_of_completion(name, folder)
        verdict.hold(not fault, f"{name}: {fault}")
    return verdict


def _killed(name: str, folder: Path, by: signal.Signals, after: float) -> str:
    ran = vibeam(["run", f"{name}.toml"], folder, kill=(after, by))
    if fault := fault_of_message(ran, [0, -by, INTERRUPTED] if by == signal.SIGINT else [0, -by]):
        return f"after {after:.3f} s {fault}"
    try:
        file = folder / f"{name}.h5"
        if file.exists():
            read(file)
    except StoreError as fault:
        return f"after {after:.3f} s the file cannot be read: {fault}"
    return ""
