"""Reading of a measured curve's columns, by the ending of its file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from vibeam.exchange.curves import text
from vibeam.exchange.curves.columns import Columns, WantedColumn
from vibeam.exchange.curves.text import TextForm
from vibeam.exchange.files import LARGEST_TEXT, state_of
from vibeam_models.registry import loaded

HERE = "vibeam.exchange.curves"
BINARY = {
    ".mat": f"{HERE}.arrays:read_matlab",
    ".tdms": f"{HERE}.tdms:read",
    **dict.fromkeys((".h5", ".hdf5", ".hdf", ".nc"), f"{HERE}.arrays:read_hdf5"),
}
READERS = (
    BINARY
    | dict.fromkeys((".uff", ".unv", ".uf", ".58"), f"{HERE}.universal:read")
    | dict.fromkeys((".wav", ".wave"), f"{HERE}.waves:read")
)


def read_columns(path: Path, wanted: Mapping[str, WantedColumn], form: TextForm | None = None) -> Columns:
    """The columns wanted of a file, by role; FormatError names what is wrong, where, and the cure."""
    state_of(path, LARGEST_TEXT)
    if is_text(path):
        return text.read(path, wanted, form)
    found: Columns = loaded(READERS[path.suffix.lower()])(path, wanted)
    return found


def is_text(path: Path) -> bool:
    """True where a file is read as text, by its ending."""
    return path.suffix.lower() not in READERS
