"""Numbers on pages and in the heads of cases, held to what the case that they are said of states, or to results.

    python tests/page_numbers.py           # prints the numbers that nothing states
    python tests/page_numbers.py --write   # makes them the list of exceptions, page_numbers.json beside this file

A block is a row of a table, a paragraph, or the head of a case (its first comment). Heads are checked, and blocks that
name a case (`fig13`, `cases/dtu_neutral.toml`) or stand below a comment ``<!-- numbers: FILE … -->`` of cases or
results (JSON; in a head ``# numbers: FILE …``); another row may hold no number with a decimal or a unit. Each number of
a checked block must be

- an input of one of these cases, exactly, or
- a value of an [expect], [measured] or [show] of it, rounded to the digits on the page, or
- a number of the results file, rounded likewise; of a file of results also as a percentage.

Tables between ``begin`` and ``end`` comments are held to the results by ``benchmarks/pages.py`` and left out here.
Signs are left out of the comparison; mm, µm and % may stand for SI numbers. The numbers of figures, equations,
sections, periods and modes, and code, are no claims.
"""

from __future__ import annotations

import argparse
import json
import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
LISTED = Path(__file__).with_suffix(".json")
PAGES = (
    "README.md",
    "cases/README.md",
    "cases/paper/README.md",
    "cases/experiment/README.md",
    "cases/lodz/README.md",
    "cases/stuttgart/README.md",
    "cases/rigs/README.md",
    "cases/matrices/README.md",
    "cases/grazing/README.md",
    "cases/suffices/README.md",
    "cases/reductions/README.md",
    "cases/inputs/README.md",
    "cases/solid/README.md",
    "vibeam/studies/README.md",
)

FENCED = re.compile(r"^(```|~~~).*?^\1[^\n]*$", re.DOTALL | re.MULTILINE)
SOURCES = re.compile(r"^<!-- numbers: (.*?) -->$", re.MULTILINE)
COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
CODE = re.compile(r"`([^`]+)`")
HEAD, GIVEN = re.compile("#"), re.compile(r"numbers: (.*)")
GENERATED = re.compile(r"<!-- begin: (.*?) -->.*?<!-- end: \1 -->", re.DOTALL)
LINK = re.compile(r"\]\([^)]*\)")
FURTHER = r"(?:\([a-z, ]+\))?(?:\s*(?:[–,]|and)\s*\d+(?!\.?\d))*"  # (a, b), – 5 and 6
NUMBERED = re.compile(r"(?:Figs?\.|[Ee]q\.|Tables?|§+|[Pp]eriods?|[Mm]odes?)\s*\d+(?:\.\d+)*" + FURTHER)
NUMBER = re.compile(r"(?<![\w.^/])(\d+(?: \d{3})*)(\.\d+)?(?:e([−-]?\d+))?(?![\w/]|\.\d)(?:\s*(%|mm|µm))?")
ANYWHERE = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?", re.IGNORECASE)
SCALES = {"%": (1.0, 100.0), "mm": (1.0, 1e3), "µm": (1.0, 1e6, 1e3), "": (1.0,)}
WORDS = ("title", "source", "label", "file")  # keys whose numbers say nothing of the model
STATED = ("expect", "measured", "show", "reference")  # tables whose numbers a page may round


@dataclass(frozen=True)
class Number:
    """Number as printed: its size, half a unit of its last digit, and its unit where that has another scale."""

    text: str
    size: float
    half: float
    unit: str


@dataclass(frozen=True)
class Stated:
    """Numbers of the files that a block may draw on: ``exact`` ones, and ``rounded`` ones."""

    exact: frozenset[float]
    rounded: frozenset[float]

    def has(self, number: Number) -> bool:
        """Test whether the number is stated."""
        scales = SCALES[number.unit]
        near = number.half * (1 + 1e-6)
        return any(abs(abs(value) * scale - number.size) <= near for value in self.rounded for scale in scales) or any(
            abs(abs(value) * scale - number.size) <= 1e-9 * number.size for value in self.exact for scale in scales
        )


def blocks(page: Path) -> Iterator[tuple[str, list[Path]]]:
    """Rows of tables, and paragraphs that draw on files, with these files."""
    given: list[Path] = []
    text = GENERATED.sub("", FENCED.sub("\n", page.read_text(encoding="utf-8")))
    for part in re.split(r"\n\s*\n", text):
        if found := SOURCES.search(part):
            given = [_file(page, name) for name in found.group(1).split()]
        body = COMMENT.sub("", part).strip()
        if not body:
            continue
        tabular = body.startswith("|")
        for row in body.splitlines() if tabular else [body]:
            files = [*given, *named(page, row)]
            if files or tabular:
                yield row, files
        given = []


