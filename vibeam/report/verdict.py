"""The verdict in words and as a table."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from vibeam.report.table_widths import ReportTable
from vibeam.studies.verdict.judgement import DIFFERENCES
from vibeam.system.number_text import shown_unit, signed

if TYPE_CHECKING:
    from vibeam.studies.verdict.judgement import FidelityRow
    from vibeam.studies.verdict.study import Verdict


def table_of(found: Verdict) -> ReportTable:
    """Table of all models."""
    what = quantity_of(found)
    table = ReportTable(f"Fidelities over frequency and {found.axis.name}, against {found.finest.name}: {what}")
    table.add("fidelity", "modes|", "cost|", "suffices|", "bias|", "rms|", "correlation|", "gain|", "other kind|")
    table.add("of what kind", "wrong between", "use it for")
    table.caption = (
        "cost: CPU time of a point over the finest's; suffices: share of the map within the accuracy and of one kind; "
        "bias, rms: where of one kind\n"
        "gain: variance of a mean over the map at equal cost, without over with this model as a control variate; "
        "other kind: share of the map, and what the finest does there"
    )
    for row in found.rows:
        table.add_row(
            row.fidelity, str(row.modes), f"1/{row.cost_ratio:.3g}", f"{row.within:.1%}", signed(row.bias),
            f"{row.rms:.3g}" if not isfinite(row.rms) else f"{row.rms:.2%}", f"{row.correlation:.4f}",
            f"{row.gain:.2f}", f"{row.other_kind:.1%}", row.kinds or "–", where(found, row), row.use_it_for,
        )  # fmt: skip
    return table


def sentences(found: Verdict) -> Iterator[str]:
    """The verdict in plain words."""
    finest, what = found.finest.name, quantity_of(found)
    shares = [f"{name} on {share:.1%}" for name, share in found.shares.items() if name != finest and share > 0]
    needed = found.shares[finest]
    cheap = f"the cheapest model that suffices is {' of the map, '.join(shares)} of the map" if shares else ""
    rest = f"{finest} is needed on {needed:.1%}" if needed else f"{finest} is needed nowhere"
    parts = "; ".join(part for part in (cheap, rest) if part)
    yield f"To {found.accuracy * 100:.3g} % of the {what}, {parts}."
    for row, apart in zip(found.rows[:-1], found.differences, strict=False):
        kinds = [
            f"{words} on {np.mean(apart == code):.1%}" for code, words in DIFFERENCES.items() if (apart == code).any()
        ]
        if kinds:
            share = f"{row.other_kind:.1%} of the map"
            yield f"{row.fidelity} differs from {finest} in kind on {share}: {', '.join(kinds)}."
        else:
            yield f"{row.fidelity} has the same kind of motion as {finest} everywhere on the map."
    for row in found.rows[:-1]:
        if row.wrong_frequency is None:
            yield f"{row.fidelity} suffices everywhere here."
    if found.doubtful:
        yield f"On {found.doubtful:.1%} of the map the choice hangs on the scatter of motions that do not repeat."
    checked = found.verification
    if checked is not None:
        decided, count = int(checked.decided.sum()), len(checked.decided)
        yield (
            f"Flown anew at {count} places between the map's: {decided} are decided there, and {checked.right} of "
            "these are as the map says."
        )
    yield from found.refused


def quantity_of(found: Verdict) -> str:
    """Quantity that the accuracy is of."""
    return "reach at the contact" if found.quantity == "reach" else f"amplitude at the {found.case.sweep.output}"


def where(found: Verdict, row: FidelityRow) -> str:
    """The ranges in which a model does not suffice."""
    if row.wrong_frequency is None or row.wrong_key is None:
        return "–"
    low, high = row.wrong_frequency
    unit, factor = key_unit(found)
    first, last = (f"{value * factor:.3g}" for value in row.wrong_key)
    return f"{low:.4g} … {high:.4g} Hz, {first} … {last} {unit}".rstrip()


def key_unit(found: Verdict) -> tuple[str, float]:
    """Displayed unit of the second key, and the factor from SI."""
    return shown_unit(found.axis.unit, float(np.abs(found.axis.values).max()))
