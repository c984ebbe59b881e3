"""The report of the torture, one committed file: what was run, at which commit, on what, and what came of it.

A part (``PARTS``) runs numbers of a seed. A run of adjacent numbers at one
commit on one machine is a span; the file holds the spans of every part and their sums. No number counts twice.
"""

from __future__ import annotations

import fcntl
import json
import os
import platform
import resource
import subprocess
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

FILE = Path(__file__).with_name("report.json")
PARTS = (
    "rigs", "impacts", "mutants", "runs", "kills", "map_kills", "races", "lacks", "damage", "files", "map_damage",
    "environment",
)  # fmt: skip


@dataclass(frozen=True)
class Span:
    """Numbers ``first`` … ``first + count - 1`` of a seed, run at one commit: CPU seconds, counts, worst figures.

    ``findings`` maps a number to what was found there; ``mended`` likewise, of findings that no longer show.
    """

    seed: int
    first: int
    count: int
    commit: str
    machine: str
    cpu_seconds: float
    counts: dict[str, int] = field(default_factory=dict)
    worst: dict[str, float] = field(default_factory=dict)
    findings: dict[str, str] = field(default_factory=dict)
    mended: dict[str, str] = field(default_factory=dict)

    @property
    def numbers(self) -> range:
        return range(self.first, self.first + self.count)


def joined(one: Span, other: Span) -> Span:
    """Two spans as one: counts and seconds add up, the worst stays."""
    return replace(
        one,
        first=min(one.first, other.first),
        count=one.count + other.count,
        cpu_seconds=round(one.cpu_seconds + other.cpu_seconds, 1),
        counts=added([one.counts, other.counts]),
        worst=worst_of([one.worst, other.worst]),
        findings=one.findings | other.findings,
        mended=one.mended | other.mended,
    )


def added(counts: Iterable[dict[str, int]]) -> dict[str, int]:
    total: dict[str, int] = {}
    for each in counts:
        for name, value in each.items():
            total[name] = total.get(name, 0) + value
    return total


def worst_of(figures: Iterable[dict[str, float]]) -> dict[str, float]:
    """The largest of each figure."""
    total: dict[str, float] = {}
    for each in figures:
        for name, value in each.items():
            total[name] = max(total.get(name, value), value)
    return total


def spans(part: str, file: Path = FILE) -> list[Span]:
    """What the file holds of a part."""
    return [Span(**each) for each in _read(file).get(part, {}).get("spans", [])]


def left(part: str, seed: int, numbers: range, file: Path = FILE) -> list[int]:
    """Those of the numbers that the file does not hold."""
    held = {number for span in spans(part, file) if span.seed == seed for number in span.numbers}
    return [number for number in numbers if number not in held]


def record(part: str, span: Span, file: Path = FILE) -> None:
    """Put a span into the file, joined with neighbours of the same commit. ValueError: a number is there already."""
    with _alone(file):
        kept = spans(part, file)
        if len(left(part, span.seed, span.numbers, file)) < span.count:
            raise ValueError(f"{part}, seed {span.seed}: {span.numbers} is in {file.name} already")
        for other in [other for other in kept if _adjacent(other, span)]:
            kept.remove(other)
            span = joined(other, span)
        _write(part, [*kept, span], file)


def record_again(part: str, seed: int, number: int, found: str, commit: str, file: Path = FILE) -> None:
    """A number that had a finding was run again: what was found this time; nothing = it is mended."""
    with _alone(file):
        _write(part, [_run_again(span, seed, number, found, commit) for span in spans(part, file)], file)


def _run_again(span: Span, seed: int, number: int, found: str, commit: str) -> Span:
    name = str(number)
    if span.seed != seed or name not in span.findings:
        return span
    if found:
        return replace(span, findings=span.findings | {name: found})
    others = {key: what for key, what in span.findings.items() if key != name}
    return replace(span, findings=others, mended=span.mended | {name: f"{span.findings[name]} (not at {commit})"})


def _adjacent(one: Span, other: Span) -> bool:
    alike = all(getattr(one, name) == getattr(other, name) for name in ("seed", "commit", "machine"))
    return alike and (one.first + one.count == other.first or other.first + other.count == one.first)


def _write(part: str, kept: list[Span], file: Path) -> None:
    kept = sorted(kept, key=lambda span: (span.seed, span.first))
    whole = _read(file) | {part: _summary(kept) | {"spans": [asdict(span) for span in kept]}}
    fresh = file.with_suffix(".new")
    fresh.write_text(json.dumps({name: whole[name] for name in PARTS if name in whole}, indent=1) + "\n")
    fresh.replace(file)


def _summary(kept: list[Span]) -> dict[str, Any]:
    return {
        "count": sum(span.count for span in kept),
        "findings": sum(len(span.findings) for span in kept),
        "mended": sum(len(span.mended) for span in kept),
        "cpu_seconds": round(sum(span.cpu_seconds for span in kept), 1),
        "counts": added(span.counts for span in kept),
        "worst": worst_of(span.worst for span in kept),
    }


def _read(file: Path) -> dict[str, Any]:
    return json.loads(file.read_text()) if file.exists() else {}


@contextmanager
def _alone(file: Path) -> Iterator[None]:
    folder = os.open(file.parent, os.O_RDONLY)
    try:
        fcntl.flock(folder, fcntl.LOCK_EX)
        yield
    finally:
        os.close(folder)


def commit() -> str:
    """Abbreviated hash of the checkout, with a + where files that it holds were changed since."""
    return _git("rev-parse", "--short=10", "HEAD") + (
        "+" if _git("diff", "--name-only", "HEAD", "--", ":!*.json") else ""
    )


def _git(*words: str) -> str:
    done = subprocess.run(["git", *words], cwd=FILE.parent, capture_output=True, text=True, check=True)
    return done.stdout.strip()


def machine() -> str:
    """Processor, system, Python."""
    lines = Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []
    model = next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")
    return (
        f"{model or platform.processor()}, {platform.system()} {platform.machine()}, Python {platform.python_version()}"
    )


def cpu_seconds() -> float:
    """CPU time of this process and of those of its children that have ended, user and system."""
    usage = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in usage)
