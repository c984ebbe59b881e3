"""Page of a record case: history with zoom, impact velocities, energies, spectra, what the factor does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from vibeam.figures.record import kept_place, plan_of
from vibeam.figures.record_history import SIZE, draw_histories
from vibeam.report.page.energies import energy_bars
from vibeam.report.page.page import PAGE_BYTES, standing
from vibeam.report.page.parts import Picture, as_json, picture, rendered
from vibeam.report.page.record_charts import record_data

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.report.output import StudySheet
    from vibeam.runs.transient.result import TransientResult

VIEWS = ("numbers", "chart", "envelope", "record", "zoom", "timeline", "families")


def record_page(
    result: TransientResult, verdict: StudySheet, provenance: Mapping[str, str], left_out: Sequence[str] = ()
) -> str:
    """The page as HTML, ``verdict`` above; CaseError where a model of the case cannot be built any more."""
    history = picture("history", "Histories of all fidelities over time", lambda: history_figure(result))
    data = record_data(result)
    text = as_json(data)
    modes = max((each.modes for each in result.values()), default=0)
    values = standing(result, modes, provenance, left_out, PAGE_BYTES - len(text) - len(history.data))
    return rendered(
        "record.html",
        ("state", "saving", *VIEWS, "start"),
        **values,
        missing=result.missing,
        verdict=verdict,
        response=history,
        velocities=_velocities(result),
        drawn_motion=_drawn_motion(result),
        bins=_bins(data["histories"]),
        energies=energy_bars(result),
        factor=result.over if len(result.factors) > 1 else "",
        data=text,
    )


def history_figure(result: TransientResult) -> Figure:
    """Figure of the histories of all fidelities, with the title of the case."""
    from vibeam.figures.page import blank_page, legend, titled
    from vibeam.report.figures import handles_of

    made = blank_page(SIZE, result.case.figure)
    draw_histories(made, result, list(result), plan_of(result.case).outputs[0])
    titled(made, result.case.figure, result.case.title, _drawn_motion(result))
    legend(made, handles_of(made))
    return made


def _velocities(result: TransientResult) -> Picture:
    from vibeam.case.plans import ShowPlan
    from vibeam.figures.kinds import impact_velocities
    from vibeam.figures.page import blank_page

    plan = ShowPlan(name="velocities", kind="impact_velocities", key="", fidelities=tuple(result))

    def make() -> Figure:
        made = blank_page(impact_velocities.size(plan), result.case.figure)
        impact_velocities.draw(made, result, plan, ())
        return made

    return picture("impact velocities", "Impacts a second that are harder than a velocity", make)


def _drawn_motion(result: TransientResult) -> str:
    """Sentence on the motion that is drawn of several; empty of one alone."""
    parts = []
    if len(result.factors) > 1:
        parts.append(f"{result.over} {result.factors[kept_place(result)]:g}")
    if len(result.seeds) > 1:
        parts.append(f"seed {result.seeds[0]}")
    return f"Drawn: the motions at {', '.join(parts)}." if parts else ""


def _bins(histories: Sequence[Mapping[str, object]]) -> str:
    widths = [float(str(each["width"])) for each in histories]
    return f"each bin of {1e3 * max(widths):.3g} ms" if widths else "each bin"
