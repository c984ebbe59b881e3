"""Sheet of an impact on the stop: restitution of contact and sensor, and the contact in other programs' terms."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

from vibeam.report.output import StudySheet, plain
from vibeam.report.tables import ReportTable, blank, coefficient, shown
from vibeam.system.number_text import percent, ratio, with_unit

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.extensions.dictionary.mode_share import SharedImpact

SEEN = 5e-4  # difference of a coefficient that is shown


def sheet(impact: SharedImpact, case: Case) -> StudySheet:
    """Sheet of an impact on the stop of ``case``; as CSV a row a number of modes."""
    terms = [term_table(impact)] if impact.terms else []
    asked = case.asked["mode_share"].contact_time is not None
    return StudySheet(
        answer=impact_answer(impact, case) if impact.contact_time else rigid_answer(impact, case),
        tables=[*(terms if asked else []), share_table(impact)],
        more=[] if asked else terms,
        data=plain(impact),
        rows=[plain(row) for row in impact.shares],
    )


def rigid_answer(impact: SharedImpact, case: Case) -> str:
    """Sentence on an impact that takes no time, which moves all modes: the restitution of contact and mode 1."""
    last, of_contact = impact.shares[-1], case.scene.held[0] == "contact"
    given, seen = (impact.restitution, last.seen) if of_contact else (last.needed, impact.restitution)
    return (
        f"R = {coefficient(given)} at a contact that takes no time, which moves all {last.modes} modes, is "
        f"R₁ = {coefficient(seen)} of mode 1 at a sensor."
    )


def impact_answer(impact: SharedImpact, case: Case) -> str:
    """Sentence on an impact that lasts so long: the modes that count, and the restitution of contact and mode 1."""
    last, of_contact = impact.shares[-1], case.scene.held[0] == "contact"
    given, seen = (impact.restitution, last.seen) if of_contact else (last.needed, impact.restitution)
    return (
        f"R = {coefficient(given)} at a contact of {with_unit(impact.contact_time, 's')}, which moves "
        f"{last.modes} {'modes' if last.modes > 1 else 'mode'}, {with_unit(last.mass, 'kg')} in all, is "
        f"R₁ = {coefficient(seen)} of mode 1 at a sensor."
    )


def share_table(impact: SharedImpact) -> ReportTable:
    """Table of the restitution of mode 1 and of the contact, a row a number of modes."""
    given = ratio(impact.restitution)
    table = blank(
        "Restitution of contact and sensor", "modes|", "mode 1|", f"R₁ if R = {given}|", f"R if R₁ = {given}|"
    )
    table.add("damping for it|", "1/S|")
    for row in impact.shares:
        numbers = str(row.modes), percent(row.share), coefficient(row.seen), coefficient(row.needed)
        table.add_row(*numbers, shown(row.damping, "N s/m") if isfinite(row.damping) else "", shown(row.mass, "kg"))
    table.caption = "R₁: of mode 1, at a sensor; R: of the contact; --contact-time: in other programs"
    if impact.contact_time:
        table.caption = "R₁: of mode 1, at a sensor; R: of a free mass 1/S; last: the modes below 3/2t_c"
    return table


def term_table(impact: SharedImpact) -> ReportTable:
    """Table of the contact in the terms of other programs, a row a form."""
    table = blank("The contact in other programs", "program", "parameters", "R otherwise")
    table.add("least R|", "force from", detail=True)
    for each in impact.terms.values():
        said = [f"{name} {value:.4g} {each.units[name]}".removesuffix(" 1") for name, value in each.parameters.items()]
        otherwise = "" if each.slow == each.fast else f"{each.slow:.3f} … {each.fast:.3f}"
        if abs(each.own - each.restitution) > SEEN or not each.parameters:
            otherwise = f"{each.own:.3f} written"
        table.add_row(each.program, ", ".join(said) or "out of reach", otherwise, f"{each.least:.3g}", each.source)
    table.caption = (
        f"at {with_unit(impact.speed, 'm/s')}; otherwise: from 0.01 to 10 m/s; written: where R itself is put in"
    )
    return table
