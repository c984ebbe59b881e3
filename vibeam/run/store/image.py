"""Results file in memory: HDF5 works there alone, so that it never meets a disk error."""

from __future__ import annotations

from io import SEEK_END, BytesIO
from typing import Any


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
