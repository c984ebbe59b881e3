"""Tables of an ``accuracy`` study: candidates with their shares of the points, claims, verification."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from vibeam.figures.units import METRIC, DisplayUnits
from vibeam.report.table_widths import ReportTable
from vibeam.report.tables import blank
from vibeam.runs.comparison.differences import HeldComparison, both_peaks
from vibeam.system.number_text import percent, signed

if TYPE_CHECKING:
    from vibeam.runs.accuracy.study import AccuracyChoice, Chosen


MOST = 5  # points listed one by one
ON_ITS_WAY = "only to find the motion that goes on in closed form"

WAYS = {
    "averaging": "averaged: one impact a period",
    "orbit": "closed form: stable and clear of the stop, one impact a period or none",
    "flight": "no such motion known: flown",
}


def choices(study: AccuracyChoice) -> ReportTable:
    """Table of all candidates, the cheapest model first."""
    names = ("fidelity", "modes|", "solver", "points|", "asked|", "estimate|", "CPU|", "why")
    table = blank(f"Within {percent(study.within)} of {study.finest}", *names, heads=3)
    for row in study.chosen:
        if row.asked:
            estimate = percent(row.estimate) if row.taken else "–"
            numbers = (str(row.asked), estimate, f"{row.cpu_seconds:.3g} s")
            table.add_row(row.fidelity, str(row.modes), row.solver, str(row.taken), *numbers, _why(study, row))
    table.caption = (
        f"of {', '.join(study.quantities)}; points: of the result; asked: read to find out, or for the result"
    )
    return table


def _why(study: AccuracyChoice, row: Chosen) -> str:
    if not row.taken:
        return (
            ON_ITS_WAY if row.fidelity == study.finest else "too far off where it was asked, or nothing was left for it"
        )
    return WAYS[row.solver] if row.fidelity == study.finest else f"near enough there; {WAYS[row.solver]}"


def sentences(study: AccuracyChoice, units: DisplayUnits = METRIC) -> Iterator[str]:
    """Sentences on the claimed accuracy, its verification and the cost."""
    loose = sum(int(np.count_nonzero(curve.statistical)) for curve in study.curves.values())
    if loose:
        scatter = np.concatenate([curve.scatter[curve.statistical] for curve in study.curves.values()])
        known = scatter[np.isfinite(scatter)]
        by = f" (by {percent(float(known.max()))})" if len(known) else ""
        yield (
            f"{loose} of {study.points} points do not repeat: of these the mean is claimed, single readings scatter"
            f"{by}, and both directions have the same one"
        )
    yield from _verified(study, units)
    yield (
        f"CPU time {study.cpu_seconds:.3g} s; {study.finest} everywhere by flight would take about "
        f"{study.finest_seconds:.3g} s: {percent(study.share)} of it"
    )


def limits(study: AccuracyChoice, comparisons: Sequence[HeldComparison]) -> Iterator[str]:
    """Sentences on the peaks with the other restitution held, and on the finest where it is itself less accurate."""
    for each in comparisons:
        yield from filter(None, [both_peaks(each)])
        if abs(each.limit.held.worst) > study.within:
            yield (
                f"{percent(study.within)} is asked of {study.finest}, whose own limit is further away: "
                f"{signed(each.limit.held.worst)} at most"
            )


def _verified(study: AccuracyChoice, units: DisplayUnits) -> Iterator[str]:
    missed, count = len(study.missed), len(study.verified)
    steady = [each.error for each in study.verified if not each.statistical]
    worst = f", at worst {percent(max(steady))} off where the motion repeats" if steady else ""
    yield f"verified at {count} random points: {count - missed} within{worst}"
    for each in study.missed[:MOST]:
        at = units.frequencies(each.frequency)
        yield f"  missed at {at}, {each.way}: {percent(each.error)} off, {percent(each.allowed)} allowed"
    if missed > MOST:
        yield f"  and {missed - MOST} more"
