"""Measured curves as they were read, in a panel each, with what is cut."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.report.output import SheetPicture
from vibeam.studies.measured_curves import measured_curves, measured_files
from vibeam.studies.measured_panel import MeasuredCurve, Orders, draw_curve, draw_orders

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.case.case import Case
    from vibeam.case.plans import FigurePlan

CAPTION = "measured data as read"


def case_pictures(case: Case) -> list[SheetPicture]:
    """Picture of the measured curves of a case, whose files are read when it is drawn; none where it names none."""
    draw = lambda: curves_figure(measured_curves(case), case.figure, case.title)  # noqa: E731
    return [SheetPicture("measured", CAPTION, draw, "_measured")] * any(measured_files(case))


def write_measured(case: Case, path: Path | None) -> list[Path]:
    """Files of a check: ``path`` of its references, the measured curves beside it; in its place without references."""
    if path is None:
        return []
    from vibeam.figures.page import write_page

    shown, own = case_pictures(case), [path] * bool(case.references)
    places = [path.with_stem(f"{path.stem}_measured") if own else path] * len(shown)
    for each in shown:
        write_page(each.draw, places)
    return own + places


def curves_figure(curves: Sequence[MeasuredCurve], plan: FigurePlan, title: str, orders: Orders = ()) -> Figure:
    """Panel of each curve, with crosses at the modes of fits with 1, 2, … modes: one that stays is one."""
    from vibeam.figures.page import blank_page, legend, plain, titled
    from vibeam.figures.panels import decades
    from vibeam.figures.style import COLOURS

    figure = blank_page((5.8, 2.4 * len(curves) + 1.2), plan)
    grid, drawn = figure.subplots(len(curves), squeeze=False)[:, 0], dict[str, Any]()
    for axes, curve in zip(grid, curves, strict=True):
        drawn |= draw_curve(axes, curve, COLOURS)
        if curve.fit is not None and not curve.timed:
            decades(axes, [np.ravel(curve.value)])
        axes.set_title(plain(curve.title), loc="left")
        axes.set_xlabel(plain(curve.labels[0]))
        axes.set_ylabel(plain(curve.labels[1]))
    if len(orders) > 1:
        drawn |= draw_orders(grid[0].twinx(), orders)
    titled(figure, plan, title, CAPTION)
    legend(figure, drawn)
    return figure
