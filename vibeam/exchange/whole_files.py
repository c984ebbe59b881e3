"""Files that are written as a whole or not at all."""

from __future__ import annotations

import errno
import os
import stat
from contextlib import suppress
from pathlib import Path


def regular(path: Path) -> Path:
    """The place behind the links in ``path``, where a regular file is or may be made.

    OSError, naming ``path``, for a folder, a pipe, a socket or a device: these would be waited for, or not be replaced.
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
    """Put ``content`` in the place of the file at ``path``; where that fails what was there stays.

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
    """Where this process writes what is to become ``target``."""
    return target.with_name(f".{target.name}.{os.getpid()}.part")


def new_part(part: Path, target: Path, content: bytes) -> int:
    """The descriptor of a new file ``part`` with ``content``, on the disk; OSError leaves none behind.

    It has the permissions of ``target`` where that is there.
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
    """All of ``content`` from the byte ``start`` on."""
    rest = memoryview(content)
    while rest:
        count = os.pwrite(handle, rest, start)
        rest, start = rest[count:], start + count


def _called(mode: int) -> str:
    if stat.S_ISFIFO(mode):
        return "a pipe"
    return "a socket" if stat.S_ISSOCK(mode) else "a device"
