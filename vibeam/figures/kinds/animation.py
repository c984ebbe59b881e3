"""Figure kind ``animation``: the beam and its stop in motion, beside the point on the frequency response.

Deflections of beam and stop are drawn to one scale, which the panel states; the frame of reference is the base.
"""

from __future__ import annotations

from math import lcm
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.plans import ShowPlan
from vibeam.figures.beam_panel import BeamPanel, scale_of
from vibeam.figures.loop import LONGEST
from vibeam.figures.loop import loop_columns as columns  # noqa: F401
from vibeam.figures.moving import FRAMES_A_SECOND, Moving
from vibeam.figures.page import plain
from vibeam.figures.panels import is_empty, say, start_upward
from vibeam.figures.response import draw_branch
from vibeam.figures.sheet import Comparison, Sheet
from vibeam.figures.style import Look, looks_of, name_of
from vibeam.figures.units import frequency_label, motion_of, units_for, with_unit
from vibeam.system.number_text import FREQUENCIES, LENGTHS, prefixed
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D


WIDTH, HIGH, ROW, AROUND = 7.2, 3.7, 1.35, 1.4  # inches: of the page, of one beam's page, of a further beam, of titles
LEFT = 0.52  # share of the width that the beams have
FLASH = 0.06  # drive periods for which an impact is marked


def size(plan: ShowPlan) -> tuple[float, float]:
    """Beams above each other on the left, curve and history on the right."""
    return WIDTH, max(HIGH, AROUND + ROW * len(plan.fidelities))


def caption(plan: ShowPlan) -> str:
    """Caption of the figure."""
    reached = {"up": ", on the branch swept up", "down": ", on the branch swept down"}.get(
        plan.own["direction"] or "", ""
    )
    unit, factor = prefixed(FREQUENCIES, plan.frequency[0], usual=-1)
    return f"settled motion at {plan.frequency[0] * factor:.5g} {unit}{reached}, seen from the base"


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> Moving:
    """Draw the first frame; what is returned draws the others."""
    loop = Loop(shown)
    page = figure.add_gridspec(1, 2, width_ratios=(LEFT, 1 - LEFT))
    curve, history = page[1].subgridspec(2, 1, height_ratios=(1.25, 1)).subplots(squeeze=False)[:, 0]
    beams = page[0].subgridspec(len(plan.fidelities), 1).subplots(squeeze=False)[:, 0]
    _curve(curve, result, plan, loop)
    panels = _beams(figure, beams, result, plan, shown)
    cursor = _history(history, result, plan, loop)

    def turn(index: int) -> None:
        for sheet, panel in panels:
            at = index * loop.step(sheet) % len(sheet["time"])
            panel.set(at, loop.struck(sheet, at, FLASH))
        cursor.set_xdata([index / loop.each] * 2)

    moving = Moving(
        loop.periods * loop.each, turn, [cursor, *(artist for _, panel in panels for artist in panel.moving)]
    )
    turn(0)
    return moving


