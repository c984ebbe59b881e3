"""Verdict of the solid on the beam, as a sheet: whether the beam suffices, the errors of each model up to the solid."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, isfinite
from shlex import quote
from typing import Any

from vibeam.case.held import Held, held_of
from vibeam.extensions.solid.elasticity.scene import assumptions
from vibeam.extensions.solid.verdict.steps import LESS_TORSION, solid_of
from vibeam.extensions.solid.verdict.study import FREQUENCIES, QUANTITIES, SAFE, SolidVariant, SolidVerdict
from vibeam.figures.units import units_of
from vibeam.report.comparison_words import Subject, both_numbers, gravest, open_points, signed, size
from vibeam.report.output import StudySheet
from vibeam.report.tables import ReportTable, blank, coefficient, shown
from vibeam.report.variants import SHORT, change_cell, time_text, variant_rows
from vibeam.runs.comparison.differences import listed
from vibeam.studies.changes import COMPARED
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.system.number_text import WORDS, begun, percent
from vibeam.system.number_text import signed as by_percent
from vibeam_models.arguments import counted

BEAM, SOLID = Subject("it"), Subject("the solid")
UNITS = {
    **dict.fromkeys((*FREQUENCIES, "twist", "peak_frequency"), "Hz"), "flexibility": "m/N", "mobility": "1/kg",
    "peak": "m",
}  # fmt: skip
NAMES = {"f1": "f₁", "f2": "f₂", "f3": "f₃", "restitution": "R", "first_mode_restitution": "R₁"}
DETAILS = ("flexibility", "mobility", "restitution", "first_mode_restitution", "peak_frequency")  # of -v and the page
FINE = 0.2  # of what is allowed: what the mesh may be off without a word


def sheet(found: SolidVerdict) -> StudySheet:
    """Sheet of a verdict; as CSV a row a model and number."""
    names = ("fidelity", "asked", "enough", "worst", "models", "steps", "coarser", "missing", "seconds", "left_out")
    return StudySheet(
        answer(found),
        [errors(found), *measured(found)],
        list(doubts(found)),
        list(details(found)),
        data={name: getattr(found, name) for name in names}
        | {"held": _held(found), "chosen": _chosen(found)}
        | {"errors": {name: found.error(name) for name in QUANTITIES}},
        rows=[
            row for each in (*found.models, found.coarser)
            for row in variant_rows(each, model=each.name, cause=each.cause)
        ],
    )  # fmt: skip


def answer(found: SolidVerdict) -> str:
    """Answer by both errors, the step that changes most, natural frequencies and peak."""
    return " ".join(filter(None, [f"{_judged(found)}.", _linear(found), _which(found)]))


def _judged(found: SolidVerdict) -> str:
    within, beside = percent(found.asked.amplitude), found.beam.comparison
    if beside is None:
        return f"Whether the beam suffices for {within} is not known"
    units = units_of(found.case)
    if found.enough is False:
        clause = gravest(BEAM, SOLID, beside, found.asked, units)
        part = f"; {found.largest} {'are' if ' and ' in found.largest else 'is'} the largest part"
        return f"The beam does not suffice for {within}: {clause}{part * bool(found.largest)}"
    if found.enough:
        return f"The beam suffices for {within}: {both_numbers(beside, units)}, beside the solid"
    if beside.suffices(found.asked) is None:
        return f"The beam may suffice for {within} ({open_points(beside, found.asked, units)})"
    if beside.suffices(found.asked):
        numbers = both_numbers(beside, units)
        return f"The beam is within {within} of the solid: {numbers}; whether the solid's mesh is fine enough is open"
    clause = gravest(BEAM, SOLID, beside, found.asked, units)
    return f"Whether the beam suffices for {within} is open: {clause}, which the solid's mesh may change"


def _linear(found: SolidVerdict) -> str:
    """Sentence on natural frequencies and peak; empty where none is known."""
    known = [found.error(name) for name in FREQUENCIES if isfinite(found.error(name))]
    peak = found.error("peak")
    clauses = [f"the peak is {signed(peak)}"] if isfinite(peak) else []
    if known:
        of = f"the worst of its first {WORDS[len(known)]} natural frequencies" if len(known) > 1 else "its frequency"
        clauses = [f"{of} is {signed(max(known, key=abs))}", *clauses]
    return f"{begun(', '.join(clauses))}." if clauses else ""


def _which(found: SolidVerdict) -> str:
    """Sentence on which solid it is, where fidelities of the case have a mesh of the user's own."""
    scenes = {name: found.case.scene_of(name) for name in found.case.fidelities}
    own = [name for name, scene in scenes.items() if scene.in_three_dimensions and scene.no_beam]
    return f"The solid is meshed from the case's tables; it is not the mesh of fidelity {listed(own)}." if own else ""


