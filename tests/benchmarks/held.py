"""Peaks of the neutral case with either restitution held, for the table of the front page.

python tests/benchmarks/held.py  # writes results/held.json; then python tests/benchmarks/pages.py
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
CASE, TARGET = HERE.parents[1] / "cases" / "dtu_neutral.toml", HERE / "results" / "held.json"
CHOICES = ("contact", "first mode")
MORE = ("fidelity.beam.modes=64", "beam.elements=60")


def rows_of(choice: str) -> list[dict[str, Any]]:
    """R, R₁, peak (m), its difference from the finest's, of each fidelity and of 64 modes on a finer mesh."""
    held = f'stop.restitution_of="{choice}"'
    plain, fine = printed(held), printed(held, *MORE)
    top = plain[-1]["peak"]["amplitude"]
    return [
        {
            "name": row["fidelity"],
            "restitution": row["restitution"],
            "first_mode": row["first_mode_restitution"],
            "peak": row["peak"]["amplitude"],
            "off": row["peak"]["amplitude"] / top - 1,
        }
        for row in [*plain, fine[-1] | {"fidelity": "64 modes, 60 elements"}]
    ]


def printed(*settings: str) -> list[dict[str, Any]]:
    """Rows of the fidelities that ``vibeam run --json`` prints."""
    words = [word for each in settings for word in ("--set", each)]
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "vibeam", "run", str(CASE), "--json", "--out", folder, *words]
        found = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    rows: list[dict[str, Any]] = found["fidelities"]
    return rows


def main() -> None:
    """Measure and write the results."""
    TARGET.write_text(json.dumps({choice: {"rows": rows_of(choice)} for choice in CHOICES}, indent=1) + "\n")


if __name__ == "__main__":
    main()
