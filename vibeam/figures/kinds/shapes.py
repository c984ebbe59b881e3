"""Figure kind ``shapes``: mode shapes of each fidelity, a solid shaded, a beam as its line, all to one scale.

A row is a mode of the solid with most modes, or of the beam with most; beside it stand the modes of the others that
have the same shape along the beam, by the modal assurance criterion |aᵀb|²/(aᵀa bᵀb) of the sections' mean deflections.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.beam_field import field_system, fields
from vibeam.case.plans import ShowPlan
from vibeam.figures.panels import say
from vibeam.figures.shading import picture, projected
from vibeam.figures.sheet import Column, Columns, Comparison, Sheet, sheet_of
from vibeam.figures.style import name_of
from vibeam.figures.units import units_of
from vibeam_models.arrays import Array
from vibeam_models.scene import Scene

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase

    from vibeam.case.case import Case
    from vibeam.case.fidelity import Fidelity
    from vibeam.figures.units import DisplayUnits
    from vibeam.system.impact_system import ImpactSystem
    from vibeam_models.scene import AnyScene

MOST = 4  # modes of a fidelity
ALIKE = 0.5  # of the criterion, from which on two modes are one
BENT = 0.05  # share of the largest displacement below which the sections' mean is not deflected
SIZE = 0.15  # of the largest displacement, in lengths of the beam
PIXELS = 900  # along the beam
DARKEST = 0.25  # of cividis, even in brightness, also to the colour-blind: darker colours hide the shade


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One sheet, by frequency."""
    return [shapes_of(fidelity, case.scene_of(fidelity), case.fidelities[fidelity])]


def shapes_of(name: str, scene: AnyScene, fidelity: Fidelity) -> Sheet:
    """Sheet of a ``scene`` reduced as a fidelity says, by frequency."""
    return sheet_of(name, lambda: _columns(scene, fidelity))


def _columns(scene: AnyScene, fidelity: Fidelity) -> Columns:
    found = dict[str, Column]()
    if scene.in_three_dimensions:
        from vibeam.case.solid_shape import solid_system

        system, pointed, bodies = solid_system(scene, fidelity)
        order, surface = np.argsort(system.omega)[:MOST], next(iter(bodies.values())).surface
        turn = np.eye(3) if isinstance(pointed, Scene) else _lying(surface.points)
        moved = surface.displacement(np.eye(system.size)[:, order]) @ turn
        found["surface_point"] = Column(surface.points @ turn, "m", "places (k, 3) on the surface of the body at rest")
        found["surface_triangle"] = Column(surface.triangles.astype(float), "1", "points (t, 3) of its triangles")
        found["surface_displacement"] = Column(moved, "1", "displacements (modes, k, 3), mass-normalised, kg^-½")
    else:
        system, pointed = field_system(scene, fidelity)
        order = np.argsort(system.omega)[:MOST]
    found["mode_frequency"] = Column(system.omega[order] / (2 * np.pi), "Hz", "natural frequency of the mode")
    if not isinstance(pointed, Scene):  # a mesh of one's own has no line
        return found
    line = fields(pointed, system)["beam"]
    return found | {
        "position": Column(line.positions, "m", "places along the beam"),
        "deflection": Column(line.deflection.T[order], "1", "of the sections (modes, k), mass-normalised, kg^-½"),
    }


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


def caption(plan: ShowPlan) -> str:
    """Caption of the figure."""
    return "mode shapes to one scale"


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
    length = max(float(np.ptp(each.of("position"))) if "position" in each.columns else _longest(each) for each in known)
    for row, axes in enumerate(grid):
        for panel, sheet in zip(axes, known, strict=True):
            mode = row if sheet is lead else _same(lead, row, sheet)
            _panel(panel, sheet, mode, length, units_of(case))
    for panel, sheet in zip(grid[0], known, strict=True):
        panel.set_title(f"{name_of(case, sheet.fidelity)}\n{panel.get_title()}", fontsize="medium")
    _share_limits(grid.ravel().tolist())
    _scale_of_colours(figure, grid.ravel().tolist())


def _same(lead: Sheet, row: int, other: Sheet) -> int | None:
    """The mode of another sheet with the shape of mode ``row`` of ``lead``; None: there is none, as of torsion.

    Of a mesh of one's own the mode of the same number.
    """
    if not {"position"} <= lead.columns.keys() & other.columns.keys():
        return row if row < len(other["mode_frequency"]) else None
    own = np.interp(other["position"], lead["position"], lead["deflection"][row])
    if np.abs(own).max() < BENT * _largest(lead, row):
        return None
    each = other["deflection"]
    alike = (each @ own) ** 2 / np.maximum(np.sum(each**2, axis=1) * (own @ own), 1e-300)
    best = int(np.argmax(alike))
    return best if alike[best] >= ALIKE else None


def _largest(sheet: Sheet, mode: int) -> float:
    """Largest displacement of a mode, of the body or of the line."""
    if "surface_displacement" in sheet.columns:
        return float(np.linalg.norm(sheet["surface_displacement"][mode], axis=1).max())
    return float(np.abs(sheet["deflection"][mode]).max()) or 1.0


def _longest(sheet: Sheet) -> float:
    """Longest side of a body, m."""
    return float(np.ptp(sheet["surface_point"], axis=0).max())


def _panel(axes: Axes, sheet: Sheet, mode: int | None, length: float, units: DisplayUnits) -> None:
    axes.set_axis_off()
    axes.set_aspect("equal")
    if "position" in sheet.columns:
        rest = projected(np.array([[0.0, 0.0, 0.0], [length, 0.0, 0.0]]))
        axes.plot(*rest.T[:2], color="0.5", linestyle=(0, (4, 3)), linewidth=0.6, zorder=0)
    if mode is None:
        axes.set_title("no such bending", fontsize="small", color="0.35")
        return
    frequency = sheet["mode_frequency"][mode] * units.frequency_factor
    axes.set_title(f"mode {mode + 1}, {frequency:.4g} {units.frequency}".rstrip(), fontsize="small")
    line = sheet["deflection"][mode] if "position" in sheet.columns else np.ones(1)
    factor = (-1 if line[np.argmax(np.abs(line))] < 0 else 1) / _largest(sheet, mode)
    if "surface_point" in sheet.columns:
        _body(axes, sheet, factor * sheet["surface_displacement"][mode], length)
    else:
        _line(axes, sheet["position"], factor * line, length)


def _body(axes: Axes, sheet: Sheet, moved: Array, length: float) -> None:
    """Draw the surface, in the colours of its displacement, shares of the largest."""
    places = sheet["surface_point"] + SIZE * length * moved
    colours = _colours()(np.linalg.norm(moved, axis=1))[:, :3]
    made = picture(places, sheet["surface_triangle"].astype(np.int64), colours, length / PIXELS)
    axes.imshow(made.pixels, extent=made.extent, interpolation="antialiased", zorder=2, aspect="equal")
    axes.update_datalim([made.extent[::2], made.extent[1::2]])


def _colours() -> Any:
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    return ListedColormap(colormaps["cividis"](np.linspace(DARKEST, 1.0, 256)))


def _line(axes: Axes, positions: Array, deflection: Array, length: float) -> None:
    """Draw the line of a beam, in the same colours."""
    from matplotlib.collections import LineCollection

    places = np.stack([positions, 0 * positions, SIZE * length * deflection], axis=1)
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
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    mapped = ScalarMappable(Normalize(0.0, 1.0), _colours())
    figure.colorbar(mapped, ax=panels, label="displacement over the largest", shrink=0.6, aspect=30, pad=0.02)
