"""Section of the book with the problems of others: every row computed, and the table of it."""

from __future__ import annotations

import importlib
import pkgutil
from itertools import groupby
from pathlib import Path
from time import process_time
from typing import Any

from tests.others import problems
from tests.others.problem import TABLE, Problem, agreed, digits
from tests.others.problems.code_aster import NOT_MODELLED

RESULTS = Path(__file__).parent / "results" / "problems.json"
for module in sorted(each.name for each in pkgutil.iter_modules(problems.__path__)):
    importlib.import_module(f"tests.others.problems.{module}")
PROBLEMS = tuple(TABLE)


def name_of(problem: Problem) -> str:
    """Name of a row, in tests and in the stored results."""
    return f"{problem.problem}: {problem.quantity}"


def sources() -> set[str]:
    """Publishers of the numbers: what a source says before its first comma."""
    return {each.source.split(",")[0] for each in PROBLEMS if not each.formula}


def measured() -> dict[str, Any]:
    """Every row's numbers, digits agreed and CPU seconds."""
    rows = []
    for each in PROBLEMS:
        begun = process_time()
        found = each.check()
        rows.append({
            "name": name_of(each), "problem": each.problem, "quantity": each.quantity, "source": each.source,
            "theirs": list(each.theirs), "ours": found.tolist(), "method": each.method, "adds": each.adds,
            "where": each.where, "within": each.within, "why": each.why, "reason": each.reason, "formula": each.formula,
            "agreed": [agreed(said, float(ours)) for said, ours in zip(each.theirs, found, strict=True)],
            "digits": [digits(said) for said in each.theirs], "seconds": process_time() - begun,
        })  # fmt: skip
        print(f"{rows[-1]['name']}: {rows[-1]['agreed']} of {rows[-1]['digits']} digits", flush=True)
    return {"rows": rows}


def table(found: dict[str, Any]) -> str:
    """The table: a line a quantity, the worst of several numbers counted."""
    lines = ["| problem | quantity | theirs | ours | digits | how they found it | what ours adds | source |"]
    lines.append("|---|---|---|---|---:|---|---|---|")
    for problem, rows in groupby(found["rows"], key=lambda row: row["problem"]):
        for number, row in enumerate(rows):
            worst = min(range(len(row["agreed"])), key=lambda k: row["agreed"][k] - row["digits"][k])
            ours = [shown(each, count) for each, count in zip(row["ours"], row["digits"], strict=True)]
            said = f"{row['agreed'][worst]} of {row['digits'][worst]}"
            off = row["agreed"][worst] < row["digits"][worst] - 1
            reason = row["reason"] or (f"Off: {row['why']}" if off and row["within"] else "")
            quantity = row["quantity"] + (f". {reason}" if reason else "")
            theirs = (f"{row['formula']} = " if row.get("formula") else "") + listed(row["theirs"])
            cells = [problem if not number else "", quantity, theirs, listed(ours), said]
            cells += [row["method"], row["adds"], row["source"]]
            lines.append("| " + " | ".join(each.replace("|", "\\|") for each in cells) + " |")
    return "\n".join([*lines, "", *left_out()])


def left_out() -> list[str]:
    """Table of the cases of a manual that are no rows, and why."""
    lines = [
        "No rows are these of code_aster's cases:",
        "",
        "| case | what it has | why it is no row |",
        "|---|---|---|",
    ]
    return [*lines, *("| " + " | ".join(each) + " |" for each in NOT_MODELLED)]


def shown(value: float, count: int) -> str:
    """A number to so many significant digits and one more."""
    return f"{value:.{count + 1}g}"


def listed(numbers: list[str], most: int = 6) -> str:
    """Numbers as a list; of many the first three and the last."""
    if len(numbers) <= most:
        return ", ".join(numbers)
    return f"{', '.join(numbers[:3])}, … {numbers[-1]} ({len(numbers)} numbers)"
