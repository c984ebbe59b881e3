"""Admissible structure of a results file: groups and plain datasets of its own, no links elsewhere."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import h5py


def refuse_foreign(file: h5py.File) -> None:
    """Raise ValueError for a soft or external link, data outside the file or not stored contiguously; RuntimeError for
    attributes that cannot be gone through.

    An accepted file is no larger on reading than on disk, and reading it touches nothing else.
    """
    import h5py

    seen: set[int] = set()
    waiting = [file["/"]]
    while waiting:
        group = waiting.pop()
        for name in group:
            place = f"{group.name.rstrip('/')}/{name}"
            if type(group.get(name, getlink=True)) is not h5py.HardLink:
                raise ValueError(f"{place} is a link to another place")
            item = group[name]
            _refuse_twice(item, place, seen)
            h5py.h5a.iterate(item.id, _read)
            if isinstance(item, h5py.Group):
                waiting.append(item)
            elif not isinstance(item, h5py.Dataset) or not _plain(item):
                raise ValueError(f"{place} holds no values of its own")


def _read(name: bytes) -> None:
    """An attribute whose record can be read."""


def _refuse_twice(item: Any, place: str, seen: set[int]) -> None:
    import h5py

    address = h5py.h5o.get_info(item.id).addr
    if address in seen:
        raise ValueError(f"{place} is linked twice")
    seen.add(address)


def _plain(dataset: h5py.Dataset) -> bool:
    """Test whether the values lie in the file contiguously."""
    import h5py

    how = dataset.id.get_create_plist()
    contiguous = how.get_layout() in (h5py.h5d.CONTIGUOUS, h5py.h5d.COMPACT) and not how.get_external_count()
    return contiguous and dataset.id.get_storage_size() == dataset.nbytes
