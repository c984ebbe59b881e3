"""Verdict of the solid on the beam, as a sheet: whether the beam is enough, and a line for each step to the solid."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import ceil, isfinite, nan
from shlex import quote
from typing import TYPE_CHECKING, Any

from vibeam.report.output import StudySheet
from vibeam.report.tables import ReportTable, blank, coefficient, shown
from vibeam.runs.comparison.differences import listed
from vibeam.studies.solid.model import FIRST, LadderModel
from vibeam.studies.solid.steps import LESS_TORSION
from vibeam.studies.solid.study import JUDGED, QUANTITIES, SolidVerdict, StepChange
from vibeam.system.number_text import WORDS, begun, percent, signed
from vibeam_models.arguments import counted

if TYPE_CHECKING:
    pass


UNITS = {
    **dict.fromkeys(("f1", "f2", "f3", "twist", "peak_frequency"), "Hz"), "flexibility": "m/N", "mobility": "1/kg",
    "peak": "m", "restitution": "1", "first_mode_restitution": "1",
}  # fmt: skip
NAMES = {
    "f1": "f₁", "f2": "f₂", "f3": "f₃", "twist": "twist", "flexibility": "flexibility", "mobility": "mobility",
    "restitution": "R", "first_mode_restitution": "R₁", "peak": "peak", "peak_frequency": "at", "rms": "rms",
}  # fmt: skip
OF_BEAMS = ("shear", LESS_TORSION)  # steps between two beams, which the mesh has no part in
FREQUENCIES = JUDGED[:FIRST]
DETAILS = ("flexibility", "peak_frequency")  # columns of -v and of the page
FINE = 0.2  # of the accuracy: what the mesh may be off without a word
LEAST, DUST = 1e-4, 1e-6  # share that is told in numbers; below which there is none
SMALL = 0.1  # share up to which two digits do


def sheet(found: SolidVerdict) -> StudySheet:
    """Sheet of a verdict; as CSV a row a model."""
    return StudySheet(
        answer=answer(found),
        tables=[ladder(found), *measured(found)],
        notes=list(doubts(found)),
        details=list(details(found)),
        data=_data(found),
        rows=list(rows(found)),
    )


def answer(found: SolidVerdict) -> str:
    """Sentence on whether the beam is enough: its frequencies, its peak, and the step that changes most."""
    within, worst, (causes, change) = percent(found.accuracy), found.worst, found.largest
    known = isfinite(found.error("peak"))
    verdict = "is enough" if found.enough else "is not enough" if found.beyond else "is not known to be enough"
    clauses = [_frequencies(found), f"the peak {_off(found.error('peak'))}" if known else "the peak is not known"]
    if found.error("rms") > found.accuracy:
        clauses.append(f"its amplitudes at the same drive frequencies {_size(found.error('rms'))} off (rms)")
    said = f"The beam {verdict} for {within}: {', '.join(filter(None, clauses))}"
    if not causes or abs(found.error(worst)) < DUST:
        return f"{said}.{_which(found)}"
    but = ", not resolved by this mesh" * (causes[-1] not in OF_BEAMS and abs(change) < found.mesh_error(worst))
    share = f"{'are' if len(causes) > 1 else 'is'} the largest part ({signed(change)} of {NAMES[worst]}{but})"
    return f"{said}; {listed(causes)}{' together' * (len(causes) > 1)} {share}.{_which(found)}"


def _which(found: SolidVerdict) -> str:
    """Sentence on which solid it is, where fidelities of the case fly a mesh of the user's own."""
    scenes = {name: found.case.scene_of(name) for name in found.case.fidelities}
    own = [name for name, scene in scenes.items() if scene.in_three_dimensions and scene.no_beam]
    return f" The solid is meshed from the case's tables; it is not the mesh of fidelity {listed(own)}." if own else ""


def _frequencies(found: SolidVerdict) -> str:
    """Clause on the natural frequencies; empty where none is known."""
    errors = [found.error(name) for name in FREQUENCIES if isfinite(found.error(name))]
    if not errors:
        return ""
    worst, several = max(errors, key=abs), len(errors) > 1
    of = f"its first {WORDS[len(errors)]} natural frequencies are" if several else "its natural frequency is"
    if abs(worst) <= found.accuracy:
        return f"{of} within {_size(max(abs(worst), LEAST))} of the solid's"
    side = "off" if min(errors) < 0 < max(errors) else f"too {'high' if worst > 0 else 'low'}"
    return f"{of} {'up to ' * several}{_size(worst)} {side}"


def _off(value: float) -> str:
    return f"{_size(value)} too {'high' if value > 0 else 'low'}" if abs(value) >= LEAST else "within 0.01 % of it"


def _size(value: float) -> str:
    return f"{100 * abs(value):.2g} %" if abs(value) < 0.995 else f"{100 * abs(value):.0f} %"


