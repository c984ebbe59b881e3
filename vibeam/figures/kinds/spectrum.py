"""Figure kind ``spectrum``: amplitude spectra of displacement and velocity; a sine reads its peak value."""

from __future__ import annotations

from matplotlib.figure import Figure

from vibeam.case.case import Case
from vibeam.case.plans import ShowPlan
from vibeam.figures.panels import decades, faults_at, labelled, sheets_at, titled
from vibeam.figures.settled_motion import chain_or_exact, measured_window
from vibeam.figures.sheet import Column, Columns, Comparison, Sheet
from vibeam.figures.style import name_of
from vibeam.figures.units import motion_of, units_for
from vibeam.observe.harmonics import spectrum_of
from vibeam_models.arrays import Array

PERIODS = 64
SAMPLES = 256  # samples a drive period, of a motion that is not measured
SHOWN = 16  # largest frequency shown, in multiples of the drive frequency


def columns(case: Case, name: str, frequency: float, plan: ShowPlan) -> Columns:
    """Spectra at one ``frequency``, Hz."""
    chain = chain_or_exact(case, name, SAMPLES * frequency)
    record = measured_window(case, name, frequency, plan, plan.periods or PERIODS, chain).window
    displacement, velocity = (spectrum_of(record.time, values) for values in (record.displacement, record.velocity))
    return {
        "line": Column(displacement.frequency, "Hz", "frequency of the line"),
        "displacement_line": Column(displacement.amplitude, "q", "amplitude of the displacement"),
        "velocity_line": Column(velocity.amplitude, "q/s", "amplitude of the velocity"),
    }


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw displacement above velocity, a column a frequency."""
    case, units = result.case, units_for(result, plan.output)
    rows = (("displacement", units.length_factor), ("velocity", units.speed_factor))
    grid = figure.subplots(2, len(plan.frequency), sharex="col", sharey="row", squeeze=False)
    heights: dict[str, list[Array]] = {name: [] for name, _ in rows}
    for column, frequency in enumerate(plan.frequency):
        titled(grid[0, column], units, frequency)
        for sheet, look in sheets_at(case, frequency, plan, shown):
            inside = (sheet["line"] > 0) & (sheet["line"] <= SHOWN * frequency)
            across = sheet["line"][inside] * units.frequency_factor
            for axes, (name, factor) in zip(grid[:, column], rows, strict=True):
                heights[name].append(sheet[f"{name}_line"][inside] * factor)
                axes.plot(across, heights[name][-1], label=name_of(case, sheet.fidelity), **look.keys(0.8))
        for axes in grid[:, column]:
            faults_at(case, frequency, plan, shown, axes)
        labelled(grid[1, column], "frequency", units.frequency, across=True)
    for axes, (name, _) in zip(grid[:, 0], rows, strict=True):
        decades(axes, heights[name])
        axes.set_ylabel(motion_of(plan.output, name, units))
