"""Global heaps of an HDF5 file: a damaged one on which HDF5 may search forever is recognised before it is opened."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from mmap import mmap

Content = bytes | mmap
SIGNATURE = b"GCOL\x01\0\0\0"
HEADER = 16  # bytes: signature, version, size of the collection; likewise of each object in it
_OBJECT = struct.Struct("<HHIQ")  # index, references, reserved, size


def heaps_are_whole(content: Content) -> bool:
    """Test whether the objects of every global heap lie within it, one behind the other.

    Layout: HDF5 File Format Specification 3.0, section III.E. An object of index 0 is free space: its size includes its
    header, so that one of size 0 has no next one.
    """
    return all(_is_whole(content, start) for start in _starts(content))


def _starts(content: Content) -> Iterator[int]:
    at = content.find(SIGNATURE)
    while at >= 0:
        yield at
        at = content.find(SIGNATURE, at + 1)


def _is_whole(content: Content, start: int) -> bool:
    if start + HEADER > len(content):
        return False
    end = start + int.from_bytes(content[start + 8 : start + HEADER], "little")
    at = start + HEADER
    while at + HEADER <= min(end, len(content)):
        index, _, _, size = _OBJECT.unpack_from(content, at)
        if index == 0 and size < HEADER:
            return False
        at += size if index == 0 else HEADER + -(-size // 8) * 8
    return at <= end <= len(content)
