"""The kind ``spectrum``: amplitude spectra of displacement and velocity, a sine reads its peak value."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibeam.observe.spectrum import spectrum_of
from vibeam.report.units import rates_of, units_of
from vibeam.show.motion import sheet_each
from vibeam.show.panels import labelled, sheets_at, titled
from vibeam.show.plan import Column, Columns, Sheet, ShowPlan
from vibeam.show.seen import chain_or_exact, seen

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.case import Case
    from vibeam.result import Result

PERIODS = 64
SAMPLES = 256  # a drive period, of a motion that is not measured
SHOWN = 16  # multiples of the drive frequency


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One a frequency."""
    return sheet_each(plan, fidelity, lambda frequency: _columns(case, fidelity, frequency, plan))


def _columns(case: Case, name: str, frequency: float, plan: ShowPlan) -> Columns:
    chain = chain_or_exact(case, name, SAMPLES * frequency)
    record = seen(case, name, frequency, plan, plan.periods or PERIODS, chain).window
    place, speed = (spectrum_of(record.time, values) for values in (record.displacement, record.velocity))
    return {
        "line": Column(place.frequency, "Hz", "frequency of the line"),
        "displacement_line": Column(place.amplitude, "q", "amplitude of the displacement"),
        "velocity_line": Column(speed.amplitude, "q/s", "amplitude of the velocity"),
    }


def draw(figure: Figure, result: Result, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Displacement above velocity, a column a frequency."""
    units, rate = units_of(result.case), rates_of(result.case)
    grid = figure.subplots(2, len(plan.frequency), sharex="col", sharey="row", squeeze=False)
    for column, frequency in enumerate(plan.frequency):
        titled(grid[0, column], units, frequency)
        for sheet, colour in sheets_at(frequency, plan, shown):
            line = sheet.of("line")
            inside = (line > 0) & (line <= SHOWN * frequency)
            across = line[inside] * units.frequency_factor
            rows = (("displacement_line", units.length_factor), ("velocity_line", rate.factor))
            for axes, (values, factor) in zip(grid[:, column], rows, strict=True):
                axes.semilogy(
                    across, sheet.of(values)[inside] * factor, color=colour, linewidth=0.8, label=sheet.label
                )  # fmt: skip
        labelled(grid[1, column], "frequency", units.frequency, across=True)
    labelled(grid[0, 0], "displacement", units.length)
    labelled(grid[1, 0], "velocity", rate.name)
