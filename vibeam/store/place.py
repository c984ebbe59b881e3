"""Place of a file of results and of the blocks beside it: one writer at a time, replaced as a whole."""

from __future__ import annotations

import errno
import os
import platform
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from glob import escape
from itertools import count
from os.path import lexists, samestat
from pathlib import Path

from vibeam.exchange.whole_files import Fill, fill_sealed, is_link, open_own, part_beside, regular, write_at
from vibeam.store.blocks import discard
from vibeam.store.errors import ELSEWHERE, ROOM, StoreError, writing

UNKNOWN = (errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOLCK)  # errors of file systems without locks, which HDF5 accepts too
UNLINKED = (*UNKNOWN, errno.EPERM, errno.EMLINK)  # errors of file systems without a second name for a file
TRIES = 100
FAR = 1 << 30  # byte of a lock under Windows
Tell = Callable[[str], None]


def warn(line: str) -> None:
    """Tell a line where nobody listens: as a warning."""
    warnings.warn(line, stacklevel=3)


@dataclass(frozen=True)
class Place:
    """File ``target``, called ``path`` by the user, and the ``folder`` of blocks beside it."""

    path: Path
    target: Path

    @property
    def folder(self) -> Path:
        """Folder of blocks, which need not be there."""
        return _parts(self.target)

    def fill(self, fill: Fill) -> None:
        """Replace the file by what ``fill`` writes, sealed; StoreError where the disk fails: what was there stays."""
        with writing(self.path, ROOM):
            fill_sealed(self.target, fill)

    def replace(self, content: bytes) -> None:
        """Replace the file by ``content``, as ``fill``."""
        self.fill(lambda handle: write_at(handle, 0, content))

    def discard(self) -> None:
        """Delete the blocks; StoreError where they cannot be."""
        with writing(self.path, ELSEWHERE):
            discard(self.folder)

    def keep_aside(self, said: str, tell: Tell, blocks: bool = False) -> Path:
        """Give the file the further name ``OUT.1.h5``, or that of the next number that nothing has; return it.

        It keeps its own name too, except where the file system knows no second one. ``blocks``: give their folder the
        name ``OUT.1.h5.parts`` instead. ``tell`` hears it behind what is ``said``. StoreError where it cannot be.
        """
        names = (self.target.with_name(f"{self.target.stem}.{each}{self.target.suffix}") for each in count(1))
        free = (each for each in names if not (lexists(_parts(each)) or (blocks and lexists(each))))
        with writing(self.path, ELSEWHERE):
            further = self.folder.rename(_parts(next(free))) if blocks else next(filter(None, map(self._named, free)))
        tell(f"{self.path}: {said}; its results are kept aside as {further.name}")
        return further

    def _named(self, further: Path) -> Path | None:
        """The name, given now or before a kill; None where another file has it."""
        try:
            os.link(self.target, further)
        except FileExistsError:
            return further if samestat(os.lstat(self.target), os.lstat(further)) else None
        except OSError as fault:
            if fault.errno not in UNLINKED:
                raise
            if lexists(further):
                return None
            os.rename(self.target, further)
        return further

    def tidy(self, kin: str = "") -> None:
        """Delete what a writer that was killed has left of files it had begun; of all that begin by ``kin``, too."""
        for name in (self.target.name, *([kin] if kin else [])):
            begun = part_beside(self.target.with_name(name)).name.removesuffix("part")
            for file in self.target.parent.glob(f"{escape(begun)}*part"):
                with suppress(OSError):  # a folder, and whatever else is none of ours
                    file.unlink()


def _parts(file: Path) -> Path:
    return file.with_name(f"{file.name}.parts")


def place_of(path: Path) -> Place:
    """The place of a file, there or not, a link to it followed; StoreError for a folder, a pipe or a device.

    Blocks that a link leads to are refused: they would be written, and deleted, in a folder of somebody else's.
    """
    try:
        place = Place(path, regular(path))
    except OSError as fault:
        raise StoreError(f"{path}: {fault.strerror}") from None
    if is_link(place.folder):
        raise StoreError(f"{path}: {place.folder} is a link, no folder of vibeam's own: delete it, or {ELSEWHERE}")
    return place


@contextmanager
def locked(path: Path, own: bool = False) -> Iterator[Place]:
    """Hold the lock of the file called ``path``; StoreError names another holder.

    The lock is the operating system's, on a file beside: it ends with the process, however that ends. ``own``: the name
    is none of the user's, so that no link there is followed.
    """
    place = Place(path, path) if own else place_of(path)
    file = place.target.with_name(f".{place.target.name}.lock")
    with writing(path, ELSEWHERE):
        handle = _acquired(path, file)
    try:
        yield place
    finally:
        _release(handle, file)


def _acquired(path: Path, file: Path) -> int:
    for _ in range(TRIES):
        handle = open_own(file, os.O_RDWR | os.O_CREAT)
        if not _lock(handle):
            holder = os.read(handle, 200).decode(errors="replace")
            os.close(handle)
            raise StoreError(f"{path}: {holder or 'another process'} is writing it: wait for it, or {ELSEWHERE}")
        if _is_there(handle, file):
            return _signed(handle, file)
        os.close(handle)  # deleted by its last holder meanwhile
    raise StoreError(f"{path}: other processes are writing it: wait for them, or {ELSEWHERE}")


def _lock(handle: int) -> bool:
    """Try to lock the file for this process; also True where the file system knows no locks."""
    try:
        _lock_or_fail(handle)
    except (BlockingIOError, PermissionError):
        return False
    except OSError as fault:
        return fault.errno in UNKNOWN
    return True


if sys.platform == "win32":

    def _lock_or_fail(handle: int) -> None:
        """Lock a byte far behind the holder's name: nobody else may read what is locked."""
        import msvcrt

        os.lseek(handle, FAR, os.SEEK_SET)
        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        finally:
            os.lseek(handle, 0, os.SEEK_SET)

    def _release(handle: int, file: Path) -> None:
        """End the lock; what is open cannot be deleted, so that the next holder keeps the file."""
        os.close(handle)
        with suppress(PermissionError):
            file.unlink(missing_ok=True)

else:

    def _lock_or_fail(handle: int) -> None:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def _release(handle: int, file: Path) -> None:
        file.unlink(missing_ok=True)
        os.close(handle)


def _is_there(handle: int, file: Path) -> bool:
    try:
        return samestat(os.fstat(handle), os.lstat(file))
    except FileNotFoundError:
        return False


def _signed(handle: int, file: Path) -> int:
    try:
        os.ftruncate(handle, 0)
        os.write(handle, f"process {os.getpid()} on {platform.node()}".encode())
    except OSError:
        _release(handle, file)
        raise
    return handle
