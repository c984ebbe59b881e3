"""Blocks of a map that are on disk, those that are not yet, and what they hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from vibeam.case.plans import MapPlan
from vibeam.maps.block import Block, Grid, Values
from vibeam.maps.grids import blocks_of
from vibeam.maps.partial import partial_response
from vibeam.maps.refined import Passes
from vibeam.maps.result import MapResult
from vibeam.maps.store.blocks import read_block
from vibeam.maps.store.gathered import Source
from vibeam.maps.store.manifest import Manifest
from vibeam.run.store.errors import StoreError

if TYPE_CHECKING:
    from vibeam.case.case import Case


@dataclass
class Job:
    """Blocks of a map: those known so far (of a refined grid pass by pass), and which of them are on disk."""

    case: Case
    plan: MapPlan
    grids: Mapping[str, Grid]
    keys: Mapping[str, str]
    folder: Path
    path: Path
    blocks: list[Block] = field(default_factory=list)
    done: set[tuple[str, int]] = field(default_factory=set)
    found: int = 0
    passes: dict[str, Passes] = field(default_factory=dict)
    latest: dict[str, list[Block]] = field(default_factory=dict)

    @classmethod
    def begun(
        cls, case: Case, plan: MapPlan, grids: Mapping[str, Grid], manifest: Manifest, folder: Path, path: Path
    ) -> Job:  # fmt: skip
        """All blocks that follow from what is there; those that are there and whole are done."""
        job = cls(case, plan, grids, manifest.keys, folder, path)
        for name, grid in grids.items():
            if grid.refine:
                job.passes[name] = Passes(grid, manifest.sizes[name])
            job._add(name, job.passes[name].first() if grid.refine else blocks_of(grid, manifest.sizes[name]))
        job.grow()
        return job

    def _add(self, fidelity: str, blocks: list[Block]) -> None:
        stored = [block for block in blocks if self.read(block) is not None]
        self.blocks += blocks
        self.latest[fidelity] = blocks
        self.done |= {name_of(block) for block in stored}
        self.found += points_of(stored)

    def grow(self) -> None:
        """Add the passes that follow from finished ones."""
        for name, passes in self.passes.items():
            while self.latest[name] and all(name_of(block) in self.done for block in self.latest[name]):
                self._add(name, passes.following(self._stored(self.latest[name])))

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
        return read_block(self.folder, block, self.keys[block.grid.fidelity])

    def result(self) -> MapResult:
        """What is known now."""
        there = self.there
        known = {
            name: partial_response(
                grid, ((block, self.read(block)) for block in there if block.grid.fidelity == name)
            )
            for name, grid in self.grids.items()
        }  # fmt: skip
        total, done = points_of(self.blocks), points_of(there)
        return MapResult(self.case, self.plan, known, total, self.found, done, self.path)

    def sources(self) -> list[Source]:
        """All blocks with their values, fidelity by fidelity; StoreError where one is damaged."""
        return [Source(grid, partial(self._stored, self._of(name))) for name, grid in self.grids.items()]

    def _of(self, fidelity: str) -> list[Block]:
        return [block for block in self.blocks if block.grid.fidelity == fidelity]

    def _stored(self, blocks: list[Block]) -> Iterator[tuple[Block, Values]]:
        for block in blocks:
            values = self.read(block)
            if values is None:
                raise StoreError(f"{self.folder}: a block was damaged meanwhile: run again to compute it anew")
            yield block, values


def name_of(block: Block) -> tuple[str, int]:
    """What tells a block from all others of its map."""
    return block.grid.fidelity, block.first


def points_of(blocks: list[Block]) -> int:
    """Number of points of some blocks."""
    return sum(block.size for block in blocks)
