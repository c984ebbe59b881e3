"""A results file that cannot be used: what is wrong with it, and the cure."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

# what h5py raises where the bytes are not as they were written
FAULTS = (OSError, KeyError, RuntimeError, ValueError, TypeError, AttributeError)


class StoreError(ValueError):
    """A results file that cannot be used: the message names the file, what is wrong, and the cure."""


@contextmanager
def reading(path: Path, where: str) -> Iterator[None]:
    """StoreError for whatever ``where`` in the file cannot be read by."""
    try:
        yield
    except FAULTS as fault:
        raise damaged(path, where, fault) from None


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """StoreError where there is no place for what is written into the open file."""
    try:
        yield
    except OSError as fault:
        raise unwritable(path, fault, "make room, then run again to go on") from None


def damaged(path: Path, where: str, fault: BaseException) -> StoreError:
    """The file does not hold what was written."""
    return StoreError(f"{path}: {where} cannot be read ({reason(fault)}): the file is damaged: delete it and run again")


def unwritable(path: Path, fault: OSError, cure: str) -> StoreError:
    """Nothing can be written where the file is, or is to be."""
    return StoreError(f"{path}: cannot be written ({reason(fault)}): {cure}")


def reason(fault: BaseException) -> str:
    """Why, in a few words."""
    if isinstance(fault, OSError) and fault.errno:
        return os.strerror(fault.errno).lower()
    return (str(fault).splitlines() or [type(fault).__name__])[0]
