"""Number of modes that a case needs, as a sheet: the answer, its table, the figure of errors over modes."""

from __future__ import annotations

from collections.abc import Iterator

from vibeam.case.case import Case
from vibeam.case.held import held_of
from vibeam.case.study_plans import ModesNeededPlan
from vibeam.figures.units import METRIC, DisplayUnits, units_of
from vibeam.report.comparison_words import SDOF, Subject, both_numbers, cells, gravest, open_points
from vibeam.report.decision_figures import Decision, ModelError
from vibeam.report.output import StudySheet
from vibeam.report.record_studies import CAPTION, FEW, ONE
from vibeam.report.run_answer import beyond, own_miss, own_words
from vibeam.report.tables import ReportTable, blank
from vibeam.report.variants import change_cell, gravest_number, time_text, variant_rows, within_words
from vibeam.runs.comparison.errors import GIVEN
from vibeam.studies.modes_needed import ModesNeeded, ModesTried, modes_needed
from vibeam.system.number_text import begun, modes_in_words, percent
from vibeam_models.arguments import counted

SINGLE = Subject("one degree of freedom")
SHOWN = ("plan", "modes", "size", "rows", "single", "own", "realisations", "left_out")  # as JSON
QUICK, SECONDS = 7, 0.4  # frequencies and CPU seconds of the first answer
REFINE = "refine the mesh (beam.elements)"


def first_answer(case: Case, plan: ModesNeededPlan | None = None) -> str:
    """Answer of a quick look at a few frequencies; empty where that tells nothing."""
    try:
        found = modes_needed(case, plan, budget=SECONDS, frequencies=QUICK, own=False)
    except ValueError:
        return ""
    row = found.enough
    if row is None or row.comparison is None or row.comparison.amplitude is None:
        return ""
    said = f"{modes_in_words(row.modes)} {_subject(row).does('suffice')} for {percent(found.asked.amplitude)}"
    return f"At {found.frequencies} frequencies {said}: {both_numbers(row.comparison, _units(found))}."


def answer(found: ModesNeeded) -> str:
    """Answer in one or a few sentences."""
    within, own, units = percent(found.asked.amplitude), found.own.suffices(found.asked), _units(found)
    row, whole = found.enough, Subject(every(found), found.modes > 1)
    if own is False:
        clause = own_miss(whole, found.own, found.asked, units)
        cure = f"; {REFINE}" if found.own.elements and found.modes == found.size else ""
        said = f"No number of modes suffices for {within}: {clause}{cure}."
    elif row is not None:
        who, numbers = _subject(row), within_words(row, found.asked, units)
        known = own or found.own.why == GIVEN
        verb = who.does("suffice") + f" for {within}" if known else f"{who.is_} within {within} of {whole.name}"
        said = f"{begun(who.name)} {verb}: {numbers}" + (f", beside {whole.name}." if known else ".")
    else:
        said = f"{begun(_more(found))}{_missing(found, units)}."
    left = f"{counted(found.left_out, 'realisation')} left out over the budget." if found.left_out else ""
    held, reference = f"{_held(found)} is held.", own_words(whole, found.own, found.asked, units)
    return " ".join(filter(None, [said, _single(found, units), begun(reference), held, left]))


def _held(found: ModesNeeded) -> str:
    held = held_of(found.case.scene)
    return held.label if held.coefficient is not None else f"The {held.label}"


def _units(found: ModesNeeded) -> DisplayUnits:
    return units_of(found.case) if found.case.record is None else METRIC


def _subject(row: ModesTried) -> Subject:
    return Subject(modes_in_words(row.modes), row.modes > 1)


def _more(found: ModesNeeded) -> str:
    tried = [row.modes for row in found.rows if not row.why]
    if not tried:
        return f"{every(found)}: there are no fewer to compare"
    within = percent(found.asked.amplitude)
    if len(tried) > 1:
        return f"none of {tried[0]} to {tried[-1]} modes is known to suffice for {within}"
    return f"{modes_in_words(tried[0])} {'do' if tried[0] > 1 else 'does'} not suffice for {within}"


def _missing(found: ModesNeeded, units: DisplayUnits) -> str:
    """Clause on what the largest number of modes misses."""
    last = next((row for row in reversed(found.rows) if row.changes), None)
    if last is None or last.suffices(found.asked):
        return ""
    if last.comparison is None:
        return f": of {modes_in_words(last.modes)} {gravest_number(last)}"
    if last.suffices(found.asked) is None:
        return f"; {modes_in_words(last.modes)} may ({open_points(last.comparison, found.asked, units)})"
    return f": {gravest(_subject(last), Subject(every(found), True), last.comparison, found.asked, units)}"


