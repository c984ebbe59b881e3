"""Atomic writing of files; files with a seal, by which damage is known before anything of the content is read."""

from __future__ import annotations

import errno
import os
import stat
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path

Fill = Callable[[int], None]  # writes the content of a new file, by its descriptor
BINARY = getattr(os, "O_BINARY", 0)  # Windows: a descriptor is of text unless told


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
    fill_whole(path, lambda handle: write_at(handle, 0, content))


def fill_whole(path: Path, fill: Fill) -> None:
    """Replace the file at ``path`` by what ``fill`` writes; otherwise as ``write_whole``. Other errors pass through."""
    target = regular(path)
    part = part_beside(target, f".{os.getpid()}-{os.urandom(4).hex()}")  # machines may share the folder
    try:
        os.close(new_part(part, target, fill))
        take_place(part, target)
    except OSError as fault:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise OSError(fault.errno, fault.strerror, str(path)) from None


def part_beside(target: Path, mark: str = "") -> Path:
    """The name of a hidden file beside ``target``; a long name is shortened, so that there is room for the ending."""
    return target.with_name(f".{target.name.encode()[:200].decode(errors='ignore')}{mark}.part")


def new_part(part: Path, target: Path, fill: Fill) -> int:
    """Fill a new file ``part``, synchronised to disk, and return its descriptor; an error removes it.

    It gets the permissions of an existing ``target``.
    """
    handle = os.open(part, os.O_RDWR | os.O_CREAT | os.O_EXCL | BINARY, 0o666)
    try:
        with suppress(FileNotFoundError):
            os.chmod(part, stat.S_IMODE(os.stat(target).st_mode))
        fill(handle)
        os.fsync(handle)
    except BaseException:
        os.close(handle)
        part.unlink()
        raise
    return handle


def take_place(part: Path, target: Path) -> None:
    """Rename ``part`` to ``target``, and bring the folder's names to disk where that can be asked for."""
    os.replace(part, target)
    with suppress(OSError):
        folder = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def write_at(handle: int, start: int, content: bytes | memoryview) -> None:
    """Write all of ``content`` from the byte ``start`` on."""
    rest = memoryview(content)
    while rest:
        count = _write(handle, rest, start)
        rest, start = rest[count:], start + count


if sys.platform == "win32":  # which has no call that takes the place too

    def _write(handle: int, content: memoryview, start: int) -> int:
        os.lseek(handle, start, os.SEEK_SET)
        return os.write(handle, content)

    def _read(handle: int, count: int, start: int) -> bytes:
        os.lseek(handle, start, os.SEEK_SET)
        return os.read(handle, count)

else:

    def _write(handle: int, content: memoryview, start: int) -> int:
        return os.pwrite(handle, content, start)

    def _read(handle: int, count: int, start: int) -> bytes:
        return os.pread(handle, count, start)


def read_at(handle: int, count: int, start: int) -> bytes:
    """The ``count`` bytes from the byte ``start`` on, fewer where the file ends before."""
    pieces, wanted = list[bytes](), count
    while wanted and (piece := _read(handle, wanted, start)):
        pieces.append(piece)
        wanted, start = wanted - len(piece), start + len(piece)
    return b"".join(pieces)


def _called(mode: int) -> str:
    if stat.S_ISFIFO(mode):
        return "a pipe"
    return "a socket" if stat.S_ISSOCK(mode) else "a device"


STDOUT = "stdout"  # in place of a file's name


@contextmanager
def naming_stdout() -> Iterator[None]:
    """Context of what is printed on stdout: an OSError names that, as it names a file."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror, STDOUT) from None


PIECE = 1 << 20  # bytes that are digested at once
LENGTH = len("\nsha256 \n") + 64


def write_sealed(path: Path, content: bytes, of: str = "") -> None:
    """Replace the file at ``path`` by ``content``, sealed as what it is ``of``; errors as ``write_whole``."""
    fill_sealed(path, lambda handle: write_at(handle, 0, content), of)


def fill_sealed(path: Path, fill: Fill, of: str = "") -> None:
    """Replace the file at ``path`` by what ``fill`` writes, sealed; errors as ``fill_whole``."""

    def sealed(handle: int) -> None:
        fill(handle)
        size = os.fstat(handle).st_size
        write_at(handle, size, seal_of(_pieces(handle, size), of))

    fill_whole(path, sealed)


def read_sealed(path: Path, of: str = "") -> bytes | None:
    """Content of a sealed file without its seal; None where that does not fit. OSError where it cannot be read."""
    return unsealed(path.read_bytes(), of)


def unsealed(content: bytes, of: str = "") -> bytes | None:
    """Content of a sealed file, read whole, without its seal; None where that does not fit."""
    whole, said = content[:-LENGTH], content[-LENGTH:]
    return whole if said == seal_of([whole], of) else None


def is_sealed(path: Path) -> bool:
    """Test whether the seal of a file of any size fits. OSError where it cannot be read."""
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size - LENGTH
        return size >= 0 and _read(file.fileno(), LENGTH, size) == seal_of(_pieces(file.fileno(), size))


def seal_of(pieces: Iterable[bytes], of: str = "") -> bytes:
    """Line that ends what is sealed: the SHA-256 of what it is ``of`` and of its ``pieces``."""
    found = sha256(of.encode())
    for piece in pieces:
        found.update(piece)
    return f"\nsha256 {found.hexdigest()}\n".encode()


def _pieces(handle: int, size: int) -> Iterator[bytes]:
    """The first ``size`` bytes of an open file."""
    return (_read(handle, min(PIECE, size - at), at) for at in range(0, size, PIECE))
