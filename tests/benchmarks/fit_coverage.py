"""How often 95 % intervals of ``vibeam fit`` cover the truth, and the CPU time of an iteration.

    python tests/benchmarks/fit_coverage.py [--sets 100]

Each scenario: points of the branches at the case's own values, normal noise of 1 %, keys estimated from a start that is
off, and the likelihood ratio at the true value of each key against the 95 % level: whether the profile interval covers
it. Writes results/fit_coverage.json.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

import vibeam
from vibeam.exchange.curves.record import ReferenceCurve
from vibeam.studies.fit.estimate import Scan, estimate, minimise
from vibeam.studies.fit.problem import Problem
from vibeam.studies.fit.profile import LEVEL

CASES = Path(__file__).parents[2] / "cases"

GAIN, RESTITUTION, DAMPING = (
    '"drive.gain" = ["2e-4 1/V", "1e-3 1/V"]',
    '"stop.restitution" = [0.4, 0.92]',
    '"beam.damping_ratio" = [0.005, 0.04]',
)

#: file, fidelity, keys, {reference: (from, to, points)}, {fidelity: set}
SCENARIOS: dict[str, tuple[str, str, list[str], dict[str, Any], str]] = {
    "gain and restitution, one degree of freedom": ("dtu_neutral", "sdof", [GAIN, RESTITUTION], {}, "stable"),
    "gain, restitution, thickness, two modes": (
        "dtu_neutral", "two_modes", [GAIN, RESTITUTION, '"beam.thickness" = ["1 mm", "1.07 mm"]'], {}, "stable",
    ),
    "gain, restitution, damping, two levels of drive": (
        "dtu_neutral", "sdof", [GAIN, RESTITUTION, DAMPING], {"drive.voltage": "0.9 V"}, "stable",
    ),
    "gain, restitution, gap, loose stop": (
        "dtu_loose", "sdof", [GAIN, RESTITUTION, '"stop.gap" = ["0.02 mm", "0.2 mm"]'], {}, "stable",
    ),
    "gain and restitution, tight stop": ("dtu_tight", "sdof", [GAIN, RESTITUTION], {}, "stable"),
    "gain and restitution, tight stop, unstable branch too": (
        "dtu_tight", "sdof", [GAIN, RESTITUTION], {}, "controlled",
    ),
}  # fmt: skip


def exact(case: vibeam.Case, fidelity: str, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies and amplitudes of motions that are stable (or, controlled, unstable)."""
    system, found = case.system(fidelity), []
    for frequency in np.linspace(13.8, 17.6, 30):
        omega = 2 * np.pi * frequency
        drive = vibeam.Drive(omega, float(np.ravel(case.amplitude_of(fidelity, np.array([omega])))[0]))
        for each in vibeam.orbits(system, drive):
            if each.admissible and (each.stable or kind == "controlled"):
                found.append((frequency, each.amplitude("sensor")))
    return tuple(np.array(found).T)  # type: ignore[return-value]


def covered(name: str, sets: int) -> dict[str, Any]:
    """Number of sets in which each key's interval covers the truth."""
    file, fidelity, keys, second, kind = SCENARIOS[name]
    case = vibeam.load(CASES / f"{file}.toml", set={"fit.keys": "{" + ", ".join(keys) + "}"})
    cases = {"first": case}
    if second:
        table = "{ " + ", ".join(f'"{key}" = "{value}"' for key, value in second.items()) + " }"
        own = {"fidelity.second.reduction": "static_mode", "fidelity.second.set": table}
        case = vibeam.load(CASES / f"{file}.toml", set={"fit.keys": "{" + ", ".join(keys) + "}"} | own)
        cases = {"first": case, "second": case}
    assert case.fit is not None
    names = {"first": fidelity, "second": "second"}
    truth = {each: exact(case, names[each], kind) for each in cases}
    rng = np.random.default_rng(20)
    plan = replace(case.fit, references=tuple(cases), unstable=tuple(cases) if kind == "controlled" else ())
    case = replace(case, fit=plan)
    hits, lost = np.zeros(len(plan.keys), dtype=int), 0
    for _ in range(sets):
        own = replace(case, references={})
        for each, (frequency, value) in truth.items():
            noisy = value * (1 + 0.01 * rng.standard_normal(len(value)))
            own = own.with_reference(each, ReferenceCurve.of(frequency, noisy, uncertainty=0.01 * value), names[each])
        problem = Problem.of(own)
        start = problem.start
        off = problem.values(np.clip(start + 0.05 * rng.standard_normal(len(start)), 0.02, 0.98))
        keys_off = tuple(replace(each, start=float(value)) for each, value in zip(problem.keys, off, strict=True))
        started = replace(problem, keys=keys_off)
        problem, found = estimate(started, Scan.of(started))
        lost += int(not found.actual.all())
        least = [minimise(problem, found.x, found.chosen, {k: float(each)})[1] for k, each in enumerate(start)]
        hits += [each - found.misfit < LEVEL for each in least]
    points = sum(len(frequency) for frequency, _ in truth.values())
    keys_hit = dict(zip((each.key for each in plan.keys), hits.tolist(), strict=True))
    return {"sets": sets, "points": points, "covered": keys_hit, "sets_with_points_on_no_motion": lost}


def iteration() -> dict[str, Any]:
    """CPU time of residuals and Jacobian: 60 points, eight modes, four keys, two of the structure."""
    case = vibeam.load(CASES / "synthetic/fit.toml")
    frequency = np.linspace(14.0, 17.0, 60)
    curve = ReferenceCurve.of(frequency, np.full(60, 3e-4), uncertainty=3e-6)
    problem = Problem.of(case.with_reference("laser", curve, "beam"))
    x, chosen, times = problem.start, np.zeros(60, dtype=int), []
    for k in range(9):
        begin = process_time()
        problem.residuals(x + 1e-3 * (k + 1), chosen)
        times.append(1e3 * (process_time() - begin))
    return {
        "points": 60,
        "modes": 8,
        "keys": 4,
        "cpu_ms_median": float(np.median(times[1:])),
        "cpu_ms_least": min(times),
    }


def main() -> None:
    """Run all scenarios and write the results."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--sets", type=int, default=100)
    sets = parser.parse_args().sets
    found: dict[str, Any] = {"iteration": iteration(), "scenarios": {}}
    print(found["iteration"])
    for name in SCENARIOS:
        begin = process_time()
        found["scenarios"][name] = covered(name, sets)
        print(name, found["scenarios"][name], f"{process_time() - begin:.0f} s", flush=True)
        (Path(__file__).parent / "results" / "fit_coverage.json").write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
