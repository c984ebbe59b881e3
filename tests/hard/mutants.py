"""Mutants of case files: each is known by its seed and number, and ends as a case or as one CaseError."""

from __future__ import annotations

import tempfile
import time
import traceback
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from case_texts import beside, originals
from mutations import CONTENT, LINES, SYNTAX, Mutation
from verdict import Verdict
from workers import Stage

import vibeam
from vibeam.case.case import Case
from vibeam.casefile.read import parse
from vibeam.exchange.faults import OVERRIDE, CaseError
from vibeam.studies.regression.references import require_readable

NAMED = 0.2  # share of the mutants, of cases that name files, that are of these
SLOW = 2.0  # seconds of CPU time to load a case
LONGEST = 3000  # characters of one fault, with the list of all quantities or tables in it


@dataclass(frozen=True)
class Mutant:
    """Mutated ``content`` of the file at ``place``, the case ``origin`` or a file that it names; the mutations."""

    origin: Path
    place: Path
    content: bytes
    by: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.origin}, {self.place.name}: {', '.join(self.by)}"


def mutant(seed: int, number: int, attempt: int = 0) -> Mutant:
    """One to four mutations of one file, of a case or now and then of a file that it names.

    A third of the mutants of cases keeps to what may still be a case; attempts after the first are of cases.
    """
    rng = np.random.default_rng([seed, number, attempt])
    origin = sorted(originals())[int(rng.integers(len(originals())))]
    named = [place for place in sorted(beside()) if place.name in originals()[origin]]
    if named and attempt == 0 and rng.random() < NAMED:
        place = named[int(rng.integers(len(named)))]
        return Mutant(origin, place, *_mutated(beside()[place], LINES, rng))
    kinds = CONTENT if rng.random() < 1 / 3 else CONTENT + SYNTAX
    return Mutant(origin, origin, *_mutated(originals()[origin], kinds, rng))


def _mutated(text: str, kinds: Sequence[Mutation], rng: np.random.Generator) -> tuple[bytes, tuple[str, ...]]:
    by = []
    for _ in range(min(4, int(rng.geometric(0.5)))):
        mutation = kinds[int(rng.integers(len(kinds)))]
        text = mutation(text, rng) or "\n"
        by.append(mutation.__name__)
    return text.encode("utf-8", "surrogateescape"), tuple(by)


def judge(seed: int, number: int, stage: Stage) -> Verdict:
    """A mutant, loaded."""
    made, verdict = mutant(seed, number), Verdict()
    stage(str(made))
    begun = time.process_time()
    try:
        found, fault = judged(made)
    except Exception:
        found, fault = None, " < ".join(traceback.format_exc().strip().splitlines()[:-6:-1])
    verdict.measure("seconds", time.process_time() - begun, SLOW)
    verdict.count(type(found).__name__)
    verdict.hold(not fault, f"{made}: {fault}")
    return verdict


def judged(made: Mutant) -> tuple[Case | CaseError, str]:
    """What loading gives, and the fault in that; empty: none."""
    with _placed(made) as file, warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            case = vibeam.load(file)
            require_readable(case)
        except CaseError as error:
            return error, fault_of_message(error, made.content, file.read_bytes())
        return case, _fault_of_text(case, file)


@contextmanager
def _placed(made: Mutant) -> Iterator[Path]:
    """The case in a folder of its own, with what it names; one of them as the mutant has it."""
    texts = {place: text.encode() for place, text in beside().items()}
    texts |= {made.origin: originals()[made.origin].encode(), made.place: made.content}
    with tempfile.TemporaryDirectory() as folder:
        for place, content in texts.items():
            (Path(folder) / place).parent.mkdir(parents=True, exist_ok=True)
            (Path(folder) / place).write_bytes(content)
        yield Path(folder) / made.origin


def fault_of_message(error: CaseError, *contents: bytes) -> str:
    """Fault in what is said of files with these contents; empty: none."""
    lines = max(content.count(b"\n") + content.count(b"\r") for content in contents) + 1
    for fault in error.faults:
        said = str(fault)
        if not said.isprintable() or len(said) > LONGEST:
            return f"message of {len(said)} characters: {said[:100]!r}"
        if fault.file == OVERRIDE or not (fault.line is None or 1 <= fault.line <= lines):
            return f"place that is not in the file: {said}"
    return "" if error.faults else "CaseError without a fault"


def _fault_of_text(case: Case, file: Path) -> str:
    """A case's own text loads as the same case."""
    again = parse(case.text, file)
    same = (again.text, again.key, again.own) == (case.text, case.key, case.own)
    return "" if same else "its own text loads as another case"
