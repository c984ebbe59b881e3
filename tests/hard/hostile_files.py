"""Files of matrices and curves that are damaged, or made to do harm: each is told in one message, or read.

A number is one file: of a format as its own program writes it, damaged (a mutation of its text, or of its bytes), or
one of ``HOSTILE``, whose message is known. It is read as a user would, through a case, in a process with limits.
"""

from __future__ import annotations

import sys
import tempfile
import warnings
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from damage import KINDS, damaged
from hostile_kinds import CURVE, HOSTILE, SOUND, Hostile, K, X
from limited import GIB, Ended, Limits, run_limited
from mutants import fault_of_message
from mutations import LINES
from verdict import Verdict
from workers import Stage

from vibeam.casefile.read import parse
from vibeam.exchange.curves.record import ReferenceForm
from vibeam.exchange.curves.reference import read_curve
from vibeam.exchange.faults import CaseError
from vibeam_models.beam import structure_of

TEXT = (".csv", ".mtx", ".inp", ".pch")

LIMITS = Limits(cpu=10, memory=2 * GIB)

CASE = """\
[matrices]
mass = "M.npy"
stiffness = "{name}"
damping_ratio = 0.01
contact = 4
base = "all"
units = "SI"
[stop]
gap = "1 mm"
restitution = 0.7
[drive]
amplitude = "0.1 mm"
[sweep]
frequency = {{ from = "5 Hz", to = "7 Hz", points = 5 }}
settle = 20
hold = 10
[fidelity.whole]
reduction = "full"
"""

FORM = ReferenceForm(columns={"frequency": "f", "amplitude": "x"}, unit="m")

WORDED = ReferenceForm(columns=FORM.columns | {"direction": "direction"}, unit="m")

NUMBERED = ReferenceForm(columns={"frequency": 1, "amplitude": 2}, unit="m")

FORMS = {"curve_own.csv": ReferenceForm(), "curve_words.h5": WORDED, "curve_first.csv": NUMBERED}


def judge(seed: int, number: int, stage: Stage) -> Verdict:
    """One file, read: those made to do harm in turn, and as many that are damaged."""
    rng = np.random.default_rng([seed, number])
    verdict = Verdict()
    with tempfile.TemporaryDirectory() as where:
        kind = _damaged(rng) if number % 2 else HOSTILE[number // 2 % len(HOSTILE)]
        stage(kind.name)
        ended = read_file(kind, Path(where), rng)
    made = "damaged" if number % 2 else "hostile" if kind.said else "odd"
    verdict.count(f"{made}, {'told' if ended.code == 2 else 'read'}")
    verdict.measure("GiB", ended.resident / GIB, LIMITS.memory / GIB)
    verdict.measure("seconds", ended.seconds, LIMITS.cpu)
    fault = fault_of(ended, kind)
    verdict.hold(not fault, f"{kind.name}: {fault}")
    return verdict


def read_file(kind: Hostile, folder: Path, rng: np.random.Generator) -> Ended:
    """A file of that kind, written to an empty folder and read in a process with limits."""
    _warm()
    kind.write(folder / kind.name, rng)
    return run_limited(lambda: _told_or_read(folder / kind.name, same=kind.said is None), folder, LIMITS)


def fault_of(ended: Ended, kind: Hostile) -> str:
    """What is wrong with how reading ended; empty: nothing."""
    if fault := ended.fault(LIMITS):
        return fault
    if kind.said and kind.said not in ended.err:
        return f"not {kind.said!r} but {ended.err[:300] or 'read'!r}"
    return f"told: {ended.err[:300]!r}" if kind.said is None and ended.code else ""


def _damaged(rng: np.random.Generator) -> Hostile:
    """A sound file after a mutation of its text, or of its bytes; it may be told, or read."""
    name = str(rng.choice(list(SOUND)))

    def write(path: Path, rng: np.random.Generator) -> None:
        SOUND[name](path)
        if path.suffix in TEXT and rng.random() < 0.7:
            mutation = LINES[int(rng.integers(len(LINES)))]
            text = mutation(path.read_text(encoding="utf-8"), rng) or "\n"
            path.write_bytes(text.encode("utf-8", "surrogateescape"))
        else:
            path.write_bytes(damaged(path.read_bytes(), str(rng.choice(KINDS)), rng))

    return Hostile(name, "", write)


def _told_or_read(file: Path, same: bool) -> None:
    """Read a file through a case as a matrix, or as a curve; exit 2 with one message, 1 where that is not right.

    ``same``: it must be read, as K or as the curve.
    """
    warnings.simplefilter("error")
    try:
        found, truth = _read(file)
    except CaseError as error:
        print(error, file=sys.stderr)
        if fault := fault_of_message(error, CASE.encode(), *([file.read_bytes()] if _is_short(file) else [])):
            raise AssertionError(fault) from None
        sys.exit(2)
    assert not same or np.array_equal(found, truth), "read as something else"


def _read(file: Path) -> tuple[Any, Any]:
    if file.name.startswith(CURVE):
        return read_curve(file, "amplitude", FORMS.get(file.name, FORM)).value, X
    np.save(file.with_name("M.npy"), np.eye(len(K)))
    return structure_of(parse(CASE.format(name=file.name), file.with_name("case.toml")).scene).K, K


@cache
def _warm() -> None:
    """Import here what every fork would import."""
    with tempfile.TemporaryDirectory() as where:
        for name in ("matrix.npz", "matrix_sparse.h5", "matrix.mat", "matrix.csv", "curve.mat", "curve.h5"):
            SOUND[name](Path(where) / name)
            _read(Path(where) / name)


def _is_short(file: Path) -> bool:
    return file.is_file() and 0 < file.stat().st_size < 10**7