def ladder(found: SolidVerdict) -> ReportTable:
    """Table with the beam, a line for each step, the solid, and what the beam is off."""
    columns = [name for name in QUANTITIES if _varies(found, name)]
    table = blank("From the beam to the solid", "step")
    for name in columns:
        table.add(f"{NAMES[name]}|", detail=name in DETAILS)
    table.add("CPU|", detail=True)
    seconds = {model.name: model.cpu_seconds for model in found.models}
    table.add_row("the beam", *(_value(found.beam, name) for name in columns), _time(found.beam.cpu_seconds))
    table.add_section()
    for step in found.steps:
        marks = (_change(found, step, name) for name in columns)
        plus = "" if step.cause == LESS_TORSION else "+ "
        table.add_row(plus + step.cause, *marks, _time(seconds[step.name]))
    table.add_section()
    table.add_row("the solid", *(_value(found.solid, name) for name in columns), "")
    table.add_row("the beam is off", *(_cell(found.error(name)) for name in columns), "")
    if not found.coarser.why:
        errors = (_cell(found.mesh_error(name)).replace("+", "± ") for name in columns)
        table.add_row("the solid's mesh", *errors, _time(found.coarser.cpu_seconds))
    table.caption = (
        "steps: change over the solid's number, their sum is what the beam is off with the other sign; –: not known, "
        "the next step has it; "
        f"mobility: of the contact up to the beam's mode {found.beam.modes}; mesh: half of what one twice as "
        "coarse changes; rms: of the amplitudes at the same drive frequencies from the solid's; *: not resolved"
    )
    return table


def _varies(found: SolidVerdict, name: str) -> bool:
    """Test whether a quantity is known, and not the one that is held."""
    symbol = {"restitution": "contact", "first_mode_restitution": "first mode"}.get(name)
    return isfinite(found.error(name)) and symbol != found.held.restitution_of


def _value(model: LadderModel, name: str) -> str:
    value = model.value(name)
    if name == "rms":
        return percent(value)
    return coefficient(value) if UNITS[name] == "1" else shown(value, UNITS[name])


def _cell(value: float) -> str:
    """Share as text, to two digits where it is small; a dash for NaN."""
    small = DUST <= abs(value) < SMALL
    return f"{100 * value:+.2g} %" if small else signed(value) if isfinite(value) else "–"


def _change(found: SolidVerdict, step: StepChange, name: str) -> str:
    """Change as text, with a mark where the solid's mesh does not resolve it."""
    value = step.changes[name]
    return _cell(value) + "*" * (step.cause not in OF_BEAMS and DUST < abs(value) < found.mesh_error(name))


def _time(seconds: float) -> str:
    return f"{float(f'{seconds:.2g}'):g} s"


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
            cells += [signed(value / each.value - 1), "calibrated" if read else "predicted"]
        table.add_row(each.name, f"{each.number:g}", shown(each.value, "Hz"), *cells)
    table.caption = "calibrated: the number chose a key that the model reads, and tests nothing"
    yield table


def doubts(found: SolidVerdict) -> Iterator[str]:
    """Notes on what is uncertain, each with what to do about it."""
    if found.left_out:
        enough = ceil(2 * found.seconds * len(found.models) / (len(found.models) - found.left_out))
        yield (
            f"{counted(found.left_out, 'model')} did not fit into {found.budget:g} s of CPU time: vibeam verdict "
            f"{quote(str(found.case.path))} --only solid --budget '{enough} s' makes all."
        )
    rough = [name for name in JUDGED if found.mesh_error(name) > FINE * found.accuracy]
    if rough:
        changed = listed([f"{NAMES[name]} ± {percent(found.mesh_error(name))}" for name in rough])
        yield f"The solid's mesh leaves an error ({changed}): take more elements, solid.along first."
    for model in (found.beam, found.solid):
        if model.why_no_peak:
            yield f"{begun(model.name)}: {'' if isfinite(model.peak) else 'no '}peak: {model.why_no_peak}."
    lost = [str(place) for place, value in enumerate(found.solid.frequencies, 1) if not isfinite(value)]
    if lost:
        yield f"The solid has no mode of the shape of the beam's mode {listed(lost)}: these are not compared."
    yield from (f"{each}." for each in found.assumed)


def details(found: SolidVerdict) -> Iterator[str]:
    """Sentences on what is held, on the calibrated, on models that cannot be made, on what has no limit."""
    yield f"{found.held.label} is held in every model; modes are paired by shape, fidelity {found.fidelity}."
    if found.chosen:
        kept = [key for key in found.chosen if key not in found.solid.unread]
        left = [key for key in found.chosen if key in found.solid.unread]
        yield (
            f"Measured numbers chose {listed(found.chosen)}: the beam is calibrated by them"
            + (
                f"; the solid reads no {listed(left)}" + ("" if kept else ", and predicts")
                if left
                else ", and the solid too"
            )
            + "."
        )
    for model in found.models:
        if model.why:
            yield f"{begun(model.name)}: {model.why}."
    yield (
        "The mobility of a patch in all modes grows without limit as the mesh is refined; natural frequencies, "
        "flexibility, and the mobility of a number of modes converge."
    )


def rows(found: SolidVerdict) -> Iterator[Mapping[str, Any]]:
    """A row for each model: its numbers in SI, the change from the model before over the solid's number."""
    changes = {step.name: step.changes for step in found.steps}
    for model in (*found.models, found.coarser):
        numbers = {name: model.value(name) for name in QUANTITIES}
        own = changes.get(model.name, {})
        yield {
            "model": model.name, "cause": model.cause, "modes": model.modes, **numbers,
            **{f"change of {name}": own.get(name, nan) for name in QUANTITIES},
            "cpu_seconds": model.cpu_seconds, "why": model.why or model.why_no_peak,
        }  # fmt: skip


def _data(found: SolidVerdict) -> dict[str, Any]:
    names = ("fidelity", "accuracy", "held", "enough", "worst", "models", "steps", "coarser", "chosen")
    errors = {name: found.error(name) for name in QUANTITIES}
    return {name: getattr(found, name) for name in (*names, "seconds", "left_out")} | {"errors": errors}