def head_of(case: Path) -> tuple[str, list[Path]]:
    """Head of a case, and the files that it draws on."""
    lines = [line.removeprefix("#").strip() for line in takewhile(HEAD.match, case.read_text("utf-8").splitlines())]
    further = [name for line in lines if (found := GIVEN.match(line)) for name in found.group(1).split()]
    text = " ".join(line for line in lines if not GIVEN.match(line))
    return text, [case, *(_file(case, name) for name in further)]


def named(page: Path, block: str) -> list[Path]:
    """Cases that a block names in code: by path, by file, or by the bare name on the page of their folder."""
    places = (page.parent, ROOT, ROOT / "cases", ROOT / "cases" / "paper", ROOT / "cases" / "experiment")
    names = (word for code in CODE.findall(block) for word in code.split() if re.fullmatch(r"[\w./*]+", word))
    found = {}
    for name in names:
        file = name if name.endswith(".toml") else f"{name}.toml"
        found |= {place / file: None for place in places if (place / file).is_file()}
    return list({path.resolve(): None for path in found})


def _file(page: Path, name: str) -> Path:
    for place in (page.parent, ROOT):
        if (place / name).is_file():
            return (place / name).resolve()
    raise FileNotFoundError(f"{page}: numbers: no file {name}")


def numbers(block: str) -> list[Number]:
    """Numbers that a block claims."""
    cells = block.strip("|").split("|") if block.startswith("|") else [block]
    if len(cells) > 1 and re.fullmatch(r"\s*(?:eq\. )?[\d\s,–]+", cells[0]):
        cells = cells[1:]  # the figure's number
    text = " | ".join(cells)
    for mark in (LINK, CODE, NUMBERED):
        text = mark.sub(" ", text)
    return [_number(match) for match in NUMBER.finditer(text)]


def _number(match: re.Match[str]) -> Number:
    whole, fraction, power, unit = match.groups()
    exponent = int((power or "0").replace("−", "-"))
    size = float(f"{whole.replace(' ', '')}{fraction or ''}") * 10.0**exponent
    half = 0.5 * 10.0 ** (exponent - max(len(fraction or "") - 1, 0))
    return Number(match.group().strip(), size, half, unit or "")


def stated(files: list[Path]) -> Stated:
    """Numbers of cases and results."""
    exact: set[float] = set()
    rounded: set[float] = set()
    for file in files:
        text = file.read_text(encoding="utf-8")
        if file.suffix == ".json":
            values = set(_numbers_in(json.loads(text)))
            rounded |= values | {100 * value for value in values}
            continue
        content = {name: each for name, each in tomllib.loads(text).items() if name not in WORDS}
        for name, table in content.items():
            (rounded if name in STATED else exact).update(_numbers_in(table))
    return Stated(frozenset(exact), frozenset(rounded))


def _numbers_in(value: Any) -> Iterator[float]:
    if isinstance(value, dict):
        for name, each in value.items():
            if name not in WORDS:
                yield from _numbers_in(each)
    elif isinstance(value, list):
        for each in value:
            yield from _numbers_in(each)
    elif isinstance(value, str):
        yield from map(float, ANYWHERE.findall(value))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield float(value)


def unmatched(page: Path) -> list[str]:
    """Numbers on a page that none of the files of their block states, as ``files: number``."""
    found = []
    for block, files in [head_of(page)] if page.suffix == ".toml" else blocks(page):
        if not files:
            found += [f"no source: {each.text}" for each in numbers(block) if each.unit or "." in each.text]
            continue
        known = stated(files)
        names = " ".join(sorted({file.stem for file in files}))
        found += [f"{names}: {number.text}" for number in numbers(block) if not known.has(number)]
    return found


def all_unmatched() -> dict[str, list[str]]:
    """Unmatched numbers of all pages that have some."""
    cases = (str(case.relative_to(ROOT)) for case in sorted((ROOT / "cases").rglob("*.toml")))
    return {name: found for name in (*PAGES, *cases) if (found := unmatched(ROOT / name))}


def main() -> None:
    """Print or write them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="make them the list of exceptions")
    found = all_unmatched()
    if parser.parse_args().write:
        LISTED.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    for name, each in found.items():
        print(f"{name}: {len(each)}", *each, sep="\n  ")


if __name__ == "__main__":
    main()
