"""Run of a map: block by block in threads, each kept on disk, gathered to one file at the end; parts of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from math import prod
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING, Any

from vibeam.case.grid_keys import is_structural
from vibeam.case.source import of_source
from vibeam.maps.block import Block, Grid
from vibeam.maps.cluster import Cluster, evaluate_here
from vibeam.maps.evaluate import grids_of, key_of, lines_of_block, plan_of
from vibeam.maps.gathered import OTHER, Source, finished, gather, is_ours, read_map, stored_keys
from vibeam.maps.result import MapResult
from vibeam.runs.comparison.differences import listed
from vibeam.runs.keys import digest_of_code
from vibeam.store.blocks import Values, discard
from vibeam.store.errors import ELSEWHERE, StoreError, writing
from vibeam.store.long_work import LongWork, WorkPart
from vibeam.store.parts import StepsOnDisk, take_part
from vibeam.store.place import Place, Tell, locked, place_of, warn
from vibeam.store.shares import are_shared, handed_over, set_aside
from vibeam.system.progress import telling

if TYPE_CHECKING:
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

    Blocks of lines lie in files of ``OUT.parts`` until all are there: a run that is killed loses the
    blocks in flight, one for each of the ``workers`` (threads; None: one a core). ``fresh``: keep nothing.
    ``progress``: True shows a bar; a function is called, from any thread, with the points done and their total.
    Within ``vibeam.store.shares.sharing`` it is what is shared: only the gathering then goes on to the file.
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
    grids, work = grids_of(case, plan), work_of(case, plan, path, cluster)
    if are_shared():
        work = handed_over(work, done=finished(place_of(path), work.keys))
    with locked(path) as place, telling(progress, "flying") as told:
        place.tidy(kin=place.target.stem)  # pictures of the map
        if fresh:
            _remove(place)
        elif not are_shared():
            _set_aside(place, work, tell or warn)
        found = total = sum(grid.lines * prod(grid.shape) for grid in grids.values())
        if not finished(place, work.keys):
            if tell is not None:
                for said in bodies_told(case, plan):
                    tell(said)
            if not are_shared():
                found = take_part(work, WorkPart(), workers if cluster is None else cluster.blocks, told).found
            _gather(place, case, plan, work, grids)
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


def _set_aside(place: Place, work: LongWork, tell: Tell) -> None:
    """Give the map of the case as it was, finished or under way, a further name."""
    if stored_keys(place) not in (None, work.keys):
        place.keep_aside("holds the map of the case as it was", tell)
    set_aside(work, tell)


def _remove(place: Place) -> None:
    with writing(place.path, ELSEWHERE):
        if place.target.exists() and not is_ours(place.target):
            raise StoreError(f"{place.path}: {OTHER}")
        discard(place.folder)
        place.target.unlink(missing_ok=True)


def work_of(case: Case, plan: MapPlan, path: Path, cluster: Cluster | None = None) -> LongWork:
    """A map as a long computation, whose steps are blocks of lines."""
    grids = grids_of(case, plan)
    evaluate = evaluate_here if cluster is None else cluster.evaluate
    return LongWork(
        path,
        {name: key_of(case, grid) for name, grid in grids.items()},
        {name: range(0, grid.lines, lines_of_block(case, grid)) for name, grid in grids.items()},
        lambda step: evaluate(Block(grids[step.name], step.first, step.last)),
        digest_of_code(),
        {name: prod(grid.shape) for name, grid in grids.items()},
    )


def _gather(place: Place, case: Case, plan: MapPlan, work: LongWork, grids: Mapping[str, Grid]) -> None:
    stored = StepsOnDisk(work)
    stored.require_all()

    def blocks(name: str) -> Iterator[tuple[Block, Values]]:
        for step in stored.work.every:
            if step.name == name:
                yield Block(grids[name], step.first, step.last), stored.values(step)

    gather(place, case, plan, work.keys, [Source(grid, partial(blocks, name)) for name, grid in grids.items()])
