"""Page of a record case: history with zoom, impact velocities, energies, spectra, what the factor does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from vibeam.case.plans import ShowPlan
from vibeam.exchange.faults import CaseError
from vibeam.figures.kinds import impact_velocities
from vibeam.figures.page import blank_page
from vibeam.figures.record import drawn_motion
from vibeam.report.page.energies import energy_bars
from vibeam.report.page.parts import Picture, as_json, picture, rendered
from vibeam.report.page.record_charts import record_data
from vibeam.report.page.standing import PAGE_BYTES, standing
from vibeam.report.record_figure import record_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.report.output import StudySheet
    from vibeam.runs.stored_result import StoredResult
    from vibeam.runs.systems import Overview
    from vibeam.runs.transient.result import TransientResult

STILL = 110  # columns of a panel of the still picture
VIEWS = ("base64", "numbers", "chart", "envelope", "record", "zoom", "timeline", "families")


def record_page(stored: StoredResult, sections: Mapping[str, StudySheet]) -> str:
    """The page as HTML, ``sections`` of extensions in it; CaseError where a model of the case cannot be built."""
    from vibeam.report.transient import transient_report

    result: Any = stored.result
    history = picture("history", "Histories of all fidelities over time", lambda: record_figure(result, STILL))
    velocities = _velocities(result)
    data = record_data(result)
    text = as_json(data)
    room = PAGE_BYTES - len(text) - len(history.data) - len(velocities.data)
    modes = max((each.modes for each in result.values()), default=0)
    return rendered(
        "record.html",
        ("state", "saving", *VIEWS, "start"),
        **standing(result, modes, _overview(result), stored.provenance, stored.left_out, room),
        missing=stored.missing,
        verdict=transient_report(result),
        response=history,
        velocities=velocities,
        drawn_motion=drawn_motion(result),
        bins=_bins(data["histories"]),
        energies=energy_bars(result),
        factor=result.over if len(result.factors) > 1 else "",
        data=text,
        sections=list(sections.items()),
    )


def _overview(result: TransientResult) -> Overview | None:
    """Rig and load in a sentence; None where a file of the load is not there any more."""
    from vibeam.runs.transient.motions import MotionMaker
    from vibeam.runs.transient.overview import overview_of_record

    try:
        return overview_of_record({name: MotionMaker(result.case, name) for name in result}, result.total)
    except CaseError:
        return None


def _velocities(result: TransientResult) -> Picture:
    plan = ShowPlan(name="velocities", kind="impact_velocities", key="", fidelities=tuple(result))

    def make() -> Figure:
        made = blank_page(impact_velocities.size, result.case.figure)
        impact_velocities.draw(made, result, plan, ())
        return made

    return picture("impact velocities", "Impacts a second that are harder than a velocity", make)


def _bins(histories: Sequence[Mapping[str, Any]]) -> str:
    """Width of the bins of the histories on the page, of the first output, around the marks too."""
    first = next((each["signal"] for each in histories if each["signal"] != "input"), "")
    own = [float(each["width"]) for each in histories if each["signal"] == first]
    if not own:
        return "each bin"
    close = f", around the marks of {1e3 * min(own):.3g} ms" if min(own) < 0.9 * max(own) else ""
    return f"each bin of {1e3 * max(own):.3g} ms{close}"
