"""A results file that cannot be used: what is wrong with it, and the cure."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

# what h5py raises where the bytes are not as they were written
FAULTS = (OSError, KeyError, RuntimeError, ValueError, TypeError, AttributeError)

CURE = "start over with --fresh, or delete it and run again"


class StoreError(ValueError):
    """A results file that cannot be used: the message names the file, what is wrong, and the cure."""


@contextmanager
def reading(path: Path, where: str) -> Iterator[None]:
    """StoreError for whatever ``where`` in the file cannot be read by."""
    try:
        yield
    except StoreError:
        raise
    except FAULTS as fault:
        raise damaged(path, where, fault) from None


def damaged(path: Path, where: str, fault: BaseException) -> StoreError:
    """The file does not hold what was written."""
    return StoreError(f"{path}: {where} cannot be read ({reason(fault)}): the file is damaged: {CURE}")


def unwritable(path: Path, fault: OSError, cure: str) -> StoreError:
    """Nothing can be written where the file is, or is to be."""
    return StoreError(f"{path}: cannot be written ({reason(fault)}): {cure}")


def reason(fault: BaseException) -> str:
    """Why, in a few words; without the name that the file has in memory."""
    if isinstance(fault, OSError) and fault.errno:
        return os.strerror(fault.errno).lower()
    first = (str(fault).splitlines() or [""])[0]
    return re.sub(r",? ?name = '[^']*'", "", first) or type(fault).__name__
