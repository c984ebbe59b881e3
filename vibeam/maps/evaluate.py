"""Grids of case keys: those of a [map.NAME], their keys and blocks; quantities of one fidelity over one, in memory."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from hashlib import sha256
from math import prod
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.case.case import units_of_output
from vibeam.case.grid_keys import DISPLACEMENT, FREQUENCY, SHARE, STARTS, VELOCITY, MapPlan, axis_faults
from vibeam.case.source import of_source
from vibeam.exchange.faults import CaseError, Fault
from vibeam.maps.block import QUANTITIES, SWEPT, Block, Grid, Source, Way, evaluate_block
from vibeam.maps.models import models_of
from vibeam.maps.points import Axis, Starts, shape_of
from vibeam.store.blocks import Values
from vibeam.system.labelled import DataNames, LabelledData, LabelledPart
from vibeam.system.record_pieces import blocks
from vibeam_models.arguments import floats
from vibeam_models.arrays import ValueRecord
from vibeam_models.memory import check_room

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Model

Run = Literal["up", "down", "both", "apart"]
WAYS: Mapping[Run, tuple[Way, ...]] = {"up": ("up",), "down": ("down",), "both": ("up", "down"), "apart": ()}
AT_ONCE = 20_000  # points in memory beside the result
A_NUMBER = 11.0  # bytes of a number of a point, those of its block and of the result, measured


@dataclass(frozen=True, eq=False, repr=False)
class GridResponse(ValueRecord, LabelledData):
    """Quantities over a grid: ``values`` by name, (ways, axis 1, axis 2, …) each, SI units.

    A point that failed is NaN, its reason in ``ended``. ``strobes`` have one dimension more: output at the end of the
    last periods, the latest last; random starts come before that. ``ways``: ("apart",) where nothing is carried.
    ``names``: units of the output and of the axes, title and key of the case.

    >>> import vibeam
    >>> vibeam.evaluate("cases/dtu_neutral.toml", "sdof", {"sweep.frequency": [14.0, 15.0]}, direction="both").ways
    ('up', 'down')
    """

    fidelity: str
    axes: Mapping[str, NDArray[np.float64]]
    ways: tuple[str, ...]
    values: Mapping[str, NDArray[Any]]
    names: DataNames = field(default=DataNames(), repr=False)

    def of_case(self, case: Case, output: str) -> GridResponse:
        """The same with the units of an output and of the axes of a case, its title and its key."""
        units = {key: _unit(case, key) for key in self.axes}
        return replace(self, names=DataNames(units_of_output(case, output), units, case.about))

    def _parts(self) -> list[LabelledPart]:
        starts = min((each.shape for each in self.values.values()), key=len)[1 + len(self.axes) :]
        axes = {"direction": list(self.ways), **self.axes} | ({"start": range(starts[0])} if starts else {})
        return [LabelledPart({"fidelity": self.fidelity}, axes, self.values)]

    @property
    def _names(self) -> DataNames:
        return self.names

    def __getitem__(self, quantity: str) -> NDArray[Any]:
        """One quantity over the axes (of several ways, with these first)."""
        values = self.values[quantity]
        return values[0] if len(self.ways) == 1 else values

    def way(self, way: str) -> Mapping[str, NDArray[Any]]:
        """All quantities of one way over the axes; KeyError names the ways."""
        if way not in self.ways:
            raise KeyError(f"no way {way!r}: there are {', '.join(self.ways)}")
        return {name: values[self.ways.index(way)] for name, values in self.values.items()}


def _unit(case: Case, key: str) -> str:
    known = {FREQUENCY: "Hz", DISPLACEMENT: "m", VELOCITY: "m s-1"}
    with suppress(ValueError):  # numbers of a fidelity's table have none
        return known.get(key) or case.keys.unit(key) or "1"
    return "1"


@of_source
def evaluate(
    case: Case,
    fidelity: str,
    axes: Mapping[str, ArrayLike],
    *,
    quantities: Sequence[str] = ("amplitude", "period"),
    direction: Run = "up",
    frequency: float | None = None,
    settle: int | None = None,
    hold: int | None = None,
    output: str | None = None,
    strobes: int = 0,
    starts: Starts | None = None,
    lanes: bool = True,
    threads: int | None = None,
) -> GridResponse:
    """Evaluate a fidelity of a case over the grid of ``axes``: dotted keys and their values in SI.

    ``"sweep.frequency"`` (Hz) is the drive's; ``"start.displacement"`` (m) and ``"start.velocity"`` (m/s) of the
    contact are where each motion starts. The last axis is swept ``direction`` "up", "down" or "both", the state carried
    along it and every line begun at equilibrium; "apart": every point by itself, from equilibrium, from where the
    axes say or, ``starts`` times, at random. ``frequency``: in Hz, where it is no axis. ``settle``, ``hold`` and
    ``output``: None as in the case's sweep. ``quantities``: of ``QUANTITIES``; ``strobes``, ``lanes`` and ``threads``
    as in ``vibeam.batch``: a line over the frequency is a sweep of ``vibeam.run`` to round-off, without ``lanes`` to
    the bit.

    KeyError for an unknown fidelity or quantity, CaseError for a value that the case may not have, ValueError for axes
    or a case that a grid cannot take.

    >>> import vibeam
    >>> axes = {"stop.gap": [0.0, 1e-4], "sweep.frequency": [14.0, 15.0, 16.0]}
    >>> found = vibeam.evaluate("cases/dtu_neutral.toml", "sdof", axes)
    >>> found["amplitude"].shape
    (2, 3)
    """
    grid = grid_of(
        case, fidelity, axes, quantities=quantities, direction=direction, frequency=frequency, settle=settle,
        hold=hold, output=output, strobes=strobes, starts=starts, lanes=lanes,
    )  # fmt: skip
    points = grid.lines * int(np.prod(grid.shape))
    numbers = points * (len(grid.quantities) + max(strobes - 1, 0))
    check_room(f"{points} points of a grid", A_NUMBER * numbers, "take fewer points or quantities, or vibeam.run_map")
    size = max(1, AT_ONCE // int(np.prod(grid.shape)))
    parts = [evaluate_block(Block(grid, part.start, part.stop), threads) for part in blocks(grid.lines, size)]
    known = {axis.key: np.array(axis.values) for axis in grid.axes}
    found = GridResponse(fidelity, known, grid.ways or ("apart",), over_axes(grid, parts))
    return found.of_case(case, grid.output)


def over_axes(grid: Grid, parts: Sequence[Values]) -> Values:
    """Values of all lines, (lines, ways, …), over the axes: (ways, axis 1, axis 2, …)."""
    above = shape_of(grid.axes)[:-1]
    found = {name: np.concatenate([part[name] for part in parts]) for name in grid.quantities}
    return {
        name: np.moveaxis(each, 1, 0).reshape(each.shape[1], *above, *each.shape[2:]) for name, each in found.items()
    }


def grid_of(
    case: Case, fidelity: str, axes: Mapping[str, ArrayLike], *, quantities: Sequence[str], direction: Run,
    frequency: float | None = None, settle: int | None = None, hold: int | None = None, output: str | None = None,
    strobes: int = 0, starts: Starts | None = None, lanes: bool = True,
) -> Grid:  # fmt: skip
    """The grid that ``evaluate`` is asked for, its lines side by side with ``lanes``; errors as there."""
    unknown = [name for name in quantities if name not in QUANTITIES]
    if unknown:
        raise KeyError(f"no quantity {', '.join(map(repr, unknown))}: there are {', '.join(QUANTITIES)}")
    plan, model = case.sweep, case.model(fidelity)
    made = tuple(Axis(key, tuple(np.atleast_1d(floats(key, values)).tolist())) for key, values in axes.items())
    _require_keys(model, made)
    grid = Grid(
        model,
        made,
        WAYS[direction],
        plan.settle if settle is None else settle,
        plan.hold if hold is None else hold,
        plan.output if output is None else output,
        tuple(dict.fromkeys((*quantities, "ended"))),
        _frequency(case, axes, frequency),
        strobes,
        starts,
        lanes,
    )
    faults = faults_of(grid)
    if faults:
        raise ValueError("; ".join(faults))
    return grid


def _require_keys(model: Model, axes: Sequence[Axis]) -> None:
    """CaseError with every fault of the keys and of their first and last values."""
    faults: list[Fault] = []
    for axis in axes:
        rigs = axis.values and axis.key not in (FREQUENCY, SHARE, *STARTS)
        for value in {axis.values[0], axis.values[-1]} if rigs else ():
            try:
                model.at({axis.key: value}).checked()
            except CaseError as error:
                faults += error.faults
    if faults:
        raise CaseError(faults)


def _frequency(case: Case, axes: Mapping[str, ArrayLike], given: float | None) -> float | None:
    """The drive frequency where it is no axis: as given, or the one of the case's sweep."""
    if FREQUENCY in axes or given is not None:
        return given
    return float(case.sweep.frequency[0]) if len(case.sweep.frequency) == 1 else None


