"""Section of the book on uncertainty: means, bands and their intervals beside 10⁵ plain samples of the finest model.

The truth is drawn by numpy with a seed of its own, each sample's peak by the exact motions of ``uncertain/``, which
sweeps at the same inputs confirm. A repetition is the study with another seed, as it is asked without --samples, with
exact peaks in place of its sweeps.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.others.uncertain.intervals import KEPT, NAMES, held, inside, read, widths, written
from tests.others.uncertain.plain_samples import drawn
from tests.others.uncertain.rigs import RIGS, Assembled, Rig
from vibeam.studies.uncertainty.replicates import replicates
from vibeam.studies.uncertainty.samples import Sampler, inputs_of
from vibeam.studies.uncertainty.statistics import LEVELS, Distribution, saltelli

SAMPLES, SEED = 100_000, 35  # of brute force
REPETITIONS = 100
HALF = 128  # samples of the study where --samples is not said: 256 motions of the finest model
CHECKED = 200  # plain samples that are flown too
ENOUGH, FEW = 93, 20  # intervals of a hundred that hold the truth at least, and one moved by three half widths at most
LEAST = 88  # of a hundred that hold a quantile: 95 less three standard deviations of such a count
WIDE = 1.3  # half widths at most, over what the scatter of the estimates asks for


def measured() -> dict[str, Any]:
    """Brute force and repetitions of every rig."""
    return {"samples": SAMPLES, "repetitions": REPETITIONS, "rigs": [_measured(rig) for rig in RIGS]}


def _measured(rig: Rig) -> dict[str, Any]:
    model = Assembled(rig, rig.case())
    found = {
        "name": rig.name,
        "inputs": {each.key: each.text for each in rig.inputs},
        "finest": f"{model.name}, {model.case.system(model.name).size} modes",
        "points": 2 * HALF,
        "replicates": replicates(HALF),
        **truth(rig, model, SAMPLES),
        "flown": flown(rig, model, CHECKED),
    }
    studies = [study(rig, model, seed) for seed in range(REPETITIONS)]
    values = np.array([[each.mean, *each.quantiles] for each in studies])
    ends = np.array([[each.mean_within, *each.within] for each in studies])  # (repetitions, numbers, 2)
    found["studies"] = {
        name: {"value": written(values[:, at]), "low": written(ends[:, at, 0]), "high": written(ends[:, at, 1])}
        for at, name in enumerate(NAMES)
    }
    print(f"{rig.name}: {held(found)}", flush=True)
    return found


def truth(rig: Rig, model: Assembled, count: int) -> dict[str, Any]:
    """Mean, deviation and quantiles of plain samples with their standard errors, the first peaks, CPU seconds."""
    peaks = rig.exact(model, drawn(rig.inputs, count, SEED))
    if np.isnan(peaks).any():
        raise ValueError(f"{rig.name}: {np.isnan(peaks).sum()} samples without a motion that is known")
    ordered, levels = np.sort(peaks), np.array(LEVELS)
    low, high = (
        ordered[np.rint(count * levels + sign * np.sqrt(count * levels * (1 - levels))).astype(int)] for sign in (-1, 1)
    )
    return {
        "mean": float(peaks.mean()),
        "error": float(peaks.std(ddof=1) / np.sqrt(count)),
        "deviation": float(peaks.std(ddof=1)),
        "quantiles": np.quantile(peaks, levels).tolist(),
        "quantile_errors": ((high - low) / 2).tolist(),
        "first": written(peaks[:20]),
        "all": written(np.quantile(peaks, np.linspace(0, 1, KEPT + 1))),
    }


def flown(rig: Rig, model: Assembled, count: int) -> dict[str, float]:
    """Exact peaks over those of sweeps less 1 at the first plain samples, largest and mean."""
    plain = {key: values[:count] for key, values in drawn(rig.inputs, SAMPLES, SEED).items()}
    asked = {model.name: np.ones(count, dtype=bool)}
    swept = Sampler(model.case, tuple(plain)).each(np.stack(list(plain.values()), axis=1), asked)[model.name]
    off = rig.exact(model, plain) / swept.peak - 1
    return {"samples": count, "largest": float(np.abs(off).max()), "mean": float(off.mean())}


def study(rig: Rig, model: Assembled, seed: int) -> Distribution:
    """The peaks of the study of a seed."""
    shares = saltelli(len(rig.inputs), HALF, seed)[:, :2].reshape(-1, len(rig.inputs))
    inputs = inputs_of(model.case.uncertain, shares)
    peaks = rig.exact(model, {each.key: column for each, column in zip(rig.inputs, inputs.T, strict=True)})
    return Distribution.of(float("nan"), peaks.reshape(replicates(HALF), -1))


def table(found: dict[str, Any]) -> str:
    """A row for each rig."""
    rows = [_row(rig) for rig in found["rigs"]]
    lines = [list(rows[0]), ["---"] * len(rows[0]), *(list(row.values()) for row in rows)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def _row(rig: dict[str, Any]) -> dict[str, str]:
    counts, moved, wide, share = held(rig), held(rig, 3.0), widths(rig), inside(rig)
    truths = zip(rig["quantiles"][::2], rig["quantile_errors"][::2], strict=True)
    first = {name: [read(each[side])[0] for side in ("low", "high")] for name, each in rig["studies"].items()}
    shown = ("5%", "50%", "95%")
    return {
        "rig": rig["name"],
        "uncertain": ", ".join(f"`{key}` {text}" for key, text in rig["inputs"].items()),
        "finest model": rig["finest"],
        "brute force, mean (mm)": _known(rig["mean"], rig["error"]),
        "5, 50, 95 %": ", ".join(_known(*each) for each in truths),
        "one study, mean": _between(*first["mean"]),
        "its 5, 50, 95 %": ", ".join(_between(*first[name]) for name in shown),
        "intervals of a hundred that hold: mean": f"**{counts['mean']}**",
        "5, 50, 95 %, each": ", ".join(f"**{counts[name]}**" for name in shown),
        "half width over what the scatter asks for: mean": f"{wide['mean']:.2f}",
        "of 5, 50, 95 %": ", ".join(f"{wide[name]:.2f}" for name in shown),
        "any, of a truth moved by three half widths": f"at most {max(moved.values())}",
        "of all inside a study's 5 … 95 %": f"{share.mean():.1%} ({share.min():.1%} … {share.max():.1%})",
        "brute force off sweeps": f"{rig['flown']['largest']:.1e}, mean {rig['flown']['mean']:.1e}",
    }


def _known(value: float, error: float) -> str:
    return f"{1e3 * value:.5f} ± {1.96e3 * error:.5f}"


def _between(low: float, high: float) -> str:
    return f"{1e3 * low:.5f} … {1e3 * high:.5f}"
