"""Figure kind ``shapes``: mode shapes of each fidelity, a solid shaded, a beam as its line, all to one scale.

A row is a mode of the solid with most modes, or of the beam with most; beside it stand the modes of the others that
have the same shape along the beam, by the modal assurance criterion |aᵀb|²/(aᵀa bᵀb) of the sections' mean deflections.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure, FigureBase

from vibeam.case.beam_field import field_system, fields
from vibeam.case.case import Case
from vibeam.case.fidelity import Fidelity
from vibeam.case.plans import ShowPlan
from vibeam.figures.panels import say
from vibeam.figures.shading import picture, projected
from vibeam.figures.sheet import Column, Columns, Comparison, Sheet, sheet_of
from vibeam.figures.style import name_of
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.number_text import with_unit
from vibeam_models.arrays import Array
from vibeam_models.registry import loaded
from vibeam_models.scene import AnyScene, Scene

MOST = 4  # modes of a fidelity
ALIKE = 0.5  # of the criterion, from which on two modes are one
BENT = 0.05  # share of the largest displacement below which the sections' mean is not deflected
SIZE = 0.15  # of the largest displacement, in lengths of the beam
LINES = {f"{beam}_position": f"{beam}_deflection" for beam in ("beam", "opposite")}
PIXELS = 900  # along the beam
DARKEST = 0.25  # of cividis, even in brightness, also to the colour-blind: darker colours hide the shade
caption = "mode shapes to one scale"


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One sheet, by frequency."""
    return [sheet_of(fidelity, lambda: _columns(case.scene_of(fidelity), case.fidelities[fidelity]))]


def _columns(scene: AnyScene, fidelity: Fidelity) -> Columns:
    found = dict[str, Column]()
    if scene.in_three_dimensions:
        system, pointed, bodies = loaded(scene.spatial).solid_system(scene, fidelity)
        order = np.argsort(system.omega)[:MOST]
        surfaces = [body.surface for body in bodies.values()]
        points = np.concatenate([each.points for each in surfaces])
        before = np.cumsum([0, *(len(each.points) for each in surfaces)])
        triangles = np.concatenate([each.triangles + at for each, at in zip(surfaces, before, strict=False)])
        turn = np.eye(3) if isinstance(pointed, Scene) else _lying(points)
        moved = np.concatenate([each.displacement(np.eye(system.size)[:, order]) for each in surfaces], axis=1)
        found["surface_point"] = Column(points @ turn, "m", "places (k, 3) on the surfaces of the bodies at rest")
        found["surface_triangle"] = Column(triangles.astype(float), "1", "points (t, 3) of their triangles")
        found["surface_displacement"] = Column(moved @ turn, "1", "displacements (modes, k, 3), mass-normalised, kg^-½")
    else:
        system, pointed = field_system(scene, fidelity)
        order = np.argsort(system.omega)[:MOST]
    found["mode_frequency"] = Column(system.omega[order] / (2 * np.pi), "Hz", "natural frequency of the mode")
    lines = fields(pointed, system) if isinstance(pointed, Scene) else {}  # a mesh of one's own has none
    for name, line in lines.items():
        found[f"{name}_position"] = Column(line.positions, "m", "places along it")
        found[f"{name}_deflection"] = Column(line.deflection.T[order], "1", "of its sections (modes, k), kg^-½")
    for other in pointed.named("opposite") if lines else ():
        along, across = pointed.stop.position - other.position - other.arm, pointed.stop.gap
        across += sum(float(np.nanmax(line.height, initial=0.0)) / 2 for line in lines.values())
        found["opposite_place"] = Column(np.array([along, across]), "m", "of the opposite beam, along and across")
    return found


def _lying(points: Array) -> Array:
    """Turn (3, 3) by whole axes that lays a body's longest side along x and its shortest along z."""
    turn = np.eye(3)[:, np.argsort(-np.ptp(points, axis=0))]
    return np.asarray(turn * [1, np.linalg.det(turn), 1])


def refusal(case: Case, fidelity: str, system: ImpactSystem) -> str:
    """Why a fidelity has no shapes: it has neither a beam nor a body; empty where it has."""
    scene = case.scene_of(fidelity)
    return "" if isinstance(scene, Scene) or scene.in_three_dimensions else f"no shapes to draw: {scene.no_beam}"


