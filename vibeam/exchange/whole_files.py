"""Atomic writing of files; files with a seal, by which damage is known before anything of the content is read."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path

Fill = Callable[[int], None]  # writes the content of a new file, by its descriptor
BINARY = getattr(os, "O_BINARY", 0)  # Windows: a descriptor is of text unless told
OWN = BINARY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)  # Windows has neither


def regular(path: Path) -> Path:
    """Resolve the links in ``path`` to the place of a regular file, existing or not.

    OSError, naming ``path``, for a folder, a pipe, a socket or a device: these would block, or not be replaced.
    """
    target = Path(os.path.realpath(path))
    with suppress(FileNotFoundError, NotADirectoryError):
        if what := _called(os.stat(target).st_mode):
            raise OSError(errno.EINVAL, f"is {what}, not a file: name another", str(path))
    return target


def beside(path: Path) -> Path:
    """The path of a file whose name vibeam makes; OSError where a link is there: one is followed where it is named."""
    if is_link(path):
        raise OSError(errno.ELOOP, "is a link, which is followed only where --out names it: delete it", str(path))
    return path


def write_whole(path: Path, content: bytes) -> None:
    """Replace the file at ``path``, or the one that a link there stands for; on failure the old content stays.

    OSError, naming ``path``, where it is no regular file or cannot be written.
    """
    _fill(path, regular(path), lambda handle: write_at(handle, 0, content))


def _fill(path: Path, target: Path, fill: Fill) -> None:
    part = part_beside(target, f".{os.getpid()}-{os.urandom(4).hex()}")  # machines may share the folder
    try:
        _fill_new(part, target, fill)
        os.replace(part, target)
    except BaseException as fault:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        if isinstance(fault, OSError):
            raise OSError(fault.errno, fault.strerror, str(path)) from None
        raise
    with suppress(OSError), closing(os.open(target.parent, os.O_RDONLY)) as folder:
        os.fsync(folder)


def _fill_new(part: Path, target: Path, fill: Fill) -> None:
    """Fill a new file ``part``, which gets the permissions of an existing ``target``, and bring it to disk."""
    with closing(os.open(part, os.O_RDWR | os.O_CREAT | os.O_EXCL | BINARY, 0o666)) as handle:
        with suppress(FileNotFoundError):
            if stat.S_ISREG(mode := os.lstat(target).st_mode):
                os.chmod(part, stat.S_IMODE(mode))
        fill(handle)
        os.fsync(handle)


@contextmanager
def closing(handle: int) -> Iterator[int]:
    """Context of an open descriptor."""
    try:
        yield handle
    finally:
        os.close(handle)


def part_beside(target: Path, mark: str = "") -> Path:
    """The name of a hidden file beside ``target``; a long name is shortened, so that there is room for the ending."""
    return target.with_name(f".{target.name.encode()[:200].decode(errors='ignore')}{mark}.part")


def write_at(handle: int, start: int, content: bytes | memoryview) -> None:
    """Write all of ``content`` from the byte ``start`` on; one thread at a time uses the ``handle``."""
    rest = memoryview(content)
    os.lseek(handle, start, os.SEEK_SET)
    while rest:
        rest = rest[os.write(handle, rest) :]


def read_at(handle: int, count: int, start: int) -> bytes:
    """The ``count`` bytes from the byte ``start`` on, fewer where the file ends before; as ``write_at``."""
    pieces, wanted = list[bytes](), count
    os.lseek(handle, start, os.SEEK_SET)
    while wanted and (piece := os.read(handle, wanted)):
        pieces.append(piece)
        wanted -= len(piece)
    return b"".join(pieces)


def open_own(path: Path, flags: int = os.O_RDONLY) -> int:
    """Descriptor of a file that vibeam alone names, a lock say: never of what a link there stands for.

    OSError where it is no regular file and, where it is written, where it has further names: it is not ours alone.
    """
    with suppress(FileNotFoundError):
        _require_own(path, os.lstat(path), flags)
    handle = os.open(path, flags | OWN, 0o666)
    try:
        _require_own(path, os.fstat(handle), flags)
    except OSError:
        os.close(handle)
        raise
    return handle


def _require_own(path: Path, found: os.stat_result, flags: int) -> None:
    linked = flags & os.O_RDWR and found.st_nlink > 1
    if what := _called(found.st_mode) or ("a file with a hard link" if linked else ""):
        raise OSError(f"{path} is {what}, no file of vibeam's own: delete it")


def is_link(path: Path) -> bool:
    """Test whether a name, of a folder too, stands for another place."""
    try:
        return not os.path.samestat(os.lstat(path), os.stat(path))  # a junction of Windows too
    except OSError:
        return os.path.lexists(path)


def _called(mode: int) -> str:
    """Kind of what is no regular file; empty of one."""
    kinds = {stat.S_IFREG: "", stat.S_IFLNK: "a link", stat.S_IFDIR: "a folder", stat.S_IFIFO: "a pipe"}
    return (kinds | {stat.S_IFSOCK: "a socket"}).get(stat.S_IFMT(mode), "a device")


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
    """Replace what is at ``path``, a link too, by ``content``, sealed as what it is ``of``; OSError naming ``path``."""
    fill_sealed(path, lambda handle: write_at(handle, 0, content), of)


def fill_sealed(path: Path, fill: Fill, of: str = "") -> None:
    """Replace the file at ``path`` by what ``fill`` writes, sealed; otherwise as ``write_sealed``."""

    def sealed(handle: int) -> None:
        fill(handle)
        size = os.fstat(handle).st_size
        write_at(handle, size, seal_of(_pieces(handle, size), of))

    _fill(path, path, sealed)


def read_sealed(path: Path, of: str = "") -> bytes | None:
    """Content of a sealed file without its seal; None where that does not fit. OSError as ``open_own``."""
    with open(open_own(path), "rb") as file:
        return unsealed(file.read(), of)


def unsealed(content: bytes, of: str = "") -> bytes | None:
    """Content of a sealed file, read whole, without its seal; None where that does not fit."""
    whole, said = content[:-LENGTH], content[-LENGTH:]
    return whole if said == seal_of([whole], of) else None


def is_sealed(path: Path) -> bool:
    """Test whether the seal of a file of any size fits. OSError where it cannot be read."""
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size - LENGTH
        return size >= 0 and read_at(file.fileno(), LENGTH, size) == seal_of(_pieces(file.fileno(), size))


def seal_of(pieces: Iterable[bytes], of: str = "") -> bytes:
    """Line that ends what is sealed: the SHA-256 of what it is ``of`` and of its ``pieces``."""
    found = sha256(of.encode())
    for piece in pieces:
        found.update(piece)
    return f"\nsha256 {found.hexdigest()}\n".encode()


def _pieces(handle: int, size: int) -> Iterator[bytes]:
    """The first ``size`` bytes of an open file."""
    return (read_at(handle, min(PIECE, size - at), at) for at in range(0, size, PIECE))
