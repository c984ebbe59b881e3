"""Pictures for a reader who decides: models over each other with their errors marked, and error against CPU time.

Both are drawn from what a study or a run gives: curves, comparisons with the reference, CPU times. What is not known is
never drawn as good: an open comparison has an open mark at its bound, and a model without one is named below.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from math import nan
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.case import Case, quantity_of
from vibeam.figures.page import blank_page, legend, titled
from vibeam.figures.style import COLOURS
from vibeam.figures.units import DisplayUnits, amplitude_of, frequency_label, units_of
from vibeam.report.comparison_words import cells, size, spread
from vibeam.report.error_panels import ModelError, error_keys, error_panels, is_drawn
from vibeam.report.output import SheetPicture
from vibeam.runs.comparison.errors import AmplitudeError, Asked, EndError, ResponseComparison
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SMALL, HIGH = (5.0, 4.2), (5.0, 5.6)  # inches of a picture, which a telephone shows too; of one with a long legend
BOTH = (8.6, 4.4)
BAND: dict[str, Any] = {"color": "0.72", "linewidth": 3.4, "zorder": 2.0}  # of the reference
COVERED: dict[str, Any] = {"up": "-", "down": (0, (4, 1.6))}
REMARK = "brackets: largest error of amplitudes (upright), of ends of branches (level)"
SHADED = "; shaded: other motion"


@dataclass(frozen=True, eq=False)
class ModelCurve:
    """Response of a ``model`` in one ``direction``: ``amplitude`` over ``frequency`` in Hz."""

    model: str
    direction: str
    frequency: Array
    amplitude: Array


@dataclass(frozen=True, eq=False)
class Decision:
    """What a decision between the models of a ``case`` is made of.

    ``curves``: of the ``reference`` and of the models ``shown`` beside it, the recommended one first, each with its
    comparison. ``errors``: of all models, also by other solvers, ``against`` more than the reference where that is not
    empty; ``reference_seconds``: CPU time of a point of the reference; ``left_out``: models without a comparison.
    ``group``: a name of these models where there are others; ``of_peaks``: the errors are of peaks under a record.
    """

    case: Case
    asked: Asked
    reference: str
    curves: tuple[ModelCurve, ...] = ()
    shown: tuple[tuple[str, ResponseComparison], ...] = ()
    errors: tuple[ModelError, ...] = ()
    reference_seconds: float = nan
    left_out: tuple[str, ...] = ()
    group: str = ""
    against: str = ""
    of_peaks: bool = False

    def with_solvers(self, other: Decision) -> Decision:
        """The same models with the errors of solvers beside theirs."""
        left_out = (*self.left_out, *other.left_out)
        against = f"{self.reference}, of solvers against {other.reference}"
        return replace(self, errors=(*self.errors, *other.errors), left_out=left_out, against=against)

    @property
    def draw(self) -> Callable[[], Figure] | None:
        """Both pictures as one figure, the only one there is, or None."""
        shown = [each.draw for each in self.pictures]
        return partial(_both, self) if len(shown) > 1 else shown[0] if shown else None

    @property
    def pictures(self) -> Iterator[SheetPicture]:
        """Its pictures, those that have something to show."""
        if self.curves:
            words = f"Response of {self.reference}, {' and '.join(name for name, _ in self.shown)}, with their errors"
            yield SheetPicture(f"Models over each other{self.group}", words, partial(responses_figure, self))
        if is_drawn(self.errors):
            words = "Errors of all models against CPU time"
            if any(each.solver for each in self.errors):
                words += "; of a solver the largest at its frequencies, also where its motion is of another kind"
            yield SheetPicture(f"What accuracy costs in time{self.group}", words, partial(times_figure, self))


def _both(found: Decision) -> Figure:
    """Both pictures beside each other."""
    figure = blank_page(BOTH, found.case.figure)
    [[left, right]] = figure.subfigures(1, 2, squeeze=False, width_ratios=[1.2, 1.0])
    keys, errors = draw_responses(left.subplots(), found), _errors(right, found)
    titled(figure, found.case.figure, found.case.title, f"models beside {found.reference}")
    legend(figure, [*keys, *errors], _remark(found))
    return figure


def responses_figure(found: Decision) -> Figure:
    """The models shown over the reference, their largest errors marked where they are."""
    figure = blank_page(SMALL, found.case.figure)
    keys = draw_responses(figure.subplots(), found)
    titled(figure, found.case.figure, "", f"models beside {found.reference}")
    legend(figure, keys, _marked(found))
    return figure


def times_figure(found: Decision) -> Figure:
    """Errors of all models over the CPU time of a point."""
    figure = blank_page(HIGH if any(each.solver for each in found.errors) else SMALL, found.case.figure)
    keys = _errors(figure, found)
    titled(figure, found.case.figure, "", f"errors against {found.against or found.reference}")
    legend(figure, keys, _left_out(found))
    return figure


def _errors(figure: Any, found: Decision) -> list[Any]:
    error_panels(figure, found.errors, found.asked, found.reference_seconds, found.of_peaks)
    return error_keys(found.errors, found.case, found.reference_seconds)


def _left_out(found: Decision) -> str:
    return f"not compared: {', '.join(found.left_out)}" if found.left_out else ""


def _remark(found: Decision) -> str:
    return "; ".join(filter(None, [_marked(found), _left_out(found)]))


def _marked(found: Decision) -> str:
    """What the marks on the curves say."""
    return f"{REMARK}{SHADED * any(each.kinds for _, each in found.shown)}" if found.shown else ""


def draw_responses(axes: Axes, found: Decision) -> list[Any]:
    """Draw curves and marks; return what the legend has to explain."""
    from matplotlib.lines import Line2D

    largest = max((float(np.nanmax(each.amplitude, initial=0.0)) for each in found.curves), default=0.0)
    output = found.case.sweep.output
    units = units_of(found.case, largest, quantity=quantity_of(found.case, output).name)
    colours = dict(zip((name for name, _ in found.shown), COLOURS, strict=False))
    for each in found.curves:
        keys: dict[str, Any] = BAND
        if each.model in colours:
            place = list(colours).index(each.model)
            keys = {"color": colours[each.model], "linewidth": 1.3 - 0.3 * place, "zorder": 3.0 + place}
        axes.plot(
            each.frequency * units.frequency_factor, each.amplitude * units.length_factor,
            linestyle=COVERED[each.direction], gid=f"response-{each.model}-{each.direction}", **keys,
        )  # fmt: skip
    axes.set_xlabel(frequency_label(units))
    axes.set_ylabel(amplitude_of(output, units))
    axes.margins(y=0.1)
    for place, (name, comparison) in enumerate(found.shown):
        _Marks(axes, units, name, colours[name], place).draw(comparison, _reference(found))
    lines = [Line2D([], [], label=f"{found.reference}, the reference", **BAND)]
    for name, comparison in found.shown:
        lines.append(Line2D([], [], color=colours[name], label=_with_errors(name, comparison, found.asked)))
    if {each.direction for each in found.curves} == set(COVERED):
        lines.append(Line2D([], [], color="0.25", linestyle=COVERED["down"], label="dashed: swept down"))
    return lines


def _with_errors(name: str, found: ResponseComparison, asked: Asked) -> str:
    """Model with its numbers, those that there are, and whether these are allowed."""
    numbers = zip(("amplitudes", "ends", "other motion"), cells(found), strict=True)
    said = [f"{what} {number}" for what, number in numbers if number != "–"]
    within = {True: "within what is allowed", False: "more than is allowed", None: "open"}[found.suffices(asked)]
    return f"{name}: {', '.join([*said, within])}".replace(" %", "\u00a0%")


def _reference(found: Decision) -> dict[str, ModelCurve]:
    return {each.direction: each for each in found.curves if each.model == found.reference}


@dataclass(frozen=True)
class _Marks:
    """Marks of one model's errors on ``axes``; ``place`` of the model among those shown."""

    axes: Axes
    units: DisplayUnits
    model: str
    colour: str
    place: int

    def draw(self, found: ResponseComparison, reference: dict[str, ModelCurve]) -> None:
        """Mark the largest error of amplitudes, the worst end and the gravest difference in kind where they are."""
        if found.amplitude is not None:
            self._amplitude(found.amplitude)
        if found.ends and found.ends[0].ours.direction in reference:
            self._end(found.ends[0], reference[found.ends[0].ours.direction])
        if found.kinds:
            kind, factor = found.kinds[0], self.units.frequency_factor
            self.axes.axvspan(
                kind.low * factor, kind.high * factor, color=self.colour, alpha=0.14, linewidth=0,
                gid=f"kind-error-{self.model}",
            )  # fmt: skip

    def _amplitude(self, error: AmplitudeError) -> None:
        at = error.frequency * self.units.frequency_factor
        levels = [each * self.units.length_factor for each in (error.ours, error.reference)]
        self._bracket(([at, at], levels), "_", "amplitude-error", spread(error), error.scatter > 0)

    def _end(self, end: EndError, reference: ModelCurve) -> None:
        """Mark of an end halfway up its jump; of one that is not surely elsewhere the range where it may be."""
        unknown, at = abs(end.error) <= end.open, end.reference.frequency
        places = [at * (1 - end.open), at * (1 + end.open)] if unknown else [end.ours.frequency, at]
        level = _halfway(reference, at) * self.units.length_factor
        words = f"± {size(end.open)}" if unknown else size(end.error)
        across = [each * self.units.frequency_factor for each in places]
        self._bracket((across, [level, level]), "|", "frequency-error", words, unknown)

    def _bracket(self, ends: tuple[list[float], list[float]], cap: str, kind: str, words: str, unknown: bool) -> None:
        """Bracket with its size; of what is not surely known dashed, with open ends."""
        look: dict[str, Any] = {"marker": cap, "markersize": 9}
        if unknown:
            look = {"marker": "o", "markersize": 4, "markerfacecolor": "white", "linestyle": ":"}
        self.axes.plot(*ends, color=self.colour, linewidth=1.1, zorder=9, gid=f"{kind}-{self.model}", **look)
        first = self.place == 0  # its size stands above and before the bracket, that of the next one behind it
        corner = (min(ends[0]), max(ends[1])) if first else (max(ends[0]), sum(ends[1]) / 2)
        self.axes.annotate(
            words, corner, (-5, 3) if first else (6, -3), textcoords="offset points", color=self.colour, zorder=10,
            fontsize="small", ha="right" if first else "left",
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.4},
        )  # fmt: skip


def _halfway(curve: ModelCurve, at: float) -> float:
    """Amplitude halfway between the points of a curve before and behind a frequency."""
    order = np.argsort(curve.frequency)
    place = int(np.clip(np.searchsorted(curve.frequency[order], at), 1, len(order) - 1)) if len(order) > 1 else 0
    beside = curve.amplitude[order][max(place - 1, 0) : place + 1]
    return float(np.nanmean(beside)) if np.isfinite(beside).any() else 0.0
