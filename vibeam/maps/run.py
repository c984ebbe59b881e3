"""Run of a map: block by block in threads, each kept on disk, gathered to one file at the end."""

from __future__ import annotations

from collections.abc import Callable
from glob import escape
from math import prod
from pathlib import Path
from threading import Lock
from time import monotonic
from typing import TYPE_CHECKING

from vibeam.exchange.whole_files import regular
from vibeam.flight.engine.threads import Stopped
from vibeam.maps.block import Block
from vibeam.maps.cluster import Cluster, evaluate_here
from vibeam.maps.evaluate import grids_of, key_of, lines_of_block, plan_of
from vibeam.maps.job import Job, name_of, points_of
from vibeam.maps.result import MapResult
from vibeam.maps.store.blocks import discard, opened, write_block
from vibeam.maps.store.gathered import finished, gather, is_ours, read_map
from vibeam.runs.parallel import run_parallel
from vibeam.runs.store.errors import StoreError, unwritable
from vibeam.runs.store.lock import locked

if TYPE_CHECKING:
    from threading import Event

    from vibeam.case.case import Case

__all__ = ["MapResult", "run_map"]
Progress = Callable[[int, int], None]
EVERY, SHARE = 5.0, 20.0  # s between partial pictures at least, and how many times as long as one takes


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
            manifest = opened(folder, keys, {name: lines_of_block(case, grid) for name, grid in grids.items()})
            job = Job.begun(case, plan, grids, manifest, folder, path)
            _compute(job, progress, partial, workers, cluster)
            found = job.found
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
        if target.exists() and not is_ours(target):
            raise StoreError(f"{path}: is no file of a map: choose another --out, or delete it")
        discard(folder)
        target.unlink(missing_ok=True)
    except OSError as fault:
        raise unwritable(path, fault, "choose another --out") from None


def _compute(
    job: Job,
    progress: Progress | None,
    partial: Callable[[MapResult], None] | None,
    workers: int | None,
    cluster: Cluster | None,
) -> None:
    """Compute the missing blocks, then gather all."""
    lock, watch = Lock(), _Watch()
    if progress:
        progress(job.found, points_of(job.blocks))

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
            job.done.add(name_of(block))
        if progress:
            progress(points_of(job.there), points_of(job.blocks))
        if partial and len(job.done) < len(job.blocks) and watch.due():
            watch.drawn(lambda: partial(job.result()))

    run_parallel(task, job.missing, workers if cluster is None else cluster.blocks)
    gather(job.path, job.case, job.plan, job.keys, job.sources())


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
