"""Working arrays of a compiled engine: one copy for each thread, so that threads may share a solver."""

from __future__ import annotations

from threading import local
from typing import Any, Generic, TypeVar, cast

import numpy as np

Arrays = TypeVar("Arrays", bound=tuple[Any, ...])


class PerThread(Generic[Arrays]):
    """A (nested) tuple of arrays, copied once for each thread that works on it; the original is never written to."""

    def __init__(self, original: Arrays) -> None:
        self._original, self._local = original, local()

    def own(self) -> Arrays:
        """The calling thread's copy, the same one at every call."""
        try:
            return cast(Arrays, self._local.copy)
        except AttributeError:
            self._local.copy = copied(self._original)
            return cast(Arrays, self._local.copy)

    def __reduce__(self) -> tuple[type[PerThread[Arrays]], tuple[Arrays]]:
        return PerThread, (self._original,)


def copied(arrays: Arrays) -> Arrays:
    """The same tuple with a copy of every array; what occurs twice in it stays one."""
    return cast(Arrays, _copied(arrays, {}))


def _copied(value: Any, seen: dict[int, Any]) -> Any:
    if id(value) not in seen:
        is_array = isinstance(value, np.ndarray)
        seen[id(value)] = value.copy() if is_array else type(value)(*(_copied(each, seen) for each in value))
    return seen[id(value)]
