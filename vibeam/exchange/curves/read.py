"""Reading of a measured curve's columns, by the ending of its file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from vibeam.exchange.curves import text
from vibeam.exchange.curves.columns import Columns, WantedColumn
from vibeam.exchange.curves.text import TextForm
from vibeam.exchange.files import LARGEST_TEXT, state_of

BINARY = {
    ".mat": "read_matlab", ".h5": "read_hdf5", ".hdf5": "read_hdf5", ".hdf": "read_hdf5", ".nc": "read_hdf5",
}  # fmt: skip

UNIVERSAL = (".uff", ".unv", ".uf", ".58")


def read_columns(path: Path, wanted: Mapping[str, WantedColumn], form: TextForm | None = None) -> Columns:
    """The columns wanted of a file, by role; FormatError names what is wrong, where, and the cure."""
    state_of(path, LARGEST_TEXT)
    ending = path.suffix.lower()
    if ending in BINARY:
        from vibeam.exchange.curves import arrays

        reader = arrays.read_matlab if BINARY[ending] == "read_matlab" else arrays.read_hdf5
        return reader(path, wanted)
    if ending in UNIVERSAL:
        from vibeam.exchange.curves import universal

        return universal.read(path, wanted)
    return text.read(path, wanted, form)


def is_text(path: Path) -> bool:
    """True where a file is read as text, by its ending."""
    return path.suffix.lower() not in (*BINARY, *UNIVERSAL)
