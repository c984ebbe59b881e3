"""What a mean of the neutral rig's peak costs by several models, against the finest alone, at equal variance.

    python tests/benchmarks/cheaper_mean.py

CPU time, in one process; correlations and costs as ``vibeam uncertainty`` measures them. Writes
results/cheaper_mean.json.
"""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import vibeam

CASE = Path(__file__).parents[2] / "cases" / "uncertain" / "neutral.toml"

INPUTS = {
    "mass, restitution, damping": ("mass.mass", "stop.restitution", "beam.damping_ratio"),
    "gap and thickness too": ("mass.mass", "stop.restitution", "beam.damping_ratio", "stop.gap", "beam.thickness"),
}


def measured(keys: tuple[str, ...], seed: int) -> dict[str, Any]:
    """Saving of one study."""
    case = vibeam.load(CASE)
    own = replace(case, uncertain=tuple(each for each in case.uncertain if each.key in keys))
    found = vibeam.uncertainty(own, samples=32, seed=seed).mean_peak
    assert found is not None
    return {
        "runs": dict(zip(found.chosen.names, found.counts, strict=True)),
        "correlations": {name: found.correlations[name] for name in found.chosen.names[1:]},
        "milliseconds": {name: 1e3 * found.seconds[name] for name in found.chosen.names},
        "predicted_saving": found.chosen.gain,
        "saving": found.saving,
        "alone": asdict(found.alone),
        "several": asdict(found.several),
    }


def main() -> None:
    """Measure and write the results."""
    found = {name: [measured(keys, seed) for seed in (0,)] for name, keys in INPUTS.items()}
    (Path(__file__).parent / "results" / "cheaper_mean.json").write_text(json.dumps(found, indent=1) + "\n")
    for name, each in found.items():
        print(name, *(f"{one['saving']:.3g} ({one['predicted_saving']:.3g} predicted)" for one in each))


if __name__ == "__main__":
    main()