def errors(found: SolidVerdict) -> ReportTable:
    """Table of the solid, and of the errors of each model beside it, the beam first."""
    held = {"contact": "restitution", "first mode": "first_mode_restitution"}.get(_held(found).restitution_of)
    known = [name for name in QUANTITIES if name != held and isfinite(found.error(name))]
    columns = [name for name in known if any(model.error(name) for model in found.models)]
    table = blank("From the beam to the solid", "model")
    for name in columns:
        table.add(f"{SHORT.get(AskedNumber(name), NAMES.get(name, name))}|", detail=name in DETAILS)
    table.add("CPU|", detail=True)
    table.add_row("the solid", *(_value(found.solid, name) for name in columns), time_text(found.solid.seconds))
    table.add_section()
    for model in found.models:
        cause = f"{'' if model.cause == LESS_TORSION else '+ '}{model.cause}" if model.cause else "the beam"
        table.add_row(cause, *_changes(model, columns), time_text(model.seconds))
    table.add_section()
    mesh = (f"± {percent(found.mesh_error(name))}" for name in columns)
    table.add_row("the solid's mesh", *mesh, time_text(found.coarser.seconds))
    table.caption = (
        "errors beside the solid, of each model with one assumption less than the one above; mesh: half of what one "
        f"twice as coarse changes; mobility: of the contact up to the beam's mode {found.beam.modes}"
    )
    return table


def _changes(model: SolidVariant, columns: list[str]) -> Iterator[str]:
    known = {each.number.quantity: change_cell(each) for each in model.changes}
    yield from (known.get(name, "–") for name in columns)


def _value(model: SolidVariant, name: str) -> str:
    if AskedNumber(name) in COMPARED:
        return ""
    return shown(model.value(name), UNITS[name]) if name in UNITS else coefficient(model.value(name))


def _held(found: SolidVerdict) -> Held:
    return held_of(found.case.scene_of(found.fidelity))


def measured(found: SolidVerdict) -> Iterator[ReportTable]:
    """Table of measured natural frequencies beside beam and solid, where the case has any."""
    numbers = [
        each for each in found.case.measured.values()
        if each.quantity == "mode_frequency" and found.quantity(each.number) and not each.against
        and found.case.scene_of(each.fidelity).platform is None  # whose own mode is numbered among them
    ]  # fmt: skip
    if not numbers:
        return
    table = blank("Measured natural frequencies", "measured", "mode|", "value|", "beam|", "", "solid|", "")
    for each in numbers:
        cells = []
        for model in (found.beam, found.solid):
            value, read = model.value(found.quantity(each.number)), set(each.chose) - set(model.unread)
            cells += [by_percent(value / each.value - 1), "calibrated" if read else "predicted"]
        table.add_row(each.name, f"{each.number:g}", shown(each.value, "Hz"), *cells)
    table.caption = "calibrated: the number chose a key that the model reads, and tests nothing"
    yield table


def doubts(found: SolidVerdict) -> Iterator[str]:
    """Notes on what is uncertain, each with what to do about it."""
    if found.left_out:
        all_models = len(found.models) + len(found.missing)
        enough = ceil(2 * found.seconds * all_models / (all_models - found.left_out))
        yield (
            f"{counted(found.left_out, 'model')} did not fit into {found.budget:g} s of CPU time: vibeam verdict "
            f"{quote(str(found.case.path))} --only solid --budget '{enough} s' makes all."
        )
    rough = {each.number: SAFE * each.size for each in found.coarser.changes if SAFE * each.share > FINE}
    if rough:
        changed = listed([f"{number} ± {size(error)}" for number, error in rough.items()])
        yield f"The solid's mesh leaves an error ({changed}): take more elements, solid.along first."
    for model in (found.beam, found.solid):
        yield from (f"{begun(model.name)}: {each}." for each in model.remarks)
    lost = [name[1:] for name in FREQUENCIES if name in found.beam.values and not isfinite(found.solid.value(name))]
    if lost:
        yield f"The solid has no mode of the shape of the beam's mode {listed(lost)}: these are not compared."
    scene: Any = found.case.scene_of(found.fidelity)
    yield from (f"{each}." for each in assumptions(solid_of(scene)))


def details(found: SolidVerdict) -> Iterator[str]:
    """Sentences on what is held, on the calibrated, on models that cannot be made, on what has no limit."""
    yield f"{_held(found).label} is held in every model; modes are paired by shape, fidelity {found.fidelity}."
    if chosen := _chosen(found):
        left = [key for key in chosen if key in found.solid.unread]
        solid = (
            "the solid too" if not left else f"the solid reads no {listed(left)}" + ", and predicts" * (left == chosen)
        )
        yield f"Measured numbers chose {listed(chosen)}: the beam is calibrated by them; {solid}."
    yield from (f"{begun(name)}: {why}." for name, why in found.missing.items())
    yield (
        "The mobility of a patch in all modes grows without limit as the mesh is refined; natural frequencies, "
        "flexibility, and the mobility of a number of modes converge."
    )


def _chosen(found: SolidVerdict) -> list[str]:
    """Keys that measured numbers chose."""
    return sorted({key for each in found.case.measured.values() for key in each.chose})