def faults_of(grid: Grid) -> list[str]:
    """Faults of the axes of a grid, each with its cure."""
    keys = [axis.key for axis in grid.axes]
    found = [] if keys else ["a grid has at least one axis"]
    found += [f"{axis.key}: has no value" for axis in grid.axes if not axis.values]
    faults = axis_faults(keys, bool(grid.ways), grid.frequency, grid.starts is not None)
    found += [f"{key}: {message}" for key, message in faults]
    if grid.strobes > grid.hold:
        found.append(f"strobes: {grid.strobes} values need as many periods held: hold is {grid.hold}")
    if ("strobes" in grid.quantities) != (grid.strobes > 0):
        found.append("strobes: the quantity and how many of it go together")
    return found


SECONDS = 1.0  # of a block, about: what a run that is killed may lose
PERIOD = 1.5e-6  # s that a drive period of one mode takes, about
POINT, CALL, TIMES = 4e-5, 1e-3, 4  # s that a point takes beside its periods, and a call of the batch, about; ratio
MOST_CARRIED = 1_000_000  # points of a block whose lines take steps together
TOGETHER = 8  # lines of a block at most of a picture whose motions are judged: those that stand in lanes together
SHOT = 4  # lines of a block whose motions are shot at
LEAST, MOST = 256, 50_000  # points of a block
FILES = 20_000  # blocks of a map, about: of larger maps each is longer, so that one client can hand them all out


