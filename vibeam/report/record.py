"""Record of a result as reference files: curves in vibeam's own form, with what they were computed from."""

from __future__ import annotations

import csv
from io import StringIO
from typing import TYPE_CHECKING

import numpy as np

from vibeam.exchange.curves.record import COLUMNS, QUANTITIES
from vibeam.exchange.curves.reference import RECORDED
from vibeam.store.provenance import provenance
from vibeam.system.response import complete

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.result import Result


def record(result: Result, name: str) -> str:
    """The curves of one fidelity as the text of a reference file; points that failed have no values."""
    text = StringIO(newline="")
    for line in _head(result.case, name):
        text.write(f"# {line}\n" if line != RECORDED else f"{line}, which is no reference\n")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for direction, response in result[name].items():
        known = complete(response)
        for index, frequency in enumerate(response.frequency.tolist()):
            values = [getattr(response, each)[index].item() for each in QUANTITIES]
            cells = ["" if not known[index] or not np.isfinite(value) else repr(value) for value in values]
            writer.writerow([repr(frequency), direction, *cells])
    return text.getvalue()


def _head(case: Case, name: str) -> list[str]:
    """Comments: case, model, sweep, versions."""
    fidelity, sweep = case.fidelities[name], case.sweep
    made = provenance()
    settled = f"direction {sweep.direction}, settle {sweep.settle}, hold {sweep.hold} periods, output {sweep.output}"
    title = " ".join(case.title.split())
    return [
        RECORDED,
        f"case {case.path.name}, {title}; key {case.key}",
        f"fidelity {name}: reduction {fidelity.reduction}, solver {fidelity.solver}; key {case.own[name]}",
        f"sweep: {settled}",
        "; ".join(f"{what} {value}" for what, value in made.items()),
        "SI units (a nondimensional model: its own); period: least n <= 16, 0 none, -1 no impact",
    ]
