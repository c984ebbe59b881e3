"""A results file changed by hand and sealed again, as if vibeam had written it so."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from vibeam.exchange.whole_files import read_sealed, write_sealed
from vibeam.store.hdf5 import content_of, in_memory


@contextmanager
def edited(path: Path) -> Iterator[h5py.File]:
    """The HDF5 of the file, in memory until the end."""
    content = read_sealed(path)
    assert content is not None
    with in_memory(content) as file:
        yield file
        write_sealed(path, content_of(file))
