"""Time of flight with nothing special in the scene, two checkouts in turn: what a change costs who does not ask for it.

    python tests/benchmarks/common_path.py BEFORE AFTER [--rounds 15]

BEFORE and AFTER are folders of checkouts. Each round runs both in processes of their own, in turn: the nominal SDOF
sweep (51 points) and the DTU rig's with eight modes (13 points), 250 periods a point. Printed are the least and the
median CPU time an impact and AFTER over BEFORE; least over least is what a busy machine disturbs least.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

WORK = """
import json, time
import numpy as np
import vibeam

def sdof():
    system = vibeam.ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, restitution=0.9)
    return system, np.linspace(1.5, 2.5, 51), 0.5e-3

def rig():
    case = vibeam.load("cases/dtu_neutral.toml")
    return case.system("beam"), 2 * np.pi * np.linspace(14, 17, 13), case.base_amplitude

found = {}
for name, build in {"sdof": sdof, "eight modes": rig}.items():
    system, grid, amplitude = build()
    costs = []
    for _ in range(6):
        begun = time.process_time()
        response = vibeam.sweep(system, omega=grid, amplitude=amplitude, settle=200, hold=50)
        costs.append((time.process_time() - begun) / response.impacts.sum())
    found[name] = min(costs[1:])
print(json.dumps(found))
"""


def main() -> None:
    """Run and compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--rounds", type=int, default=15)
    arguments = parser.parse_args()
    both = (arguments.before.resolve(), arguments.after.resolve())
    for checkout in both:
        costs(checkout)  # compiles
    rounds = [[costs(checkout) for checkout in both] for _ in range(arguments.rounds)]
    print(f"{'µs an impact':14}{'before':>22}{'after':>22}{'ratio':>20}\n{'':14}" + f"{'least':>11}{'median':>11}" * 3)
    for name in rounds[0][0]:
        table = 1e6 * np.array([[cost[name] for cost in pair] for pair in rounds])
        least, median = table.min(axis=0), np.median(table, axis=0)
        ratio = (least[1] / least[0], np.median(table[:, 1] / table[:, 0]))
        figures = (least[0], median[0], least[1], median[1], *ratio)
        print(f"{name:14}" + "".join(f"{figure:11.4f}" for figure in figures))


def costs(checkout: Path) -> dict[str, float]:
    """Seconds an impact of each sweep, the best of five, in a process of its own."""
    paths = os.pathsep.join(str(checkout / part) for part in ("", "models", "reductions"))
    environment = {**os.environ, "PYTHONPATH": paths}
    done = subprocess.run(
        [sys.executable, "-c", WORK], cwd=checkout, env=environment, capture_output=True, text=True, check=True
    )
    return dict(json.loads(done.stdout))


if __name__ == "__main__":
    main()
