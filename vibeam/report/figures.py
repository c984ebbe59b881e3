"""Figures of a result in files: its curves over frequency, and the further ones that its case asks for."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibeam.case.case import Case, quantity_of
from vibeam.case.plans import ShowPlan
from vibeam.figures import FIGURES
from vibeam.figures.files import all_current, figure_files, paths_of, shown_paths, stamp
from vibeam.figures.sheet import Comparison, module_of, named_of
from vibeam.report.output import SheetPicture
from vibeam.report.run_report import run_decisions
from vibeam.system.labelled import Viewed
from vibeam.system.response import Branches, FrequencyResponse

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write_figures(result: Any, path: Path) -> list[Path]:
    """Draw all figures of a case beside its results file ``path``, unless they are there; return their files.

    Its own: of a sweep the curves over frequency and its fidelities over each other, of a record the histories.
    """
    files, mark, pictures = figure_files(path, result.case), stamp(path, result.case), _decisive(result, path)
    files += [file for _, own in pictures for file in own]
    if not all_current(files, mark):
        from vibeam.figures.page import write_page
        from vibeam.figures.response_curve import write_frc

        own = paths_of(path, result.case.figure)
        if result.case.record is not None:
            from vibeam.report.record_figure import record_figure

            write_page(partial(record_figure, result), own, mark=mark)
        else:
            write_frc(result, *own, mark=mark)
        for each, own in pictures:
            write_page(each.draw, own, mark=mark)
        write_shown(result, path, mark)
    return files


def _decisive(result: Any, path: Path) -> list[tuple[SheetPicture, list[Path]]]:
    """Pictures of fidelities over each other and of their errors, with their files ``STEM_errors``."""
    if result.case.record is not None or len(result) < 2 or "errors" in result.case.shows:
        return []
    stem, plan = path.with_name(f"{path.stem}_errors.x"), result.case.figure
    return [(each, each.files(stem, plan)) for found in run_decisions(result)[:1] for each in found.pictures]


def write_shown(result: Comparison, path: Path, mark: str | None = None) -> list[Path]:
    """Draw every [show.NAME] of the case as ``STEM_NAME`` beside ``path``, in the case's formats; return the files."""
    from vibeam.figures.page import write_page

    written = []
    for plan in result.case.shows.values():
        files = shown_paths(path, result.case, plan.name)
        if FIGURES[plan.kind].ending:
            module_of(plan).write(files[0], result.shown.get(plan.name, ()), mark or "")
        else:
            write_page(partial(figure, result, plan), files, mark=mark)
        written += files
    return written


def figure(result: Comparison, plan: ShowPlan) -> Figure:
    """Figure of one table."""
    from vibeam.figures.page import blank_page, legend, titled
    from vibeam.figures.panels import name_faults
    from vibeam.report.record_figure import handles_of

    made, shown = blank_page(_size(plan), result.case.figure), result.shown.get(plan.name, ())
    module_of(plan).draw(made, result, plan, shown)
    held = result.held.partition("\n")[0]
    titled(made, result.case.figure, result.case.title, ", ".join(filter(None, [_caption(result.case, plan), held])))
    legend(made, handles_of(made) | name_faults(result.case, plan, shown))
    return made


def _caption(case: Case, plan: ShowPlan) -> str:
    """Title of the figure."""
    own = getattr(module_of(plan), "caption", FIGURES[plan.kind].meaning)
    return named_of(str(own(plan) if callable(own) else own), quantity_of(case, plan.output).name)


def _size(plan: ShowPlan) -> tuple[float, float]:
    """Size by the figure kind, else one panel for each frequency of a motion."""
    own = getattr(module_of(plan), "size", None)
    if own is not None:
        wide, high = own(plan) if callable(own) else own
        return wide, high
    panels = 1 if plan.quantity else len(plan.frequency)
    return (5.8 if panels == 1 else 3.2 * panels + 0.6, 4.2)


def plot(shown: Viewed, *paths: str | Path, quantity: str = "amplitude") -> Figure:
    """Plot a result, as ``vibeam run`` writes it, a response over frequency, or what a notebook shows of a record.

    ``paths``: files to write it to (.png, .svg, .pdf). ``quantity``: of a response, any that has one number a point.
    The figure belongs to no window. ValueError for another quantity or an object without a figure.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> figure = vibeam.plot(vibeam.sweep(system, omega=[1.9, 2.0, 2.1], amplitude=0.1), "curve.png", quantity="reach")
    >>> figure.axes[0].get_xlabel()
    'drive frequency, Ω/2π'
    """
    from vibeam.figures.page import write_page

    made: list[Figure] = []

    def make() -> Figure:
        made.append(_figure(shown, quantity))
        return made[0]

    write_page(make, [Path(path) for path in paths])
    return made[0]


def _figure(shown: Any, quantity: str) -> Figure:
    if isinstance(shown, Branches | FrequencyResponse):
        from vibeam.figures.response import response_figure

        return response_figure(dict(shown.items()) if isinstance(shown, Branches) else {"up": shown}, quantity)
    if quantity != "amplitude":
        raise ValueError(f"quantity: goes with a response; plot result[fidelity] for {quantity!r}")
    from vibeam.report.views import sheet_of

    draw = sheet_of(shown).draw if isinstance(shown, Viewed) else None
    if draw is None:
        raise ValueError(f"plot: a {type(shown).__name__} has no figure")
    return draw()
