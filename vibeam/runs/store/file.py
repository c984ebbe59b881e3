"""Results file of a case: created, opened, adapted, or refused, also for links and data that are not its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from vibeam.exchange.hdf5 import contents, heaps_are_whole, is_own
from vibeam.exchange.whole_files import regular
from vibeam.runs.store.branch import Values, read_rows
from vibeam.runs.store.content import FORMAT, OLDER, SIGNATURE, UNSIGNED, adapted, blank, format_of, is_ours
from vibeam.runs.store.disk import Disk, Image
from vibeam.runs.store.errors import CURE, FAULTS, StoreError, damaged, reading, reason
from vibeam.runs.store.lock import locked
from vibeam.runs.store.models import MODELS, Keyed, read_models
from vibeam.runs.store.reuse import Wanted, branch_names
from vibeam.runs.store.store import Store
from vibeam.system.quantities import LAYOUT
from vibeam.system.response import FrequencyResponse

if TYPE_CHECKING:
    import h5py


def refuse_foreign(file: h5py.File) -> None:
    """Raise ValueError for a soft or external link, data outside the file or not stored contiguously; RuntimeError for
    attributes that cannot be gone through.

    An accepted file is no larger on reading than on disk, and reading it touches nothing else.
    """
    import h5py

    for place, item, again in contents(file):
        if item is None:
            raise ValueError(f"/{place} is a link to another place")
        if again:
            raise ValueError(f"/{place} is linked twice")
        h5py.h5a.iterate(item.id, _read)
        if not isinstance(item, h5py.Group) and (not isinstance(item, h5py.Dataset) or not _plain(item)):
            raise ValueError(f"/{place} holds no values of its own")


def _read(name: bytes) -> None:
    """An attribute whose record can be read."""


def _plain(dataset: h5py.Dataset) -> bool:
    """Test whether the values lie in the file contiguously."""
    import h5py

    contiguous = dataset.id.get_create_plist().get_layout() in (h5py.h5d.CONTIGUOUS, h5py.h5d.COMPACT)
    return contiguous and is_own(dataset) and dataset.id.get_storage_size() == dataset.nbytes


Tell = Callable[[str], None]
Plan = Callable[[Keyed], Wanted]


@contextmanager
def opened(path: Path, wanted: Plan, *, fresh: bool = False, tell: Tell = lambda line: None) -> Iterator[Store]:
    """Open the results file of one case, created where there is none; locked against other processes.

    ``wanted``: what the case wants of it, called with what the file has of its models, before anything is changed.
    A file of a changed case keeps the branches whose numbers are the same; ``tell`` gets one line on that. ``fresh``:
    a new file replaces the old one with its first point. StoreError where ``path`` is something else,
    belongs to another case, is damaged, locked or cannot be written. A file created here that gets no point is deleted
    again.
    """
    target = _regular(path)
    with locked(path, target):
        disk = Disk(path, target)
        try:
            with _begun(disk, wanted, target.exists(), fresh, tell) as begun:
                yield from _used(begun, disk)
        finally:
            disk.close()


@dataclass(frozen=True)
class _Begun:
    """Open file: ``new`` or not, ``made`` where there was none, ``changed`` so that it stays without points too."""

    image: Image
    file: h5py.File
    wanted: Wanted
    models: Keyed
    new: bool
    made: bool = False
    changed: bool = False


def _used(begun: _Begun, disk: Disk) -> Iterator[Store]:
    store = Store(begun.file, begun.image, disk, begun.wanted.units, begun.models, noted=begun.new)
    try:
        yield store
    finally:
        if begun.made and not store.written:
            disk.remove()
    if begun.changed:
        disk.settle()


@contextmanager
def _begun(disk: Disk, plan: Plan, exists: bool, fresh: bool, tell: Tell) -> Iterator[_Begun]:
    import h5py

    if exists and not fresh:
        with _continued(disk, plan, tell) as begun:
            yield begun
        return
    if exists and not is_ours(disk.read()):
        raise no_result(disk.path)
    wanted = plan({})
    image = blank(wanted)
    put = disk.stage if exists else disk.create
    put(image.getvalue())
    with h5py.File(image, "r+") as file:
        yield _Begun(image, file, wanted, {}, new=True, made=not exists)


@contextmanager
def _continued(disk: Disk, plan: Plan, tell: Tell) -> Iterator[_Begun]:
    image = Image(disk.read())
    with _open(image, disk.path) as file:
        with reading(disk.path, f"/{MODELS}"):
            models = read_models(file)
        wanted = plan(models)
        line = adapted(file, disk.path, wanted)
        if line is not None:
            file.flush()
            disk.stage(image.getvalue())
            if line:
                tell(f"{disk.path}: {line}")
        yield _Begun(image, file, wanted, models, new=False, changed=line is not None)


@contextmanager
def opened_to_read(path: Path) -> Iterator[h5py.File]:
    """Open a copy in memory of a results file; StoreError where it is none, or is damaged."""
    try:
        content = _regular(path).read_bytes()
    except OSError as fault:
        raise StoreError(f"{path}: cannot be opened ({reason(fault)})") from None
    if not is_ours(content):
        raise StoreError(f"{path}: is no results file: name one that vibeam run has written")
    with _open(Image(content), path) as file:
        yield file


def read(path: Path) -> dict[tuple[str, str], FrequencyResponse]:
    """Read every branch of a results file, by fidelity and direction; points that were not run are NaN."""
    with opened_to_read(path) as file, reading(path, "its groups"):
        rows = _unsigned_rows if format_of(file) == UNSIGNED else read_rows
        found = {(fidelity, direction): rows(file[fidelity][direction]) for fidelity, direction in branch_names(file)}
        return {at: FrequencyResponse(**{name: values[name] for name in LAYOUT}) for at, values in found.items()}


def _unsigned_rows(group: h5py.Group) -> Values:
    return {name: group[name][()] for name in LAYOUT}


@contextmanager
def _open(image: Image, path: Path) -> Iterator[h5py.File]:
    import h5py

    if image.read(len(SIGNATURE)) != SIGNATURE:  # h5py would take an empty file for a new one
        raise no_result(path)
    if not heaps_are_whole(image.getvalue()):
        raise damaged(path, "it", ValueError("a heap of its texts is broken"))
    try:
        file = h5py.File(image, "r+")
    except FAULTS as fault:
        raise damaged(path, "it", fault) from None
    with file:
        with reading(path, "it"):
            known = format_of(file) in (FORMAT, *OLDER)
        if not known:
            raise no_result(path)
        try:
            refuse_foreign(file)
        except FAULTS as fault:
            raise StoreError(f"{path}: {reason(fault)}: vibeam writes no such file: {CURE}") from None
        yield file


def no_result(path: Path) -> StoreError:
    """Error for a file that is no results file."""
    return StoreError(f"{path}: is no vibeam result: choose another --out, or delete it")


def _regular(path: Path) -> Path:
    try:
        return regular(path)
    except OSError as fault:
        raise StoreError(f"{path}: {fault.strerror}") from None
