"""Results file of a case: opened, written from several threads, read; with the blocks beside it, for its one writer.

What is known of a run is the file and the blocks in ``OUT.h5.parts``, whoever asks: a run that goes on, or a reader.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

from vibeam.runs.store.adaptation import FORMAT, Requirements, adapted, blank, difference, loses
from vibeam.runs.store.branches import (
    BranchPlan,
    StoredBranch,
    branch_names,
    join_blocks,
    keep_block,
    points_of,
    read_branch,
    read_rows,
    response_of,
    rows_of,
    write_rows,
)
from vibeam.runs.store.image import bytes_of, opened_image
from vibeam.runs.store.records import Kept, Keyed, KeyedRecord, keep, kept, read_models, write_models
from vibeam.store.errors import ANEW, ELSEWHERE, StoreError, reading
from vibeam.store.hdf5 import content_of, text_of
from vibeam.store.place import Place, Tell, locked, place_of
from vibeam.store.provenance import note_continued
from vibeam.system.quantities import OutputUnits
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State

if TYPE_CHECKING:
    import h5py

OTHER = f"is no vibeam result: {ELSEWHERE}, or delete it"
NAME = "name one that vibeam run has written"
MOST = 100  # blocks beside a file, then they are gathered
Plan = Callable[[Keyed], Requirements]


class Store:
    """Open results file, safe to write from several threads; made by ``opened``.

    The first points of a session put the whole file in place, further ones are blocks beside it, which the end gathers.
    ``file``: in memory; ``units``: of the output; ``models``: what the file had of its models when it was opened;
    ``blocks``: number of those that it has in memory alone; ``new``: it was made here; ``fresh``: in place of another;
    ``changed``: it says something else than on disk; ``aside``: the further name of the file that it replaces. Every
    method: StoreError where the file cannot be read or written.
    """

    def __init__(
        self, place: Place, file: h5py.File, units: OutputUnits, models: Keyed, *,
        blocks: int = 0, new: bool = False, fresh: bool = False, changed: bool = False, aside: Path | None = None,
    ) -> None:  # fmt: skip
        self._place, self._file, self._aside = place, file, aside
        self._lock = threading.Lock()
        self._blocks, self._new, self._fresh, self._changed = blocks, new, fresh, changed
        self._begun = False
        self._failure: StoreError | None = None
        self.path, self.models, self.units = place.path, models, units

    def __enter__(self) -> Store:
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: object, trace: TracebackType | None) -> None:
        """Gather the blocks; where the run failed before its first point the file stays as it was."""
        try:
            if self._failure is None and (self._blocks or self._changed) and (self._begun or kind is None):
                self._gather()
        except StoreError:
            if kind is None:  # else there is another message, and the blocks are there
                raise
        finally:
            self._file.close()
            if self._aside and not self._begun and self._place.target.exists():
                self._aside.unlink()  # nothing was replaced

    @contextmanager
    def _reading(self, where: str) -> Iterator[h5py.File]:
        with self._lock, reading(self.path, where):
            yield self._file

    @contextmanager
    def _writing(self) -> Iterator[h5py.File]:
        """Context that refuses writes after a failed one, which would build on data not on the disk."""
        with self._lock:
            if self._failure is not None:
                raise self._failure
            try:
                yield self._file
            except StoreError as failure:
                self._failure = failure
                raise

    def _gather(self) -> None:
        """Put the whole file in place, and discard the blocks, which are in it."""
        if not self._begun and self._new:
            if self._place.target.exists() and not self._fresh:
                raise StoreError(f"{self.path}: another program has made it meanwhile: {ELSEWHERE}")
            self._place.discard()  # of an old file, with the same keys perhaps
        elif not self._begun:
            note_continued(self._file["provenance"])
        self._place.replace(content_of(self._file))
        self._place.discard()
        self._begun, self._changed, self._blocks = True, False, 0

    def restore(self, branch: BranchPlan) -> StoredBranch:
        """Stored part of one branch."""
        with self._reading(f"/{branch.group}") as file:
            return read_branch(file[branch.group], branch)

    def write(self, branch: BranchPlan, start: int, block: FrequencyResponse, states: Sequence[State]) -> None:
        """Put ``block`` at the points from ``start`` on, and the ``states`` after its last ones."""
        with self._writing() as file:
            group, rows = file[branch.group], rows_of(block, states)
            write_rows(group, start, rows)
            if not self._begun or self._blocks == MOST:
                self._gather()
            else:
                keep_block(self.path, self._place.folder, group, start, rows)
                self._blocks += 1

    def has(self, fidelities: Collection[str]) -> bool:
        """Test whether there are points of any of the fidelities."""
        with self._reading("its groups") as file:
            return any(name in fidelities and points_of(file[name][way]) for name, way in branch_names(file))

    def kept(self, record: KeyedRecord[Kept], key: str) -> Kept | None:
        """The record stored for ``key``, of all that decides it; None without one."""
        with self._reading(f"/{record.place}") as file:
            return kept(file, record, key)

    def keep(self, record: KeyedRecord[Kept], key: str, value: Kept) -> None:
        """Replace a record by ``value``."""
        with self._writing() as file:
            keep(file, record, key, value)
            self._gather()

    def keep_models(self, models: Keyed) -> None:
        """Replace the properties of all models, unless they are the same."""
        with self._writing() as file:
            before, now = ({name: repr(each) for name, each in some.items()} for some in (read_models(file), models))
            if before != now:  # as text: NaN is not itself
                write_models(file, models)
                self._gather()


@contextmanager
def opened(
    path: Path, wanted: Plan, *, fresh: bool = False, tell: Tell = lambda line: None
) -> Iterator[Store]:  # fmt: skip
    """Open the results file of one case, made with its first point where there is none; locked against other processes.

    ``wanted``: what the case wants of it, called with what the file has of its models, before anything is changed.
    A file of a changed case keeps the branches whose numbers are the same; where points would be lost, the file as it
    was is kept aside; ``tell`` gets one line on either. ``fresh``: a new file takes the old one's place with its first
    point. StoreError where ``path`` is something else, or damaged, locked or not to be written, or where the case of
    another name would lose its points.
    """
    with locked(path) as place:
        place.tidy()
        if place.target.exists() and not fresh:
            store = _continued(place, wanted, tell)
        else:
            if place.target.exists():
                bytes_of(place, "r+b", FORMAT, OTHER)
            needs = wanted({})
            store = Store(place, blank(needs), needs.units, {}, new=True, fresh=fresh)
        with store:
            yield store


def _continued(place: Place, plan: Plan, tell: Tell) -> Store:
    path = place.path
    file = opened_image(place, "r+b", FORMAT, OTHER)
    with reading(path, "it"):
        blocks = join_blocks(file, place.folder)
        models = read_models(file)
    if not blocks:
        place.discard()  # what is there goes on from nothing
    wanted = plan(models)
    with reading(path, "it"):
        other = difference(file, wanted)
        lost = bool(other) or loses(file, wanted)
        if lost and text_of(file["case"], "name") != wanted.name:
            raise StoreError(f"{path}: holds another case ({other or 'of other points'}): {ANEW}")
        if lost and blocks:
            place.replace(content_of(file))
            place.discard()
            blocks = 0
        line = f"holds the case as it was ({other})" if other else adapted(file, wanted)
    aside = place.keep_aside(line or "", tell) if lost else None
    if line and not lost:
        tell(f"{path}: {line}")
    if other:
        return Store(place, blank(wanted), wanted.units, {}, new=True, fresh=True, aside=aside)
    return Store(place, file, wanted.units, models, blocks=blocks, changed=line is not None, aside=aside)


@contextmanager
def opened_to_read(path: Path) -> Iterator[h5py.File]:
    """Open a copy in memory of a results file and its blocks; StoreError where it is none, or is damaged."""
    place = place_of(path)
    with opened_image(place, "rb", FORMAT, f"is no results file: {NAME}", NAME) as file:
        with reading(path, "it"):
            join_blocks(file, place.folder)
        yield file


def read(path: Path) -> dict[tuple[str, str], FrequencyResponse]:
    """Read every branch of a results file, by fidelity and direction; points that were not run are NaN."""
    with opened_to_read(path) as file, reading(path, "its groups"):
        return {(name, way): response_of(read_rows(file[name][way])) for name, way in branch_names(file)}
