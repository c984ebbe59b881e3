"""Results of earlier runs: the file alone says what was run."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from vibeam.case.case import Case
from vibeam.exchange.faults import CaseError, Fault
from vibeam.runs.result import Result
from vibeam.runs.stored_result import StoredResult, read_result
from vibeam.runs.transient.result import TransientResult
from vibeam.runs.transient.run import read_transient
from vibeam.runs.transient.store import is_transient
from vibeam.store.errors import StoreError


def read(path: str | Path) -> Result | TransientResult:
    """Result in a results file, complete or not: ``vibeam.read("dtu_neutral.h5")["beam"].up.amplitude``.

    A ``TransientResult`` where its case has [record].
    Nothing is computed or written. StoreError where it is no results file, and where its case names files, of matrices
    say, that are not in its folder.

    >>> import vibeam
    >>> case = vibeam.load("cases/dtu_neutral.toml", {"sweep.frequency.points": 3})
    >>> result = vibeam.run(case, "short.h5")
    >>> vibeam.read("short.h5")["beam"] == result["beam"]
    True
    """
    found: Result | TransientResult = stored(path).result
    return found


def stored(path: str | Path, case: Case | None = None) -> StoredResult:
    """All that a results file holds; ``case``: in place of the one in the file, whose numbers must be the same.

    References whose files are not beside the results file are left out. StoreError as ``read``, where the ``case`` is
    another one, and where the case names other files that are not there.
    """
    file, lost = Path(path), []

    def own(text: str) -> Case:
        made, left_out = _parsed(text, file)
        lost.extend(left_out)
        return made

    read_file = read_transient if is_transient(file) else read_result
    if case is None:
        found = read_file(file, own)
        return replace(found, left_out=tuple(lost))
    found = read_file(file, lambda text: case)
    if case.numbers != found.numbers:
        raise StoreError(f"{file}: is not of {case.path}: its case decides other numbers")
    return found


def _parsed(text: str, results: Path) -> tuple[Case, list[str]]:
    """The case of a results file, and the references left out of it."""
    from vibeam.casefile.read import parse

    place = results.with_suffix(".toml")
    try:
        return parse(text, place, {}), []
    except CaseError as wrong:
        names = list(dict.fromkeys(fault.key.split(".")[1] for fault in wrong.faults if _of_reference(fault)))
        if not all(map(_of_reference, wrong.faults)):
            named = " and ".join(fault.key for fault in wrong.faults if not _of_reference(fault))
            cure = f"copy them into the folder of {results.name}, or name the case with --case"
            raise StoreError(f"{results}: the files of {named} are not beside it: {cure}\n{wrong}") from None
    return parse(text, place, {f"reference.{name}": None for name in names}), names


def _of_reference(fault: Fault) -> bool:
    return fault.key.startswith("reference.") and fault.key.endswith(".file")
