"""HDF5 files of others: their content, and its values where they lie there too and are not too many.

A damaged global heap on which HDF5 may search forever is recognised before the file is opened."""

from __future__ import annotations

import mmap
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from math import ceil, prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibeam.exchange.files import BYTES, FormatError, require_room, state_of

if TYPE_CHECKING:
    import h5py
import struct

Content = bytes | mmap.mmap
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


DEEPEST = 32  # groups in groups
MOST = 50_000  # groups and datasets of a file
CHUNKS = 200_000  # of a dataset
WORD = 1000  # characters of a text
SMALL = 1_000_000  # bytes of a compressed piece: what deflate makes of it, 1032 times as much at most, is bearable
FILTERS = {1: "gzip", 2: "shuffle", 3: "fletcher32", 4: "szip", 5: "nbit", 6: "scaleoffset", 32000: "lzf"}
Place = tuple[str, Any, bool]  # path, what lies there (None: a link to another place), whether it was met before


@contextmanager
def opened(path: Path) -> Iterator[h5py.File]:
    """A regular file to read; OSError where it is no HDF5 file."""
    import h5py

    state_of(path)
    with h5py.File(path, "r") as file:
        yield file


def contents(file: h5py.File) -> Iterator[Place]:
    """Everything in a file, groups before what they hold; FormatError where it is too deep, or too much."""
    import h5py

    seen: set[int] = set()

    def below(group: h5py.Group, above: str, depth: int) -> Iterator[Place]:
        if depth > DEEPEST:
            raise FormatError(f"has groups that lie deeper than {DEEPEST} in each other")
        for name in group:
            place = f"{above}{name}"
            if type(group.get(name, getlink=True)) is not h5py.HardLink:
                yield place, None, False
                continue
            item = group[name]
            address = h5py.h5o.get_info(item.id).addr
            yield place, item, address in seen
            if address not in seen and isinstance(item, h5py.Group):
                seen.add(address)
                yield from below(item, f"{place}/", depth + 1)
            seen.add(address)

    for number, place in enumerate(below(file["/"], "", 0)):
        if number == MOST:
            raise FormatError(f"has more than {MOST} groups and datasets")
        yield place


def is_own(dataset: h5py.Dataset) -> bool:
    """Test whether the values lie in the file itself, not in files that it names."""
    import h5py

    how = dataset.id.get_create_plist()
    return how.get_layout() != h5py.h5d.VIRTUAL and not how.get_external_count()


def values_of(dataset: h5py.Dataset) -> Any:
    """Values of a dataset; FormatError where they lie elsewhere, were never written, or are too many."""
    if not is_own(dataset):
        raise FormatError(f"{dataset.name!r} has its values in other files: copy them into this one")
    if dataset.shape is None or (dataset.size and not dataset.id.get_storage_size()):
        raise FormatError(f"{dataset.name!r} has no values: they were never written")
    require_room(dataset.shape, dataset.dtype.itemsize)
    if dataset.chunks is not None:
        _require_small_chunks(dataset)
    return _words(dataset) if dataset.dtype.hasobject else dataset[()]


def _require_whole_heaps(path: str) -> None:
    """FormatError where HDF5 would look for a text without end."""
    with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        if not heaps_are_whole(content):
            raise FormatError("is damaged: a heap of its texts is broken")


def text_at(item: Any, *names: str) -> str:
    """The text of the first attribute of these names that there is, empty without one or where it is no short text."""
    import numpy as np

    for name in names:
        if name in item.attrs and (attribute := item.attrs.get_id(name)).shape in ((), (1,)):
            if attribute.dtype.hasobject:
                _require_whole_heaps(item.file.filename)
            found = np.asarray(item.attrs[name]).item()
            return (found.decode("utf-8", "replace") if isinstance(found, bytes) else str(found))[:WORD]
    return ""


def _words(dataset: h5py.Dataset) -> Any:
    """Texts of any length, one by one: a short file may name a long one many times."""
    import h5py
    import numpy as np

    if h5py.check_string_dtype(dataset.dtype) is None or dataset.size > MOST:
        raise FormatError(f"{dataset.name!r} holds neither numbers nor up to {MOST} words")
    _require_whole_heaps(dataset.file.filename)
    found = []
    for index in np.ndindex(dataset.shape):
        found.append(dataset[index])
        if len(found[-1]) > WORD:
            raise FormatError(f"{dataset.name!r} holds a word of {len(found[-1])} characters")
    return np.array(found).reshape(dataset.shape)


def _require_small_chunks(dataset: h5py.Dataset) -> None:
    """FormatError for pieces of a dataset that are too many, too large, or packed in a way that is not known."""
    count = prod(ceil(size / chunk) for size, chunk in zip(dataset.shape, dataset.chunks, strict=True))
    size = prod(dataset.chunks) * dataset.dtype.itemsize
    if count > CHUNKS or size > 2 * BYTES:
        told = f"{count} pieces of {size / 1e6:.3g} MB"
        raise FormatError(f"{dataset.name!r} lies in {told}: write it in one piece, or few small ones")
    how = dataset.id.get_create_plist()
    filters = [how.get_filter(number) for number in range(how.get_nfilters())]
    for code, _, _, name in filters:
        if code not in FILTERS:
            raise FormatError(f"{dataset.name!r} is packed by {name.decode('ascii', 'replace')!r}: pack it by gzip")
    if any(each[0] == 1 for each in filters) and dataset.id.get_storage_size() > SMALL:
        dataset.id.chunk_iter(lambda chunk: _require_size(dataset, chunk, size) if chunk.size > SMALL else None)


def _require_size(dataset: h5py.Dataset, chunk: Any, size: int) -> None:
    """FormatError for a packed piece that is larger than it says; the four bytes are those of a checksum."""
    raw = dataset.id.read_direct_chunk(chunk.chunk_offset)[1]
    if not chunk.filter_mask and len(zlib.decompressobj().decompress(raw, size + 5)) > size + 4:
        raise FormatError(f"{dataset.name!r} has a packed piece of more than its {size} bytes: it is damaged")
