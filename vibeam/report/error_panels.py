"""Panels of error against CPU time: amplitudes above, ends of branches and kinds of motion below, a mark a model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf, isfinite, nan
from typing import TYPE_CHECKING, Any

from vibeam.figures.style import COLOURS, KEY, name_of
from vibeam.report.comparison_words import LEAST, MOST
from vibeam.runs.comparison.errors import Asked, ResponseComparison
from vibeam.solvers import SOLVERS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from vibeam.case.case import Case

SWEPT, BEYOND = ("o", 5.0), ("D", 5.0)  # marks of a model by its sweep, of the reference against a fuller model
DARK = "0.25"
SDOF = "sdof"  # mark of one degree of freedom along the static deflection
FEW_DECADES = 30.0  # range of an axis up to which numbers between powers of ten have room
SLACK = 3.0  # factor between the marks and the edge of a panel


@dataclass(frozen=True)
class ErrorSize:
    """Size of an error, its bound where it is ``open`` whether it suffices; NaN: there is none."""

    value: float = nan
    open: bool = False

    @property
    def shown(self) -> float:
        """Value within what is drawn."""
        return min(max(self.value, LEAST), MOST)


@dataclass(frozen=True)
class ModelError:
    """Errors of a ``model`` beside the reference and the CPU time of a point, s.

    ``mark``: what is written beside it; ``solver``: by which it is computed, empty where by its sweep, with the
    ``method`` whose settings are joined by a line. ``beyond``: it is the reference, beside a fuller model.
    """

    model: str
    seconds: float
    amplitude: ErrorSize
    frequency: ErrorSize = ErrorSize()
    mark: str = ""
    solver: str = ""
    method: str = ""
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


def is_drawn(errors: Sequence[ModelError]) -> bool:
    """Test whether there is an error at a known CPU time."""
    return any(_panels(errors))


def _panels(errors: Sequence[ModelError]) -> Iterator[str]:
    """Names of the panels that show something."""
    timed = [each for each in errors if each.seconds > 0]
    if any(isfinite(each.amplitude.shown) for each in timed):
        yield "amplitude"
    if any(each.frequency.value > 0 for each in timed):
        yield "frequency"


def error_panels(
    figure: Any, errors: Sequence[ModelError], asked: Asked, reference: float = nan, of_peaks: bool = False
) -> None:  # fmt: skip
    """Draw the panels above each other, over the CPU time of a point; ``reference``: that of the reference.

    ``of_peaks``: in place of amplitudes, of motions under a record.
    """
    names = list(_panels(errors))
    grid = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    words = {"amplitude": f"{'peak' if of_peaks else 'amplitude'} error (%)", "frequency": "ends, other motion (%)"}
    for axes, name in zip(grid, names, strict=True):
        _panel(axes, [each for each in errors if each.seconds > 0], name)
        axes.axhline(100 * getattr(asked, name), color="0.5", linewidth=0.8, linestyle=":", gid=f"asked-{name}")
        if reference > 0:
            axes.axvline(1e3 * reference, color="0.8", linewidth=3.4, zorder=0, gid="reference-time")
        axes.set_ylabel(words[name])
        _scale(axes)
    grid[-1].set_xlabel(f"CPU time of a {'motion' if of_peaks else 'point'} (ms)")


def _panel(axes: Axes, errors: Sequence[ModelError], name: str) -> None:
    colours = _colours(errors)
    joined: dict[tuple[str, str, str], list[tuple[float, float]]] = {}
    for each in errors:
        error: ErrorSize = getattr(each, name)
        if error.value != error.value:
            continue
        at, colour = (1e3 * each.seconds, 100 * error.shown), colours.get(each.model, DARK) if each.solver else DARK
        shape, size = _shape(each)
        axes.plot(
            *at, marker=shape, markersize=size, color=colour, markerfacecolor="white" if error.open else colour,
            linestyle="", zorder=3, gid=f"{name}-of-{each.model}{f'-{each.solver}' * bool(each.solver)}",
        )  # fmt: skip
        if each.mark:
            below = each.mark == SDOF  # beside one mode, where it often lies
            axes.annotate(each.mark, at, (4, -9 if below else 3), textcoords="offset points", fontsize="small")
        if each.solver:
            joined.setdefault((each.model, each.solver, each.method), []).append(at)
    for (model, *_), points in joined.items():
        axes.plot(*zip(*points, strict=True), color=colours[model], linewidth=0.6, alpha=0.5, zorder=2)


def _scale(axes: Axes) -> None:
    """Logarithmic axes with plain numbers and room around the marks."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axes.set(xscale="log", yscale="log")
    low, high = axes.dataLim.intervaly
    axes.set_ylim(low / SLACK, high * SLACK)
    axes.margins(x=0.12)
    for axis, (least, most) in ((axes.xaxis, axes.dataLim.intervalx), (axes.yaxis, (low, high))):
        axis.set_major_formatter("{x:g}")
        axis.set_minor_locator(LogLocator(subs=(2, 5)))
        axis.set_minor_formatter("{x:g}" if most < FEW_DECADES * least else NullFormatter())
    axes.grid(which="major", color="0.93", linewidth=0.5, zorder=0)


def _shape(each: ModelError) -> tuple[str, float]:
    return SOLVERS[each.solver].marker if each.solver else BEYOND if each.beyond else SWEPT


def _colours(errors: Sequence[ModelError]) -> dict[str, str]:
    """Colour of each model that a solver computes."""
    names = dict.fromkeys(each.model for each in errors if each.solver)
    return {name: COLOURS[place % len(COLOURS)] for place, name in enumerate(names)}


def error_keys(errors: Sequence[ModelError], case: Case, reference: float = nan) -> list[Any]:
    """Entries of the legend: models that solvers compute, solvers, what marks and lines say."""
    from matplotlib.lines import Line2D

    drawn = [each for each in errors if each.seconds > 0]
    keys = [
        Line2D([], [], color=colour, linewidth=2.5, label=name_of(case, name))
        for name, colour in _colours(drawn).items()
    ]
    grey = KEY | {"linewidth": 0.0, "markerfacecolor": DARK}

    def mark(shape: tuple[str, float], label: str, **own: Any) -> Line2D:
        return Line2D([], [], label=label, **(grey | {"marker": shape[0], "markersize": shape[1]} | own))

    if any(not each.solver and not each.beyond for each in drawn):
        keys.append(mark(SWEPT, "model"))
    if any(each.beyond for each in drawn):
        keys.append(mark(BEYOND, "reference, against a fuller model"))
    named = dict.fromkeys(each.solver for each in drawn if each.solver)
    keys += [mark(declaration.marker, name) for name, declaration in SOLVERS.items() if name in named]
    if any(each.amplitude.open or each.frequency.open for each in drawn):
        keys.append(mark(SWEPT, "open mark: bound of what is not known", markerfacecolor="white"))
    if reference > 0:
        keys.append(Line2D([], [], color="0.8", linewidth=3.4, label="time of the reference"))
    return [*keys, Line2D([], [], color="0.5", linewidth=0.8, linestyle=":", label="error that is allowed")]