PICTURED: Mapping[str, Source] = {"verdict": "judged", "stability": "orbits"}


def plan_of(case: Case, name: str | MapPlan) -> MapPlan:
    """The plan of a map, or the one that is given; KeyError names those of the case."""
    if isinstance(name, MapPlan):
        return name
    if name not in case.maps:
        known = f"there are {', '.join(case.maps)}" if case.maps else "the case has none: add a table [map.NAME]"
        raise KeyError(f"no map {name!r}: {known}")
    return case.maps[name]


def grids_of(case: Case, plan: MapPlan) -> Mapping[str, Grid]:
    """The grid of each fidelity of a map; errors as in ``evaluate``."""
    starts = None if plan.starts is None else Starts(plan.starts, plan.seed, plan.spread or 0.0)
    kind = PICTURED.get(plan.picture, "flown")
    swept = {"judged": (plan.quantity, *SWEPT), "orbits": ("period",)}.get(kind, plan.quantities)
    if kind != "flown":
        _require_plane(plan)
    grids = {
        fidelity: grid_of(
            case, fidelity, {axis.key: axis.values for axis in plan.axes}, quantities=swept,
            direction=plan.direction, frequency=plan.frequency, settle=plan.settle, hold=plan.hold,
            output=plan.output, strobes=plan.strobes, starts=starts,
        )
        for fidelity in models_of(case, plan).twins
    }  # fmt: skip
    if kind == "flown":
        return grids
    ways: tuple[Way, ...] = ("harder", "softer") if kind == "orbits" else ("up", "down")
    own = partial(replace, quantities=plan.quantities, motions=kind, periods=plan.periods, ways=ways)
    return {name: own(grid) for name, grid in grids.items()}


def _require_plane(plan: MapPlan) -> None:
    for axis in plan.axes:
        if len(axis.values) < 2 or np.any(np.diff(axis.values) <= 0):
            raise ValueError(f'{axis.key}: picture = "{plan.picture}" takes two values or more, which ascend')


def key_of(case: Case, grid: Grid) -> str:
    """Digest of all that decides the numbers of a grid, the code aside."""
    rest = {"fidelity": grid.fidelity} | asdict(replace(grid, model=None))  # type: ignore[arg-type]
    del rest["model"]
    if grid.motions == "flown":
        del rest["motions"], rest["periods"]
    if not grid.lanes:
        del rest["lanes"]  # so that maps of earlier versions stay the same ones
    return sha256(f"{case.own[grid.fidelity]} {rest!r}".encode()).hexdigest()


def lines_of_block(case: Case, grid: Grid) -> int:
    """Number of lines of a block: those that take about ``SECONDS``, and at least one.

    Where the state is carried, all lines of a block take a step of the last axis in one call: there are as many as
    make the points ``TIMES`` times as long as the call.
    """
    if grid.motions == "orbits" and case.system(grid.fidelity).beyond_plain:
        return SHOT
    if grid.motions != "flown":
        return -(-grid.lines // -(-grid.lines // TOGETHER))
    modes = case.fidelities[grid.fidelity].modes or 1
    seconds = POINT + (grid.settle + grid.hold) * PERIOD * (1 + modes / 8)
    line = prod(grid.shape)
    points = min(max(SECONDS / seconds, LEAST, grid.lines * line / FILES), MOST)
    together = min(TIMES * CALL / seconds, MOST_CARRIED / line) if grid.ways else 1
    return max(1, min(int(max(points / line, together)), grid.lines))
