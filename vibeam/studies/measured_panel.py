"""Measured curve as it was read, and its panel: all points, in grey those that are cut, the fit over the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST = 20_000  # points drawn of a curve; of more the least and the greatest of each of many stretches
Orders = Sequence[Sequence[tuple[float, float]]]


@dataclass(frozen=True, eq=False)
class MeasuredCurve:
    """Curve as it was read, for a picture: ``value`` (n,), or (m, n) of several, at ``at`` (n,), in SI.

    ``used`` (n,): points that are not cut. ``fit``: places (k,), and what was fitted there. ``labels``: of the axes,
    heads with units. ``timed``: over time, not frequency.
    """

    at: Array
    value: Array
    used: Any
    fit: tuple[Array, Array] | None = None
    labels: tuple[str, str] = ("", "")
    name: str = ""
    timed: bool = False

    @property
    def cut(self) -> int:
        """Number of points that are not used."""
        return len(self.used) - int(sum(self.used))

    @property
    def title(self) -> str:
        """Name, and how many points are cut."""
        return f"{self.name}: {self.cut} of {len(self.used)} points are cut" if self.cut else self.name


def label(head: str, unit: str) -> str:
    """Label of an axis: the head of a column, and its unit where it has one."""
    return f"{head} in {unit.replace('^2', '²')}" if unit not in ("", "1") else head


def draw_curve(axes: Axes, curve: MeasuredCurve, colours: Sequence[str]) -> dict[str, Any]:
    """Lines of a history, dots over frequency, by what a legend calls them; ``colours`` of what is used and fitted."""
    shown = _shown(curve.value)
    at, used, value = curve.at[shown], curve.used[shown], curve.value[..., shown]
    look: dict[str, Any] = {"linestyle": "", "marker": ".", "markersize": 3.5}
    if curve.timed:
        look = {"linewidth": 1.6}
    drawn = {}
    if curve.cut:
        drawn["cut"] = axes.plot(at, value.T, color="0.75", **look)[0]
    drawn["measured"] = axes.plot(at, np.where(used, value, np.nan).T, color=colours[0], **look)[0]
    if curve.fit is not None:
        place, model = curve.fit
        shown = _shown(model)
        lines = axes.plot(place[shown], model[..., shown].T, color=colours[1], linewidth=0.8, zorder=3)
        drawn["fitted"] = lines[0]
    return drawn


def draw_orders(axes: Axes, orders: Orders) -> dict[str, Any]:
    """Crosses at the modes of each fit, frequency (Hz) and damping ratio, over the number of its modes."""
    places = np.transpose([(mode[0], count) for count, modes in enumerate(orders, 1) for mode in modes])
    (crosses,) = axes.plot(*places, "k+", zorder=4)
    axes.set_yticks(range(len(orders) + 2))
    axes.set_ylabel("modes in the fit")
    return {"modes of each fit": crosses}


def _shown(value: Any) -> Any:
    """Indices of the points drawn of ``value`` (…, n): all, or of each of many stretches the least and the greatest."""
    size = np.nan_to_num(np.max(np.atleast_2d(value), axis=0))
    width = ceil(2 * len(size) / MOST)
    if width <= 2:
        return np.arange(len(size))
    parts = {at: size[at : at + width] for at in range(0, len(size), width)}
    return np.unique([at + end for at, part in parts.items() for end in (np.argmin(part), np.argmax(part))])
