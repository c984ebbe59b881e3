"""The table of the page beside this file: what certificates.json holds, by groups of entries.

python tests/independent/proved_table.py     # writes it; prove_certificates.py does, too
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

FILE, PAGE = (Path(__file__).with_name(name) for name in ("certificates.json", "README.md"))

BETWEEN = re.compile(r"(?<=<!-- begin: proved -->\n).*?(?=<!-- end: proved -->)", re.DOTALL)

GROUPS = {
    "random rigs, every kind of stop, all of the motion": "random, ",
    "the rig with every law of a stop": "rig, ",
    "the rig of DTU: `cases/dtu_*.toml`": "cases/dtu_",
    "its measured figures: `cases/experiment/`": "cases/experiment/",
    "other cases": "cases/",
}

COUNTS = ("motions", "impacts", "segments_checked", "pieces_proved")

TITLES = ("what was flown", "entries", "motions", "impacts", "segments checked", "pieces proved", "named as integrated")


def table(held: dict[str, dict[str, Any]]) -> str:
    """Counts of every group, in Markdown; each entry is in the first group whose words it begins with."""
    left, lines = dict(held), [TITLES, ("---", *["---:"] * (len(TITLES) - 1))]
    for title, start in GROUPS.items():
        mine = [left.pop(name) for name in list(left) if name.startswith(start)]
        sums = [sum(each[count] for each in mine) for count in COUNTS]
        integrated = sum(sum(each["unproved"].values()) for each in mine)
        lines.append((title, *(f"{number:,}".replace(",", " ") for number in (len(mine), *sums, integrated))))
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def written(page: str, held: dict[str, dict[str, Any]]) -> str:
    """The page with the table of what the file holds."""
    return BETWEEN.sub(lambda _: table(held), page)


def write() -> None:
    """Renew the table on the page."""
    held = json.loads(FILE.read_text(encoding="utf-8"))
    PAGE.write_text(written(PAGE.read_text(encoding="utf-8"), held), encoding="utf-8")


if __name__ == "__main__":
    write()
