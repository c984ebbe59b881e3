"""Summary of a fidelity's error estimates: one row, its cell in a table, and the sentences on what is not known."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vibeam.runs.estimate.records import FidelityEstimate
from vibeam.system.number_text import percent

NAN = float("nan")
WHOLE = "it is the full model"
COLUMN = "est. off"

CAPTION = (
    f"{COLUMN}: largest error in amplitude over the points with impacts whose full model makes the same motion;\n"
    "(k/n): estimated at k of n points with impacts, no number where that is less than half of them"
)

LEAST = 0.5  # share of the points with impacts at which an error must be known to be one of the curve


@dataclass(frozen=True)
class EstimateSummary:
    """Estimated error in amplitude of one fidelity against the full model of ``modes`` modes.

    ``worst``, ``rms``: over the ``points`` at which it is known, of ``total`` at which one of the models touches the
    stop; NaN where that is less than half of them. ``unknown``: number of the others by reason; ``why``: there is no
    estimate at all.
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

    @property
    def cell(self) -> str:
        """Largest error and its coverage, for a table."""
        if self.why or not self.total:
            return "full" if self.why == WHOLE else "–" if self.why else "no impact"
        return f"{percent(self.worst)} ({self.points}/{self.total})"


@dataclass(frozen=True)
class EstimateTexts:
    """Estimates in words, for the terminal and the page: ``cells`` by fidelity, empty where nothing is estimated.

    ``column``: their head, ``caption``: its meaning; ``sentences``: on what is not known, and why.
    """

    rows: tuple[EstimateSummary, ...]
    cells: Mapping[str, str]
    sentences: tuple[str, ...]
    column: str = COLUMN
    caption: str = CAPTION


def estimate_texts(found: Mapping[str, FidelityEstimate]) -> EstimateTexts:
    """Cells and sentences of the estimates of every fidelity."""
    rows = tuple(summary(name, each) for name, each in found.items())
    known = any(row.total or row.why == WHOLE for row in rows)
    return EstimateTexts(rows, {row.fidelity: row.cell for row in rows if known}, tuple(_sentences(rows)))


def summary(name: str, found: FidelityEstimate) -> EstimateSummary:
    """Summarise the estimates of one fidelity."""
    if found.whole:
        return EstimateSummary(name, found.modes, 0.0, 0.0, 0, 0, {}, WHOLE)
    parts, unknown = list(found.branches.values()), dict[str, int]()
    bounds = np.concatenate([np.zeros(0), *(part.amplitude_bound[part.known & part.impacting] for part in parts)])
    total = sum(int(np.count_nonzero(part.impacting)) for part in parts)
    for part in parts:
        for basis, count in part.reasons.items():
            unknown[basis.value] = unknown.get(basis.value, 0) + count
    worst, rms = NAN, NAN
    if len(bounds) and len(bounds) >= LEAST * total:
        worst, rms = float(bounds.max()), float(np.sqrt(np.mean(bounds**2)))
    return EstimateSummary(
        name, found.modes, worst, rms, len(bounds), total, unknown, found.why, found.cpu_seconds
    )  # fmt: skip


def _sentences(rows: Sequence[EstimateSummary]) -> Iterator[str]:
    """Sentences on where nothing is estimated, and why; fidelities with the same reason together."""
    reasons: dict[str, list[str]] = {}
    for row in rows:
        if row.why and row.why != WHOLE:
            reasons.setdefault(row.why, []).append(row.fidelity)
    for why, names in reasons.items():
        yield f"{', '.join(names)}: not estimated against the full model ({why})"
    for row in rows:
        if row.unknown:
            listed = "; ".join(f"{reason}: {count}" for reason, count in row.unknown.items())
            few = "" if row.points >= LEAST * row.total else ", too few to say how far off it is"
            yield (
                f"{row.fidelity} against the full model: known at {row.points} of {row.total} points with impacts{few} "
                f"({listed})"
            )
