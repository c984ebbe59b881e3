"""Mutated text files of records: the answer is the same, or a fault, or what was taken says that it is another.

Mutated are heads, rows of units, separators and whole lines, not the digits of numbers: those are data.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_labview import content

import vibeam

G = 9.80665
AT = np.arange(12) * 2.0  # ms
VALUES = np.array([0.25, 1.5, -2.75, 3.25, 1.75, -0.5, 0.75, -1.25, 2.5, 0.375, -0.625, 1.125])
Base = tuple[str, str, dict[str, Any], int]  # name, text, form, lines of its head


def table(*heads: str, mark: str = ",", decimal: str = ".") -> str:
    rows = (f"{at:.3f}{mark}{value:.4f}{mark}{7 * value:.4f}".replace(".", decimal)
            for at, value in zip(AT, VALUES, strict=True))  # fmt: skip
    return "\n".join([*heads, *rows]) + "\n"


BY_NAME: dict[str, Any] = {"column": "acc", "time": "t"}
BY_NUMBER: dict[str, Any] = {"column": 2, "time": 1}
BASES: list[Base] = [
    ("a.csv", table("t [ms],acc [g],u [V]"), BY_NAME, 1),
    ("a.csv", table("t,acc,u", "ms,g,V"), BY_NAME, 2),
    ("a.csv", table("t,acc,u", "ms,g,V"), BY_NUMBER, 2),
    ("a.csv", table("t [ms];acc [g];u [V]", mark=";", decimal=","), BY_NAME, 1),
    ("a.csv", table("Logger 7", "made today", "t\tacc\tu", "(ms)\t(g)\t(V)", mark="\t"), BY_NUMBER, 4),
    ("a.csv", table("# time in ms", "# acceleration in g", "# t acc u", mark=" "), BY_NUMBER, 3),
    ("a.csv", table("#time_ms,acc_g,u_V"), BY_NUMBER, 1),
    ("a.csv", table("Horizontal Units,ms", "Vertical Units,g", "TIME,CH1,CH2"), BY_NUMBER, 3),
    *((f"a{columns}.lvm", content(columns, mark), {"column": "ay"}, 22)
      for columns in ("No", "One", "Multi") for mark in ("\t", ",")),
]  # fmt: skip
Mutation = Callable[[list[str], int, np.random.Generator], list[str]]


def _one(lines: list[str], place: int, change: Callable[[str], str]) -> list[str]:
    return [*lines[:place], change(lines[place]), *lines[place + 1 :]]


def without_head(lines: list[str], head: int, rng: np.random.Generator) -> list[str]:
    place = int(rng.integers(head))
    return lines[:place] + lines[place + 1 :]


def without_row(lines: list[str], head: int, rng: np.random.Generator) -> list[str]:
    place = int(rng.integers(head, len(lines)))
    return lines[:place] + lines[place + 1 :]


def twice(lines: list[str], head: int, rng: np.random.Generator) -> list[str]:
    place = int(rng.integers(len(lines)))
    return [*lines[: place + 1], *lines[place:]]


def exchanged(lines: list[str], head: int, rng: np.random.Generator) -> list[str]:
    one, other = int(rng.integers(head)), int(rng.integers(len(lines)))
    swapped = list(lines)
    swapped[one], swapped[other] = lines[other], lines[one]
    return swapped


def a_letter_less(lines: list[str], head: int, rng: np.random.Generator) -> list[str]:
    place = int(rng.integers(head))
    at = int(rng.integers(max(1, len(lines[place]))))
    return _one(lines, place, lambda text: text[:at] + text[at + 1 :])


def a_letter_more(lines: list[str], head: int, rng: np.random.Generator) -> list[str]:
    place, letter = int(rng.integers(head)), str(rng.choice(list("kmMµ#%;, \t/^2gVN[]()\"'x")))
    at = int(rng.integers(len(lines[place]) + 1))
    return _one(lines, place, lambda text: text[:at] + letter + text[at:])


def another_separator(lines: list[str], head: int, rng: np.random.Generator) -> list[str]:
    place, mark = int(rng.integers(len(lines))), str(rng.choice([";", "\t", ",", "|", " ", ""]))
    between = ";" if any(";" in line for line in lines) else "\t, "  # between semicolons commas are parts of numbers
    marks = [at for at, letter in enumerate(lines[place]) if letter in between]
    if not marks:
        return lines
    at = int(rng.choice(marks))
    return _one(lines, place, lambda text: text[:at] + mark + text[at + 1 :])


def other_case(lines: list[str], head: int, rng: np.random.Generator) -> list[str]:
    return _one(lines, int(rng.integers(head)), str.upper if rng.random() < 0.5 else str.lower)


def a_remark(lines: list[str], head: int, rng: np.random.Generator) -> list[str]:
    place = int(rng.integers(len(lines) + 1))
    said = str(rng.choice(["made today", "# made today", "s,m/s^2,V", "Units: mV", "Rate 935, overflows 4", "", ";;"]))
    return [*lines[:place], said, *lines[place:]]


def cut_off(lines: list[str], head: int, rng: np.random.Generator) -> list[str]:
    text = "\n".join(lines)
    return text[: int(rng.integers(1, len(text)))].split("\n")


def a_comment(lines: list[str], head: int, rng: np.random.Generator) -> list[str]:
    return _one(lines, int(rng.integers(head)), lambda text: f"# {text}")


MUTATIONS: list[Mutation] = [
    without_head, without_row, twice, exchanged, a_letter_less, a_letter_more, another_separator, other_case, a_remark,
    cut_off, a_comment,
]  # fmt: skip


def told(record: vibeam.Record) -> Any:
    """What the line says of units, steps and remarks."""
    taken = record.taken
    return [(each.place, each.unit.casefold()) for each in taken.columns], taken.rate, taken.notes


def fault_of(found: vibeam.Record, truth: vibeam.Record) -> str:
    """What is wrong with a record that says the same of itself as the true one; empty: nothing."""
    if told(found) != told(truth):
        return ""  # the line says that it is another
    first = np.flatnonzero(np.isclose(truth.times, found.start, atol=1e-9))
    if not len(first):
        return f"begins at {found.start}"
    count = len(found.times)
    part = slice(int(first[0]), int(first[0]) + count)
    same = len(truth.times[part]) == count and np.allclose(
        found.at(found.times), truth.at(truth.times[part]), rtol=1e-9
    )
    return "" if same else "other numbers"


@pytest.mark.parametrize("chunk", [*range(12), *(pytest.param(each, marks=pytest.mark.slow) for each in range(12, 65))])
def test_a_mutated_file_gives_the_same_or_a_fault(tmp_path: Path, chunk: int) -> None:
    wrong, counts = list[str](), {"read": 0, "told": 0}
    for number in range(100 * chunk, 100 * chunk + 100):
        rng = np.random.default_rng([48, number])
        name, text, form, head = BASES[number % len(BASES)]
        truth_file = tmp_path / name
        truth_file.write_text(text)
        truth = vibeam.record_of_file(truth_file, **form)
        mutation = MUTATIONS[int(rng.integers(len(MUTATIONS)))]
        changed = "\n".join(mutation(text.rstrip("\n").split("\n"), head, rng)) + "\n"
        truth_file.write_text(changed)
        try:
            found = vibeam.record_of_file(truth_file, **form)
        except vibeam.CaseError as fault:
            counts["told"] += 1
            if "\n" in str(fault) and len(fault.faults) > 3:
                wrong.append(f"{number} {mutation.__name__}: {fault}")
            continue
        counts["read"] += 1
        if reason := fault_of(found, truth):
            wrong.append(f"{number} {mutation.__name__} {form}: {reason}\n{changed}\n{found.taken}")
    assert not wrong, "\n\n".join(wrong)
    assert min(counts.values()) > 10
