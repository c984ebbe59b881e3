"""Results file on disk, created exclusively, overwritten in place or replaced as a whole, and its image in memory."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterable
from contextlib import suppress
from io import SEEK_END, BytesIO
from pathlib import Path
from typing import Any

from vibeam.exchange.whole_files import new_part, part_beside, take_place, write_at
from vibeam.runs.store.errors import StoreError, reason, unwritable
from vibeam.runs.store.lock import lock

ELSEWHERE = "choose another --out"
ROOM = "make room, then run again to go on"
NO_LINKS = (errno.EPERM, errno.EOPNOTSUPP, errno.ENOSYS, errno.EMLINK)


class Disk:
    """File ``target``, called ``path`` by the user, for its one writer.

    What is staged lies beside it, with all the room it needs, until something is written into it: then it takes the
    file's place. Every method: StoreError where the disk fails, and the old content stays.
    """

    def __init__(self, path: Path, target: Path) -> None:
        self.path = path
        self._target, self._part = target, part_beside(target)
        self._handle: int | None = None
        self._staged = False

    def read(self) -> bytes:
        """Read the whole file; it is then overwritten in place."""
        try:
            self._part.unlink(missing_ok=True)  # left by a process that was killed: this one holds the lock
            self._handle = os.open(self._target, os.O_RDWR | os.O_NONBLOCK)
            with open(os.dup(self._handle), "rb") as file:
                content = file.read()
        except OSError as fault:
            raise StoreError(f"{self.path}: cannot be opened ({reason(fault)}): {ELSEWHERE}") from None
        if not lock(self._handle):
            raise StoreError(f"{self.path}: another program has it open: close it there, or {ELSEWHERE}")
        return content

    def create(self, content: bytes) -> None:
        """Create the file; it must not exist."""
        self.stage(content)
        try:
            self._publish()
        except FileExistsError:
            raise StoreError(f"{self.path}: another program has made it meanwhile: {ELSEWHERE}") from None
        except OSError as fault:
            raise unwritable(self.path, fault, ELSEWHERE) from None
        self._staged = False

    def stage(self, content: bytes, cure: str = ELSEWHERE) -> None:
        """Write ``content`` to a file beside."""
        try:
            self._part.unlink(missing_ok=True)
            handle = new_part(self._part, self._target, lambda part: write_at(part, 0, content))
        except OSError as fault:
            raise unwritable(self.path, fault, cure) from None
        lock(handle)
        self._release()
        self._handle, self._staged = handle, True

    def overwrite(self, pieces: Iterable[tuple[int, bytes]]) -> None:
        """Write bytes at their positions; a staged file takes effect from now on."""
        assert self._handle is not None
        try:
            for start, content in pieces:
                write_at(self._handle, start, content)
        except OSError as fault:
            raise unwritable(self.path, fault, ROOM) from None
        self.settle()

    def replace(self, content: bytes) -> None:
        """Replace the whole file by ``content``, atomically."""
        self.stage(content, ROOM)
        self.settle()

    def settle(self) -> None:
        """Move the staged file into place."""
        if self._staged:
            try:
                take_place(self._part, self._target)
            except OSError as fault:
                raise unwritable(self.path, fault, ELSEWHERE) from None
            self._staged = False

    def remove(self) -> None:
        """Delete the file."""
        self._target.unlink(missing_ok=True)

    def close(self) -> None:
        """Close the file; discard what is still staged."""
        if self._staged:
            self._part.unlink(missing_ok=True)
        self._release()

    def _publish(self) -> None:
        try:
            os.link(self._part, self._target)
        except OSError as fault:
            if fault.errno not in NO_LINKS:
                raise
            os.close(os.open(self._target, os.O_WRONLY | os.O_CREAT | os.O_EXCL))
            take_place(self._part, self._target)
        with suppress(FileNotFoundError):
            self._part.unlink()

    def _release(self) -> None:
        if self._handle is not None:
            os.close(self._handle)
            self._handle = None


class Image(BytesIO):
    """Bytes of an HDF5 file, as a file object for ``h5py.File`` that tracks changes.

    HDF5 cannot close a file whose bytes could not be written, and ends the process; here its writes never fail.
    """

    def __init__(self, content: bytes = b"") -> None:
        super().__init__(content)
        self._changed: list[tuple[int, int]] = []

    def write(self, data: Any) -> int:
        """Write as any file object."""
        start = self.tell()
        count = super().write(data)
        self._changed.append((start, start + count))
        return count

    def truncate(self, size: int | None = None) -> int:
        """Truncate as any file object; a longer file is filled with zeros."""
        wanted = self.tell() if size is None else size
        missing = wanted - self.seek(0, SEEK_END)
        if missing > 0:
            self.write(bytes(missing))
        return super().truncate(wanted)

    def changes(self) -> list[tuple[int, bytes]]:
        """Changes since the last call: the first byte of each piece, and its bytes, in file order."""
        pieces, self._changed = _joined(self._changed), []
        with self.getbuffer() as content:
            return [(start, bytes(content[start:stop])) for start, stop in pieces]


def _joined(pieces: list[tuple[int, int]]) -> list[tuple[int, int]]:
    found: list[tuple[int, int]] = []
    for start, stop in sorted(pieces):
        if found and start <= found[-1][1]:
            found[-1] = (found[-1][0], max(stop, found[-1][1]))
        else:
            found.append((start, stop))
    return found
