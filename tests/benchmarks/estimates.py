"""Estimated error of a reduced model's response, against flights of the full model it stands for.

    python tests/benchmarks/estimates.py [--beams 1000] [--dtu] [--random]

Random beams (``tests/support/random_beams.py``) whose reduced model has a motion of period 1 with impacts, settled from
equilibrium: the estimate, made without the full model's flight, against the full model settled from equilibrium too. A
beam is compared where that has the same kind of motion, period 1 with as many impacts; others are counted. Then the
three DTU cases with either restitution held, at every point of both directions at which both models repeat alike, with
the CPU seconds of the estimates over those of the full model's own sweeps in the same process. ``--dtu``
or ``--random`` alone keeps the other results.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

import vibeam
from vibeam.case.fidelity import Fidelity, system
from vibeam.flight.solver import FlightSolver
from vibeam.periodic.orbit_search import orbits
from vibeam.runs.estimate.error import estimate_error
from vibeam.runs.estimate.records import Basis, ErrorEstimate
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import FrequencyResponse, join
from vibeam.system.state import StatesAfter

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from support.random_beams import RandomBeam, random_beam  # noqa: E402

TARGET = Path(__file__).with_name("results") / "estimates.json"
NAMES = ("dtu_tight", "dtu_neutral", "dtu_loose")
CHOICES = ("contact", "first mode")
SETTLE, HOLD = 800, 20
FLOOR = 1e-5  # share of the amplitude below which a true error is what the flights are settled and read to
Row = dict[str, Any]


def settled(model: ImpactSystem, beam: RandomBeam) -> tuple[FrequencyResponse, StatesAfter]:
    """Response at one drive, from equilibrium, and the state after it."""
    flight = FlightSolver(model, beam.omega)
    found, state = flight.steady([beam.omega], beam.amplitude, None, SETTLE, HOLD, "sensor")
    return found, StatesAfter(state.displacement[None], state.velocity[None])


def compared(beam: RandomBeam) -> Row | None:
    """Estimate and true error of one beam; None where its reduced motion is not of period 1 with impacts.

    Nor where the flight solver cannot take one of the models (real rates of overdamped modes that nearly coincide).
    """
    try:
        (response, after), (full, _) = settled(beam.reduced, beam), settled(beam.full, beam)
    except ValueError:
        return None
    if response.period[0] != 1:
        return None
    estimate = estimate_error(response, beam.reduced, beam.full, beam.amplitude, "sensor", after)
    basis = Basis.of_code(int(estimate.basis[0]))
    row = {"label": beam.label, "basis": basis.name, "estimate": float(estimate.amplitude_bound[0])}
    same = full.period[0] == 1 and full.impacts_per_period[0] == response.impacts_per_period[0]
    true = float(abs(response.amplitude[0] / full.amplitude[0] - 1))
    return row | {"same": bool(same), "true": true, "full_period": int(full.period[0])}


def coexists(beam: RandomBeam) -> bool:
    """Test whether the full model has a stable motion with one impact a period, certified, beside the one it took."""
    found = orbits(beam.full, Drive(beam.omega, beam.amplitude))
    return any(each.admissible and each.stable for each in found)


def random_beams(count: int) -> Row:
    """Comparison of so many beams of period 1."""
    rows: list[Row] = []
    seed = 0
    while len(rows) < count:
        row = compared(random_beam(seed))
        rows += [] if row is None else [row | {"seed": seed}]
        seed += 1
    known = [row for row in rows if row["basis"] == "ORBIT"]
    return {
        "beams": count, "drawn": seed, "known": len(known),
        "unknown": dict(Counter(row["basis"] for row in rows if row["basis"] != "ORBIT")),
        "unknown_and_other_motion": sum(row["basis"] != "ORBIT" and not row["same"] for row in rows),
        "other_motion": [[row["seed"], row["full_period"]] for row in known if not row["same"]],
        "coexisting": sum(coexists(random_beam(row["seed"])) for row in known if not row["same"]),
        **effectivities([(row["estimate"], row["true"]) for row in known if row["same"]]),
        "worst": sorted(
            ([row["seed"], row["estimate"], row["true"]] for row in known if row["same"]),
            key=lambda each: -each[1] / max(each[2], FLOOR),
        )[:5],
    }  # fmt: skip


def effectivities(pairs: list[tuple[float, float]]) -> Row:
    """Share of the estimates that are not below the true error, and quantiles of estimate over true error."""
    estimate, true = np.array(pairs).reshape(-1, 2).T
    large = true > FLOOR
    ratio = estimate[large] / true[large]
    return {
        "compared": len(true), "below_floor": int(np.count_nonzero(~large)),
        "not_below_true": float(np.mean(estimate >= true)), "median": float(np.median(ratio)),
        "quantile_95": float(np.quantile(ratio, 0.95)), "least": float(ratio.min()), "largest": float(ratio.max()),
        "median_true": float(np.median(true)), "largest_true": float(true.max()),
    }  # fmt: skip


def both_ways(case: Any, model: ImpactSystem) -> tuple[FrequencyResponse, float]:
    """Both directions of a case's sweep, one after the other, and the CPU seconds they took."""
    omega, plan = 2 * np.pi * case.sweep.frequency, case.sweep
    begun = time.thread_time()
    found = vibeam.sweep(
        model, omega=omega, amplitude=case.amplitude(omega), direction="both", settle=plan.settle, hold=plan.hold,
        output=plan.output,
    )  # fmt: skip
    return join([found.up, found.down]), time.thread_time() - begun


