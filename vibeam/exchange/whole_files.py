"""Atomic writing of files."""

from __future__ import annotations

import errno
import os
import stat
from contextlib import suppress
from pathlib import Path


def regular(path: Path) -> Path:
    """Resolve the links in ``path`` to the place of a regular file, existing or not.

    OSError, naming ``path``, for a folder, a pipe, a socket or a device: these would block, or not be replaced.
    """
    target = Path(os.path.realpath(path))
    with suppress(FileNotFoundError, NotADirectoryError):
        mode = os.stat(target).st_mode
        if stat.S_ISDIR(mode):
            raise OSError(errno.EISDIR, "is a folder: name a file in it", str(path))
        if not stat.S_ISREG(mode):
            raise OSError(errno.EINVAL, f"is {_called(mode)}, not a file: name another", str(path))
    return target


def write_whole(path: Path, content: bytes) -> None:
    """Replace the file at ``path`` by ``content``; on failure the old content stays.

    OSError, naming ``path``, where it is no regular file or cannot be written.
    """
    target = regular(path)
    part = part_of(target)
    try:
        handle = new_part(part, target, content)
        os.close(handle)
        os.replace(part, target)
    except OSError as fault:
        part.unlink(missing_ok=True)
        raise OSError(fault.errno, fault.strerror, str(path)) from None


def part_of(target: Path) -> Path:
    """Path of this process's temporary file for ``target``."""
    return target.with_name(f".{target.name}.{os.getpid()}.part")


def new_part(part: Path, target: Path, content: bytes) -> int:
    """Write ``content`` to a new file ``part``, synchronised to disk, and return its descriptor; OSError removes it.

    It gets the permissions of an existing ``target``.
    """
    handle = os.open(part, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o666)
    try:
        with suppress(FileNotFoundError):
            os.fchmod(handle, stat.S_IMODE(os.stat(target).st_mode))
        write_at(handle, 0, content)
        os.fsync(handle)
    except BaseException:
        os.close(handle)
        part.unlink()
        raise
    return handle


def write_at(handle: int, start: int, content: bytes | memoryview) -> None:
    """Write all of ``content`` from the byte ``start`` on."""
    rest = memoryview(content)
    while rest:
        count = os.pwrite(handle, rest, start)
        rest, start = rest[count:], start + count


def _called(mode: int) -> str:
    if stat.S_ISFIFO(mode):
        return "a pipe"
    return "a socket" if stat.S_ISSOCK(mode) else "a device"
