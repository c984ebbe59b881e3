"""Error against CPU time: a colour a fidelity, a marker a solver, the Pareto front.

Left: error against the finest fidelity. Right: error of the solver alone, against the exact motion
of its own fidelity. Where the left-hand points of a colour form a column, the model's error dominates.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, NullLocator

from vibeam.case.held import held_of
from vibeam.figures.lettering import power_of_ten
from vibeam.figures.page import blank_page, legend, titled
from vibeam.figures.style import COLOURS, KEY, looks, name_of, shade
from vibeam.solvers import SOLVERS

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.studies.cost.row import RunRow
    from vibeam.studies.cost.study import CostStudy
    from vibeam.system.curves import Difference


JOINED: dict[str, Any] = {"RK23": "-", "RK45": "--", "DOP853": "-.", "LSODA": ":", "": "-"}
FRONT: dict[str, Any] = {"color": "0.8", "linewidth": 5.0, "zorder": 1.0, "solid_capstyle": "round"}
FLOOR = 1e-16  # position of an error of zero
WIDEST, EDGE = 6.0, 50.0  # position of larger errors and of failures
NAMED = {0: "100 %", -2: "1 %"}  # powers of ten that read better as plain numbers
Pick = Callable[["RunRow"], "Difference"]


def work_precision(study: CostStudy, case: Case) -> Figure:
    """Figure of a study of ``case``."""
    figure = blank_page((8.4, 5.4), case.figure)
    whole, own = figure.subplots(1, 2, sharey=True)
    colours = _colours(study, case)
    _panel(whole, study, colours, lambda row: row.total)
    _front(whole, study)
    _panel(own, study, colours, lambda row: row.numerical)
    whole.set_title(f"model and solver: against {study.finest}, exact", loc="left")
    own.set_title("solver alone: against its own model, exact", loc="left")
    whole.set_ylabel("CPU time of a frequency (s)")
    for axes in (whole, own):
        _scale(axes, study)
        axes.set_xlabel("root mean square error of amplitude")
    titled(figure, case.figure, study.title, f"what accuracy costs, {held_of(case.scene).label}")
    legend(figure, _legend(study, case, colours))
    return figure


def _colours(study: CostStudy, case: Case) -> dict[str, Any]:
    """Colour of each fidelity as in all figures, then of the truncated models; a second round is lighter."""
    names = dict.fromkeys([*case.fidelities, *(row.fidelity for row in study.rows)])
    shown = {row.fidelity for row in study.rows}
    shades = ("up", "down")
    return {
        name: shade(own.colour, shades[place // len(COLOURS) % 2])
        for place, (name, own) in enumerate(looks(names))
        if name in shown
    }


def _panel(axes: Axes, study: CostStudy, colours: dict[str, Any], pick: Pick) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    for (fidelity, solver, method), rows in _ladders(study).items():
        points = np.array([_point(row, pick) for row in rows])
        drawn = points[:, 0] < WIDEST
        whole = np.array([row.found == len(study.frequency) for row in rows])
        look: dict[str, Any] = {"color": colours[fidelity], "linewidth": 0.7, "linestyle": JOINED.get(method, "-")}
        axes.plot(*points[drawn].T, **look, alpha=0.55, zorder=2)
        _marks(axes, points[drawn & whole], solver, colours[fidelity], full=True)
        _marks(axes, points[~(drawn & whole)], solver, colours[fidelity], full=False)


def _scale(axes: Axes, study: CostStudy) -> None:
    """Scale both panels alike: from a decade below the least error to failures."""
    errors = [each.rms for row in study.rows for each in (row.total, row.numerical)]
    least = max(min([error for error in errors if error > 0], default=1e-3) / 10, FLOOR)
    axes.axvline(WIDEST, color="0.5", linewidth=0.6, linestyle=(0, (2, 2)))
    powers = [power for power in range(-16, 1, 2) if 10.0**power > least]
    axes.xaxis.set_major_locator(FixedLocator([*(10.0**power for power in powers), EDGE]))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_xticklabels([*(NAMED.get(power, power_of_ten(power)) for power in powers), "failed"])
    axes.set_xlim(least, 4 * EDGE)
    axes.grid(which="major", color="0.93", linewidth=0.5, zorder=0)
    axes.set_axisbelow(True)


def _ladders(study: CostStudy) -> dict[tuple[str, str, str], list[RunRow]]:
    """Rows joined by one line: a solver's settings on one fidelity."""
    found: dict[tuple[str, str, str], list[RunRow]] = {}
    for row in study.rows:
        found.setdefault((row.fidelity, row.solver, row.method), []).append(row)
    return found


def _point(row: RunRow, pick: Pick) -> tuple[float, float]:
    """Error and time; failures, and values beyond the axis, at its right-hand edge; what was given up: time used."""
    error, seconds = pick(row).rms, row.seconds if row.computed else row.used
    return (float(max(error, FLOOR)) if np.isfinite(error) and error < WIDEST else EDGE), max(seconds, 1e-9)


def _marks(axes: Axes, points: Any, solver: str, colour: Any, full: bool) -> None:
    if not len(points):
        return
    shape, size = SOLVERS[solver].marker
    face = colour if full else "white"
    axes.plot(*points.T, linestyle="", marker=shape, markersize=size, markerfacecolor=face, markeredgecolor=colour,
              markeredgewidth=0.7, zorder=3)  # fmt: skip


def _front(axes: Axes, study: CostStudy) -> None:
    """Draw the Pareto front as a staircase: nothing lies below and left of it."""
    points = np.array([_point(study.rows[i], lambda row: row.total) for i in study.front]).reshape(-1, 2)
    if len(points):
        axes.step(points[:, 0], points[:, 1], where="post", **FRONT)


def _legend(study: CostStudy, case: Case, colours: dict[str, Any]) -> list[Line2D]:
    modes = {row.fidelity: row.modes for row in study.rows}
    handles = [
        Line2D([], [], color=colour, linewidth=2.5, label=_called(case, name, modes[name]))
        for name, colour in colours.items()
    ]
    grey = KEY | {"linewidth": 0.0, "markerfacecolor": "0.25"}
    for solver, declaration in SOLVERS.items():
        if any(row.solver == solver for row in study.rows):
            shape, size = declaration.marker
            handles.append(Line2D([], [], label=solver, **(grey | {"marker": shape, "markersize": size})))
    methods = [method for method in JOINED if method and any(row.method == method for row in study.rows)]
    handles += [Line2D([], [], color="0.25", linewidth=0.9, linestyle=JOINED[each], label=each) for each in methods]
    handles.append(Line2D([], [], **FRONT, label="Pareto front"))
    if any(row.found < len(study.frequency) for row in study.rows):
        open_mark = grey | {"marker": "o", "markersize": 4.5, "markerfacecolor": "white"}
        handles.append(Line2D([], [], label="open: some frequencies without a motion, or given up", **open_mark))
    return handles


def _called(case: Case, name: str, modes: int) -> str:
    label = name_of(case, name)
    return label if label != name else f"{name} ({modes} mode{'s' * (modes > 1)})"
