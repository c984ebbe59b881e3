"""Steps from the beam to the solid on three of ``cases/solid``: python tests/benchmarks/solid_steps.py

Writes results/solid_steps.json, which the page of those cases is held to.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

HERE = Path(__file__).parent
CASES = HERE.parents[1] / "cases" / "solid"
KEPT = ("answer", "enough", "steps", "errors", "chosen")


def main() -> None:
    """Write the steps of every case."""
    found = {}
    for name in ("dtu", "ratio_3", "slender"):
        command = [sys.executable, "-m", "vibeam", "verdict", str(CASES / f"{name}.toml"), "--only", "solid", "--json"]
        with TemporaryDirectory() as place:
            told = json.loads(subprocess.run(command, check=True, capture_output=True, text=True, cwd=place).stdout)
        found[name] = {key: told[key] for key in KEPT}
    (HERE / "results" / "solid_steps.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