def _single(found: ModesNeeded, units: DisplayUnits) -> str:
    """Sentence on one degree of freedom; empty where it suffices as one mode does, or is not known."""
    row = found.single
    if row is None or row.comparison is None or row.suffices(found.asked) is not False:
        return ""
    return f"{begun(gravest(SINGLE, Subject(every(found), True), row.comparison, found.asked, units))}."


def sheet(found: ModesNeeded) -> StudySheet:
    """Sheet of a study; as CSV a row for each number of modes, under a record for each of its numbers."""
    recorded = found.case.record is not None
    pictures = [] if recorded else list(decision(found).pictures)
    return StudySheet(
        answer(found),
        [_table(found)],
        list(_notes(found)),
        data={name: getattr(found, name) for name in SHOWN}
        | {"enough": None if found.enough is None else found.enough.modes},
        rows=[each for row in found.rows for each in variant_rows(row)] if recorded
        else [_numbers(row) for row in _all_rows(found)],
        draw=pictures[0].draw if pictures else None,
        pictures=pictures,
    )  # fmt: skip


def every(found: ModesNeeded) -> str:
    """All modes, or those that stand for them."""
    return f"{'all ' * (found.modes == found.size > 1)}{modes_in_words(found.modes)}"


def decision(found: ModesNeeded) -> Decision:
    """Content of the pictures: the number that is enough and the next fewer over the reference; all errors."""
    whole = every(found)
    swept = {each.modes for each in found.rows} | {each.modes for each in found.curves}
    names = {modes: modes_in_words(modes) for modes in swept} | {found.modes: whole}
    curves = {(names[each.modes], each.direction): (each.frequency, each.amplitude) for each in found.curves}
    known = {row.modes: row.comparison for row in found.rows if row.comparison is not None}
    shown = {names[each.modes]: known[each.modes] for each in found.curves if each.modes in known}
    return Decision(
        found.case, found.asked, whole, curves, shown, tuple(_errors(found)), found.seconds,
        tuple(names[row.modes] for row in found.rows if row.comparison is None),
    )  # fmt: skip


def _errors(found: ModesNeeded) -> Iterator[ModelError]:
    """Errors of all models that were compared, of the reference beside a fuller one."""
    for row in _all_rows(found):
        if row.comparison is not None:
            mark = SDOF if row is found.single else str(row.modes)
            yield ModelError.of(mark, row.comparison, found.asked, row.seconds, mark)
    if found.own.comparison is not None:
        yield ModelError.of(
            every(found), found.own.comparison, found.asked, found.seconds, str(found.modes), beyond=True
        )


def _all_rows(found: ModesNeeded) -> list[ModesTried]:
    return [*filter(None, [found.single]), *found.rows]


def _numbers(row: ModesTried) -> dict[str, object]:
    own = row.comparison or None
    return {
        "modes": row.modes, "reduction": row.reduction,
        "amplitude_error": None if own is None else own.amplitude_error,
        "frequency_error": None if own is None else own.frequency_error,
        "kind_width": None if own is None else own.kind_width, "why": row.why,
    }  # fmt: skip


def _table(found: ModesNeeded) -> ReportTable:
    recorded = found.case.record is not None
    heads = [str(each.number) for each in found.rows[0].changes] if recorded else ["amplitudes", "ends", "kinds"]
    table = blank(f"Errors against {every(found)}", "model", *(f"{each}|" for each in heads), "suffices|")
    table.add("CPU|", detail=True)
    words = {True: "yes", False: "no", None: "may"}
    for row in _all_rows(found):
        name = "sdof" if row.reduction == "static_mode" else f"modes {row.modes}"
        numbers = map(change_cell, row.changes) if recorded else cells(row.comparison)
        table.add_row(name, *numbers, "–" if row.why else words[row.suffices(found.asked)], time_text(row.seconds))
    if found.own.comparison is not None:
        own = tuple(f"[{each}]" for each in cells(found.own.comparison))
        suffices = words[found.own.suffices(found.asked)]
        table.add_row(f"modes {found.modes}", *own, suffices, time_text(found.seconds))
    table.caption = CAPTION.format(f"{modes_in_words(found.modes)} of {found.own.fidelity}") if recorded else (
        f"sdof: along the static deflection at the contact; {found.frequencies} frequencies, ends of branches between\n"
        "kinds: width in which the motion is another"
    ) + f"; [ ]: against {beyond(found.own).name}" * (found.own.comparison is not None)  # fmt: skip
    return table


def _notes(found: ModesNeeded) -> Iterator[str]:
    if found.case.record is not None:
        yield FEW if found.realisations > 1 else ONE
    elif found.modes < found.size:
        yield f"{found.modes} of {found.size} modes stand for all; vibeam verdict --only modes --budget allows more"
    reasons: dict[str, list[str]] = {}
    for row in found.rows:
        if row.why:
            reasons.setdefault(row.why, []).append(str(row.modes))
    for why, names in reasons.items():
        yield f"{', '.join(names)} modes: {why}"
