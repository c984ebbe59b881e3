"""Mutants that load, built and run as a command would, in a process with limits: no traceback, no hang, < 2 GiB."""

from __future__ import annotations

import sys
import tempfile
from itertools import count
from pathlib import Path

import numpy as np
from case_texts import beside
from limited import GIB, Ended, Limits, run_limited
from mutants import Mutant, judged, mutant
from short_runs import shortened
from verdict import Verdict
from workers import Stage

from vibeam.case.case import Case
from vibeam.cli.main import main
from vibeam.exchange.faults import CaseError
from vibeam.runs.store.file import read
from vibeam.system.quantities import Ended as Reason


def judge(seed: int, number: int, stage: Stage) -> Verdict:
    """A mutant that loads, built and run."""
    made, short = mutant_that_loads(seed, number)
    verdict, limits = Verdict(), Limits()
    stage(str(made))
    ended, fault = fault_of_run(short, made.origin, limits)
    verdict.count(f"exit {ended.code}")
    verdict.measure("GiB", ended.resident / GIB, limits.memory / GIB)
    verdict.measure("seconds", ended.seconds, float("inf"))
    verdict.hold(not fault, f"{made}: {fault}")
    return verdict


def mutant_that_loads(seed: int, number: int) -> tuple[Mutant, str]:
    """The first attempt of that number that is a case, and stays one when made short; that short case."""
    for attempt in count(1):
        made = mutant(seed, number, attempt)
        case, _ = judged(made)
        if not isinstance(case, CaseError) and (short := _short(case)):
            return made, short
    raise AssertionError


def _short(case: Case) -> str:
    from vibeam.casefile.read import parse

    text = shortened(case)
    try:
        parse(text, case.path)
    except CaseError:
        return ""
    return text


def run_case(text: str, folder: Path, limits: Limits) -> Ended:
    """``vibeam run`` of a case in ``folder``."""
    (folder / "mutant.toml").write_text(text, encoding="utf-8")

    def command() -> None:
        sys.argv = ["vibeam", "run", "mutant.toml", "--out", "mutant.h5"]
        main()

    return run_limited(command, folder, limits)


def fault_of_run(text: str, origin: Path, limits: Limits) -> tuple[Ended, str]:
    """Run of a case, with what lies beside its ``origin``, and its fault; empty: none."""
    with tempfile.TemporaryDirectory() as where:
        folder = Path(where)
        for place in (place for place in beside() if place.parent == origin.parent):
            (folder / place.name).write_text(beside()[place], encoding="utf-8")
        ended = run_case(text, folder, limits)
        fault = ended.fault(limits) or _warned(ended) or (fault_of_file(folder / "mutant.h5") if not ended.code else "")
        left = [path.name for path in folder.iterdir() if path.name.startswith(".")]
        return ended, fault or (f"left behind: {', '.join(left)}" if left else "")


def _warned(ended: Ended) -> str:
    line = next((line for line in ended.err.splitlines() if "Warning" in line), "")
    return f"warning: {line}" if line else ""


def fault_of_file(path: Path) -> str:
    """A point is finite and complete, or it says why not."""
    for at, response in read(path).items():
        complete = response.ended == Reason.COMPLETE.code
        finite = np.isfinite(response.amplitude) & np.isfinite(response.reach)
        if np.any(complete & ~finite):
            return f"{'/'.join(at)}: a complete point that is not finite"
        if np.any(response.ended == Reason.NOT_RUN.code):
            return f"{'/'.join(at)}: a point that was not run"
    return ""
