"""The grids of a [map.NAME]: one for each of its fidelities, with the key of all that decides its numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from hashlib import sha256
from math import prod
from typing import TYPE_CHECKING

from vibeam.case.plans import MapPlan
from vibeam.maps.block import Block, Grid
from vibeam.maps.evaluate import grid_of
from vibeam.maps.points import Starts

if TYPE_CHECKING:
    from vibeam.case.case import Case

SECONDS = 1.0  # of a block, about: what a run that is killed may lose
PERIOD = 1.5e-6  # s that a drive period of one mode takes, about
POINT, CALL, SHARE = 4e-5, 1e-3, 4  # s that a point takes beside its periods, and a call of the batch, about; ratio
MOST_CARRIED = 1_000_000  # points of a block whose lines take steps together
LEAST, MOST = 256, 50_000  # points of a block
FILES = 20_000  # blocks of a map, about: of larger maps each is longer, so that one client can hand them all out


def plan_of(case: Case, name: str) -> MapPlan:
    """The plan of a map; KeyError names those of the case."""
    if name not in case.maps:
        known = f"there are {', '.join(case.maps)}" if case.maps else "the case has none: add a table [map.NAME]"
        raise KeyError(f"no map {name!r}: {known}")
    return case.maps[name]


def grids_of(case: Case, plan: MapPlan) -> Mapping[str, Grid]:
    """The grid of each fidelity of a map; errors as in ``evaluate``."""
    starts = None if plan.starts is None else Starts(plan.starts, plan.seed, plan.spread or 0.0)
    return {
        fidelity: grid_of(
            case, fidelity, {axis.key: axis.values for axis in plan.axes}, quantities=plan.quantities,
            direction=plan.direction, frequency=plan.frequency, settle=plan.settle, hold=plan.hold,
            output=plan.output, strobes=plan.strobes, starts=starts,
        )
        for fidelity in plan.fidelities
    }  # fmt: skip


def key_of(case: Case, grid: Grid) -> str:
    """Digest of all that decides the numbers of a grid, the code aside."""
    rest = {"fidelity": grid.fidelity} | asdict(replace(grid, model=None))  # type: ignore[arg-type]
    del rest["model"]
    if not grid.lanes:
        del rest["lanes"]  # so that maps of earlier versions stay the same ones
    return sha256(f"{case.own[grid.fidelity]} {rest!r}".encode()).hexdigest()


def lines_of_block(case: Case, grid: Grid) -> int:
    """Number of lines of a block: those that take about ``SECONDS``, and at least one.

    Where the state is carried, all lines of a block take a step of the last axis in one call: there are as many as
    make the points ``SHARE`` times as long as the call.
    """
    modes = case.fidelities[grid.fidelity].modes or 1
    seconds = POINT + (grid.settle + grid.hold) * PERIOD * (1 + modes / 8)
    line = prod(grid.shape)
    points = min(max(SECONDS / seconds, LEAST, grid.lines * line / FILES), MOST)
    together = min(SHARE * CALL / seconds, MOST_CARRIED / line) if grid.ways else 1
    return max(1, min(int(max(points / line, together)), grid.lines))


def blocks_of(grid: Grid, size: int) -> list[Block]:
    """The blocks of a grid, ``size`` lines each, the last one shorter."""
    return [Block(grid, first, min(first + size, grid.lines)) for first in range(0, grid.lines, size)]
