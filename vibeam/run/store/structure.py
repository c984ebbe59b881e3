"""What a results file may consist of: groups and plain datasets of its own, nothing that lies elsewhere."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import h5py


def refuse_foreign(file: h5py.File) -> None:
    """ValueError for a link that is soft or external, data outside the file or not stored as they are.

    What is left is no larger than the file, and reading it touches nothing else.
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
            if isinstance(item, h5py.Group):
                waiting.append(item)
            elif not isinstance(item, h5py.Dataset) or not _plain(item):
                raise ValueError(f"{place} holds no values of its own")


def _refuse_twice(item: Any, place: str, seen: set[int]) -> None:
    import h5py

    address = h5py.h5o.get_info(item.id).addr
    if address in seen:
        raise ValueError(f"{place} is linked twice")
    seen.add(address)


def _plain(dataset: h5py.Dataset) -> bool:
    """Whether the values lie in the file one after the other, all of them."""
    import h5py

    how = dataset.id.get_create_plist()
    contiguous = how.get_layout() in (h5py.h5d.CONTIGUOUS, h5py.h5d.COMPACT) and not how.get_external_count()
    return contiguous and dataset.id.get_storage_size() == dataset.nbytes
