"""Blocks of a map that are on disk, those that are not yet, and what they hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from vibeam.case.grid_keys import MapPlan
from vibeam.maps.block import Block, Grid
from vibeam.maps.evaluate import blocks_of
from vibeam.maps.gathered import Source
from vibeam.runs.keys import digest_of_code
from vibeam.store import blocks as files
from vibeam.store.blocks import Values
from vibeam.store.errors import StoreError
from vibeam.store.place import Place

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


@dataclass
class MapJob:
    """Blocks of a map: all of them, and those ``missing`` on disk."""

    case: Case
    plan: MapPlan
    grids: Mapping[str, Grid]
    keys: Mapping[str, str]
    place: Place
    blocks: list[Block] = field(default_factory=list)
    missing: list[Block] = field(default_factory=list)
    found: int = 0

    @classmethod
    def begun(
        cls, case: Case, plan: MapPlan, grids: Mapping[str, Grid], manifest: files.Manifest, place: Place
    ) -> MapJob:  # fmt: skip
        """All blocks; those that are there and whole are not missing."""
        job = cls(case, plan, grids, manifest.keys, place)
        for name, grid in grids.items():
            job.blocks += blocks_of(grid, manifest.sizes[name])
        job.missing = [block for block in job.blocks if job.read(block) is None]
        job.found = points_of(job.blocks) - points_of(job.missing)
        return job

    def read(self, block: Block) -> Values | None:
        """Values of a block; None where it has no file, or one that is damaged."""
        return read_block(self.place.folder, block, self.keys[block.grid.fidelity])

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


def points_of(blocks: list[Block]) -> int:
    """Number of points of some blocks."""
    return sum(block.size for block in blocks)
