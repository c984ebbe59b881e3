"""Bifurcation diagram: the output at the end of each drive period over one axis, with motions known in closed form."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from vibeam.figures.page import plain
from vibeam.figures.style import COLOURS, name_of, shade
from vibeam.figures.units import motion_of, units_of
from vibeam.maps.closed_form import ClosedForm, closed_form_strobes
from vibeam.maps.run import MapResult
from vibeam.report.maps.labels import shown_axis
from vibeam_models.arguments import counted

SIZES = {"up": 1.3, "down": 2.6, "apart": 1.3}
STABLE: dict[str, Any] = {"color": "black", "linestyle": "-"}
UNSTABLE = {1: COLOURS[1], 2: COLOURS[3], 4: COLOURS[2]}  # by impacts, dashed


def size_of(result: MapResult) -> tuple[float, float]:
    """A panel a fidelity, one below the other."""
    return 6.4, 1.3 + 2.9 * len(result.responses)


def bifurcation(figure: Figure, result: MapResult, exact: bool) -> tuple[list[Any], list[str]]:
    """Draw the points of every way, the downward ones larger and behind; legend and notes."""
    plan, count = result.plan, len(result.responses)
    grid = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    across = shown_axis(result.case, plan.axes[-1])
    sizes = [np.nanmax(np.abs(each.values["strobes"]), initial=0.0) for each in result.responses.values()]
    units = units_of(result.case, length=float(max(sizes)))
    handles: dict[str, Any] = {}
    notes: dict[str, None] = {}
    for axes, (fidelity, response) in zip(grid, result.responses.items(), strict=True):
        x = response.axes[across.key] * across.factor
        for number, way in reversed(list(enumerate(response.ways))):
            strobes = response.values["strobes"][number] * units.length_factor
            look: dict[str, Any] = {
                "linestyle": "", "marker": ".", "markersize": SIZES[way], "markeredgewidth": 0,
                "color": shade(COLOURS[0], "up" if way == "apart" else way),
            }  # fmt: skip
            axes.plot(np.repeat(x, strobes.shape[-1]), strobes.ravel(), rasterized=True, **look)
            called = "each point from its own start" if way == "apart" else f"sweep {way}"
            handles[way] = Line2D([], [], **(look | {"markersize": 5.0}), label=called)
        if exact:
            found, why = closed_form_strobes(result.case, plan, fidelity)
            _lines(axes, found, across.factor, units.length_factor, handles)
            if why:
                notes[why] = None
        if len(x) > 1:
            axes.set_xlim(x.min(), x.max())
        axes.set_ylabel(motion_of(plan.output, "displacement", units))
        if count > 1:
            axes.set_title(plain(name_of(result.case, fidelity)))
    grid[-1].set_xlabel(across.label)
    first = [each for each in ("up", "down", "apart", "exact, stable") if each in handles]
    return [handles[each] for each in dict.fromkeys([*first, *handles])], list(notes)


def _lines(axes: Any, found: list[ClosedForm], across: float, upward: float, handles: dict[str, Any]) -> None:
    """Draw periodic motions: full where they are stable, dashed, up to the next stable point, where not."""
    for each in sorted(found, key=lambda branch: branch.impacts):
        beside = each.stable.copy()
        beside[1:] &= each.stable[:-1]
        beside[:-1] &= each.stable[1:]
        struck = f"{counted(each.impacts, 'impact')} in {counted(each.periods, 'period')}"
        dashed = {"color": UNSTABLE[each.impacts], "linestyle": (0, (3, 1.5))}
        for name, shown, look in (
            ("exact, stable", each.stable, STABLE),
            (f"exact, unstable: {struck}", ~beside, dashed),
        ):
            values = np.where(shown[:, None], each.strobes, np.nan) * upward
            if np.isfinite(values).any():
                axes.plot(each.values * across, joined(values), linewidth=0.7, **look)
                handles[name] = Line2D([], [], linewidth=1.0, label=name, **look)


def joined(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values (points, k) cut where a line would jump by more than a tenth of all."""
    span = np.nanmax(values) - np.nanmin(values)
    if not span:
        return values
    jumps = np.abs(np.diff(values, axis=0)) > 0.1 * span
    cut = values.copy()
    cut[1:][jumps] = np.nan
    return cut
