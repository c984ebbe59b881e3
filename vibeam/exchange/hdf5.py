"""HDF5 files of others: their content, and its values where they lie there too and are not too many."""

from __future__ import annotations

import mmap
from collections.abc import Collection, Iterator
from math import prod
from pathlib import Path
from struct import unpack_from
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.exchange.files import FormatError, require_room, state_of

if TYPE_CHECKING:
    import h5py

DEEPEST = 32  # groups in groups
MOST = 50_000  # groups and datasets of a file
WORD = 1000  # characters of a text
SAID = 33  # texts or numbers of an attribute
Place = tuple[str, Any, bool]  # path, what lies there (None: a link to another place), whether it was met before


def opened(path: Path) -> h5py.File:
    """A regular file to read; OSError where it is no HDF5 file."""
    import h5py

    state_of(path)
    _require_heaps(path)
    return h5py.File(path, "r")


def _require_heaps(path: Path) -> None:
    """FormatError for a heap of texts with an empty piece, at which the library would never go on.

    Layout: HDF5 File Format Specification 3.0, III.E "Global Heap".
    """
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        at = -1
        while (at := content.find(b"GCOL\1\0\0\0", at + 1)) >= 0:
            place, end = at + 16, min(at + int.from_bytes(content[at + 8 : at + 16], "little"), len(content))
            while place + 16 <= end:
                index, size = unpack_from("<H6xQ", content, place)
                if not index and size < 16:
                    raise FormatError(f"is damaged: the heap at byte {at} has an empty piece")
                place += size if not index else 16 + size + -size % 8


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
    return _words(dataset) if dataset.dtype.hasobject else dataset[()]


def text_at(item: Any, *names: str) -> str:
    """The text of the first attribute of these names that there is, empty without one or where it is no short text."""
    found = words_of(item, names)
    return next((str(found[name]) for name in names if name in found), "")


def words_of(item: Any, words: Collection[str]) -> dict[str, Any]:
    """Numbers and texts of the attributes of these names, in small letters."""
    found: dict[str, Any] = {}
    for name in item.attrs:
        shape = item.attrs.get_id(name).shape
        if name.casefold() in words and shape is not None and 0 < prod(shape) <= SAID:
            values = np.ravel(np.asarray(item.attrs[name])).tolist()
            texts = [each.decode("utf-8", "replace") if isinstance(each, bytes) else each for each in values]
            cut = [each[:WORD] if isinstance(each, str) else each for each in texts]
            found[name.casefold()] = cut[0] if len(cut) == 1 else cut
    return found


def referred(place: str, dataset: h5py.Dataset) -> Iterator[tuple[str, h5py.Dataset]]:
    """A dataset by its path; of MATLAB's cells and arrays of structures what they refer to, as ``run(2)/acc``."""
    import h5py

    if h5py.check_ref_dtype(dataset.dtype) is not h5py.Reference or not is_own(dataset) or dataset.size > WORD:
        yield place, dataset
        return
    above, _, name = place.rpartition("/")
    cells = not above or words_of(dataset, ("matlab_class",))
    for number, reference in enumerate(np.ravel(dataset[()]), 1):
        inner = dataset.file[reference] if reference else None
        if isinstance(inner, h5py.Dataset):
            yield f"{place}({number})" if cells else f"{above}({number})/{name}", inner


def _words(dataset: h5py.Dataset) -> Any:
    """Texts of any length, one by one: a short file may name a long one many times."""
    import h5py

    if h5py.check_string_dtype(dataset.dtype) is None or dataset.size > MOST:
        raise FormatError(f"{dataset.name!r} holds neither numbers nor up to {MOST} words")
    found = []
    for index in np.ndindex(dataset.shape):
        found.append(dataset[index])
        if len(found[-1]) > WORD:
            raise FormatError(f"{dataset.name!r} holds a word of {len(found[-1])} characters")
    return np.array(found).reshape(dataset.shape)
