"""Cost of an impact against the number of modes: flight on the DTU rig, 1 … 200 modes of 100 elements.

    python tests/benchmarks/modes.py [--rounds 5]

With constant modal damping the lower modes ring on from impact to impact; with damping proportional to stiffness,
ζ_i = ζ₁ω_i/ω₁, the fourth mode is overdamped already and only the first two outlast a flight. "Ringing" counts the
modes that keep more than 1e-16 of their amplitude over half a drive period; "panels" are the pieces of flight looked
at for an impact. Neutral gap, 14 … 17 Hz in 3 points of 250 periods from settled motion; the least CPU time of the
rounds. The exponent is that of cost ~ modes^exponent against the row before: 1 is linear.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import vibeam
from vibeam.case.fidelity import Fidelity, system
from vibeam.flight.solver import FlightSolver
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import Ended
from vibeam.system.state import State
from vibeam_models.base_motion import base_amplitude

RIG = Path(__file__).parents[2] / "cases" / "dtu_neutral.toml"
TARGET = Path(__file__).with_name("results") / "modes.json"
MODES = (1, 2, 4, 8, 16, 32, 64, 100, 200)
GRID = 2 * np.pi * np.array([14.0, 15.5, 17.0])
PERIODS, ELEMENTS, LEAST = 250, 100, 36.0  # e⁻³⁶ is round-off
SETTLE, LIMIT = 200, 100  # periods; impacts a period after which flight gives up
PATIENCE = 150  # seconds for one row
LAWS = ("constant", "stiffness")
Row = dict[str, Any]


def built(modes: int, damping: str) -> tuple[ImpactSystem, float]:
    """The rig's system, and the amplitude of its base."""
    scene = vibeam.load(RIG, set={"beam.elements": ELEMENTS, "beam.damping": damping}).scene
    return cut(system(scene, Fidelity("full", "full")), modes), base_amplitude(scene)


def cut(whole: ImpactSystem, modes: int) -> ImpactSystem:
    """Its first modes, or all where there are fewer."""
    rows = {name: getattr(whole, name)[:modes] for name in ("omega", "zeta", "contact", "load", "static")}
    return replace(whole, **rows, outputs={name: row[:modes] for name, row in whole.outputs.items()})


def ringing(case: ImpactSystem) -> int:
    """How many modes half a drive period leaves more than round-off of."""
    decay = np.where(
        case.zeta < 1, case.zeta, case.zeta - np.sqrt(np.maximum(case.zeta**2 - 1, 0))
    ) * case.omega  # fmt: skip
    return int(np.sum(decay * np.pi / GRID.mean() < LEAST))


class Run:
    """One system, settled, ready to be timed."""

    def __init__(self, modes: int, damping: str) -> None:
        self.case, self.amplitude = built(modes, damping)
        self.solver = FlightSolver(self.case, float(GRID[0]), limit=LIMIT)
        self.state: State | None = None
        seen, self.state = self.solver.steady(GRID[:1], self.amplitude, None, SETTLE, 1, "contact")
        if not np.isfinite(seen.amplitude[0]):
            raise ValueError(Ended.of_code(int(seen.ended[0])).value)

    def cost(self) -> tuple[float, float]:
        """CPU seconds an impact, and evaluations an impact."""
        begun = time.process_time()
        found, _ = self.solver.steady(GRID, self.amplitude, self.state, PERIODS - 1, 1, "contact")
        spent, impacts = time.process_time() - begun, found.impacts.sum()
        return spent / impacts, float(found.evaluations.sum() / impacts)


def main() -> None:
    """Print and write the rows, each in a process of its own: what does not end is ended, and said."""
    arguments = parse()
    if arguments.row:
        modes, law = arguments.row
        print(json.dumps(row_of(int(modes), law, arguments.rounds)))
        return
    Run(1, "constant")  # compiles, or finds it compiled
    rows: list[Row] = []
    print(f"{'damping':12}{'modes':>6}{'µs each':>10}{'exponent':>10}{'ringing':>9}{'panels':>9}")
    for modes in MODES:
        for law in LAWS:
            rows.append(apart(modes, law, arguments.rounds))
            compare(rows)
            show(rows[-1])
    TARGET.write_text(json.dumps(rows, indent=1) + "\n")


def apart(modes: int, law: str, rounds: int) -> Row:
    """``row_of`` in another process."""
    command = [sys.executable, __file__, "--rounds", str(rounds), "--row", str(modes), law]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return {"modes": modes, "damping": law, "failed": f"did not end within {PATIENCE} s"}
    if done.returncode:
        return {"modes": modes, "damping": law, "failed": done.stderr.strip().splitlines()[-1]}
    return dict(json.loads(done.stdout))


def row_of(modes: int, law: str, rounds: int) -> Row:
    """Times of one system."""
    run = Run(modes, law)
    costs, panels = zip(*[run.cost() for _ in range(rounds + 1)], strict=True)
    return {
        "modes": run.case.size, "damping": law, "ringing": ringing(run.case), "panels": panels[0],
        "cost_us": 1e6 * min(costs[1:]), "cost_median_us": 1e6 * float(np.median(costs[1:])),
    }  # fmt: skip


def compare(rows: list[Row]) -> None:
    """The exponent of the last row against the one before of the same damping."""
    last = rows[-1]
    same = [row for row in rows[:-1] if row["damping"] == last["damping"] and "cost_us" in row]
    if same and "cost_us" in last and last["modes"] > same[-1]["modes"]:
        growth = np.log(last["cost_us"] / same[-1]["cost_us"])
        last["exponent"] = float(growth / np.log(last["modes"] / same[-1]["modes"]))


def show(row: Row) -> None:
    """One line."""
    if "failed" in row:
        print(f"{row['damping']:12}{row['modes']:6}  {row['failed']}", flush=True)
        return
    exponent = row.get("exponent", np.nan)
    print(
        f"{row['damping']:12}{row['modes']:6}{row['cost_us']:10.3f}{exponent:10.2f}{row['ringing']:9}{row['panels']:9.1f}",
        flush=True,
    )


def parse() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--row", nargs=2, metavar=("MODES", "DAMPING"), help="one system only, as JSON")
    return parser.parse_args()


if __name__ == "__main__":
    main()
