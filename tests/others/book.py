"""The proof book: its page made from stored results, and the results from runs.

    python -m tests.others.book                       # the page anew, from results/*.json
    python -m tests.others.book --run                 # every section computed first, about 15 minutes of CPU time
    python -m tests.others.book --run problems        # that section alone
    python -m tests.others.book --check               # changes nothing; exit code 1 if the page is not of the results

A table stands in ``README.md`` between ``<!-- begin: NAME -->`` and ``<!-- end: NAME -->``.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import re
import sys
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: its matrices are small
HERE = Path(__file__).parent
PAGE = HERE / "README.md"
SECTIONS = ("problems", "scenes", "dictionary", "uncertainty")


def section(name: str) -> Any:
    """Module of a section: ``measured()`` its results, ``table(results)`` its table."""
    return importlib.import_module(f"tests.others.{name}_book")


def stored(name: str) -> dict[str, Any]:
    """Stored results of a section."""
    return dict(json.loads((HERE / "results" / f"{name}.json").read_text(encoding="utf-8")))


def page(text: str) -> str:
    """The page with the tables of the stored results."""
    for name in SECTIONS:
        between = re.compile(rf"(<!-- begin: {name} -->\n).*?(<!-- end: {name} -->)", re.DOTALL)
        text, count = between.subn(lambda found: found[1] + section(name).table(stored(name)) + "\n" + found[2], text)  # noqa: B023
        if count != 1:
            raise SystemExit(f"{PAGE.name}: no place for the table {name!r}")
    return text


def main() -> None:
    """Run what is asked for, then write or check the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", nargs="*", choices=SECTIONS, metavar="SECTION", help="compute these, or all")
    parser.add_argument("--check", action="store_true", help="change nothing")
    asked = parser.parse_args()
    for name in [] if asked.run is None else asked.run or SECTIONS:
        found = json.dumps(section(name).measured(), indent=1, ensure_ascii=False) + "\n"
        (HERE / "results" / f"{name}.json").write_text(found, encoding="utf-8")
    before = PAGE.read_text(encoding="utf-8")
    after = page(before)
    if asked.check:
        sys.exit(int(before != after))
    PAGE.write_text(after, encoding="utf-8")


if __name__ == "__main__":
    main()