def size(plan: ShowPlan) -> tuple[float, float]:
    """A column a fidelity, a row a mode."""
    return 2.1 * len(plan.fidelities) + 1.1, 1.25 * MOST + 0.6


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw a panel for each mode of each fidelity; dashed: the axis of the beam at rest."""
    draw_modes(figure, result.case, shown)


def draw_modes(figure: FigureBase, case: Case, shown: Sequence[Sheet]) -> None:
    """Draw these sheets in a figure or a part of one, a column each under the name of a fidelity."""
    known = [sheet for sheet in shown if not sheet.fault]
    if not known:
        say(figure.subplots(), shown[0].fault if shown else "nothing to show")
        return
    lead = max(known, key=lambda sheet: ("surface_point" in sheet.columns, len(sheet["mode_frequency"])))
    grid = figure.subplots(len(lead["mode_frequency"]), len(known), squeeze=False)
    length = max(float(np.ptp(each["beam_position"])) if _has_line(each) else _longest(each) for each in known)
    for column, sheet in zip(grid.T, known, strict=True):
        pairs = pairs_of(lead, sheet)
        for row, panel in enumerate(column):
            _panel(panel, sheet, pairs.get(row), length)
        column[0].set_title(f"{name_of(case, sheet.fidelity)}\n{column[0].get_title()}", fontsize="medium")
    _share_limits(grid.ravel().tolist())
    _scale_of_colours(figure, grid.ravel().tolist())


def _has_line(sheet: Sheet) -> bool:
    return "beam_position" in sheet.columns


def pairs_of(lead: Sheet, other: Sheet) -> dict[int, int]:
    """Mode of ``other`` by that of ``lead`` where each is the likest of the other; of a mesh of one's own by number."""
    rows, columns = len(lead["mode_frequency"]), len(other["mode_frequency"])
    if lead is other or not (_has_line(lead) and _has_line(other)):
        return {mode: mode for mode in range(min(rows, columns))}
    both = [(place, line) for place, line in LINES.items() if place in lead.columns and place in other.columns]
    own = np.concatenate(
        [[np.interp(other[place], lead[place], mode) for mode in lead[line]] for place, line in both], axis=1
    )
    each = np.concatenate([other[line] for _, line in both], axis=1)
    sizes = np.sum(own**2, axis=1)[:, None] * np.sum(each**2, axis=1)
    alike = (own @ each.T) ** 2 / np.maximum(sizes, 1e-300)
    alike[[np.abs(line).max() < BENT * largest(lead, mode) for mode, line in enumerate(own)]] = 0
    best = alike.argmax(axis=1)
    return {
        row: int(mode) for row, mode in enumerate(best) if alike[row, mode] >= max(ALIKE, float(alike[:, mode].max()))
    }


def largest(sheet: Sheet, mode: int) -> float:
    """Largest displacement of a mode, of the bodies or of the lines."""
    if "surface_displacement" in sheet.columns:
        return float(np.linalg.norm(sheet["surface_displacement"][mode], axis=1).max())
    return max(float(np.abs(sheet[name][mode]).max()) for name in LINES.values() if name in sheet.columns) or 1.0


def _longest(sheet: Sheet) -> float:
    """Longest side of a body, m."""
    return float(np.ptp(sheet["surface_point"], axis=0).max())


def _panel(axes: Axes, sheet: Sheet, mode: int | None, length: float) -> None:
    axes.set_axis_off()
    axes.set_aspect("equal")
    if _has_line(sheet):
        rest = projected(np.array([[0.0, 0.0, 0.0], [length, 0.0, 0.0]]))
        axes.plot(*rest.T[:2], color="0.5", linestyle=(0, (4, 3)), linewidth=0.6, zorder=0)
    if mode is None:
        axes.set_title("no such bending", fontsize="small", color="0.35")
        return
    axes.set_title(f"mode {mode + 1}, {with_unit(sheet['mode_frequency'][mode], 'Hz')}", fontsize="small")
    line = sheet["beam_deflection"][mode] if _has_line(sheet) else np.ones(1)
    factor = (-1 if line[np.argmax(np.abs(line))] < 0 else 1) / largest(sheet, mode)
    if "surface_point" in sheet.columns:
        _body(axes, sheet, factor * sheet["surface_displacement"][mode], length)
        return
    for position, deflection in LINES.items():
        if position in sheet.columns:
            place = sheet["opposite_place"] if position.startswith("opposite") else (0.0, 0.0)
            _line(axes, sheet[position] + place[0], factor * sheet[deflection][mode], length, place[1])


def _body(axes: Axes, sheet: Sheet, moved: Array, length: float) -> None:
    """Draw the surface, in the colours of its displacement, shares of the largest."""
    places = sheet["surface_point"] + SIZE * length * moved
    colours = _colours()(np.linalg.norm(moved, axis=1))[:, :3]
    made = picture(places, sheet["surface_triangle"].astype(np.int64), colours, length / PIXELS)
    axes.imshow(made.pixels, extent=made.extent, interpolation="antialiased", zorder=2, aspect="equal")
    axes.update_datalim([made.extent[::2], made.extent[1::2]])


def _colours() -> Any:
    return ListedColormap(colormaps["cividis"](np.linspace(DARKEST, 1.0, 256)))


def _line(axes: Axes, positions: Array, deflection: Array, length: float, across: float) -> None:
    """Draw the line of a beam, in the same colours."""
    places = np.stack([positions, 0 * positions, across + SIZE * length * deflection], axis=1)
    at = projected(places)[:, :2]
    middle = np.abs(deflection[1:] + deflection[:-1]) / 2
    pieces = list(np.stack([at[:-1], at[1:]], axis=1))
    drawn = LineCollection(pieces, cmap=_colours(), linewidths=2.4, capstyle="round")
    drawn.set_array(middle)
    drawn.set_clim(0.0, 1.0)
    axes.add_collection(drawn)
    axes.update_datalim(at)


def _share_limits(panels: list[Axes]) -> None:
    """The same limits in all panels, so that one length is the same everywhere."""
    boxes = [axes.dataLim for axes in panels]
    low, high = np.min([box.min for box in boxes], axis=0), np.max([box.max for box in boxes], axis=0)
    edge = 0.03 * float((high - low)[0])
    for axes in panels:
        axes.set_xlim(low[0] - edge, high[0] + edge)
        axes.set_ylim(low[1] - edge, high[1] + edge)


def _scale_of_colours(figure: FigureBase, panels: list[Axes]) -> None:
    mapped = ScalarMappable(Normalize(0.0, 1.0), _colours())
    figure.colorbar(mapped, ax=panels, label="displacement over the largest", shrink=0.6, aspect=30, pad=0.02)
