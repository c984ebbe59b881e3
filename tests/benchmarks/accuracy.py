"""``accuracy = "1 %"`` on the three DTU cases at full size: how much of it holds, at which share of the cost.

    python tests/benchmarks/accuracy.py [--within 0.01] [--repeats 5]

The finest fidelity is swept everywhere by flight, as ``vibeam run`` does without the key, alternating with the choice
in one process; CPU times are the least of the repeats, verification and building of models apart. A point holds where
the amplitude is within, of what the finest model's own sweep reads there. Where that does not repeat it also holds
where the value is one of its readings from other starts: within the accuracy and the scatter of eight of them
(Student's t, 99 %), those of both sweeps and of six holds in a row from equilibrium.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

import vibeam
from vibeam.accuracy.rungs import rows
from vibeam.accuracy.study import Curve, study
from vibeam.accuracy.verify import DRAWS, judged
from vibeam.case import Case
from vibeam.response import Branches, FrequencyResponse
from vibeam.solvers.flight import FlightSolver
from vibeam.sweep import join

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


def holds(case: Case, curve: Curve, truths: list[FrequencyResponse], within: float) -> list[tuple[float, float, bool]]:
    """Error and what it may be at every point, and whether the finest model repeats there; its own sweep comes first.

    The other sweep runs the other way.
    """
    plan, told = case.sweep, []
    flight = FlightSolver(case.system("beam"), 2 * np.pi * float(plan.frequency.min()))
    for place in range(len(truths[0])):
        one, own = (rows(each, np.array([place])) for each in (curve.response, truths[0]))
        error, allowed = judged(one, own, ("amplitude",), within)
        if error > allowed and own.period[0] == 0:
            drawn, state = [own, rows(truths[1], np.array([-1 - place]))], None
            while len(drawn) < DRAWS:
                settle = plan.settle if state is None else 0
                more, state = flight.steady(own.omega, case.base_amplitude, state, settle, plan.hold, plan.output)
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
    print("case         points    hold  repeat  worst there    choice    finest   share")
    for name in ("dtu_neutral", "dtu_loose", "dtu_tight"):
        case = vibeam.load(CASES / f"{name}.toml")
        pairs = [(study(case, asked.within, checks=0), everywhere(case)) for _ in range(asked.repeats + 1)][1:]
        found, truth = pairs[0]
        sweeps = [response for _, response in truth.items()]
        told = holds(case, found.curves["up"], sweeps, asked.within)
        told += holds(case, found.curves["down"], sweeps[::-1], asked.within)
        share = np.mean([error <= allowed for error, allowed, _ in told])
        steady = [error for error, allowed, repeats in told if repeats and error <= allowed]
        choice, finest = min(one.cpu_seconds for one, _ in pairs), min(seconds(other) for _, other in pairs)
        print(
            f"{name:12} {len(told):6d} {share:7.2%} {sum(row[2] for row in told):7d} {max(steady):12.1e} "
            f"{choice:7.4f} s {finest:7.4f} s {choice / finest:7.1%}"
        )
        for row in found.chosen:
            if row.asked:
                print(f"    {row.fidelity:10} {row.solver:9} {row.taken:4d} points, {row.asked:4d} asked")


if __name__ == "__main__":
    main()
