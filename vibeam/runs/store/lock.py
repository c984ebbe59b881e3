"""Lock of a results file: one writer at a time, and its name."""

from __future__ import annotations

import errno
import os
import platform
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from vibeam.runs.store.errors import StoreError, unwritable

UNKNOWN = (errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOLCK)  # errors of file systems without locks, which HDF5 accepts too
TRIES = 100


@contextmanager
def locked(path: Path, target: Path) -> Iterator[None]:
    """Hold the lock of the results file ``target``, called ``path`` by the user; StoreError names another holder.

    The lock is the operating system's, on a file beside: it ends with the process, however that ends.
    """
    place = target.with_name(f".{target.name}.lock")
    try:
        handle = _acquired(path, place)
    except OSError as fault:
        raise unwritable(path, fault, "choose another --out") from None
    try:
        yield
    finally:
        place.unlink(missing_ok=True)
        os.close(handle)


def _acquired(path: Path, place: Path) -> int:
    for _ in range(TRIES):
        handle = os.open(place, os.O_RDWR | os.O_CREAT, 0o666)
        if not lock(handle):
            holder = os.read(handle, 200).decode(errors="replace")
            os.close(handle)
            raise StoreError(
                f"{path}: {holder or 'another process'} is writing it: wait for it, or choose another --out"
            )
        if _is_there(handle, place):
            return _signed(handle, place)
        os.close(handle)  # deleted by its last holder meanwhile
    raise StoreError(f"{path}: other processes are writing it: wait for them, or choose another --out")


def lock(handle: int) -> bool:
    """Try to lock the file for this process; also True where the file system knows no locks."""
    import fcntl

    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError as fault:
        return fault.errno in UNKNOWN
    return True


def _is_there(handle: int, place: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(handle), os.stat(place))
    except FileNotFoundError:
        return False


def _signed(handle: int, place: Path) -> int:
    try:
        os.ftruncate(handle, 0)
        os.pwrite(handle, f"process {os.getpid()} on {platform.node()}".encode(), 0)
    except OSError:
        place.unlink(missing_ok=True)
        os.close(handle)
        raise
    return handle
