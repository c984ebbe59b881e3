"""Bytes of a results file: read whole, of the kind of format that they state, opened where their seal fits."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from vibeam.exchange.whole_files import unsealed
from vibeam.store.errors import CURE, ELSEWHERE, FAULTS, StoreError, reason, unopened
from vibeam.store.hdf5 import SIGNATURE, in_memory
from vibeam.store.place import Place

if TYPE_CHECKING:
    import h5py


def bytes_of(place: Place, mode: str, form: str, refusal: str, cure: str = ELSEWHERE) -> tuple[str, bytes]:
    """Format and bytes of the file, even a damaged one, opened in that ``mode``; StoreError where it cannot be.

    ``refusal``: of a file that states no format of the kind of ``form``, which is the kind's name and a number.
    """
    try:
        with place.target.open(mode) as file:
            content = bytes(file.read())
    except OSError as fault:
        raise unopened(place.path, fault, cure) from None
    kind = form.rpartition(" ")[0]
    found = re.search(rf"{kind} \d+".encode(), content) if content.startswith(SIGNATURE) else None
    if not found:
        raise StoreError(f"{place.path}: {refusal}")
    return found.group().decode(), content


def opened_image(place: Place, mode: str, form: str, refusal: str, cure: str = ELSEWHERE) -> h5py.File:
    """The file in memory; StoreError as ``bytes_of``, and where it is not, to the bit, as this version wrote it."""
    stated, content = bytes_of(place, mode, form, refusal, cure)
    if stated != form:
        raise StoreError(f"{place.path}: is no vibeam result of this version: {CURE}")
    whole = unsealed(content)
    if whole is None:
        raise StoreError(f"{place.path}: its digest does not fit: it is damaged, or was changed since: {CURE}")
    try:
        return in_memory(whole)
    except FAULTS as fault:
        raise StoreError(f"{place.path}: it cannot be read ({reason(fault)}): {CURE}") from None
