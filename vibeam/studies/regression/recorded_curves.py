"""Curves of a result as the text of reference files, regression values, and the tables that name these."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from io import StringIO
from pathlib import Path

import numpy as np

from vibeam.case.case import Case
from vibeam.exchange.curves.record import COLUMNS, QUANTITIES
from vibeam.exchange.curves.reference import RECORDED
from vibeam.runs.result import Result
from vibeam.store.provenance import provenance
from vibeam.system.response import complete


def recorded_answer(case: Case, files: Mapping[str, Path]) -> str:
    """Sentence on recorded fidelities, and the tables that check the case against their files."""
    home, tables = case.path.parent, []
    for name, file in files.items():
        shown = file.relative_to(home) if file.is_relative_to(home) else file.absolute()
        lines = [f"[reference.{name}_before]", f'file = "{shown.as_posix()}"', f'fidelity = "{name}"']
        tables.append("\n".join([*lines, 'quantity = "amplitude"', 'tolerance = "0.001 %"', ""]))
    fidelities = f"{len(files)} fidelities are" if len(files) > 1 else f"{next(iter(files))} is"
    answer = f"{fidelities} recorded as regression values; a table like this in the case checks them:"
    return "\n".join([answer, *tables])


def recorded_curves(result: Result, name: str) -> str:
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
