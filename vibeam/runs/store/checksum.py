"""Checksums (CRC-32) of every point of a branch, and of all other data read back from a file."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import h5py


CHECKSUM = "checksum"
NO_VALUES = (CHECKSUM, "DIMENSION_LIST", "REFERENCE_LIST")  # references between scales


def of_rows(columns: Iterable[NDArray[Any]], name: str) -> NDArray[np.uint32]:
    """Checksum of each row of ``columns``, all of (rows, …), together with ``name``."""
    rows = np.hstack([_as_bytes(values) for values in columns])
    start = zlib.crc32(name.encode())
    return np.array([zlib.crc32(row, start) for row in rows], dtype=np.uint32)


def of_group(group: h5py.Group) -> int:
    """Checksum of the names, values and attributes in a group and below it."""
    import h5py

    found = _of_attributes(group)
    for name in sorted(group):
        item = group[name]
        inner = of_group(item) if isinstance(item, h5py.Group) else _of_dataset(item)
        found = zlib.crc32(f"{name} {inner}".encode(), found)
    return found


def sign(group: h5py.Group) -> None:
    """Store the checksum of a completed group; one that is there is overwritten in place."""
    put = group.attrs.modify if CHECKSUM in group.attrs else group.attrs.create
    put(CHECKSUM, np.uint32(of_group(group)))


def is_sound(group: h5py.Group) -> bool:
    """Whether a group has a checksum and matches it."""
    return CHECKSUM in group.attrs and int(group.attrs[CHECKSUM]) == of_group(group)


def verify(group: h5py.Group) -> None:
    """Raise ValueError where the group does not match its checksum."""
    if not is_sound(group):
        raise ValueError("its checksum does not fit")


def _as_bytes(values: NDArray[Any]) -> NDArray[np.uint8]:
    wide = int(np.prod(values.shape[1:]))
    return np.ascontiguousarray(values).reshape(len(values), wide).view(np.uint8)


def _of_dataset(dataset: h5py.Dataset) -> int:
    return zlib.crc32(_encoded(dataset[()]), _of_attributes(dataset))


def _of_attributes(item: Any) -> int:
    found = 0
    for name in sorted(set(item.attrs) - set(NO_VALUES)):
        found = zlib.crc32(_encoded(item.attrs[name]), zlib.crc32(name.encode(), found))
    return found


def _encoded(value: Any) -> bytes:
    if isinstance(value, str):
        return value.encode()
    values = np.asarray(value)
    return f"{values.dtype.str}{values.shape}".encode() + values.tobytes()
