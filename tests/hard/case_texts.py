"""Texts that mutants are made of: every case file, and the templates with all that they show."""

from __future__ import annotations

import re
from functools import cache
from itertools import pairwise
from pathlib import Path

from vibeam.casefile.template import template

CASES = Path(__file__).parents[2] / "cases"

HEADER = re.compile(r"^\[.*\]$", re.MULTILINE)


@cache
def originals() -> dict[Path, str]:
    """Every case file, and the template, by its place in a folder of them."""
    cases = {path.relative_to(CASES): path.read_text(encoding="utf-8") for path in sorted(CASES.rglob("*.toml"))}
    return cases | {Path("rigs", "case.toml"): template()}


@cache
def beside() -> dict[Path, str]:
    """What these name: reference curves, matrices, modes; by place in the same folder."""
    return {path.relative_to(CASES): path.read_text(encoding="utf-8") for path in CASES.rglob("*.csv")}


@cache
def full_template() -> str:
    """The template with every key that it shows, optional ones too."""
    lines = template().splitlines()
    return "\n".join(re.sub(r"^# (?=\[|[a-z_]+ = )", "", line) for line in lines)


@cache
def stock() -> tuple[str, ...]:
    """All texts from which pieces are taken."""
    return (*originals().values(), full_template())


def blocks(text: str) -> list[str]:
    """The tables of a text, each with its heading; the first is what stands before all headings."""
    starts = [0, *(each.start() for each in HEADER.finditer(text)), len(text)]
    return [text[start:end] for start, end in pairwise(starts)]


def heading(block: str) -> str:
    """Kind of a table: ``[fidelity.beam]`` and ``[fidelity.sdof]`` are of one."""
    return re.split(r"[.\]]", block)[0] if block.startswith("[") else ""


@cache
def stock_blocks() -> tuple[str, ...]:
    return tuple(block for text in stock() for block in blocks(text) if block.startswith("["))
