"""Models beside a reference, of any study: cells of a table and rows of CSV."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite, isinf, isnan
from typing import Any

from vibeam.figures.units import DisplayUnits
from vibeam.report.comparison_words import both_numbers
from vibeam.report.comparison_words import signed as off_by
from vibeam.report.record_studies import change_text
from vibeam.runs.comparison.errors import Asked
from vibeam.studies.changes import AMPLITUDES, COMPARED, ENDS, KINDS, ModelVariant, NumberChange
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.system.number_text import percent, signed

SHORT = {ENDS: "ends", KINDS: "other motion", AskedNumber("peak_frequency"): "at"}
LEAST = 1e-3  # change over what is allowed that is written as a number


def change_cell(change: NumberChange) -> str:
    """A change in a cell; of ends and kinds it is known to a thousandth."""
    if change.number not in COMPARED:
        return change_text(change)
    scatter = f" ± {percent(2 * change.error)}" if change.number == AMPLITUDES and change.error else ""
    return f"{signed(change.change)}{scatter}"


def share(value: float) -> str:
    """Change over what is allowed, as text."""
    return "∞" if isinf(value) else f"{value:.3g}" if value > LEAST else "0"


def time_text(seconds: float) -> str:
    """CPU time; a dash for NaN."""
    return "–" if isnan(seconds) else f"{1e3 * seconds:.3g} ms"


def within_words(variant: ModelVariant, asked: Asked, units: DisplayUnits) -> str:
    """Errors of a model that suffices: both of a sweep, of a record those of peaks and the hardest impact."""
    found = variant.comparison
    if found is None:
        return f"peaks and the hardest impact within {percent(variant.worst * asked.amplitude)}"
    return both_numbers(found, units)


def gravest_of(variant: ModelVariant) -> NumberChange | None:
    """Change that is largest over what is allowed of it; None where none is known."""
    known = [each for each in variant.changes if isfinite(each.allowed) and not isnan(each.share)]
    return max(known, key=lambda each: each.share, default=None)


def gravest_number(variant: ModelVariant) -> str:
    """Clause on the number that is most off."""
    top = gravest_of(variant)
    if top is None:
        return "no motion runs to its end"
    if abs(top.change) <= top.allowed:  # what it is uncertain by alone is beyond that
        return f"the {top.number} may be {percent(top.size)} off"
    return f"the {top.number} is {'not there to compare' if isinf(top.change) else off_by(top.change)}"


def variant_rows(variant: ModelVariant, **head: Any) -> Iterator[dict[str, Any]]:
    """Rows of every number of a model, beside the ``head``; missing values are empty, with their reason."""
    head |= {"modes": variant.modes, "cpu_seconds": "" if isnan(variant.seconds) else variant.seconds}
    if not variant.changes:
        yield head | {"why": variant.why}
    for each in variant.changes:
        values = {"mean": each.mean, "change": each.change, "error": each.error, "allowed": each.allowed}
        known = {name: value if isfinite(value) else "" for name, value in values.items()}
        yield head | {"number": str(each.number)} | known | {"share": each.share, "why": variant.why}
