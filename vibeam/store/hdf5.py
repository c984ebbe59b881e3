"""HDF5 that others open as it is: laid out in memory, described for NetCDF's readers, sealed, read where its seal fits.

HDF5 ends the process where a disk is full, and may search for ever in a damaged file: it writes to no disk here, and
opens what is as it was written.
"""

from __future__ import annotations

import io
import os
from collections.abc import Iterable
from itertools import count
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.whole_files import write_at

if TYPE_CHECKING:
    import h5py
    from numpy.typing import DTypeLike

_NUMBERS = count()  # HDF5 tells files in memory apart by their names
SIGNATURE = b"\x89HDF\r\n\x1a\n"


def in_memory(content: bytes = b"") -> h5py.File:
    """HDF5 file in memory, a new one or that of ``content``, to be written and never put on disk by HDF5."""
    import h5py

    if not content:
        return h5py.File(f"results {next(_NUMBERS)}", "w", driver="core", backing_store=False)
    return h5py.File(h5py.h5f.open_file_image(content, h5py.h5f.FILE_IMAGE_OPEN_RW))


def content_of(file: h5py.File) -> bytes:
    """Bytes of a file in memory."""
    file.flush()
    return bytes(file.id.get_file_image())


def fixed(text: str) -> NDArray[np.bytes_]:
    """Text of fixed length, a blank where it is empty."""
    import h5py

    encoded = (text or " ").encode()
    return np.array(encoded, dtype=h5py.string_dtype("utf-8", len(encoded)))


def text_of(item: h5py.Group | h5py.Dataset, name: str) -> str:
    """Text of fixed length in an attribute; empty without it."""
    found: bytes = item.attrs.get(name, b"")
    return found.decode().strip()


def described(
    group: h5py.Group, name: str, values: Any, long_name: str, unit: str, *scales: h5py.Dataset
) -> h5py.Dataset:  # fmt: skip
    """New dataset with long name, unit, and the ``scales`` of its dimensions."""
    dataset = group.create_dataset(name, data=values)
    dataset.attrs["long_name"], dataset.attrs["units"] = long_name, unit
    for dimension, scale in zip(dataset.dims, scales, strict=False):
        dimension.attach_scale(scale)
    return dataset


def scale(group: h5py.Group, name: str, values: Any, long_name: str, unit: str) -> h5py.Dataset:
    """New dataset that is the scale of a dimension of others."""
    made = described(group, name, values, long_name, unit)
    made.make_scale(name)
    return made


class Code(Protocol):
    """Number with a meaning, in words."""

    name: str
    value: str

    @property
    def code(self) -> int:
        """The number."""


def describe_codes(dataset: h5py.Dataset, codes: Iterable[Code]) -> None:
    """State the meanings of the codes in ``dataset``: as flag attributes of the CF conventions, and in words."""
    known = list(codes)
    dataset.attrs["flag_values"] = np.array([each.code for each in known], dtype=np.int64)
    dataset.attrs["flag_meanings"] = " ".join(each.name for each in known)
    dataset.attrs["meaning"] = "; ".join(f"{each.code}: {each.value}" for each in known)


class SparseImage(io.RawIOBase):
    """File object for ``h5py.File`` that keeps the pieces written to it; what lies between them is 0.

    So a file whose values do not fit in memory is laid out there without them.
    """

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
        """Position as in any file object."""
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
