"""Views of records: the sheet of each kind, which a notebook shows, and its rows for a table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.faults import CaseError
from vibeam.exchange.files import dotted
from vibeam.report.output import StudySheet
from vibeam.report.output import plain as plain_of
from vibeam.report.tables import ARROWS, blank, coefficient
from vibeam.system.response import Branches, FrequencyResponse
from vibeam_models.arguments import counted
from vibeam_models.registry import loaded

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.case.case import Case
    from vibeam.maps.evaluate import GridResponse
    from vibeam.periodic.orbit import Orbit
    from vibeam.runs.result import Result
    from vibeam.runs.transient.result import TransientResult
    from vibeam.studies.derive import DerivedTable
    from vibeam.studies.modes import ModeTable

SMALL = (4.6, 2.8)  # inches of a figure
POINTS = 400  # of an orbit that is drawn
SHOWN = 8  # contacts of an orbit


def rows(record: Any) -> tuple[list[dict[str, Any]], Mapping[str, str], Mapping[str, str]]:
    """Rows of a record's sheet, nested values by names with a dot, the units of their columns, what they are of."""
    found = [dict(dotted(row if isinstance(row, Mapping) else plain_of(row))) for row in sheet_of(record).rows]
    units = UNITS.get(type(record).__name__, lambda record: {})(record)
    return found, units, getattr(getattr(record, "case", None), "about", {})


def sheet_of(record: Any) -> StudySheet:
    """Sheet of a record; of an extension's class that which it names as ``shown_by``."""
    made: StudySheet = loaded(SHEETS.get(type(record).__name__) or record.shown_by)(record)
    return made


def _case(case: Case) -> StudySheet:
    """Rig and sweep in a sentence; the fidelities."""
    from vibeam.runs.systems import Systems, overview_of, properties_of

    try:
        models = {name: properties_of(case, name, system) for name, system in Systems(case).items()}
        answer, notes = str(overview := overview_of(case, models)), list(overview.warnings())
    except CaseError as faults:
        return StudySheet("This case cannot be run", notes=str(faults).splitlines())
    table = blank("Fidelities", "fidelity", "reduction", "modes|", "R|", "R₁|", "solver")
    for name, each in case.fidelities.items():
        model = models[name]
        coefficients = map(coefficient, (model.restitution, model.first_mode_restitution))
        table.add_row(name, each.reduction, str(model.modes), *coefficients, each.solver)
    return StudySheet(answer, [table], notes)


def _result(result: Result) -> StudySheet:
    from vibeam.figures.response_curve import frc
    from vibeam.report.run_report import run_report

    return replace(run_report(result), draw=lambda: frc(result), pictures=())


def _transient(result: TransientResult) -> StudySheet:
    from vibeam.report.record_figure import record_figure
    from vibeam.report.transient import transient_report

    return replace(transient_report(result), draw=lambda: record_figure(result))


def _response(response: FrequencyResponse | Branches) -> StudySheet:
    from vibeam.figures.response import response_figure

    peak, branches = response.peak, {"up": response} if isinstance(response, FrequencyResponse) else response.items()
    where = f"{peak.frequency:.5g} Hz{ARROWS.get(peak.direction, '')}"
    answer = f"Highest amplitude {peak.amplitude:.4g} at {where}" if peak.point >= 0 else "No point is complete"
    return StudySheet(answer, draw=lambda: response_figure(dict(branches), "amplitude"))


def _modes(table: ModeTable) -> StudySheet:
    from vibeam.report.modes import sheet

    shapes = {f"{row.frequency:.4g} Hz": shape for row, shape in zip(table.rows[:4], table.shapes.T, strict=False)}
    lines = {name: shape / (np.abs(shape).max() or 1.0) for name, shape in shapes.items()}  # torsion bends nothing
    drawn = partial(_lines, "position (m)", "deflection", table.positions, lines) if lines else None
    return replace(sheet(table), rows=table.rows, draw=drawn)


def _derived(table: DerivedTable) -> StudySheet:
    from vibeam.report.derive import derivation

    return StudySheet("", [derivation(table)], table.notes, rows=table.rows)


