"""Number of modes that a case needs, as a sheet: the answer, known before any flight, its table, notes and data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import inf, isfinite

from vibeam.case.case import Case
from vibeam.case.study_plans import ModesNeededPlan
from vibeam.report import reductions
from vibeam.report.output import StudySheet
from vibeam.report.reductions import DUST, LARGEST, enough, limits, off, shown
from vibeam.report.tables import ReportTable, blank
from vibeam.studies.modes_needed.limit import TOO_FEW
from vibeam.studies.modes_needed.losses import ResponseError
from vibeam.studies.modes_needed.reduction import ReductionProblem, plan_asked
from vibeam.studies.modes_needed.response import Claim
from vibeam.studies.modes_needed.study import MODAL, BeforeFlight, ModesNeeded, before_flight
from vibeam.system.curves import evenly
from vibeam.system.number_text import begun, modes_in_words, percent, ratio, signed

HELD = {"contact": "R at the contact", "first mode": "R as mode 1 sees it"}
SINGLE = "one degree of freedom"
MOST = 5  # notes
HINT = (
    "R is held at the contact: what mode 1 keeps of its speed falls with each mode that is added, and what is left "
    'goes like 1/n: hold what all modes leave it (R₁ of vibeam modes, stop.restitution_of = "first mode"), or let the '
    "stop yield."
)


def first_answer(case: Case, plan: ModesNeededPlan | None = None, final: bool = True) -> str:
    """Answer before anything is flown: numbers, what will be flown, or why none can be told; ValueError of a plan.

    ``final``: empty unless nothing will be flown and a number is told.
    """
    _, asked = case.sweep, plan_asked(case, plan, {})
    try:
        problem = ReductionProblem.of(case, asked)
    except ValueError as refusal:
        return "" if final else f"{begun(str(refusal))}."
    found = before_flight(problem)
    known = found.choices and found.claim.closed == found.claim.frequencies
    return before(found, problem.plan) if known or not final else ""


def before(found: BeforeFlight, plan: ModesNeededPlan) -> str:
    """Answer by the closed forms alone, with either restitution held."""
    within, claim = percent(plan.accuracy), found.claim
    if not found.choices:
        told = f"no number of modes can be told for {within}: {claim.refused}"
        flown = f"{found.why}: all {claim.modes} modes are flown over the sweep to tell how many suffice for {within}"
        return f"{begun(told if claim.refused else flown)}{_losses(found.by_losses, plan)}."
    here, several = found.choices[0], claim.closed < claim.frequencies
    number = len(here.rows) if here.enough is None else here.enough
    said = _suffice(number, here.enough is not None, here.rows[number - 1], plan, claim)
    if several:
        said += f" at the {claim.closed} of {claim.frequencies} frequencies whose motion has a closed form"
    alone = f"; {SINGLE} is {_size(here.single)}" if number > 1 and isfinite(here.single.peak) else ""
    return f"{said}{alone}.{_held(found, plan)}" + (" The sweep is flown for the others." if several else "")


def _suffice(number: int, enough: bool, error: ResponseError, plan: ModesNeededPlan, claim: Claim) -> str:
    """Clause on a number of modes, with its error at the peak."""
    if claim.modes == 1:
        return "The case has one mode, and nothing that could be left out"
    if number == claim.modes:
        every = "Both modes" if number == 2 else f"All {modes_in_words(number)}"
        return f"{every} of the case are needed for {percent(plan.accuracy)}"
    verb = ("suffices" if number == 1 else "suffice") if enough else "do not suffice"
    of = f"{percent(plan.accuracy)} of the amplitude of all {claim.modes} modes"
    return f"{begun(modes_in_words(number))} {verb} for {of} ({_size(error, ' at the peak')})"


def _held(found: BeforeFlight, plan: ModesNeededPlan) -> str:
    """Sentence on what is held, and on the other choice; empty where it makes no difference."""
    if found.claim.modes == 1 or not found.choices:
        return ""
    here, *others = found.choices
    said = f" {begun(HELD[here.held.restitution_of])} is held at {ratio(here.held.coefficient or 0.0, 'g')}"
    for there in others:
        if there.enough == here.enough and abs(there.single.peak - here.single.peak) < DUST:
            said += ", which makes no difference"
            continue
        needed = f"more than {plan.most} modes" if there.enough is None else modes_in_words(there.enough)
        of = HELD[there.held.restitution_of].replace("R ", "R held ", 1)
        alone = f"{SINGLE} would be {_size(there.single)}, and " if isfinite(there.single.peak) else ""
        said += f"; with {of} {alone}{needed} would be needed"
    return f"{said}."


def _size(error: ResponseError, where: str = "") -> str:
    """Error at the peak in words; the largest one where that is not known."""
    if isfinite(error.peak):
        way, worst = "low" if error.peak < 0 else "high", abs(error.worst)
        peak = f"{percent(abs(error.peak))} too {way}{where}" if abs(error.peak) >= DUST else f"exact{where}"
        return f"{peak} and {percent(worst)} off at most" if worst > max(2 * abs(error.peak), DUST) else peak
    return f"{'more than ' * error.given_up}{percent(min(abs(error.worst), LARGEST))} off"


def _losses(by_losses: int | None, plan: ModesNeededPlan) -> str:
    needed = f"more than {plan.most} modes" if by_losses is None else modes_in_words(by_losses)
    return f"; by what one impact loses, which claims nothing of the amplitude, {needed} would be needed"


def answer(found: ModesNeeded) -> str:
    """Answer by all that is known, flown where motions have no closed form."""
    claim, best, within = found.reduction.claim, found.recommended, percent(found.plan.accuracy)
    if claim.refused or best is None:
        why = claim.refused or "no basis can be had"
        modal = next((each.by_losses for each in found.reduction.recommended if each.basis == MODAL.name), None)
        return f"No number of modes can be told for {within}: {why}{_losses(modal, found.plan)}."
    if best.basis == MODAL.name and found.before.choices and claim.closed == claim.frequencies:
        return before(found.before, found.plan) + _fewer(found)
    known = [row for row in found.reduction.of(best.basis) if row.response.total]
    if not known:
        return f"No number of modes can be told for {within}: nothing is known of basis {best.basis}."
    shown = best.losses or known[-1]
    said = _suffice(shown.modes, best.modes is not None, shown.response, found.plan, claim)
    if best.basis != MODAL.name:
        said = said.replace("mode", "coordinate", 1) + f" in basis {best.basis}"
    first = known[0].response
    alone = "would make other motions" if first.strays(found.plan.accuracy) else f"would be {_size(first)}"
    least = f"; {modes_in_words(known[0].modes)} {alone}" if known[0] is not shown else ""
    return f"{said}{least}: known at {_known(claim)}.{_held(found.before, found.plan)}{_fewer(found)}"


def _known(claim: Claim) -> str:
    """Points at which a motion of all modes is known."""
    closed = f"{claim.closed} of {claim.frequencies} frequencies in closed form ({claim.struck} of them with impacts)"
    flown = f"{claim.repeating} of {claim.flown} points of the sweep that were flown"
    return " and at ".join([closed] * bool(claim.closed) + [flown] * bool(claim.flown))


def _fewer(found: ModesNeeded) -> str:
    """Sentence on the bases that need fewer coordinates than modes."""
    modal = next((each for each in found.reduction.recommended if each.basis == MODAL.name), None)
    if modal is None:
        return ""
    enough = [each for each in found.reduction.recommended if each.modes and each.modes < (modal.modes or inf)]
    fewer = ", ".join(f"{each.basis} {each.modes}" for each in enough)
    return f" Fewer coordinates do in another basis: {fewer}." if fewer else ""


def sheet(found: ModesNeeded) -> StudySheet:
    """Sheet of a study; as CSV the losses, a row for each basis and number of coordinates."""
    reduced, doubts = reductions.sheet(found.reduction), list(uncertain(found))
    first, *further = [*reduced.tables] if found.reduction.claim.refused else [errors(found), *reduced.tables]
    return replace(
        reduced,
        answer=answer(found),
        tables=[first],
        notes=doubts[:MOST],
        details=[*doubts[MOST:], *details(found)],
        more=[*further, *([limits(found.limits)] if found.limits else [])],
        data={name: getattr(found, name) for name in ("plan", "before", "limits", "no_limits")} | dict(reduced.data),
    )


def errors(found: ModesNeeded) -> ReportTable:
    """Error of the amplitude with n coordinates: of modes at the peak with either restitution held, of all bases."""
    study, counts = found.reduction, sorted({row.modes for row in found.reduction.rows})
    shown = {*counts[:3], *evenly(min(4, len(counts)), len(counts), 3).tolist()}
    table = blank(f"Error of the amplitude against all {study.claim.modes} modes, with n coordinates", "basis")
    table.add("enough|", "sdof|")
    for n in counts:
        table.add(f"{n}|", detail=n not in shown)
    for each in found.before.choices:
        cells = (signed(row.peak) if abs(row.peak) >= DUST else "0" for row in (each.single, *each.rows))
        table.add_row(f"modal, peak, {each.held.symbol} held", str(each.enough or f"> {len(counts)}"), *cells)
    for row in study.recommended:
        if not row.why:
            table.add_row(row.basis, enough(study, row), "", *(off(each, study.within) for each in study.of(row.basis)))
    table.caption = (
        f"enough: n for {percent(found.plan.accuracy)}; sdof: along the static deflection; peak: signed, else the "
        "largest error at any frequency; >: flown up to there; other: it makes other motions; –: not known"
    )
    return table


def uncertain(found: ModesNeeded) -> Iterator[str]:
    """Remarks on what is uncertain, each with what to do about it."""
    study, claim = found.reduction, found.reduction.claim
    if not claim.refused and claim.closed < claim.frequencies and claim.repeating < claim.flown:
        yield f"Known of all modes at {_known(claim)}; of the others nothing is claimed: sweep where motions repeat."
    yield from study.notes
    if found.before.choices and found.before.choices[0].held.restitution_of == "contact" and claim.modes > 1:
        yield HINT
    reasons = dict.fromkeys(row.why for row in found.limits if row.why not in ("", TOO_FEW) and claim.modes > 1)
    for why in reasons:
        if not any(why != each and why.startswith(each) for each in reasons):
            yield f"No limit of infinitely many modes: {why}."


def details(found: ModesNeeded) -> Iterator[str]:
    """Sentences on the settings, and on how the numbers are known."""
    study = found.reduction
    if not study.claim.refused:
        why = study.claim.why_flown or ("models whose damping couples their modes" if study.claim.flown else "")
        yield f"compared where both make the same motion: known at {_known(study.claim)}{f': {why}' if why else ''}"
    low, high = (shown(end, "Hz") for end in study.band)
    time = shown(study.contact_time, "s") if isfinite(study.contact_time) else "not known: an impulse stands for it"
    yield f"{study.size} coordinates; band {low} … {high}, with {study.in_band} of its modes; contact time {time}"
    for each in study.recommended:
        if each.why:
            yield f"{each.basis}: {each.why}"
        elif each.frequency is not None:
            yield f'{each.basis}: about frequency = "{each.frequency:.6g} Hz"'
    if found.no_limits:
        yield f"limits of infinitely many modes: {found.no_limits}"
