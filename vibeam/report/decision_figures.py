"""Pictures for a reader who decides: models over each other with their errors marked, and error against CPU time.

Both are drawn from what a study or a run gives: curves, comparisons with the reference, CPU times. What is not known is
never drawn as good: an open comparison has an open mark, and a model without a comparison is named below.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import inf, nan
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.case import Case, quantity_of
from vibeam.figures.units import amplitude_of, frequency_label, units_of
from vibeam.report.comparison_words import cells, size, spread
from vibeam.report.output import SheetPicture
from vibeam.runs.comparison.errors import Asked, EndError, ResponseComparison
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Curve = tuple[Array, Array]
Curves = Mapping[tuple[str, str], Curve]
PANELS = ("amplitude", "frequency")  # errors that a picture has a panel of
SMALL, HIGH = (5.0, 4.2), (5.0, 5.6)  # inches of a picture, which a telephone shows too; of one with a long legend
BAND: dict[str, Any] = {"color": "0.72", "linewidth": 3.4, "zorder": 2.0}  # of the reference
WAYS: dict[str, Any] = {"up": "-", "down": (0, (4, 1.6))}
REMARK = "brackets: largest error of amplitudes (upright), of ends of branches (level)"
SHADED = "; shaded: other motion"
WITHIN = {True: "within what is allowed", False: "more than is allowed", None: "open"}
BY_SOLVERS = "; of a solver the largest error at its frequencies, also where its motion is of another kind"


@dataclass(frozen=True)
class ErrorSize:
    """Size of an error, its bound where it is ``open`` whether it suffices; NaN: there is none."""

    value: float = nan
    open: bool = False


@dataclass(frozen=True)
class ModelError:
    """Errors of a ``model`` beside the reference and the CPU time of a point, s.

    ``mark``: what is written beside it; ``solver``: by which it is computed, empty where by its sweep; ``beyond``: it
    is the reference, beside a fuller model.
    """

    model: str
    seconds: float
    amplitude: ErrorSize
    frequency: ErrorSize = ErrorSize()
    mark: str = ""
    solver: str = ""
    beyond: bool = False

    @classmethod
    def of(
        cls, model: str, found: ResponseComparison, asked: Asked, seconds: float, mark: str = "", beyond: bool = False
    ) -> ModelError:  # fmt: skip
        """By a comparison."""
        both = _amplitude(found, asked.amplitude), _frequency(found, asked.frequency)
        return cls(model, seconds, *both, mark=mark, beyond=beyond)


def _amplitude(found: ResponseComparison, allowed: float) -> ErrorSize:
    """Error of amplitudes; its bound where scatter leaves it open."""
    if found.amplitude is None:
        return ErrorSize()
    most = found.amplitude.most if found.scattered is None else found.scattered.most
    is_open = found.amplitude.least <= allowed < most
    return ErrorSize(most if is_open else abs(found.amplitude.error), is_open)


def _frequency(found: ResponseComparison, allowed: float) -> ErrorSize:
    """Largest error of ends and width of other motions; the bound of what is open unless another is surely larger."""
    known = [(abs(each.error), each.open) for each in found.ends]
    known += [(inf if each.alone else each.width, each.open) for each in found.kinds]
    surely = [size for size, open_ in known if size - open_ > allowed]
    if surely:
        return ErrorSize(max(surely))
    bounds = [size + open_ for size, open_ in known if size + open_ > allowed]
    bounds += [inf for _, low, high in found.unknown if high > low * (1 + allowed)]
    return ErrorSize(max(bounds), True) if bounds else ErrorSize(max((size for size, _ in known), default=0.0))


def shown_in(errors: Sequence[ModelError]) -> list[str]:
    """Names of the panels that show something: errors at a known CPU time."""
    return [name for name in PANELS if any(getattr(each, name).value > 0 for each in errors if each.seconds > 0)]


@dataclass(frozen=True, eq=False)
class Decision:
    """Numbers and curves from which a reader decides between the models of a ``case``.

    ``curves``: frequencies, Hz, and amplitudes of a model in a direction, of the ``reference`` and of the models
    ``shown`` beside it, the recommended one first, each with its comparison. ``errors``: of all models, also by other
    solvers, ``against`` more than the reference where that is not empty; ``reference_seconds``: CPU time of a point of
    the reference; ``left_out``: models without a comparison. ``group``: a name of these models where there are others.
    """

    case: Case
    asked: Asked
    reference: str
    curves: Curves = field(default_factory=dict)
    shown: Mapping[str, ResponseComparison] = field(default_factory=dict)
    errors: tuple[ModelError, ...] = ()
    reference_seconds: float = nan
    left_out: tuple[str, ...] = ()
    group: str = ""
    against: str = ""

    @property
    def pictures(self) -> Iterator[SheetPicture]:
        """Its pictures, those that have something to show."""
        if self.curves:
            words = f"Responses of {', '.join([self.reference, *self.shown])}"
            yield SheetPicture(f"Models over each other{self.group}", words, partial(responses_figure, self))
        if shown_in(self.errors):
            words = "Errors of all models" + BY_SOLVERS * any(each.solver for each in self.errors)
            name, ending = f"What accuracy costs in time{self.group}", "_times" * bool(self.curves)
            yield SheetPicture(name, words, partial(times_figure, self), ending)


def times_figure(found: Decision) -> Figure:
    """Errors of all models over the CPU time of a point."""
    from vibeam.figures.page import blank_page, legend, titled
    from vibeam.report.error_panels import error_panels
    from vibeam.report.record_figure import handles_of

    figure = blank_page(HIGH if any(each.solver for each in found.errors) else SMALL, found.case.figure)
    error_panels(figure, shown_in(found.errors), found.errors, found.asked, found.reference_seconds)
    titled(figure, found.case.figure, "", f"errors against {found.against or found.reference}")
    is_open = any(size.open for each in found.errors for size in (each.amplitude, each.frequency))
    remark = ["open marks: not surely known"] * is_open
    remark += [f"not compared: {', '.join(found.left_out)}"] * bool(found.left_out)
    legend(figure, handles_of(figure), "; ".join(remark))
    return figure


def responses_figure(found: Decision) -> Figure:
    """The models shown over the reference, their largest errors marked where they are."""
    from vibeam.figures.page import blank_page, legend, titled
    from vibeam.figures.style import COLOURS
    from vibeam.report.record_figure import handles_of

    output, shown = found.case.sweep.output, found.shown
    largest = max((float(np.nanmax(each, initial=0.0)) for _, each in found.curves.values()), default=0.0)
    units = units_of(found.case, largest, quantity=quantity_of(found.case, output).name)
    figure = blank_page(SMALL, found.case.figure)
    axes = figure.subplots()
    axes.set(xlabel=frequency_label(units), ylabel=amplitude_of(output, units), ymargin=0.1)
    looks: dict[str, Any] = {
        name: {"color": COLOURS[at], "linewidth": 1.3, "zorder": 3.0 + at} for at, name in enumerate(shown)
    }
    labels = {name: _with_errors(name, each, found.asked) for name, each in shown.items()}
    first_way = next(iter(found.curves))[1]
    for (model, way), (frequency, amplitude) in found.curves.items():
        label = labels.get(model, f"{model}, the reference") if way == first_way else "swept down"
        axes.plot(
            frequency * units.frequency_factor, amplitude * units.length_factor, linestyle=WAYS[way], label=label,
            gid=f"response-{model}-{way}", marker="o" * (len(frequency) == 1), **looks.get(model, BAND),
        )  # fmt: skip
    reference = {way: each for (model, way), each in found.curves.items() if model == found.reference}
    for first, (name, comparison) in zip((True, False), shown.items(), strict=False):
        for mark in _marks(comparison, reference):
            mark.draw(axes, units.frequency_factor, units.length_factor, name, looks[name]["color"], first)
    titled(figure, found.case.figure, "", f"models beside {found.reference}")
    marked = f"{REMARK}{SHADED * any(each.kinds for each in shown.values())}" if shown else ""
    legend(figure, handles_of(figure), marked)
    return figure


def _with_errors(name: str, found: ResponseComparison, asked: Asked) -> str:
    """Model with its numbers, those that there are, and whether these are allowed."""
    numbers = zip(("amplitudes", "ends", "other motion"), cells(found), strict=True)
    said = [f"{what} {number}" for what, number in numbers if number != "–"]
    return f"{name}: {', '.join([*said, WITHIN[found.suffices(asked)]])}".replace(" %", "\u00a0%")


@dataclass(frozen=True)
class _Mark:
    """Mark of an error of a ``kind``: from one point (Hz, m) to the other; ``is_open``: it is not surely there.

    Its size stands above and before the bracket of the ``first`` model, behind that of the next one.
    """

    kind: str
    frequencies: tuple[float, float]
    levels: tuple[float, float] = (nan, nan)
    words: str = ""
    is_open: bool = False

    def draw(self, axes: Any, across: float, upward: float, model: str, colour: str, first: bool) -> None:
        """Draw it in units by their factors: a bracket with its size, a shaded range of another motion."""
        x, y, name = [across * each for each in self.frequencies], [upward * each for each in self.levels], self.kind
        if name == "kind-error":
            axes.axvspan(*x, color=colour, alpha=0.14, linewidth=0, gid=f"{name}-{model}")
            return
        look: dict[str, Any] = {"marker": "_" if name == "amplitude-error" else "|", "markersize": 9}
        if self.is_open:
            look = {"marker": "o", "markersize": 4, "markerfacecolor": "white", "linestyle": ":"}
        axes.plot(x, y, color=colour, linewidth=1.1, zorder=9, gid=f"{name}-{model}", **look)
        axes.annotate(
            self.words, (min(x), max(y)) if first else (max(x), sum(y) / 2), (-5, 3) if first else (6, -3),
            color=colour, textcoords="offset points", zorder=10, fontsize="small", ha="right" if first else "left",
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.4},
        )  # fmt: skip


def _marks(found: ResponseComparison, reference: Mapping[str, Curve]) -> Iterator[_Mark]:
    """Marks of the largest error of amplitudes, of the worst end and of the gravest difference in kind."""
    if (error := found.amplitude) is not None:
        levels = error.ours, error.reference
        yield _Mark("amplitude-error", (error.frequency,) * 2, levels, spread(error), error.scatter > 0)
    for end in found.ends[:1]:
        yield _end(end, reference[end.ours.direction])
    for kind in found.kinds[:1]:
        yield _Mark("kind-error", (kind.low, kind.high))


def _end(end: EndError, reference: Curve) -> _Mark:
    """Mark of an end on the reference's jump; of one that is not surely elsewhere the range where it may be."""
    at, unknown, order = end.reference.frequency, abs(end.error) <= end.open, np.argsort(reference[0])
    level = float(np.interp(at, reference[0][order], np.nan_to_num(reference[1][order])))
    places = (at * (1 - end.open), at * (1 + end.open)) if unknown else (end.ours.frequency, at)
    words = f"± {size(end.open)}" if unknown else size(end.error)
    return _Mark("frequency-error", places, (level, level), words, unknown)
