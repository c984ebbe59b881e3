"""Summary of a fidelity's error estimates: one row for a table, and the sentences on what is not known."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from vibeam.run.estimate.records import FidelityEstimate

NAN = float("nan")

WHOLE = "it is the full model"


@dataclass(frozen=True)
class EstimateSummary:
    """Estimated error in amplitude of one fidelity against the full model of ``modes`` modes.

    ``worst``, ``rms``: over the ``points`` of ``total`` at which it is known; ``unknown``: number of the others by
    reason; ``why``: it is known at none.
    """

    fidelity: str
    modes: int
    worst: float
    rms: float
    points: int
    total: int
    unknown: Mapping[str, int]
    why: str = ""
    cpu_seconds: float = 0.0


def summaries(found: Mapping[str, FidelityEstimate]) -> list[EstimateSummary]:
    """Summarise the estimates of every fidelity."""
    return [summary(name, each) for name, each in found.items()]


def summary(name: str, found: FidelityEstimate) -> EstimateSummary:
    """Summarise the estimates of one fidelity."""
    if found.whole:
        return EstimateSummary(name, found.modes, 0.0, 0.0, 0, 0, {}, WHOLE)
    parts = list(found.branches.values())
    bounds = np.concatenate([np.zeros(0), *(part.amplitude_bound[part.known] for part in parts)])
    total, unknown = sum(len(part.basis) for part in parts), dict[str, int]()
    for part in parts:
        for basis, count in part.reasons.items():
            unknown[basis.value] = unknown.get(basis.value, 0) + count
    worst = float(bounds.max(initial=0.0)) if len(bounds) else NAN
    rms = float(np.sqrt(np.mean(bounds**2))) if len(bounds) else NAN
    why = found.why or ("" if len(bounds) else "known at no point")
    return EstimateSummary(name, found.modes, worst, rms, len(bounds), total, unknown, why, found.cpu_seconds)


def sentences(rows: list[EstimateSummary]) -> Iterator[str]:
    """Sentences on where nothing is estimated, and why; fidelities with the same reason together."""
    reasons: dict[str, list[str]] = {}
    for row in rows:
        if row.why and not row.unknown and row.total == 0 and row.why != WHOLE:
            reasons.setdefault(row.why, []).append(row.fidelity)
    for why, names in reasons.items():
        yield f"{', '.join(names)}: not estimated against the full model ({why})"
    for row in rows:
        if row.unknown:
            listed = "; ".join(f"{reason}: {count}" for reason, count in row.unknown.items())
            yield f"{row.fidelity} against the full model: not known at {row.total - row.points} points ({listed})"
