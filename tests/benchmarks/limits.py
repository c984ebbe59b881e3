"""Distance of a fidelity from its own limit: the estimate of ``vibeam run`` against models of 64 and 128 modes.

    python tests/benchmarks/limits.py [--cost] [--front]

The three DTU cases with 1, 2 and 8 modes and either restitution held, at every frequency of the sweep. "True" are the
stable closed-form motions of the same scene in 64 modes on 192 and in 128 modes on 384 elements, a motion of the same
kind at each point; an estimate counts as good within a factor of two of both. Points where both true distances are
below ``FLOOR``, where a model has no distance to speak of, are counted apart. ``flown``: largest relative difference
of the 64-mode closed forms from flight, at a few points of the case. ``--cost``: the CPU time of the comparison beside
those of the sweeps and of the whole command ``vibeam run``, in processes of their own, in turns. ``--front``: the
neutral case under both choices as the front page has it. Either of the two alone keeps the other results.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from vibeam.runs.comparison.limit import limit

import vibeam
from vibeam.case.fidelity import Fidelity, system
from vibeam.periodic.motions import closed_amplitudes
from vibeam.system.impact_system import ImpactSystem

CASES = Path(__file__).parents[2] / "cases"
TARGET = Path(__file__).with_name("results") / "limits.json"
NAMES = ("dtu_tight", "dtu_neutral", "dtu_loose")
CHOICES = ("contact", "first mode")
MODES = (1, 2, 8)
TRUTHS = ((64, 192), (128, 384))  # modes, elements
FLOOR = 1e-6  # share of the amplitude: what a flight is read off to
FLOWN = 5  # points
ROUNDS = 5
Row = dict[str, Any]


def model(case: Any, choice: str, modes: int, elements: int) -> ImpactSystem:
    """System of a case in so many modes, with the restitution held."""
    beam, stop = replace(case.scene.beam, elements=elements), replace(case.scene.stop, restitution_of=choice)
    return system(replace(case.scene, beam=beam, stop=stop), Fidelity("compared", "modal", modes))


def curves(case: Any, made: ImpactSystem) -> Any:
    """Amplitudes (points, kinds) of the stable closed-form motions."""
    omega = 2 * np.pi * np.sort(case.sweep.frequency)
    base = np.broadcast_to(np.asarray(case.amplitude(omega), dtype=float), omega.shape)
    return closed_amplitudes(made, omega, base, case.sweep.output)


def rows_of(name: str, choice: str) -> list[Row]:
    """Rows of one case and choice: one for each number of modes."""
    case = vibeam.load(CASES / f"{name}.toml")
    built = [model(case, choice, *size) for size in TRUTHS]
    truths = [curves(case, each) for each in built]
    apart = flown(case, built[0], truths[0])
    return [
        {"case": name, "held": choice, "modes": modes, "flown": apart} | compared(case, choice, modes, truths)
        for modes in MODES
    ]


def compared(case: Any, choice: str, modes: int, truths: list[Any]) -> Row:
    """Estimates and true distances at all points where every model has a stable motion of the kind."""
    here = curves(case, model(case, choice, modes, case.scene.beam.elements))
    estimated = here / curves(case, limit(case.scene, modes).holding(case.scene, choice)) - 1
    true = [here / each - 1 for each in truths]
    there = np.logical_and.reduce([np.isfinite(each) for each in (estimated, *true)])
    large = there & np.logical_or.reduce([np.abs(each) > FLOOR for each in true])
    good = large.copy()
    for each in true:
        ratio = np.divide(estimated, each, out=np.zeros_like(each), where=large)
        good &= (ratio >= 0.5) & (ratio <= 2)
    return {
        "points": int(there.sum()),
        "below_floor": int((there & ~large).sum()),
        "good": int(good.sum()),
        "estimate_rms": rms(estimated[there]),
        "true_rms_64": rms(true[0][there]),
        "true_rms_128": rms(true[1][there]),
    }


def rms(values: Any) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def flown(case: Any, made: ImpactSystem, closed: Any) -> float:
    """Largest relative difference of flights with at most one impact a period from the nearest closed-form motion."""
    grid = np.sort(case.sweep.frequency)
    which = np.linspace(0, len(grid) - 1, FLOWN).round().astype(int)
    found = vibeam.sweep(
        made, omega=2 * np.pi * grid[which], amplitude=case.base_amplitude, settle=400, output=case.sweep.output
    )
    simple = (found.period == -1) | ((found.period == 1) & (found.impacts_per_period <= 1))
    apart = [np.nanmin(np.abs(found.amplitude[i] / closed[which[i]] - 1)) for i in np.flatnonzero(simple)]
    return float(max(apart, default=np.nan))


def front() -> Row:
    """Neutral case under both choices: R, R₁, peak (m), difference of the peaks of each fidelity and of 64 modes."""
    more = ("fidelity.beam.modes=64", "beam.elements=60")
    found = {}
    for choice in CHOICES:
        held = f'stop.restitution_of="{choice}"'
        plain, fine = printed(held), printed(held, *more)
        rows = [*plain["fidelities"], fine["fidelities"][-1] | {"fidelity": "64 modes, 60 elements"}]
        top = plain["fidelities"][-1]["peak"]["amplitude"]
        found[choice] = {
            "limit": 1 / (1 + plain["comparisons"][0]["limit"]["held"]["peak"]) - 1,
            "rows": [
                {
                    "name": row["fidelity"],
                    "restitution": row["restitution"],
                    "first_mode": row["first_mode_restitution"],
                    "peak": row["peak"]["amplitude"],
                    "off": row["peak"]["amplitude"] / top - 1,
                }
                for row in rows
            ],
        }
    return found


def printed(*settings: str) -> Any:
    """What ``vibeam run --json`` prints of the neutral case."""
    words = [word for each in settings for word in ("--set", each)]
    with tempfile.TemporaryDirectory() as folder:
        case = str(CASES / "dtu_neutral.toml")
        command = [sys.executable, "-m", "vibeam", "run", case, "--json", "--out", folder, *words]
        return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def cost() -> Row:
    """CPU seconds of the comparison, of the sweeps and of the whole command, medians of the rounds."""
    rounds = [_cost_once() for _ in range(ROUNDS)]
    found = {name: float(np.median([each[name] for each in rounds])) for name in rounds[0]}
    return found | {"share_of_command": found["comparison"] / found["command"]}


def _cost_once() -> Row:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    found = printed()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return {
        "command": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
        "sweeps": sum(row["cpu_seconds"] for row in found["fidelities"]),
        "comparison": sum(each["cpu_seconds"] for each in found["comparisons"]),
    }


def main() -> None:
    """Measure, print and write the results."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parts = {"cost": cost, "front": front}
    for name in parts:
        parser.add_argument(f"--{name}", action="store_true", help="measure this alone and keep the other results")
    asked = [name for name, given in vars(parser.parse_args()).items() if given]
    found: Row = json.loads(TARGET.read_text()) if asked else {}
    if not asked:
        found["rows"] = [row for name in NAMES for choice in CHOICES for row in rows_of(name, choice)]
    found |= {name: parts[name]() for name in asked or parts}
    print(json.dumps(found, indent=1))
    TARGET.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
