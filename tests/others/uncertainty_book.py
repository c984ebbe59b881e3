"""Section of the book on uncertainty: means, bands and their intervals beside 10⁵ plain samples of the finest model.

The truth is drawn by numpy with a seed of its own, each sample's peak by the exact motions of ``uncertain/``, which
flown sweeps at the same inputs confirm. A repetition is the study with another seed, as it is asked without --samples:
its peaks of the finest fidelity are exact ones too, at the CPU time of a sweep; all that its cheaper models take is
computed as it does.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np

from tests.others.uncertain.intervals import KEPT, held, inside, read, savings, scatter, written
from tests.others.uncertain.plain_samples import drawn
from tests.others.uncertain.rigs import RIGS, Assembled, Rig
from vibeam.studies.uncertainty.mean_of_peak import PILOT, MeanPeak, mean_of_peak
from vibeam.studies.uncertainty.samples import Responses, Sampler, inputs_of
from vibeam.studies.uncertainty.statistics import LEVELS, Distribution, saltelli

SAMPLES, SEED = 100_000, 35  # of brute force
REPETITIONS = 100
HALF = 128  # samples of the study where --samples is not said: 256 of the finest model, 64 of which its mean takes
CHECKED = 200  # plain samples that are flown too
ENOUGH, FEW = 93, 20  # intervals of a hundred that hold the truth at least, and one moved by three half widths at most


def measured() -> dict[str, Any]:
    """Brute force and repetitions of every rig."""
    with one_core():
        return {"samples": SAMPLES, "repetitions": REPETITIONS, "rigs": [_measured(rig) for rig in RIGS]}


@contextmanager
def one_core() -> Iterator[None]:
    """Within it, work in one thread: two that wait for the interpreter's lock take more CPU time together."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    own = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(own)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, own)


def _measured(rig: Rig) -> dict[str, Any]:
    model = Assembled(rig, rig.case())
    found = {
        "name": rig.name,
        "inputs": {each.key: each.text for each in rig.inputs},
        "finest": f"{model.name}, {model.case.system(model.name).size} modes",
        "points": 2 * HALF,
        **truth(rig, model, SAMPLES),
        "flown": flown(rig, model, CHECKED),
    }
    studies = [study(rig, model, seed, found["flown"]["seconds"]) for seed in range(REPETITIONS)]
    means, bands = [each.mean for each in studies], [each.peak for each in studies]
    found["seconds"] |= {
        "study": float(np.mean([each.seconds for each in studies])),
        "several": float(np.mean([each.several.seconds for each in means])),
    }
    for name, every in (("several", [each.several for each in means]), ("alone", [each.alone for each in means])):
        found[name] = {key: written([getattr(each, key) for each in every]) for key in ("mean", "low", "high", "error")}
    ends = np.array([each.within for each in bands])  # (repetitions, levels, 2)
    found["quantile_ends"] = [[written(ends[:, at, side]) for side in (0, 1)] for at in range(len(LEVELS))]
    found["bands"] = [written([each.quantiles[at] for each in bands]) for at in (0, -1)]
    used = Counter(", ".join(each.chosen.names[1:]) for each in means)
    found["models"] = {"tried": list(means[0].correlations), "used": dict(used.most_common()), "runs": means[0].counts}
    found["saving"] = savings(found)
    print(f"{rig.name}: {held(found)}", flush=True)
    return found


def truth(rig: Rig, model: Assembled, count: int) -> dict[str, Any]:
    """Mean, deviation and quantiles of plain samples with their standard errors, the first peaks, CPU seconds."""
    begun = process_time()
    peaks = rig.exact(model, drawn(rig.inputs, count, SEED))
    seconds = process_time() - begun
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
        "seconds": {"brute": seconds},
    }


def flown(rig: Rig, model: Assembled, count: int) -> dict[str, float]:
    """Exact peaks over flown ones less 1 at the first plain samples, largest and mean; CPU seconds of a sweep."""
    plain = {key: values[:count] for key, values in drawn(rig.inputs, SAMPLES, SEED).items()}
    swept = Sampler(model.case, tuple(plain))(model.name, np.stack(list(plain.values()), axis=1))
    off = rig.exact(model, plain) / swept.peak - 1
    seconds = float(swept.seconds.mean())
    return {"samples": count, "largest": float(np.abs(off).max()), "mean": float(off.mean()), "seconds": seconds}