def _orbit(orbit: Orbit) -> StudySheet:
    met, many = "contact" if orbit.system.contact_law.yields else "impact", len(orbit.times)
    met = counted(many, met) if many > 1 else f"{'one' if many else 'no'} {met}"
    kind = f"{'Stable' if orbit.stable else 'Unstable'} motion with {met}"
    kind += f" and {counted(orbit.rests, 'rest')}" if orbit.rests else ""
    clear = "." if orbit.admissible else ", which passes through the stop between: no motion."
    table = blank("Orbit", "stop|", "phase (rad)|", "velocity before (m/s)|", "reach (m)|", "largest multiplier|")
    whole = f"{orbit.reach:.5g}", f"{abs(orbit.multipliers[0]):.5g}"
    for stop, phase, velocity in _contacts(orbit):
        table.add_row(stop, phase, velocity, *whole)
        whole = "", ""
    times = np.linspace(orbit.time, orbit.time + orbit.span, POINTS)
    lines = {"contact": _place(orbit, times), "stop": np.full(POINTS, orbit.system.gap)}
    if orbit.system.second_gap is not None:
        lines["second stop"] = np.full(POINTS, -orbit.system.second_gap)
    drawn = partial(_lines, "time (drive periods)", "displacement (m)", orbit.drive.omega * times / (2 * np.pi), lines)
    return StudySheet(f"{kind} in {counted(orbit.periods, 'drive period')}{clear}", [table], draw=drawn)


def _contacts(orbit: Orbit) -> list[tuple[str, str, str]]:
    """Stop, phase and velocity of the hardest contacts in the order of time; dashes without any."""
    hardest = sorted(np.argsort(-orbit.velocities, kind="stable")[:SHOWN])
    phases = np.mod(orbit.drive.omega * orbit.times, 2 * np.pi * orbit.periods)
    rows = zip(orbit.contacts[hardest], phases[hardest], orbit.velocities[hardest], strict=True)
    return [(str(stop + 1), f"{phase:.5g}", f"{speed:.5g}") for stop, phase, speed in rows] or [("–", "–", "–")]


def _place(orbit: Orbit, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Displacement of the contact; of what is no motion, as if there were no stop between its impacts."""
    from vibeam.periodic.between_impacts import carried

    if orbit.admissible:
        return orbit.path().at(times)
    moved, _ = carried(orbit.system, orbit.drive, orbit.state, orbit.time, times)
    return np.asarray(moved @ orbit.system.contact)


def _map(found: Any) -> StudySheet:
    """Sheet of a map; of a stored one without what is flown or known in closed form, which may take long."""
    from vibeam.report.maps.page import map_figure, sheet_of, still

    shown = still(found, exact=False) if type(found).__name__ == "MapResult" else found
    return replace(sheet_of(shown), draw=lambda: map_figure(shown))


def _grid(response: GridResponse) -> StudySheet:
    """First quantity over the last two axes, at the first value of others, or over the one."""
    name, values = next((name, each[-1]) for name, each in response.values.items())
    *above, (across, x) = response.axes.items()
    while values.ndim > min(2, len(response.axes)):
        values = values[0]
    over = " and ".join(f"{len(each)} values of {key}" for key, each in response.axes.items())
    draw = partial(_lines, across, name, x, {response.ways[-1]: values})
    if above:
        draw = partial(_plane, across, above[-1][0], x, above[-1][1], values)
    return StudySheet(f"{name} of {response.fidelity}, swept {response.ways[-1]}, over {over}", draw=draw)


def _lines(across: str, upward: str, x: Any, lines: Mapping[str, Any]) -> Figure:
    figure, axes = _small(across, upward)
    for name, y in lines.items():
        axes.plot(x, y, ".-" if len(y) < POINTS // 4 else "-", label=name)
    axes.legend(frameon=False)
    return figure


def _plane(across: str, upward: str, x: Any, y: Any, values: Any) -> Figure:
    figure, axes = _small(across, upward)
    figure.colorbar(axes.pcolormesh(x, y, values, shading="nearest"))
    return figure


def _small(across: str, upward: str) -> tuple[Figure, Any]:
    from vibeam.figures.page import ShownFigure

    figure = ShownFigure(figsize=SMALL, layout="constrained")
    axes = figure.subplots()
    axes.set(xlabel=across, ylabel=upward)
    return figure, axes


SHEETS: dict[str, Callable[[Any], StudySheet] | str] = {
    "Case": _case, "Result": _result, "FrequencyResponse": _response, "Branches": _response, "ModeTable": _modes,
    "DerivedTable": _derived, "Orbit": _orbit, "MapResult": _map, "GridResponse": _grid,
    "TransientResult": _transient,
    **{f"{name}Study": f"vibeam.report.{name.lower()}:sheet" for name in ("Fit", "Uncertainty")},
    "ModesNeeded": "vibeam.report.modes_needed:sheet",
    "Stability": _map, "FidelityMap": _map, "Verdict": "vibeam.report.verdict:sheet",
}  # fmt: skip
ROOT_MASS = dict.fromkeys(("contact", "sensor"), "kg^-½")
UNITS: dict[str, Callable[[Any], Mapping[str, str]]] = {
    "ModeTable": lambda table: {"frequency": "Hz", **ROOT_MASS, "load": table.load_unit},
}  # fmt: skip
