"""Run of a map: block by block in threads, each kept on disk, gathered to one file at the end."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from glob import escape
from math import prod
from pathlib import Path
from threading import Lock
from time import monotonic
from typing import TYPE_CHECKING

from vibeam.case.plans import MapPlan
from vibeam.exchange.whole_files import regular
from vibeam.flight.pause import Stopped
from vibeam.maps.block import Block, Grid, Values
from vibeam.maps.cluster import Cluster, evaluate_here
from vibeam.maps.evaluate import GridResponse
from vibeam.maps.grids import blocks_of, grids_of, key_of, lines_of_block, plan_of
from vibeam.maps.partial import partial_response
from vibeam.maps.store.blocks import digest_of, read_block, write_block
from vibeam.maps.store.gathered import Source, finished, gather, read_map
from vibeam.maps.store.manifest import discard, opened
from vibeam.run.parallel import run_parallel
from vibeam.run.store.errors import StoreError, unwritable
from vibeam.run.store.lock import locked

if TYPE_CHECKING:
    from threading import Event

    from vibeam.case.case import Case

Progress = Callable[[int, int], None]

EVERY, SHARE = 5.0, 20.0  # s between partial pictures at least, and how many times as long as one takes


@dataclass(frozen=True)
class MapResult:
    """A map: quantities of each fidelity (of very many points every so many along the last two axes).

    ``points`` in all, of which ``found`` were in the file; ``done`` of them are computed. ``path``: its file.
    """

    case: Case
    plan: MapPlan
    responses: Mapping[str, GridResponse]
    points: int
    found: int
    done: int
    path: Path

    def __getitem__(self, fidelity: str) -> GridResponse:
        return self.responses[fidelity]


@dataclass
class _Job:
    """Blocks of a map that are there, and those that are not yet."""

    case: Case
    plan: MapPlan
    grids: Mapping[str, Grid]
    keys: Mapping[str, str]
    folder: Path
    path: Path
    blocks: list[Block]
    done: set[tuple[str, int]]
    found: int = 0

    def points(self, blocks: list[Block]) -> int:
        """Number of points of some blocks: ways and random starts are counted each."""
        return sum((block.last - block.first) * prod(block.grid.shape) for block in blocks)

    @property
    def there(self) -> list[Block]:
        """Blocks that are on disk."""
        return [block for block in self.blocks if _name(block) in self.done]

    def result(self, responses: Mapping[str, GridResponse]) -> MapResult:
        """What is known now."""
        total, done = self.points(self.blocks), self.points(self.there)
        return MapResult(self.case, self.plan, responses, total, self.found, done, self.path)


def run_map(
    case: Case,
    name: str,
    out: str | Path,
    *,
    fresh: bool = False,
    workers: int | None = None,
    progress: Progress | None = None,
    partial: Callable[[MapResult], None] | None = None,
    cluster: Cluster | None = None,
) -> MapResult:
    """Compute the map ``name`` of a case into the file ``out`` (HDF5), or go on with what is there.

    Blocks of lines lie as files of their own in ``OUT.parts`` until all are there: a run that is killed loses the
    blocks in flight, one for each of the ``workers`` (threads; None: one a core). ``fresh``: keep nothing. ``progress``
    is called with the points done and their total, ``partial`` with what is known every few seconds, from any thread.
    ``cluster``: other processes that compute the blocks (``vibeam.maps.cluster.connected``); this one writes.

    KeyError for an unknown map, CaseError for values that the case may not have, ValueError for a case that a grid
    cannot take, StoreError where files are another's or the disk fails.
    """
    plan, path = plan_of(case, name), Path(out)
    grids = grids_of(case, plan)
    keys = {fidelity: key_of(case, grid) for fidelity, grid in grids.items()}
    try:
        target = regular(path)
    except OSError as fault:
        raise StoreError(f"{path}: {fault.strerror}") from None
    folder = target.with_name(f"{target.name}.parts")
    with locked(path, target):
        _tidy(target)
        if fresh:
            _remove(path, target, folder)
        found = total = sum(grid.lines * prod(grid.shape) for grid in grids.values())
        if not finished(target, keys):
            job = _job(case, plan, grids, keys, folder, path)
            found = job.found
            _compute(job, progress, partial, workers, cluster)
        elif progress:
            progress(total, total)
        discard(folder)
    return MapResult(case, plan, read_map(target, grids), total, found, total, path)


def _tidy(target: Path) -> None:
    """Delete what a run that was killed has left of files that it had begun, pictures of the map among them."""
    for file in target.parent.glob(f".{escape(target.stem)}.*part"):
        file.unlink(missing_ok=True)


def _remove(path: Path, target: Path, folder: Path) -> None:
    try:
        discard(folder)
        target.unlink(missing_ok=True)
    except OSError as fault:
        raise unwritable(path, fault, "choose another --out") from None


def _job(
    case: Case, plan: MapPlan, grids: Mapping[str, Grid], keys: Mapping[str, str], folder: Path, path: Path
) -> _Job:
    """All blocks; those that are there and whole are done."""
    sizes = {name: lines_of_block(case, grid) for name, grid in grids.items()}
    manifest = opened(folder, keys, sizes)
    blocks = [block for name, grid in grids.items() for block in blocks_of(grid, manifest.sizes[name])]
    done = {_name(block) for block in blocks if read_block(folder, block, keys[block.grid.fidelity]) is not None}
    job = _Job(case, plan, grids, keys, folder, path, blocks, done)
    job.found = job.points(job.there)
    return job


def _name(block: Block) -> tuple[str, int]:
    return block.grid.fidelity, block.first


def _compute(
    job: _Job,
    progress: Progress | None,
    partial: Callable[[MapResult], None] | None,
    workers: int | None,
    cluster: Cluster | None,
) -> None:
    """Compute the missing blocks, then gather all."""
    lock, watch, total = Lock(), _Watch(), job.points(job.blocks)
    if progress:
        progress(job.found, total)

    evaluate = evaluate_here if cluster is None else cluster.evaluate

    def task(block: Block, stop: Event) -> None:
        values = evaluate(block)
        if stop.is_set():
            raise Stopped
        try:
            write_block(job.folder, block, job.keys[block.grid.fidelity], values)
        except OSError as fault:
            raise unwritable(job.path, fault, "make room, then run again to go on") from None
        with lock:
            job.done.add(_name(block))
        if progress:
            progress(job.points(job.there), total)
        if partial and len(job.done) < len(job.blocks) and watch.due():
            watch.drawn(lambda: partial(job.result(_known(job))))

    missing = [block for block in job.blocks if _name(block) not in job.done]
    run_parallel(task, missing, workers if cluster is None else cluster.blocks)
    gather(job.path, job.case, job.plan, job.keys, _sources(job))


def _known(job: _Job) -> Mapping[str, GridResponse]:
    """What the blocks on disk hold."""
    there = job.there
    return {
        name: partial_response(
            grid,
            ((block, read_block(job.folder, block, job.keys[name])) for block in there if block.grid.fidelity == name),
        )
        for name, grid in job.grids.items()
    }


def _sources(job: _Job) -> Iterator[Source]:
    for name, grid in job.grids.items():
        yield Source(grid, _stored(job, [block for block in job.blocks if block.grid.fidelity == name]))


def _stored(job: _Job, blocks: list[Block]) -> Iterator[tuple[Block, Values, str]]:
    for block in blocks:
        key = job.keys[block.grid.fidelity]
        values = read_block(job.folder, block, key)
        if values is None:
            raise StoreError(f"{job.folder}: a block was damaged meanwhile: run again to compute it anew")
        yield block, values, digest_of(block, key, values)


class _Watch:
    """Clock of the partial pictures: one at a time, and none that would cost more than a twentieth of the run."""

    def __init__(self) -> None:
        self._lock, self._next = Lock(), monotonic() + EVERY

    def due(self) -> bool:
        """Test whether a picture is due; True for one thread alone."""
        return monotonic() >= self._next and self._lock.acquire(blocking=False)

    def drawn(self, draw: Callable[[], None]) -> None:
        """Draw it."""
        begun = monotonic()
        try:
            draw()
        finally:
            self._next = monotonic() + max(EVERY, SHARE * (monotonic() - begun))
            self._lock.release()
