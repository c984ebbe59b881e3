"""Structure of an HDF5 file in memory: all but the values of its datasets, which are written at their places by hand.

HDF5 cannot close a file whose bytes could not be written, and ends the process: here its own writes never fail, and
values that do not fit into memory never go through it.
"""

from __future__ import annotations

import io
import os
from typing import TYPE_CHECKING, Any

from vibeam.exchange.whole_files import write_at

if TYPE_CHECKING:
    import h5py
    from numpy.typing import DTypeLike


class Structure(io.RawIOBase):
    """File object for ``h5py.File`` that keeps the pieces written to it; what lies between them is 0."""

    def __init__(self) -> None:
        super().__init__()
        self.size, self._at = 0, 0
        self._pieces: list[tuple[int, bytes]] = []

    def write_to(self, handle: int) -> None:
        """Write the pieces to an empty file, with room for all values."""
        os.ftruncate(handle, self.size)
        for start, content in self._pieces:
            write_at(handle, start, content)

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Move as in any file object."""
        self._at = offset + {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: self.size}[whence]
        return self._at

    def tell(self) -> int:
        """Place as in any file object."""
        return self._at

    def write(self, data: Any) -> int:
        """Write as any file object."""
        content = bytes(data)
        self._pieces.append((self._at, content))
        self._at += len(content)
        self.size = max(self.size, self._at)
        return len(content)

    def readinto(self, buffer: Any) -> int:
        """Read as any file object; beyond the end too."""
        begin, end = self._at, self._at + len(buffer)
        buffer[:] = bytes(len(buffer))
        for start, content in self._pieces:
            first, last = max(start, begin), min(start + len(content), end)
            if first < last:
                buffer[first - begin : last - begin] = content[first - start : last - start]
        self._at = end
        return len(buffer)

    def truncate(self, size: int | None = None) -> int:
        """Set the size."""
        self.size = self._at if size is None else size
        return self.size


def without_values(group: h5py.Group, name: str, shape: tuple[int, ...], dtype: DTypeLike) -> tuple[h5py.Dataset, int]:
    """Make a dataset that has its room in the file, no values yet; with the first byte of that room."""
    from h5py import h5d, h5p

    how = h5p.create(h5p.DATASET_CREATE)
    how.set_alloc_time(h5d.ALLOC_TIME_EARLY)
    how.set_fill_time(h5d.FILL_TIME_NEVER)
    made = group.create_dataset(name, shape, dtype, dcpl=how)
    return made, made.id.get_offset()
