"""The figures that a case asks for beside its frequency-response curves, each in files of its own."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from vibeam.report.page import write_page
from vibeam.show.plan import ShowPlan, module_of

if TYPE_CHECKING:
    from vibeam.result import Result

ENDINGS = (".png", ".svg")


def write_shown(result: Result, path: Path) -> list[Path]:
    """Draw every [show.NAME] of the case as ``STEM_NAME.png`` and ``.svg`` beside ``path``; the files written."""
    written = []
    for plan in result.case.shows.values():
        files = [path.with_name(f"{path.stem}_{plan.name}{ending}") for ending in ENDINGS]
        write_page(partial(figure, result, plan), files)
        written += files
    return written


def figure(result: Result, plan: ShowPlan) -> Figure:
    """The figure of one table."""
    made = Figure(figsize=_size(plan), layout="constrained")
    module_of(plan).draw(made, result, plan, result.shown.get(plan.name, ()))
    if result.case.title:
        made.suptitle(result.case.title, fontsize=9.5)
    handles, labels = made.axes[0].get_legend_handles_labels()
    made.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
    return made


def _size(plan: ShowPlan) -> tuple[float, float]:
    """As the kind says, else a panel of its own for each frequency of a motion."""
    own = getattr(module_of(plan), "size", None)
    if own is not None:
        wide, high = own(plan)
        return wide, high
    panels = 1 if plan.quantity else len(plan.frequency)
    return (5.8 if panels == 1 else 3.2 * panels + 0.6, 4.2)
