"""Random rigs, random impacts and what else is tried for as long as there is time; the report is a committed file.

    python tests/hard/torture.py rigs --count 10000
    python tests/hard/torture.py impacts --count 10000
    python tests/hard/torture.py rigs --again

A part goes through the numbers of a seed, from the first that the report does not hold: a run that was ended, by Ctrl-C
too, goes on where it was when the same is called again. ``--again``: those numbers alone that have findings, which are
mended where they find nothing now. ``--only N``: one number, its findings printed, nothing recorded.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module
from pathlib import Path

PLACES = [Path(__file__).parent, *(Path(__file__).parents[1] / name for name in ("support", "independent"))]
sys.path[:0] = [str(place) for place in PLACES]
os.environ["OPENBLAS_NUM_THREADS"] = "1"  # as in the commands: the last digits of estimates hang on it

import report  # noqa: E402
from report import Span, added, worst_of  # noqa: E402
from verdict import Verdict  # noqa: E402
from workers import Stage, answers  # noqa: E402

RECORDED = 60.0  # seconds between two entries into the report: what is lost at most


@dataclass(frozen=True)
class Part:
    """``judge(seed, number, stage)`` of a module, and the CPU seconds that a number may take."""

    module: str
    seconds: float
    seed: int = 1
    judge: str = "judge"

    def task(self, seed: int) -> Callable[[int, Stage], Verdict]:
        return partial(getattr(import_module(self.module), self.judge), seed)


PARTS = {
    "rigs": Part("rig_checks", 10.0),
    "impacts": Part("exhaustive", 120.0),
    "mutants": Part("mutants", 20.0),
    "runs": Part("mutant_runs", 60.0),
    "kills": Part("kills", 600.0),
    "map_kills": Part("map_kills", 600.0),
    "races": Part("races", 600.0),
    "lacks": Part("scarce", 600.0),
    "damage": Part("damage", 600.0),
    "files": Part("hostile_files", 60.0),
    "map_damage": Part("map_damage", 60.0),
    "environment": Part("environment", 6000.0),
}


@dataclass
class Batch:
    """Adjacent numbers not yet recorded."""

    first: int
    count: int = 0
    verdicts: list[Verdict] = field(default_factory=list)
    findings: dict[str, str] = field(default_factory=dict)
    seconds: float = 0.0

    def add(self, number: int, verdict: Verdict, seconds: float) -> None:
        self.count += 1
        self.seconds += seconds
        self.verdicts.append(verdict)
        if verdict.findings:
            self.findings[str(number)] = "; ".join(verdict.findings)

    def span(self, seed: int, commit: str) -> Span:
        return Span(
            seed, self.first, self.count, commit, report.machine(), round(self.seconds, 1),
            added(verdict.counts for verdict in self.verdicts), worst_of(verdict.worst for verdict in self.verdicts),
            self.findings,
        )  # fmt: skip


def judged(part: Part, seed: int, numbers: Iterable[int]) -> Iterator[tuple[int, Verdict, float]]:
    """Each number with its verdict and CPU seconds; one that raised, crashed or did not end is a finding."""
    for number, answer, seconds in answers(part.task(seed), numbers, part.seconds):
        lost = f"{type(answer).__name__}: {answer}"
        yield number, answer if isinstance(answer, Verdict) else Verdict(findings=[lost]), seconds


def go_on(name: str, seed: int, numbers: list[int], file: Path) -> int:
    """Run the numbers and record them now and then; how many had findings."""
    found, commit = 0, report.commit()
    for run in _adjacent(numbers):
        batch, since = Batch(run[0]), time.monotonic()
        results = judged(PARTS[name], seed, run)
        try:
            for number, verdict, seconds in results:
                batch.add(number, verdict, seconds)
                _say(seed, number, verdict)
                found += bool(verdict.findings)
                if time.monotonic() - since > RECORDED:
                    batch, since = _recorded(name, seed, commit, batch, file), time.monotonic()
        finally:
            results.close()
            _recorded(name, seed, commit, batch, file)
    return found


def _recorded(name: str, seed: int, commit: str, batch: Batch, file: Path) -> Batch:
    """The next batch, after this one is in the file."""
    if batch.count:
        report.record(name, batch.span(seed, commit), file)
        print(f"{name}: {batch.count} to {batch.first + batch.count}, {batch.seconds:.0f} s of CPU time", flush=True)
    return Batch(batch.first + batch.count)


def _adjacent(numbers: list[int]) -> list[list[int]]:
    runs: list[list[int]] = []
    for number in numbers:
        if runs and runs[-1][-1] == number - 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    return runs


def again(name: str, file: Path) -> int:
    """Run the numbers that have findings once more; how many still have."""
    still, commit = 0, report.commit()
    for seed in {span.seed for span in report.spans(name, file)}:
        held = [int(n) for span in report.spans(name, file) if span.seed == seed for n in span.findings]
        for number, verdict, _ in judged(PARTS[name], seed, sorted(held)):
            _say(seed, number, verdict)
            still += bool(verdict.findings)
            report.record_again(name, seed, number, "; ".join(verdict.findings), commit, file)
    return still


def _say(seed: int, number: int, verdict: Verdict) -> None:
    for finding in verdict.findings:
        print(f"seed {seed}, number {number}: {finding}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("part", choices=PARTS)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int)
    parser.add_argument("--only", type=int)
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--report", type=Path, default=report.FILE)
    options = parser.parse_args()
    seed = PARTS[options.part].seed if options.seed is None else options.seed
    if options.only is not None:
        for number, verdict, _ in judged(PARTS[options.part], seed, [options.only]):
            print(number, verdict)
    elif options.again:
        sys.exit(bool(again(options.part, options.report)))
    else:
        numbers = report.left(options.part, seed, range(options.first, options.first + options.count), options.report)
        sys.exit(bool(go_on(options.part, seed, numbers, options.report)))


if __name__ == "__main__":
    main()
