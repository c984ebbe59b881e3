"""Recommended numbers of coordinates flown: how far each basis with its recommended n comes from all modes.

    python tests/benchmarks/recommended.py           # writes results/recommended.json

``vibeam.reduce`` recommends n for 5 %; here each is swept up beside the full model by ``vibeam run``, over its case's
frequencies in 31 points. Errors are of the amplitude, where both repeat with the same period; of motions that do not
repeat the mean over these points is compared. Of a case without a recommendation the reason is kept. Nothing is timed.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from vibeam.studies.modes_needed.reduction import ReductionStudy

import vibeam
from vibeam.case.case import Case
from vibeam.system.response import FrequencyResponse

CASES = Path(__file__).parents[2] / "cases"
TARGET = Path(__file__).with_name("results") / "recommended.json"
NAMES = ("dtu_neutral", "dtu_loose", "dtu_tight", "reductions/near_clamp", "reductions/at_mass", "rigs/elastic_stop")
HELD = ("contact", "first mode")
WITHIN = 0.05
SWEEP = {"sweep.settle": 150, "sweep.hold": 30, "sweep.direction": "up"}
Row = dict[str, Any]


def flown(path: Path, held: str | None = None, points: int = 31, within: float = WITHIN) -> list[Row]:
    """One row a basis that has a recommended n: what was predicted, and how far the flown amplitudes are off."""
    choice: Row = SWEEP | ({} if held is None else {"stop.restitution_of": held})
    choice |= grid(vibeam.load(path), points)
    study = vibeam.reduce(vibeam.load(path, set=choice), accuracy=within)
    found = {each.basis: each for each in study.recommended if each.modes is not None}
    if not found:
        return [{"case": path.stem, "held": held, "basis": None, "refused": study.claim.refused or "above the last n"}]
    result = vibeam.run(alone(vibeam.load(path, set=choice | fidelities(study))))
    whole = branch(result["r_full"])
    return [
        {
            "case": path.stem,
            "held": held,
            "basis": name,
            "modes": each.modes,
            "loss": each.losses.loss if each.losses else None,
            "decided_by": each.losses.decided_by if each.losses else None,
            "by_losses": each.by_losses,
        }
        | difference(branch(result[f"r_{name}"]), whole)
        for name, each in found.items()
    ]


def fidelities(study: ReductionStudy) -> Row:
    """Fidelities r_BASIS of all that is recommended, and r_full."""
    own: Row = {"fidelity.r_full": {"reduction": "full"}}
    for each in study.recommended:
        if each.modes is not None:
            about = {} if each.frequency is None else {"frequency": f"{each.frequency!r} Hz"}
            own[f"fidelity.r_{each.basis}"] = {"reduction": each.basis, "modes": each.modes} | about
    return own


def grid(case: Case, points: int) -> Row:
    """Evenly spaced frequencies over those of the case."""
    ends = case.sweep.frequency
    return {"units": "SI", "sweep.frequency": {"from": float(ends[0]), "to": float(ends[-1]), "points": points}}


def alone(case: Case) -> Case:
    """The case with the added fidelities alone, and nothing to check or draw."""
    kept = {name: each for name, each in case.fidelities.items() if name.startswith("r_")}
    return replace(case, fidelities=kept, references={}, expectations={}, measured={}, shows={})


def branch(branches: Any) -> FrequencyResponse:
    """The sweep up."""
    assert branches.up is not None
    return branches.up


def difference(found: FrequencyResponse, whole: FrequencyResponse) -> Row:
    """Relative differences in amplitude where both repeat alike, and of the means elsewhere."""
    alike = (found.period == whole.period) & (whole.period > 0) & np.isfinite(found.amplitude)
    off = found.amplitude[alike] / whole.amplitude[alike] - 1
    rest = ~alike & np.isfinite(found.amplitude) & np.isfinite(whole.amplitude)
    return {
        "points": len(alike),
        "alike": int(alike.sum()),
        "rms": float(np.sqrt(np.mean(off**2))) if alike.any() else None,
        "worst": float(np.abs(off).max()) if alike.any() else None,
        "mean_elsewhere": float(found.amplitude[rest].mean() / whole.amplitude[rest].mean() - 1)
        if rest.any()
        else None,
    }


def main() -> None:
    """Fly all cases."""
    rows = []
    for name in NAMES:
        for held in HELD if name.startswith("dtu") else (None,):
            found = flown(CASES / f"{name}.toml", held)
            print(*map(json.dumps, found), sep="\n", flush=True)
            rows += found
    TARGET.write_text(f"{json.dumps(rows, indent=1)}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
