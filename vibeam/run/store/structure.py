"""Admissible structure of a results file: groups and plain datasets of its own, no links elsewhere."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibeam.exchange.hdf5 import contents, is_own

if TYPE_CHECKING:
    import h5py


def refuse_foreign(file: h5py.File) -> None:
    """Raise ValueError for a soft or external link, data outside the file or not stored contiguously; RuntimeError for
    attributes that cannot be gone through.

    An accepted file is no larger on reading than on disk, and reading it touches nothing else.
    """
    import h5py

    for place, item, again in contents(file):
        if item is None:
            raise ValueError(f"/{place} is a link to another place")
        if again:
            raise ValueError(f"/{place} is linked twice")
        h5py.h5a.iterate(item.id, _read)
        if not isinstance(item, h5py.Group) and (not isinstance(item, h5py.Dataset) or not _plain(item)):
            raise ValueError(f"/{place} holds no values of its own")


def _read(name: bytes) -> None:
    """An attribute whose record can be read."""


def _plain(dataset: h5py.Dataset) -> bool:
    """Test whether the values lie in the file contiguously."""
    import h5py

    contiguous = dataset.id.get_create_plist().get_layout() in (h5py.h5d.CONTIGUOUS, h5py.h5d.COMPACT)
    return contiguous and is_own(dataset) and dataset.id.get_storage_size() == dataset.nbytes
