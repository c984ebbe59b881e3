"""Modes of the whole beam as a sheet: what mode 1 has of the contact in a sentence, and a row for each mode."""

from __future__ import annotations

from math import isfinite

from vibeam.report.output import StudySheet
from vibeam.report.tables import ReportTable, blank
from vibeam.studies.modes import ModeRow, ModeTable
from vibeam.system.number_text import FREQUENCIES, percent, prefixed, ratio, with_unit, without_round_off


def sheet(modes: ModeTable) -> StudySheet:
    """Sheet of a table of modes; as CSV a row a mode."""
    return StudySheet(
        answer=answer(modes),
        tables=[modal(modes)],
        notes=modes.notes,
        data={"rows": modes.rows, "load_unit": modes.load_unit, "notes": modes.notes},
        rows=modes.rows,
    )


def answer(modes: ModeTable) -> str:
    """Sentence on the first mode's share of the contact's mobility, and on the restitution of truncated models."""
    first, last, count = modes.rows[0], modes.rows[-1], len(modes.rows)
    alone = f"Mode 1, at {with_unit(first.frequency, 'Hz')}, has {percent(first.share)} of the contact's mobility"
    if count == 1:
        return f"{alone}."
    return f"{alone}, the first {count} modes have {percent(last.share)}{_seen(first, last)}."


def _seen(first: ModeRow, last: ModeRow) -> str:
    """Restitution that follows from the one held, from the first to the last truncated model."""
    if not isfinite(first.contact_restitution):
        return ""
    at, after = "cut off after mode 1", f"after mode {last.number}"
    if first.contact_restitution == last.contact_restitution:
        held = f"with R = {ratio(last.contact_restitution)} held at the contact"
        seen = first.first_mode_restitution, last.first_mode_restitution
        return f"; {held}, mode 1 sees R₁ = {ratio(seen[0])} in a model {at}, {ratio(seen[1])} {after}"
    held = f"with R₁ = {ratio(last.first_mode_restitution)} of mode 1 held"
    needs = first.contact_restitution, last.contact_restitution
    return f"; {held}, the contact has R = {ratio(needs[0])} in a model {at}, {ratio(needs[1])} {after}"


def modal(modes: ModeTable) -> ReportTable:
    """Modal table: participation of each mode at contact, sensor and drive, and the remaining restitution."""
    least = min((row.frequency for row in modes.rows if row.frequency), default=0.0)
    unit, factor = prefixed(FREQUENCIES, least, usual=-1)
    of = "finite elements" if len(modes.positions) else "structure"
    table = blank(f"Modes of the {of}", "mode|", f"{unit}|", "damping|")
    impulsive = any(isfinite(row.contact_restitution) for row in modes.rows)
    table.add("contact|", "sensor|", "load|", "Σ share|", *(["R₁ seen|", "R|"] * impulsive))
    shown = [(row.contact, row.sensor, row.load) for row in modes.rows]
    largest = [max(map(abs, column)) for column in zip(*shown, strict=True)]
    for row, numbers in zip(modes.rows, shown, strict=True):
        values = (f"{without_round_off(*pair):.4g}" for pair in zip(numbers, largest, strict=True))
        restitutions = [ratio(row.first_mode_restitution, ".4f"), ratio(row.contact_restitution, ".4f")] * impulsive
        damping = percent(row.damping_ratio) if row.frequency else "rigid body"
        first = (str(row.number), f"{row.frequency * factor:.5g}", damping, *values)
        table.add_row(*first, percent(row.share), *restitutions)
    table.caption = (
        f"contact, sensor: kg^-½; load: {modes.load_unit}; Σ share: of the contact mobility w M⁻¹ wᵀ, up to this mode"
        + "\nR: of the contact; R₁: what mode 1 sees of it where the model is cut off after this mode" * impulsive
    )
    return table
