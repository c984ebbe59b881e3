"""Compilation of kernels: cached on disk, without the interpreter's lock, IEEE arithmetic as written, no allocation.

Kernels get all their arrays from Python and make none: numba then counts no references, which in loops of a few
nanoseconds cost more than the arithmetic. Only ``entry`` functions can be called from Python; the others are compiled
into them without wrappers of their own.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit
from numba.core.caching import FunctionCache

from vibeam.flight.kernels.sources import digest, sources_of

F = TypeVar("F", bound=Callable[..., Any])
OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False}
INNER: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def kernel(function: F) -> F:
    """A piece that other kernels call."""
    return cast(F, njit(**OPTIONS, **INNER)(function))


def joined(function: F) -> F:
    """A piece that is taken whole into every place that calls it."""
    return cast(F, njit(**OPTIONS, **INNER, forceinline=True)(function))


def summing(function: F) -> F:
    """A piece whose sums may be taken in any order, so that they run side by side in the processor's lanes."""
    return cast(F, njit(**OPTIONS, **INNER, forceinline=True, fastmath={"reassoc", "nsz", "contract"})(function))


def entry(function: F) -> F:
    """A function that Python calls, compiled when it first is and then kept on disk."""
    dispatcher = njit(**OPTIONS, cache=True)(function)
    dispatcher._cache = _Cache(function)
    return cast(F, dispatcher)


class _Cache(FunctionCache):
    """numba's cache notices a change in an entry's own file only; this one in any kernel that it may call."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        self._sources = digest(sources_of(function.__module__))

    def _index_key(self, signature: Any, codegen: Any) -> tuple[Any, ...]:
        return (*super()._index_key(signature, codegen), self._sources)  # type: ignore[no-untyped-call]
