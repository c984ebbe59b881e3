"""Run of a map: block by block in threads, each kept on disk, gathered to one file at the end."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from math import prod
from pathlib import Path
from threading import Lock
from time import process_time
from typing import TYPE_CHECKING, Any

from vibeam.case.grid_keys import is_structural
from vibeam.case.source import of_source
from vibeam.flight.engine.threads import Stopped
from vibeam.maps.block import Block, Grid
from vibeam.maps.cluster import Cluster, evaluate_here
from vibeam.maps.evaluate import blocks_of, grids_of, key_of, lines_of_block, plan_of
from vibeam.maps.gathered import Source, finished, gather, is_ours, read_map, stored_keys
from vibeam.maps.result import MapResult
from vibeam.runs.comparison.differences import listed
from vibeam.runs.keys import digest_of_code
from vibeam.runs.parallel import run_parallel
from vibeam.store import blocks as files
from vibeam.store.blocks import Values, discard, known_manifest
from vibeam.store.errors import ELSEWHERE, StoreError, unwritable
from vibeam.store.place import Place, Tell, locked, place_of, warn
from vibeam.system.progress import telling

if TYPE_CHECKING:
    from threading import Event

    from vibeam.case.case import Case
    from vibeam.case.fidelity import Model
    from vibeam.case.grid_keys import MapPlan

__all__ = ["MapResult", "run_map", "stored_map"]
Progress = Callable[[int, int], None]


@of_source
def run_map(
    case: Case,
    name: str | MapPlan,
    out: str | Path,
    *,
    fresh: bool = False,
    workers: int | None = None,
    progress: Progress | bool | None = None,
    cluster: Cluster | None = None,
    tell: Tell | None = None,
) -> MapResult:
    """Compute the map ``name`` of a case, or one by a plan, into the file ``out`` (HDF5), or go on with what is there.

    Blocks of lines lie as files of their own in ``OUT.parts`` until all are there: a run that is killed loses the
    blocks in flight, one for each of the ``workers`` (threads; None: one a core). ``fresh``: keep nothing.
    ``progress``: True shows a bar; a function is called, from any thread, with the points done and their total.
    A map of the case before an edit is kept aside, ``OUT.1.h5``; ``tell`` gets one line on that, else it is a warning.
    ``cluster``: other processes that compute the blocks (``vibeam.maps.cluster.connected``); this one writes.

    KeyError for an unknown map, CaseError for values that the case may not have, ValueError for a case that a grid
    cannot take, StoreError where files are another's or the disk fails.

    >>> import vibeam
    >>> axes = {"stop.gap": ["0 mm", "0.1 mm"], "sweep.frequency": ["14 Hz", "15 Hz"]}
    >>> asked = {"axes": [{"key": key, "values": each} for key, each in axes.items()], "fidelities": ["sdof"]}
    >>> result = vibeam.run_map(vibeam.load("cases/dtu_neutral.toml", {"map.plane": asked}), "plane", "plane.h5")
    >>> result.responses["sdof"].way("up")["period"].shape
    (2, 2)
    """
    plan, path = plan_of(case, name), Path(out)
    grids = grids_of(case, plan)
    keys = {fidelity: key_of(case, grid) for fidelity, grid in grids.items()}
    with locked(path) as place, telling(progress, "flying") as told:
        place.tidy(kin=place.target.stem)  # pictures of the map
        if fresh:
            _remove(place)
        else:
            _set_aside(place, keys, tell or warn)
        found = total = sum(grid.lines * prod(grid.shape) for grid in grids.values())
        if not finished(place, keys):
            job = MapJob(case, plan, grids, keys, place)
            job.begin()
            if tell is not None:
                for said in bodies_told(case, plan):
                    tell(said)
            _compute(job, told, workers, cluster)
            found = job.found
        else:
            told(total, total)
        discard(place.folder)
    return MapResult(case, plan, read_map(place.target, grids), total, found, path)


def stored_map(case: Case, name: str, path: Path) -> MapResult | None:
    """The map ``name`` of a case in the file ``path``, nothing computed; None where none is there, or another one."""
    plan = plan_of(case, name)
    grids = grids_of(case, plan)
    try:
        place = place_of(path)
        if not finished(place, {fidelity: key_of(case, grid) for fidelity, grid in grids.items()}):
            return None
    except StoreError:
        return None
    points = sum(grid.lines * prod(grid.shape) for grid in grids.values())
    return MapResult(case, plan, read_map(place.target, grids), points, points, path)


def bodies_told(case: Case, plan: MapPlan) -> Iterator[str]:
    """Sentence on each solid that a map makes anew along its axes, with what the first of these bodies takes."""
    for name in plan.fidelities or case.fidelities:
        over = _making_bodies(case.model(name), plan) if case.scene_of(name).in_three_dimensions else {}
        if over:
            begun = process_time()
            case.model(name).at({key: values[0] for key, values in over.items()}).system()
            each, count = process_time() - begun, prod(map(len, over.values()))
            bodies = f"{count} bodies over {listed(list(over))}, each meshed, factored and reduced"
            yield f"{name}: {bodies}: {each:.2g} s of CPU time the first, some {count * each:.2g} s all"


def _making_bodies(model: Model, plan: MapPlan) -> dict[str, tuple[float, ...]]:
    """Keys and values of those axes along which the structure of a model changes."""
    found: dict[str, tuple[float, ...]] = {}
    for axis in plan.axes:
        if is_structural(axis.key) and len(axis.values) > 1:
            scenes: list[Any] = [model.at({axis.key: value}).scene() for value in axis.values[:2]]
            if scenes[0].structural() != scenes[1].structural():
                found[axis.key] = axis.values
    return found


def _set_aside(place: Place, keys: Mapping[str, str], tell: Tell) -> None:
    """Give the map of the case as it was, finished or under way, a further name."""
    if stored_keys(place) not in (None, keys):
        place.keep_aside("holds the map of the case as it was", tell)
    begun = known_manifest(place.folder)
    if begun is not None and begun.keys != keys:
        place.keep_aside("holds blocks of the case as it was", tell, blocks=True)


def _remove(place: Place) -> None:
    try:
        if place.target.exists() and not is_ours(place.target):
            raise StoreError(f"{place.path}: is no file of a map: choose another --out, or delete it")
        discard(place.folder)
        place.target.unlink(missing_ok=True)
    except OSError as fault:
        raise unwritable(place.path, fault, ELSEWHERE) from None


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

    def begin(self) -> None:
        """Find all blocks; those that are there and whole are not missing.

        StoreError where those there are of another map or other code.
        """
        sizes = {name: lines_of_block(self.case, grid) for name, grid in self.grids.items()}
        wanted = files.Manifest(dict(self.keys), sizes, digest_of_code())
        begun = files.manifest(self.place.folder, wanted)
        for name, grid in self.grids.items():
            self.blocks += blocks_of(grid, begun.sizes[name])
        self.missing = [block for block in self.blocks if self.read(block) is None]
        self.found = points_of(self.blocks) - points_of(self.missing)

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


def _compute(job: MapJob, progress: Progress, workers: int | None, cluster: Cluster | None) -> None:
    """Compute the missing blocks, then gather all."""
    lock = Lock()
    done, total = job.found, points_of(job.blocks)
    progress(done, total)
    evaluate = evaluate_here if cluster is None else cluster.evaluate

    def task(block: Block, stop: Event) -> None:
        nonlocal done
        values = evaluate(block)
        if stop.is_set():
            raise Stopped
        write_block(job.place.path, job.place.folder, block, job.keys[block.grid.fidelity], values)
        with lock:
            done += block.size
        progress(done, total)

    run_parallel(task, job.missing, workers if cluster is None else cluster.blocks)
    gather(job.place, job.case, job.plan, job.keys, job.sources())
