"""What the paper's coordinates save: CPU time of its methods on its nominal model, beside the exact flight solver.

    python tests/benchmarks/paper_methods.py [--points 5] [--periods 250] [--repeats 3] [--write]

``--write`` makes it results/paper_methods.json, of which ``pages.py`` makes the table of cases/paper.

q̈ + 2βq̇ + q = Ω²B sin Ωt, β = 0.015, B = 0.5e-3, R = 0.9, Δ = 0, Ω from 1.5 to 2.5, the state carried. Times are the
least of the repeats; errors are those of the mean impact velocity in the last period of each point against flight.
Relative times are against direct integration, as in the paper (§3.3 and §4.2: Ivanov −80 %, Zhuravlev −70 %, averaging
−93 %, mapping −14 %). The paper iterates its map; mapping here solves for the fixed point, and tests by one flight that
it passes the stop nowhere, while iterating the map is what flight does. Direct and zhuravlev take the very same steps
(see evaluations): what separates their times is that the one has a right-hand side for any number of modes, in arrays,
and the other one in plain numbers.
"""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path
from typing import Any

import numpy as np

import vibeam
from vibeam.extensions.paper.averaging import AveragingSolver
from vibeam.extensions.paper.ivanov import IvanovSolver
from vibeam.extensions.paper.mapping import MappingSolver
from vibeam.extensions.paper.zhuravlev import ZhuravlevSolver
from vibeam.flight.solver import FlightSolver
from vibeam.solvers.integration.direct import DirectSolver
from vibeam.solvers.integration.moreau import MoreauSolver

RESULT = Path(__file__).parent / "results" / "paper_methods.json"
AMPLITUDE = 0.5e-3
AS_THE_PAPER: dict[str, Any] = {"method": "RK23", "rtol": 1e-4, "atol": 1e-8}
ROWS: list[tuple[str, Any, dict[str, Any], str]] = [
    ("direct RK23 1e-4", DirectSolver, AS_THE_PAPER, ""),
    ("zhuravlev RK23 1e-4", ZhuravlevSolver, AS_THE_PAPER, "-70 %"),
    ("ivanov RK23 1e-4", IvanovSolver, AS_THE_PAPER, "-80 %"),
    ("direct DOP853 1e-10", DirectSolver, {"method": "DOP853", "rtol": 1e-10, "atol": 1e-14}, ""),
    ("moreau 1000 steps", MoreauSolver, {"steps": 1000}, ""),
    ("moreau 10000 steps", MoreauSolver, {"steps": 10_000}, ""),
    ("averaging, paper", AveragingSolver, {"damping": "paper"}, "-93 %"),
    ("averaging, log", AveragingSolver, {"damping": "log"}, ""),
    ("mapping", MappingSolver, {}, "-14 %"),
    ("flight", FlightSolver, {}, ""),
]


def main() -> None:
    """Measure and print."""
    arguments = parse()
    grid = np.linspace(1.5, 2.5, arguments.points)
    found = [measure(kind, options, grid, arguments.periods, arguments.repeats) for _, kind, options, _ in ROWS]
    base, exact = found[0][0], found[-1][1]
    print(f"{'':22}{'CPU s':>10}{'to direct':>11}{'paper':>8}{'median error':>14}{'largest':>10}{'evaluations':>13}")
    rows: list[dict[str, Any]] = []
    for (name, _, _, claim), (seconds, response) in zip(ROWS, found, strict=True):
        wrong = np.abs(response.impact_velocity / exact.impact_velocity - 1)
        change = f"{seconds / base - 1:+.0%}" if seconds / base > 0.01 else f"1/{base / seconds:.0f}"
        evaluations = int(np.sum(response.evaluations))
        rows.append({"name": name, "seconds": seconds, "paper": claim, "median_error": float(np.nanmedian(wrong))})
        rows[-1] |= {"largest_error": float(np.nanmax(wrong)), "evaluations": evaluations}
        print(
            f"{name:22}{seconds:10.4g}{change:>11}{claim:>8}{np.nanmedian(wrong):14.1e}{np.nanmax(wrong):10.1e}"
            f"{evaluations:13d}"
        )
    if arguments.write:
        run = {name: getattr(arguments, name) for name in ("points", "periods", "repeats")}
        RESULT.write_text(json.dumps(run | {"load": os.getloadavg()[0], "rows": rows}, indent=1) + "\n")


def measure(
    kind: Any, options: dict[str, Any], grid: np.ndarray, periods: int, repeats: int
) -> tuple[float, vibeam.FrequencyResponse]:
    """Least CPU seconds over the grid, and the response."""
    system = vibeam.ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, gap=0.0, restitution=0.9)
    solver = kind(system, float(grid[0]), **options)
    solver.steady(grid[:1], AMPLITUDE, None, 1, 1, "contact")
    runs = [solver.steady(grid, AMPLITUDE, None, periods - 1, 1, "contact")[0] for _ in range(repeats)]
    return min(float(np.sum(run.cpu_seconds)) for run in runs), runs[0]


def parse() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=5)
    parser.add_argument("--periods", type=int, default=250)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--write", action="store_true")
    return parser.parse_args()


if __name__ == "__main__":
    main()
