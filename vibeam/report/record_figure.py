"""Figure of the histories of a record case, with title and legend."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vibeam.case.case import plan_of_record
from vibeam.figures.record import COLUMNS, RecordResult, drawn_motion

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def record_figure(result: RecordResult, columns: int = COLUMNS) -> Figure:
    """Figure of the histories of all fidelities of a record case, with at most so many ``columns`` a panel."""
    from vibeam.figures.page import blank_page, legend, titled
    from vibeam.figures.record_history import SIZE, draw_histories

    case = result.case
    made = blank_page(SIZE, case.figure)
    draw_histories(made, result, list(result), plan_of_record(case).outputs[0], columns=columns)
    titled(made, case.figure, case.title, drawn_motion(result))
    legend(made, handles_of(made))
    return made


def handles_of(made: Figure) -> dict[str, Any]:
    """Labelled curves of all panels, each label once."""
    found: dict[str, Any] = {}
    for axes in made.axes:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    return found
