"""Blocks of a map that are on disk, those that are not yet, and what they hold."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.case.grid_keys import MapPlan
from vibeam.maps.block import DTYPES, Block, Grid
from vibeam.maps.evaluate import GridResponse, blocks_of
from vibeam.maps.gathered import SHOWN, Source, steps_of
from vibeam.maps.points import shape_of
from vibeam.maps.result import MapResult
from vibeam.runs.keys import digest_of_code
from vibeam.store import blocks as files
from vibeam.store.blocks import Values
from vibeam.store.errors import StoreError
from vibeam.store.place import Place
from vibeam.system.quantities import Ended

if TYPE_CHECKING:
    from vibeam.case.case import Case


def block_path(folder: Path, block: Block) -> Path:
    """File of a block."""
    return files.block_path(folder, block.grid.fidelity, block.first)


def write_block(path: Path, folder: Path, block: Block, key: str, values: Values) -> None:
    """Write a block of a grid with that key; StoreError, naming ``path``, where the disk fails."""
    files.write_block(path, block_path(folder, block), _identity(block, key), values)


def read_block(folder: Path, block: Block, key: str) -> Values | None:
    """Values of a block; None where it has no file, or one that is damaged or of another grid or code."""
    return files.read_block(block_path(folder, block), _identity(block, key))


def _identity(block: Block, key: str) -> str:
    return f"{key} {block.first} {block.last} {digest_of_code()}"


def manifest_of(folder: Path, keys: Mapping[str, str], sizes: Mapping[str, int]) -> files.Manifest:
    """The manifest of the blocks of a map in ``folder``; StoreError where these are of another map or other code."""
    return files.manifest(folder, files.Manifest(dict(keys), dict(sizes), digest_of_code()))


ASIDE = ("state", "resting")  # shown by no picture of a map under way


def partial_response(grid: Grid, known: Iterable[tuple[Block, Values | None]], most: int = SHOWN) -> GridResponse:
    """Response of the blocks that are ``known``; a point of any other is NaN and not run yet."""
    steps, lines = steps_of(grid, most), np.arange(grid.lines)
    above = shape_of(grid.axes)[:-1]
    kept = np.ones(grid.lines, dtype=bool)
    for place, step in zip(np.unravel_index(lines, above) if above else (), steps, strict=False):
        kept &= place % step == 0
    rows = np.cumsum(kept) - 1
    shown = [name for name in grid.quantities if name not in ASIDE]
    values = {name: _blank(grid, name, int(kept.sum()), steps[-1]) for name in shown}
    for block, found in known:
        mine = np.flatnonzero(kept[block.first : block.last])
        for name, each in (found or {}).items() if mine.size else ():
            if name not in values:
                continue
            values[name][rows[block.first + mine]] = each[mine][:, :, :: steps[-1]]
    axes = {axis.key: np.array(axis.values)[::step] for axis, step in zip(grid.axes, steps, strict=True)}
    shape = tuple(len(each) for each in axes.values())
    made = {name: each.reshape(*shape[:-1], *each.shape[1:]) for name, each in values.items()}
    return GridResponse(
        grid.fidelity, axes, grid.ways or ("apart",),
        {name: np.moveaxis(each, len(shape) - 1, 0) for name, each in made.items()},
    )  # fmt: skip


def _blank(grid: Grid, name: str, lines: int, step: int) -> NDArray[Any]:
    """Values of points that are not run yet."""
    ways, columns, *starts = grid.shape
    more = (grid.strobes,) if name == "strobes" else ()
    unknown = {"ended": Ended.NOT_RUN.code, "period": 0}.get(name, np.nan)
    return np.full((lines, ways, -(-columns // step), *starts, *more), unknown, DTYPES.get(name, float))


@dataclass
class MapJob:
    """Blocks of a map: all of them, and which are on disk."""

    case: Case
    plan: MapPlan
    grids: Mapping[str, Grid]
    keys: Mapping[str, str]
    place: Place
    blocks: list[Block] = field(default_factory=list)
    done: set[tuple[str, int]] = field(default_factory=set)
    found: int = 0

    @classmethod
    def begun(
        cls, case: Case, plan: MapPlan, grids: Mapping[str, Grid], manifest: files.Manifest, place: Place
    ) -> MapJob:  # fmt: skip
        """All blocks; those that are there and whole are done."""
        job = cls(case, plan, grids, manifest.keys, place)
        for name, grid in grids.items():
            job.blocks += blocks_of(grid, manifest.sizes[name])
        stored = [block for block in job.blocks if job.read(block) is not None]
        job.done |= {name_of(block) for block in stored}
        job.found = points_of(stored)
        return job

    @property
    def missing(self) -> list[Block]:
        """Blocks that are not on disk."""
        return [block for block in self.blocks if name_of(block) not in self.done]

    @property
    def there(self) -> list[Block]:
        """Blocks that are on disk."""
        return [block for block in self.blocks if name_of(block) in self.done]

    def read(self, block: Block) -> Values | None:
        """Values of a block; None where it has no file, or one that is damaged."""
        return read_block(self.place.folder, block, self.keys[block.grid.fidelity])

    def result(self) -> MapResult:
        """Result of the blocks that are known now."""
        there = self.there
        known = {
            name: partial_response(
                grid, ((block, self.read(block)) for block in there if block.grid.fidelity == name)
            )
            for name, grid in self.grids.items()
        }  # fmt: skip
        total, done = points_of(self.blocks), points_of(there)
        return MapResult(self.case, self.plan, known, total, self.found, done, self.place.path)

    def sources(self) -> list[Source]:
        """All blocks with their values, fidelity by fidelity; StoreError where one is damaged."""
        return [Source(grid, partial(self._stored, self._of(name))) for name, grid in self.grids.items()]

    def _of(self, fidelity: str) -> list[Block]:
        return [block for block in self.blocks if block.grid.fidelity == fidelity]

    def _stored(self, blocks: list[Block]) -> Iterator[tuple[Block, Values]]:
        for block in blocks:
            values = self.read(block)
            if values is None:
                raise StoreError(f"{self.place.folder}: a block was damaged meanwhile: run again to compute it anew")
            yield block, values


def name_of(block: Block) -> tuple[str, int]:
    """Name of a block, unlike all others of its map."""
    return block.grid.fidelity, block.first


def points_of(blocks: list[Block]) -> int:
    """Number of points of some blocks."""
    return sum(block.size for block in blocks)
