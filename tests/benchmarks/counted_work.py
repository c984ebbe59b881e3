"""Work of sweeps as budgets count it, beside its CPU time: the ratio of every fidelity that is simulated exactly.

python tests/benchmarks/counted_work.py [CASE ...]  # absent: the rigs, the first cases, matrices and near_clamp
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

import vibeam
from vibeam.runs.comparison.work import WorkRate

CASES = Path(__file__).parents[2] / "cases"
GIVEN = ("dtu_neutral.toml", "dtu_tight.toml", "rigs/*.toml", "reductions/near_clamp.toml", "matrices/*.toml")


def ratios(file: Path) -> list[tuple[float, str]]:
    """CPU time over work counted of each fidelity of a case, its second run."""
    case: Any = vibeam.load(file)
    vibeam.run(case, show=False)
    found = []
    for name, branches in vibeam.run(case, show=False).items():
        if case.fidelities[name].solver == "flight":
            rate, periods = WorkRate.of(case.scene_of(name)), case.sweep.settle + case.sweep.hold
            each = [response for _, response in branches.items()]
            counted = sum(float(rate.seconds(one, periods).sum()) for one in each)
            found.append((sum(float(np.nansum(one.cpu_seconds)) for one in each) / counted, f"{file.stem} {name}"))
    return found


def main(files: list[Path]) -> None:
    """Print the ratios in ascending order."""
    every = sorted(each for file in files for each in ratios(file))
    for ratio, name in every:
        print(f"{ratio:6.2f}  {name}")
    print(f"{len(every)} fidelities, {every[0][0]:.2f} to {every[-1][0]:.2f}")


if __name__ == "__main__":
    main([*map(Path, sys.argv[1:])] or [file for each in GIVEN for file in sorted(CASES.glob(each))])
