"""``accuracy = "1 %"`` on the three DTU cases: the fidelity taken, its estimate, and how far off the full model it is.

    python tests/benchmarks/accuracy.py [--within 1 5 15]

The full model, all modes of the mesh, is swept as the case sweeps; "true" is the largest difference in amplitude over
all points at which an error is claimed. CPU times: of the choice, sweeps and estimates, and of the full model's sweep.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

import numpy as np

import vibeam
from vibeam.case.fidelity import Fidelity, system
from vibeam.exchange.faults import CaseError
from vibeam.system.response import Branches

CASES = Path(__file__).parents[2] / "cases"


def full_sweep(case: Any) -> Branches:
    """The full model, swept as the case sweeps."""
    omega, plan = 2 * np.pi * np.sort(case.sweep.frequency), case.sweep
    found = vibeam.sweep(
        system(case.scene, Fidelity("full", "full")), omega=omega, amplitude=case.amplitude(omega), direction="both",
        settle=plan.settle, hold=plan.hold, output=plan.output,
    )  # fmt: skip
    assert isinstance(found, Branches)
    return found


def row(name: str, percent: float, truth: Branches, seconds: float) -> str:
    """One line of the table."""
    case, begun = vibeam.load(CASES / f"{name}.toml", set={"accuracy": f"{percent} %"}), time.process_time()
    try:
        result = vibeam.run(case, show=False)
    except CaseError as refusal:
        return f"| {name} | {percent:g} % | {refusal} |"
    spent, (*_, taken) = time.process_time() - begun, result.accuracy.swept
    branches, off = result.estimates[taken.fidelity].branches, []
    for way, response in result[taken.fidelity].items():
        error = np.abs(response.amplitude / getattr(truth, way).amplitude - 1)
        off += error[branches[way].known].tolist()
    known = f"{taken.known} of {taken.points}"
    return (
        f"| {name} | {percent:g} % | {taken.fidelity} | {known} | {100 * taken.error:.3g} % | {100 * max(off):.3g} % "
        f"| {spent:.2g} s | {seconds:.2g} s |"
    )


def main() -> None:
    """Print a table, one row a case and accuracy."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--within", type=float, nargs="+", default=[1, 5, 15])
    asked = parser.parse_args()
    print("| case | accuracy | taken | known at | estimate | true | CPU | full model |\n" + "|---" * 8 + "|")
    for name in ("dtu_neutral", "dtu_loose", "dtu_tight"):
        begun = time.process_time()
        truth = full_sweep(vibeam.load(CASES / f"{name}.toml"))
        seconds = time.process_time() - begun
        for percent in asked.within:
            print(row(name, percent, truth, seconds))


if __name__ == "__main__":
    main()