class Loop:
    """Common loop of the motions in ``sheets``: ``periods`` drive periods with ``each`` frames in one."""

    def __init__(self, sheets: tuple[Sheet, ...]) -> None:
        self.sheets = [sheet for sheet in sheets if not sheet.fault]
        own = [self.own(sheet) for sheet in self.sheets]
        common = lcm(*own)
        self.periods = common if common <= LONGEST else max(own, default=1)
        self.each = min((len(sheet["time"]) // self.own(sheet) for sheet in self.sheets), default=1)

    def own(self, sheet: Sheet) -> int:
        """Drive periods of one motion's loop."""
        return int(sheet["periods"][0])

    def step(self, sheet: Sheet) -> int:
        """Frames of a motion for one of the common loop."""
        return len(sheet["time"]) // self.own(sheet) // self.each

    def struck(self, sheet: Sheet, at: int, lasting: float) -> set[int]:
        """The stops struck up to ``lasting`` drive periods before the frame ``at`` of a motion's loop."""
        own = self.own(sheet)
        ago = np.mod(at * own / len(sheet["time"]) - sheet["impact_time"] * sheet.frequency, own)
        return set(sheet["impact_contact"][ago < lasting].astype(int).tolist())

    @property
    def seamless(self) -> bool:
        """True where every motion is where it began at the loop's end."""
        return all(sheet["seamless"][0] and self.periods % self.own(sheet) == 0 for sheet in self.sheets)


def _beams(
    figure: Figure, grid: Array, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]
) -> list[tuple[Sheet, BeamPanel]]:
    """A panel a fidelity, all to one scale; a note where there is no motion."""
    case, looks = result.case, looks_of(result.case, plan.fidelities)
    drawn = {sheet.fidelity: sheet for sheet in shown if not sheet.fault}
    longest = max((float(np.max(sheet["beam_position"])) for sheet in drawn.values()), default=1.0)
    largest = max((float(np.abs(sheet["beam_deflection"]).max()) for sheet in drawn.values()), default=0.0)
    units = prefixed(LENGTHS, longest), prefixed(LENGTHS, largest)
    room = (LEFT * figure.get_figwidth() - 0.6, (figure.get_figheight() - AROUND) / len(grid))
    panels = []
    for axes, name in zip(grid, plan.fidelities, strict=True):
        axes.set_title(plain(name_of(case, name)), color=looks[name].colour)
        if name not in drawn:
            say(axes, next(sheet.fault for sheet in shown if sheet.fidelity == name))
            continue
        scene: Any = case.scene_of(name)
        panel = BeamPanel(axes, drawn[name], Look(looks[name].colour), scene, *units)
        panels.append((drawn[name], panel))
    scale = scale_of([panel for _, panel in panels], room)
    for _, panel in panels:
        panel.fit(scale, room)
    grid[-1].set_xlabel(with_unit("along the beam", units[0][0]))
    for axes in grid:
        axes.set_ylabel(with_unit("deflection", units[1][0]))
    return panels


def _curve(axes: Axes, result: Comparison, plan: ShowPlan, loop: Loop) -> None:
    """Draw the frequency response of the fidelities, and the points of the motions on it."""
    units, looks = units_for(result), looks_of(result.case, plan.fidelities)
    for name, look in looks.items():
        for direction, response in result[name].items() if name in set(result) else ():
            draw_branch(axes, response, direction, look, units.frequency_factor, units.length_factor)
    for sheet in loop.sheets:
        at = sheet.frequency * units.frequency_factor
        height = sheet["amplitude"][0] * units.length_factor
        axes.axvline(at, color="0.6", linewidth=0.6, zorder=1)
        axes.plot(
            at, height, marker="o", markersize=6, color=looks[sheet.fidelity].colour, markeredgecolor="black", zorder=6
        )  # fmt: skip
    note = start_upward([axes])
    axes.set_xlabel(frequency_label(units))
    axes.set_ylabel("\n".join(filter(None, [motion_of(result.case.sweep.output, "amplitude", units), note])))


def _history(axes: Axes, result: Comparison, plan: ShowPlan, loop: Loop) -> Line2D:
    """Draw the contact's displacement over the loop with its impacts; the cursor is returned."""
    looks = looks_of(result.case, plan.fidelities)
    largest = max((float(np.abs(sheet["contact"]).max()) for sheet in loop.sheets), default=0.0)
    unit, factor = prefixed(LENGTHS, largest)
    for sheet in loop.sheets:
        look, own = looks[sheet.fidelity], loop.own(sheet)
        for begin in range(0, loop.periods, own):
            turns, hits = (sheet[name] * sheet.frequency + begin for name in ("history_time", "impact_time"))
            axes.plot(turns, sheet["contact"] * factor, **look.keys(1.0))
            height = np.interp(sheet["impact_time"], sheet["history_time"], sheet["contact"]) * factor
            axes.plot(hits, height, linestyle="", marker="*", markersize=6, color=look.colour, markeredgewidth=0)
    if is_empty(axes):
        say(axes, "no motion")
    axes.set_xlim(0, loop.periods)
    axes.set_xlabel(f"time in drive periods\n{_pace(loop, plan)}{'' if loop.seamless else '; does not repeat'}")
    axes.set_ylabel(with_unit("at the contact", unit))
    return axes.axvline(0.0, color="black", linewidth=0.9)


def _pace(loop: Loop, plan: ShowPlan) -> str:
    """Factor by which it is shown slower than the motion, to two digits."""
    slow = loop.each / FRAMES_A_SECOND * plan.frequency[0]
    times = float(f"{max(slow, 1 / slow):.2g}")
    number = f"{times:,.0f}".replace(",", " ") if times >= 10 else f"{times:g}"
    return f"shown {number} times {'slower' if slow >= 1 else 'faster'}"


def write(path: Path, plan: ShowPlan, shown: tuple[Sheet, ...], mark: str | None) -> None:
    """Write the loops as a VTU series: ``path`` is its PVD file."""
    from vibeam.exchange.vtu import write_series
    from vibeam.figures.loop import steps_of

    write_series(steps_of(shown), path, mark or "")
