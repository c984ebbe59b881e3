"""Sealed files: a digest at the end tells damage before anything of the content is read."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from hashlib import sha256
from pathlib import Path

from vibeam.exchange.whole_files import Fill, fill_whole, write_at

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
        write_at(handle, size, _seal(_pieces(handle, size), of))

    fill_whole(path, sealed)


def read_sealed(path: Path, of: str = "") -> bytes | None:
    """Content of a sealed file without its seal; None where that does not fit. OSError where it cannot be read."""
    content = path.read_bytes()
    whole, said = content[:-LENGTH], content[-LENGTH:]
    return whole if said == _seal([whole], of) else None


def is_sealed(path: Path, of: str = "") -> bool:
    """Test whether the seal of a file of any size fits. OSError where it cannot be read."""
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size - LENGTH
        return size >= 0 and os.pread(file.fileno(), LENGTH, size) == _seal(_pieces(file.fileno(), size), of)


def _seal(pieces: Iterable[bytes], of: str) -> bytes:
    found = sha256(of.encode())
    for piece in pieces:
        found.update(piece)
    return f"\nsha256 {found.hexdigest()}\n".encode()


def _pieces(handle: int, size: int) -> Iterator[bytes]:
    """The first ``size`` bytes of an open file."""
    return (os.pread(handle, min(PIECE, size - at), at) for at in range(0, size, PIECE))
