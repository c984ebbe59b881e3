"""Panel of a beam in motion: centre line, supports, masses, stops, and marks of impacts, deflections to one scale."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, inf, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.figures.loop import opposite_places
from vibeam.figures.sheet import Sheet
from vibeam.figures.style import Look
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

    from vibeam_models.scene import Scene


FAR = 3.0  # distance of a stop, in largest deflections, beyond which it is not drawn
TIP = {1.0: 7, -1.0: 6}  # carets whose tip is the point: of a stop above the beam, and of one below
ROOM = 1.3  # height of a panel over the range of all that moves in it
STEPS = (5.0, 2.0, 1.0)  # first digits of a scale
Unit = tuple[str, float]


class BeamPanel:
    """One fidelity's beam on its axes; lengths along it in ``along``, deflections in ``across`` (unit, factor)."""

    def __init__(self, axes: Axes, sheet: Sheet, look: Look, scene: Scene, along: Unit, across: Unit) -> None:
        self.axes, self.sheet, self.along, self.across = axes, sheet, along, across
        self.lift = float(sheet["stop_height"][0]) if "met" in sheet.columns else 0.0
        self._at_rest(scene)
        colour: dict[str, Any] = {"color": look.colour}
        (self.beam,) = axes.plot([], [], linewidth=2.0, solid_capstyle="butt", **colour)
        (self.masses,) = axes.plot([], [], linestyle="", marker="s", markersize=8, **colour)
        (self.other,) = axes.plot([], [], linewidth=2.0, color="0.35")
        (self.met,) = axes.plot([], [], linewidth=1.0, color="0.35", marker=TIP[1.0], markevery=[-1], markersize=7)
        self.stops = self._stops()
        (self.flash,) = axes.plot([], [], linestyle="", marker="*", markersize=26, color="#E69F00", zorder=1.5,
                                  markeredgecolor="black", markeredgewidth=0.5)  # fmt: skip
        self.weights = np.array([x for _, x in scene.weights])
        theirs: list[Artist] = [self.other, self.met] if "met" in sheet.columns else []
        self.moving: list[Artist] = [self.beam, self.masses, *theirs, *self.stops, self.flash]

    @property
    def opposite(self) -> Array:
        """As ``opposite_places``."""
        return opposite_places(self.sheet)

    def _at_rest(self, scene: Scene) -> None:
        """Draw the undeflected beams thin, and what holds them."""
        keys: dict[str, Any] = {"color": "0.8", "linewidth": 0.7, "zorder": 1}
        ends = self.sheet["beam_position"][[0, -1]]
        self.axes.plot(ends * self.along[1], np.zeros(2), **keys)
        for support in scene.carrier.held:
            clamped = support.stiffness == inf and support.rotational_stiffness == inf
            marker: dict[str, Any] = {"marker": "|" if clamped else "^", "markersize": 17 if clamped else 7}
            self.axes.plot(support.position * self.along[1], 0.0, color="0.3", markeredgewidth=3.0, **marker)
        if self.lift or "met" in self.sheet.columns:
            self.axes.plot(self.opposite[[0, -1]] * self.along[1], [self.lift * self.across[1]] * 2, **keys)

    def _stops(self) -> list[Any]:
        """Draw the stops that are near enough, their tips where the beam touches them; a note on others."""
        if "met" in self.sheet.columns:
            return []
        rows = zip(*(self.sheet[f"stop_{name}"] for name in ("position", "height", "side")), strict=True)
        made = []
        for position, height, side in rows:
            (stop,) = self.axes.plot(
                [position * self.along[1]], [height * self.across[1]], linestyle="", marker=TIP[float(side)],
                markersize=11, color="black", zorder=4, visible=self._near(height),
            )  # fmt: skip
            made.append(stop)
        if not all(self._near(height) for height in self.sheet["stop_height"]):
            self.axes.text(0.98, 0.04, "a stop is beyond the figure", transform=self.axes.transAxes, ha="right")
        return made

    def _near(self, height: float) -> bool:
        return abs(float(height)) <= FAR * float(np.abs(self.sheet["beam_deflection"]).max())

    @property
    def range(self) -> tuple[float, float]:
        """Least and largest deflection of all that is drawn, m."""
        drawn = [self.sheet["beam_deflection"].ravel(), np.zeros(1)]
        drawn.append(np.array([height for height in self.sheet["stop_height"] if self._near(height)]))
        if "met" in self.sheet.columns:
            drawn.append(self.sheet["opposite_deflection"].ravel() + self.lift)
        values = np.concatenate(drawn)
        return float(values.min()), float(values.max())

    @property
    def ends(self) -> tuple[float, float]:
        """First and last place along the beams, m, with a margin."""
        places = self.sheet["beam_position"]
        if "met" in self.sheet.columns:
            places = np.concatenate([places, self.opposite])
        margin = 0.05 * float(np.ptp(places))
        return float(places.min()) - margin, float(places.max()) + margin

    def fit(self, scale: float, room: tuple[float, float]) -> None:
        """Set the limits, with deflections ``scale`` times as large as lengths, and say so."""
        low, high = self.range
        wide = self.ends[1] - self.ends[0]
        middle, half = (low + high) / 2, wide / scale * room[1] / room[0] / 2
        first, last = (self.along[1] * end for end in self.ends)
        self.axes.set_xlim(first, last, auto=True)
        low, high = ((middle + side * half) * self.across[1] for side in (-1, 1))
        self.axes.set_ylim(low, high, auto=True)  # about: the aspect, which is kept, sets them
        self.axes.set_aspect(scale * self.along[1] / self.across[1], adjustable="datalim")
        self.axes.text(0.02, 0.04, f"deflection × {scale:g}", transform=self.axes.transAxes)

    def set(self, frame: int, struck: set[int]) -> None:
        """Draw a frame, with marks on the stops ``struck`` just before it."""
        sheet, (_, along), (_, across) = self.sheet, self.along, self.across
        places, deflection = sheet["beam_position"], sheet["beam_deflection"][frame]
        self.beam.set_data(places * along, deflection * across)
        self.masses.set_data(self.weights * along, np.interp(self.weights, places, deflection) * across)
        heights = sheet["stop_height"]
        if "met" in sheet.columns:
            heights = heights + sheet["met"][frame]
            self._set_opposite(frame, float(heights[0]))
        marked = [index for index in sorted(struck) if index < len(heights)]
        self.flash.set_data(sheet["stop_position"][marked] * along, heights[marked] * across)

    def _set_opposite(self, frame: int, height: float) -> None:
        """Draw the opposite beam, and its arm to the place where it is met."""
        (_, along), (_, across) = self.along, self.across
        places, deflection = self.opposite, self.sheet["opposite_deflection"][frame] + self.lift
        self.other.set_data(places * along, deflection * across)
        foot, tip = self.sheet["stop_position"][0] - self.sheet["met_position"][1], self.sheet["stop_position"][0]
        at = np.interp(foot, places, deflection)
        self.met.set_data(np.array([foot, tip]) * along, np.array([at, height]) * across)


def scale_of(panels: Sequence[BeamPanel], room: tuple[float, float]) -> float:
    """Scale of the deflections against lengths, 1, 2 or 5 times a power of ten, that all panels have room for.

    ``room``: width and height of a panel.
    """
    most = inf
    for panel in panels:
        (low, high), (first, last) = panel.range, panel.ends
        if high > low:
            most = min(most, room[1] / room[0] * (last - first) / (ROOM * (high - low)))
    if not 0 < most < inf:
        return 1.0
    power = 10.0 ** floor(log10(most))
    return next(step * power for step in STEPS if step * power <= most * (1 + 1e-12))