def timed(
    case: Any, reduced: ImpactSystem, full: ImpactSystem, response: FrequencyResponse
) -> tuple[ErrorEstimate, float]:
    """Estimate of one fidelity, and its least CPU seconds of three."""
    amplitude, spent = case.amplitude(2 * np.pi * response.frequency), []
    for _ in range(3):
        begun = time.thread_time()
        found = estimate_error(response, reduced, full, amplitude, case.sweep.output)
        spent.append(time.thread_time() - begun)
    return found, min(spent)


def dtu() -> list[Row]:
    """Rows of the DTU cases: one for each fidelity and choice."""
    rows = []
    for name in NAMES:
        for choice in CHOICES:
            case = vibeam.load(ROOT / "cases" / f"{name}.toml", set={"stop.restitution_of": choice})
            full = system(case.scene, Fidelity("full", "full"))
            truth, flown = both_ways(case, full)
            for fidelity in case.fidelities:
                response, _ = both_ways(case, case.system(fidelity))
                found, seconds = timed(case, case.system(fidelity), full, response)
                alike = found.known & (response.period == truth.period)
                alike &= np.abs(response.impacts_per_period - truth.impacts_per_period) < 1e-9
                true = np.abs(response.amplitude / truth.amplitude - 1)[alike]
                pairs = list(zip(found.amplitude_bound[alike].tolist(), true.tolist(), strict=True))
                rows.append({
                    "case": name, "held": choice, "fidelity": fidelity, "points": len(response),
                    "known": int(found.known.sum()), "other_motion": int((found.known & ~alike).sum()),
                    **effectivities(pairs),
                    "reasons": {basis.name: count for basis, count in found.reasons.items()},
                    "estimate_seconds": seconds, "full_seconds": flown, "share": seconds / flown,
                })  # fmt: skip
    return rows


def main() -> None:
    """Measure, print and write the results."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--beams", type=int, default=1000)
    for name in ("dtu", "random"):
        parser.add_argument(f"--{name}", action="store_true", help="measure this alone and keep the other results")
    given = parser.parse_args()
    parts = {"dtu": dtu, "random": lambda: random_beams(given.beams)}
    for name in [name for name in parts if getattr(given, name)] or list(parts):
        result = parts[name]()
        found: Row = json.loads(TARGET.read_text()) if TARGET.exists() else {}
        found[name] = result
        print(json.dumps(result, indent=1))
        TARGET.write_text(json.dumps(dict(sorted(found.items())), indent=1) + "\n")


if __name__ == "__main__":
    main()