@dataclass(frozen=True)
class Study:
    """Means of one study, the distribution of its peaks, and its CPU ``seconds`` with those of the sweeps it takes."""

    mean: MeanPeak
    peak: Distribution
    seconds: float


def study(rig: Rig, model: Assembled, seed: int, sweep: float) -> Study:
    """The study of a seed, but for its sensitivities; ``sweep``: CPU seconds of one of the finest fidelity."""
    case = model.case
    inputs = inputs_of(case.uncertain, saltelli(len(rig.inputs), HALF, seed))[: 2 * HALF]
    peaks = rig.exact(model, {each.key: column for each, column in zip(rig.inputs, inputs.T, strict=True)})
    begun = process_time()
    sampler = Sampler(case, tuple(each.key for each in rig.inputs))
    found = {name: sampler(name, inputs[:PILOT]) for name in case.fidelities if name != model.name}
    found[model.name] = Responses.of_peaks(model.name, inputs, peaks, np.full(len(peaks), sweep))
    mean = mean_of_peak(sampler, found, model.name, len(peaks), seed, lambda _: None)
    if mean is None:
        raise ValueError(f"{rig.name}: no cheaper model saves any")
    return Study(mean, Distribution.of(float("nan"), peaks), process_time() - begun + mean.counts[0] * sweep)


def table(found: dict[str, Any]) -> str:
    """Two tables: what was found of each rig, and what it cost."""
    return "\n\n".join(_table([row(rig) for rig in found["rigs"]]) for row in (_found, _cost))


def _table(rows: list[dict[str, str]]) -> str:
    lines = [list(rows[0]), ["---"] * len(rows[0]), *(list(row.values()) for row in rows)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def _found(rig: dict[str, Any]) -> dict[str, str]:
    counts, moved = held(rig), held(rig, 3.0)
    truths = zip(rig["quantiles"][::2], rig["quantile_errors"][::2], strict=True)
    first = [[read(side)[0] for side in ends] for ends in rig["quantile_ends"][::2]]
    return {
        "rig": rig["name"],
        "uncertain": ", ".join(f"`{key}` {text}" for key, text in rig["inputs"].items()),
        "finest model": rig["finest"],
        "brute force, mean (mm)": _known(rig["mean"], rig["error"]),
        "5, 50, 95 %": ", ".join(_known(*each) for each in truths),
        "one study, mean": _between(*(read(rig["several"][side])[0] for side in ("low", "high"))),
        "its 5, 50, 95 %": ", ".join(_between(*each) for each in first),
        "intervals of a hundred that hold: mean": f"**{counts['several']}**",
        "5, 50, 95 %, each": ", ".join(f"**{counts[name]}**" for name in ("5%", "50%", "95%")),
        "finest alone": str(counts["alone"]),
        "any, of a truth moved by three half widths": f"at most {max(moved.values())}",
    }


def _cost(rig: dict[str, Any]) -> dict[str, str]:
    seconds, saving, share, off = rig["seconds"], rig["saving"], inside(rig), rig["flown"]
    runs = ", ".join(map(str, rig["models"]["runs"]))
    return {
        "rig": rig["name"],
        "models beside the finest, runs": f"{' or '.join(rig['models']['used'])}: {runs}",
        "brute force, CPU s": f"{seconds['brute']:.3g}",
        "a study's mean": f"{seconds['study']:.2g} (stated {seconds['several']:.2g})",
        "at equal variance cost more: independent sweeps": f"{saving['plain']:.3g} × (stated {saving['stated']:.3g})",
        "brute force": f"{saving['brute']:.2g} ×",
        "sweeps at Sobol's points": f"{saving['sobol']:.2g} ×",
        "scatter of the means over stated error": f"{scatter(rig, 'several'):.2f}; alone {scatter(rig, 'alone'):.2f}",
        "of all inside a study's 5 … 95 %": f"{share.mean():.1%} ({share.min():.1%} … {share.max():.1%})",
        "brute force off the flown": f"{off['largest']:.1e}, mean {off['mean']:.1e}",
    }


def _known(value: float, error: float) -> str:
    return f"{1e3 * value:.5f} ± {1.96e3 * error:.5f}"


def _between(low: float, high: float) -> str:
    return f"{1e3 * low:.5f} … {1e3 * high:.5f}"
