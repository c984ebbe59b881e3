"""``accuracy = "1 %"`` on the three DTU cases at full size: how much of it holds, at which share of the cost.

    python tests/benchmarks/accuracy.py [--within 0.01] [--repeats 5]

The finest fidelity is swept everywhere by flight, as ``vibeam run`` does without the key, alternating with the choice
in one process; CPU times are the least of the repeats, verification and building of models apart. How much of them is
spent in the flight kernels says what the share would be if these were several times faster. A point holds where
the amplitude is within, of what the finest model's own sweep reads there. Where that does not repeat it also holds
where the value is one of its readings from other starts: within the accuracy and the scatter of eight of them
(Student's t, 99 %), those of both sweeps and of six holds in a row from equilibrium.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

import vibeam
from vibeam.case.case import Case
from vibeam.flight import solver as flight
from vibeam.flight.solver import FlightSolver
from vibeam.runs.accuracy.candidates import rows
from vibeam.runs.accuracy.study import AccuracyChoice, Curve, study
from vibeam.runs.accuracy.verification import DRAWS, judged
from vibeam.system.response import Branches, FrequencyResponse, join

Found = TypeVar("Found")
Times = tuple[float, float]  # CPU seconds in all, and of these in the flight kernels
CASES = Path(__file__).parents[2] / "cases"


def everywhere(case: Case) -> Branches:
    """The finest fidelity's whole sweep."""
    omega, plan = 2 * np.pi * case.sweep.frequency, case.sweep
    found = vibeam.sweep(
        case.system("beam"), omega=omega, amplitude=case.amplitude(omega), direction="both",
        settle=plan.settle, hold=plan.hold, output=plan.output,
    )  # fmt: skip
    assert isinstance(found, Branches)
    return found


def seconds(branches: Branches) -> float:
    """CPU time of all points."""
    return float(sum(response.cpu_seconds.sum() for _, response in branches.items()))


def in_kernels(work: Callable[[], Found]) -> tuple[Found, float]:
    """What ``work`` gives, and the CPU seconds that it spends in the flight kernels."""
    spent, kernel = [], flight.move

    def move(*given: Any) -> tuple[int, float]:
        begun = time.thread_time()
        found = kernel(*given)
        spent.append(time.thread_time() - begun)
        return found

    flight.move = move
    try:
        return work(), sum(spent)
    finally:
        flight.move = kernel


def shares(choice: Times, finest: Times) -> str:
    """The cost's share as it is and for kernels two and three times faster, from times in all and in kernels."""
    faster = [[whole - kernel + kernel / k for whole, kernel in (choice, finest)] for k in (1, 2, 3)]
    return " ".join(f"{ours / theirs:7.1%}" for ours, theirs in faster)


def holds(case: Case, curve: Curve, truths: list[FrequencyResponse], within: float) -> list[tuple[float, float, bool]]:
    """Error and what it may be at every point, and whether the finest model repeats there; its own sweep comes first.

    The other sweep runs the other way.
    """
    plan, told = case.sweep, []
    solver = FlightSolver(case.system("beam"), 2 * np.pi * float(plan.frequency.min()))
    for place in range(len(truths[0])):
        one, own = (rows(each, np.array([place])) for each in (curve.response, truths[0]))
        error, allowed = judged(one, own, ("amplitude",), within)
        if error > allowed and own.period[0] == 0:
            drawn, state = [own, rows(truths[1], np.array([-1 - place]))], None
            while len(drawn) < DRAWS:
                settle = plan.settle if state is None else 0
                more, state = solver.steady(own.omega, case.base_amplitude, state, settle, plan.hold, plan.output)
                drawn.append(more)
            error, allowed = judged(one, join(drawn), ("amplitude",), within)
        told.append((error, allowed, bool(own.period[0] != 0)))
    return told


def main() -> None:
    """Print a row for each case."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--within", type=float, default=0.01)
    parser.add_argument("--repeats", type=int, default=5)
    asked = parser.parse_args()
    print("case         points    hold  repeat  worst there     choice  in kernels    finest   share, 2 and 3 × faster")
    for name in ("dtu_neutral", "dtu_loose", "dtu_tight"):
        case = vibeam.load(CASES / f"{name}.toml")
        runs: list[tuple[AccuracyChoice, Times, Branches, Times]] = []
        for _ in range(asked.repeats + 1):
            found, kernels = in_kernels(lambda case=case: study(case, asked.within, checks=0))
            truth, all_kernels = in_kernels(lambda case=case: everywhere(case))
            runs.append((found, (found.cpu_seconds, kernels), truth, (seconds(truth), all_kernels)))
        found, _, truth, _ = runs[1]
        choice, finest = (min(run[i] for run in runs[1:]) for i in (1, 3))
        sweeps = [response for _, response in truth.items()]
        told = holds(case, found.curves["up"], sweeps, asked.within)
        told += holds(case, found.curves["down"], sweeps[::-1], asked.within)
        share = np.mean([error <= allowed for error, allowed, _ in told])
        steady = [error for error, allowed, repeats in told if repeats and error <= allowed]
        print(
            f"{name:12} {len(told):6d} {share:7.2%} {sum(row[2] for row in told):7d} {max(steady):12.1e} "
            f"{1e3 * choice[0]:7.2f} ms {1e3 * choice[1]:8.2f} ms {1e3 * finest[0]:6.1f} ms {shares(choice, finest)}"
        )
        for row in found.chosen:
            if row.asked:
                print(f"    {row.fidelity:10} {row.solver:9} {row.taken:4d} points, {row.asked:4d} asked")


if __name__ == "__main__":
    main()
