"""Two writers of one results file, started at once: one writes, the other says so; the file is whole."""

from __future__ import annotations

import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from commands import DISTURBED, Run, fault_of_completion, fault_of_message, undisturbed, vibeam, write_case
from verdict import Verdict
from workers import Stage


def judge(seed: int, number: int, stage: Stage) -> Verdict:
    """Two runs of one case, the second up to half a run later, then a third."""
    rng = np.random.default_rng([seed, number])
    name, later = str(rng.choice(list(DISTURBED))), float(rng.choice([0.0, rng.uniform(0, 0.5)]))
    verdict = Verdict()
    with tempfile.TemporaryDirectory() as where:
        folder = Path(where)
        write_case(name, folder)
        with ThreadPoolExecutor() as pool:
            both = list(pool.map(lambda delay: _started(name, folder, delay), (0.0, later * undisturbed(name).seconds)))
        refused = [ran for ran in both if ran.code == 2]
        verdict.count("writers", 2)
        verdict.count("refused", len(refused))
        for fault in (*(fault_of_message(ran, [0, 2]) for ran in both), _fault_of(both, refused)):
            verdict.hold(not fault, f"{name}: {fault}")
        stage(f"{name}, continued")
        fault = fault_of_completion(name, folder)
        verdict.hold(not fault, f"{name}: {fault}")
    return verdict


def _started(name: str, folder: Path, delay: float) -> Run:
    time.sleep(delay)
    return vibeam(["run", f"{name}.toml"], folder)


def _fault_of(both: list[Run], refused: list[Run]) -> str:
    if len(refused) == len(both):
        return "both were refused"
    other = [ran.err for ran in refused if "is writing it" not in ran.err and "another program" not in ran.err]
    return f"refused for another reason: {other[0]}" if other else ""
