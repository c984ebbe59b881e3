"""Planes of all models, block by block of rows in threads; finished blocks on disk, where a folder is given."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import Event, Lock
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.grid_keys import FREQUENCY
from vibeam.flight.engine.threads import Stopped
from vibeam.maps.block import Block, Grid, Values, evaluate_block
from vibeam.maps.evaluate import blocks_of, grid_of, key_of
from vibeam.maps.job import manifest_of, read_block, write_block
from vibeam.maps.points import GridPoints, grid_points
from vibeam.runs.parallel import heartbeat, run_parallel
from vibeam.store.blocks import discard
from vibeam.store.place import locked
from vibeam.studies.verdict.axes import ExactBoundary, exact_boundaries
from vibeam.studies.verdict.motions import Motions, judged, motions
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.studies.verdict.axes import VerdictAxis


ROWS = 8  # of a block at most: the points that stand in the processor's lanes together
READ = ("period", "ended", "state", "resting", "cpu_seconds")
Task = Callable[[Event], None]


@dataclass(frozen=True)
class ModelPlane:
    """One model over the plane: what is evaluated, the key of all that decides it, its points (rows, columns)."""

    grid: Grid
    key: str
    points: GridPoints

    @property
    def name(self) -> str:
        """The fidelity."""
        return self.grid.fidelity

    @property
    def size(self) -> int:
        """Rows of a block: blocks as even as may be."""
        return -(-self.grid.lines // -(-self.grid.lines // ROWS))


@contextmanager
def kept_beside(path: Path, fresh: bool = False) -> Iterator[Path]:
    """Folder of blocks beside the file ``path``, locked; deleted at the end, or at once with ``fresh``.

    StoreError where another process has it.
    """
    with locked(path) as place:
        if fresh:
            discard(place.folder)
        yield place.folder
        discard(place.folder)


def plane_of(case: Case, name: str, axis: VerdictAxis, frequency: Array, quantity: str) -> ModelPlane:
    """The plane of a model; errors as in ``vibeam.evaluate``."""
    axes = {axis.key: axis.values, FREQUENCY: frequency}
    grid = grid_of(case, name, axes, quantities=(quantity, *READ), direction="both", lanes=True)
    points = grid_points(grid.model, grid.axes, grid.frequency, np.arange(len(axis.values)))
    return ModelPlane(grid, f"verdict {key_of(case, grid)}", points)


def computed(
    case: Case, planes: Sequence[ModelPlane], axis: VerdictAxis, frequency: Array, quantity: str,
    folder: Path | None = None, tell: Callable[[str], None] | None = None,
) -> tuple[list[Motions], list[ExactBoundary]]:  # fmt: skip
    """Motions of each model, and all exact boundaries: the dearest model first, so that both ends meet.

    Blocks lie in ``folder``, where one is given, and those that are there and whole are not computed again. StoreError
    for a folder of another map, or where the disk fails.
    """
    work = _Work(case, quantity, folder, tell)
    known: dict[str, list[ExactBoundary]] = {}
    if folder is not None:
        manifest_of(folder, {each.name: each.key for each in planes}, {each.name: each.size for each in planes})
    tasks = list[Task]()
    for plane in sorted(planes, key=lambda plane: -plane.points.systems[0].size):
        mine = [work.task(plane, block) for block in blocks_of(plane.grid, plane.size)]
        tasks += [*mine[:1], _boundary_task(known, case, plane, axis, frequency), *mine[1:]]
    with heartbeat(tell, lambda: work.where(planes)):
        run_parallel(lambda task, stop: task(stop), tasks)
    found = [motions(plane.name, plane.points, work.gathered(plane)) for plane in planes]
    return found, [boundary for plane in planes for boundary in known[plane.name]]


def _boundary_task(
    known: dict[str, list[ExactBoundary]], case: Case, plane: ModelPlane, axis: VerdictAxis, frequency: Array
) -> Task:
    def task(stop: Event) -> None:
        known[plane.name] = list(exact_boundaries(case, plane.name, plane.points, axis, frequency))

    return task


class _Work:
    """Blocks under way: those in memory, and their files."""

    def __init__(self, case: Case, quantity: str, folder: Path | None, tell: Callable[[str], None] | None) -> None:
        self.case, self.quantity, self.folder, self.tell = case, quantity, folder, tell
        self.known: dict[tuple[str, int], Values] = {}
        self._lock = Lock()

    def task(self, plane: ModelPlane, block: Block) -> Task:
        """Compute one block, or find it in the folder."""

        def task(stop: Event) -> None:
            found = None if self.folder is None else read_block(self.folder, block, plane.key)
            if found is None:
                found = self._computed(block)
                if stop.is_set():
                    raise Stopped
                if self.folder is not None:
                    write_block(self.folder, self.folder, block, plane.key, found)
            with self._lock:
                self.known[plane.name, block.first] = found
                if self.tell is not None:
                    self.tell(self.where([plane]))

        return task

    def where(self, planes: Sequence[ModelPlane]) -> str:
        """Numbers of rows of each model that are known."""
        known = [(name, len(values["value"])) for (name, _), values in list(self.known.items())]
        return ", ".join(
            f"{plane.name}: {sum(rows for name, rows in known if name == plane.name)} of {plane.grid.lines} rows"
            for plane in planes
        )

    def _computed(self, block: Block) -> Values:
        grid, lines = block.grid, np.arange(block.first, block.last)
        points = grid_points(grid.model, grid.axes, grid.frequency, lines)
        swept = {name: np.moveaxis(values, 1, 0) for name, values in evaluate_block(block, threads=1).items()}
        found = judged(self.case.sweep, points, swept, self.quantity)
        return {name: np.moveaxis(values, 0, 1) for name, values in found.items()}

    def gathered(self, plane: ModelPlane) -> Values:
        """All rows of a model, (ways, rows, columns, …)."""
        parts = [self.known[plane.name, block.first] for block in blocks_of(plane.grid, plane.size)]
        return {name: np.moveaxis(np.concatenate([part[name] for part in parts]), 1, 0) for name in parts[0]}
