"""The results file of a case: made, opened, and refused where it is another's or none."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

from vibeam.provenance import write_provenance
from vibeam.response import FrequencyResponse
from vibeam.show.keep import HOME
from vibeam.store.branch import Branch, read_response
from vibeam.store.faults import FAULTS, StoreError, damaged, reading, reason, unwritable
from vibeam.store.layout import fixed, write_branch
from vibeam.store.store import Store

if TYPE_CHECKING:
    import h5py

FORMAT = "vibeam results 1"
SIGNATURE = b"\x89HDF\r\n\x1a\n"


@contextmanager
def opened(path: Path, *, text: str, key: str, branches: Sequence[Branch], unit: str = "m") -> Iterator[Store]:
    """The results file of one case, made where there is none; ``unit``: of the outputs.

    StoreError where ``path`` is something else, belongs to another case, is damaged or cannot be written. A file that
    is made here and gets no point is taken away again.
    """
    if path.is_dir():
        raise StoreError(f"{path}: is a folder: name a file in it")
    made = not path.exists()
    if made:
        _make(path, text, key, branches, unit)
    written = 0
    try:
        with _open(path, "r+") as file:
            _same_case(file, path, text, key)
            store = Store(file, path, made, unit)
            try:
                yield store
            finally:
                written = store.written
    finally:
        if made and not written:
            path.unlink(missing_ok=True)


def read(path: Path) -> dict[tuple[str, str], FrequencyResponse]:
    """Every branch a results file holds, by fidelity and direction; points that were not run are NaN."""
    with _open(path, "r") as file, reading(path, "its groups"):
        return {(fidelity, way): read_response(group) for fidelity, way, group in _branches(file)}


def _branches(file: h5py.File) -> Iterator[tuple[str, str, h5py.Group]]:
    for fidelity, ways in file.items():
        for way, group in ways.items() if fidelity != HOME else ():
            if "done" in group.attrs:
                yield fidelity, way, group


def _make(path: Path, text: str, key: str, branches: Sequence[Branch], unit: str) -> None:
    """Lay the file out under another name and rename it, so that ``path`` is whole from its first moment."""
    import h5py

    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with h5py.File(part, "w-") as file:
            file.attrs["format"] = fixed(FORMAT)
            file.create_group("case").attrs["key"] = fixed(key)
            file["case"]["text"] = fixed(text)
            write_provenance(file.create_group("provenance"))
            for branch in branches:
                write_branch(file.create_group(branch.group), branch.frequency, branch.modes, unit)
        os.replace(part, path)
    except OSError as fault:
        raise unwritable(path, fault, "choose another --out") from None
    finally:
        part.unlink(missing_ok=True) if part.parent.is_dir() else None


def _open(path: Path, mode: str) -> h5py.File:
    import h5py

    try:
        with path.open("rb") as raw:
            known = raw.read(len(SIGNATURE)) == SIGNATURE  # h5py would take an empty file for a new one
        file = h5py.File(path, mode) if known else None
    except BlockingIOError:
        raise StoreError(f"{path}: another run is writing it: wait for it, or choose another --out") from None
    except OSError as fault:
        raise _refused(path, fault) from None
    if file is not None and _format(file, path) == FORMAT:
        return file
    raise StoreError(f"{path}: is no vibeam result: choose another --out, or delete it")


def _format(file: h5py.File, path: Path) -> str | None:
    """What the file says it is; it is left open only if that is a vibeam result."""
    try:
        found = file.attrs["format"].decode() if "format" in file.attrs else None
    except FAULTS as fault:
        file.close()
        raise damaged(path, "it", fault) from None
    if found != FORMAT:
        file.close()
    return found


def _refused(path: Path, fault: OSError) -> StoreError:
    if fault.errno in (errno.EACCES, errno.EPERM, errno.EROFS, errno.ENOENT):
        return StoreError(f"{path}: cannot be opened ({reason(fault)}): choose another --out")
    return damaged(path, "it", fault)


def _same_case(file: h5py.File, path: Path, text: str, key: str) -> None:
    with reading(path, "/case"):
        there, kept = (value.decode() for value in (file["case"].attrs["key"], file["case/text"][()]))
    if there != key:
        raise StoreError(
            f"{path}: holds another case ({_first_difference(kept, text)}): choose another --out, or delete it"
        )


def _first_difference(there: str, here: str) -> str:
    pairs = zip_longest(there.splitlines(), here.splitlines(), fillvalue="nothing")
    differing = next(((old, new) for old, new in pairs if old != new), ("its key", "another"))
    return f"{differing[0] or 'nothing'!r} there, {differing[1] or 'nothing'!r} here"
