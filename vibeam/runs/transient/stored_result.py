"""Result of an earlier run under a record: the file alone says what was run."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from vibeam.runs.run_plan import restricted
from vibeam.runs.stored_result import StoredResult
from vibeam.runs.transient.run import result_of
from vibeam.runs.transient.store import read_motions

if TYPE_CHECKING:
    from vibeam.case.case import Case


def read_transient(path: str | Path, parse: Callable[[str], Case]) -> StoredResult:
    """Read a results file, complete or not; ``parse`` makes a case of its text.

    StoreError where it is none, or damaged; CaseError where its case cannot be built any more.
    """
    file = Path(path)
    stored = read_motions(file)
    case = parse(stored.whole)
    case = restricted(case, set(stored.known.models) & set(case.fidelities))
    result = result_of(case, stored.known, file, 0, stored.shown(case))
    result.found = result.total - result.missing
    return StoredResult(result, stored.provenance, result.missing, stored.numbers)
