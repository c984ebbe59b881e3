"""Errors of stored files: the fault and its cure."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

# raised by h5py for content that is not as it was written
FAULTS = (OSError, KeyError, RuntimeError, ValueError, TypeError, AttributeError)
CURE = "start over with --fresh, or delete it and run again"
ELSEWHERE = "choose another --out"
ANEW = f"{ELSEWHERE}, or start over with --fresh"
ROOM = "make room, then run again to go on"


class StoreError(ValueError):
    """Unusable file of results: the message names the file, the fault, and the cure.

    >>> import vibeam
    >>> try:
    ...     vibeam.read("gone.h5")
    ... except vibeam.StoreError as error:
    ...     print(error)
    gone.h5: cannot be opened (no such file or directory): name one that vibeam run has written
    """


@contextmanager
def reading(path: Path, where: str) -> Iterator[None]:
    """Context that turns errors of reading ``where`` in the file into StoreError."""
    try:
        yield
    except StoreError:
        raise
    except FAULTS as fault:
        raise StoreError(f"{path}: {where} cannot be read ({reason(fault)}): the file is damaged: {CURE}") from None


def unopened(path: Path, fault: OSError, cure: str = ELSEWHERE) -> StoreError:
    """Error for a file that cannot be opened."""
    return StoreError(f"{path}: cannot be opened ({reason(fault)}): {cure}")


@contextmanager
def writing(path: Path, cure: str) -> Iterator[None]:
    """Context that turns errors of writing the file, and those beside it, into StoreError."""
    try:
        yield
    except OSError as fault:
        raise StoreError(f"{path}: cannot be written ({reason(fault)}): {cure}") from None


def reason(fault: BaseException) -> str:
    """Short reason of an OS error, without the name that the file has in memory."""
    if isinstance(fault, OSError) and fault.errno:
        return os.strerror(fault.errno).lower()
    first = (str(fault).splitlines() or [""])[0]
    return re.sub(r",? ?name = '[^']*'", "", first) or type(fault).__name__
