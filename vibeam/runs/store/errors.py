"""Errors of results files: the fault and its cure."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

# raised by h5py for damaged bytes
FAULTS = (OSError, KeyError, RuntimeError, ValueError, TypeError, AttributeError)
CURE = "start over with --fresh, or delete it and run again"


class StoreError(ValueError):
    """Unusable results file: the message names the file, the fault, and the cure."""


@contextmanager
def reading(path: Path, where: str) -> Iterator[None]:
    """Context that turns errors of reading ``where`` in the file into StoreError."""
    try:
        yield
    except StoreError:
        raise
    except FAULTS as fault:
        raise damaged(path, where, fault) from None


def damaged(path: Path, where: str, fault: BaseException) -> StoreError:
    """Error for a damaged file."""
    return StoreError(f"{path}: {where} cannot be read ({reason(fault)}): the file is damaged: {CURE}")


def unwritable(path: Path, fault: OSError, cure: str) -> StoreError:
    """Error for a file that cannot be written."""
    return StoreError(f"{path}: cannot be written ({reason(fault)}): {cure}")


def reason(fault: BaseException) -> str:
    """Short reason of an OS error, without the name that the file has in memory."""
    if isinstance(fault, OSError) and fault.errno:
        return os.strerror(fault.errno).lower()
    first = (str(fault).splitlines() or [""])[0]
    return re.sub(r",? ?name = '[^']*'", "", first) or type(fault).__name__
