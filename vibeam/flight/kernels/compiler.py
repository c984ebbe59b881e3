"""How kernels are compiled: cached on disk, without the interpreter's lock, IEEE arithmetic as written, no allocation.

Kernels get all their arrays from Python and make none: numba then counts no references, which in loops of a few
nanoseconds cost more than the arithmetic. Only ``entry`` functions can be called from Python; the others are compiled
into them without wrappers of their own.
"""

from __future__ import annotations

from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit
from numba.core.caching import FunctionCache

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
    dispatcher._cache = _Cache(function)  # type: ignore[no-untyped-call]
    return cast(F, dispatcher)


def is_compiled(function: Callable[..., Any]) -> bool:
    """Whether an ``entry`` lies on disk, compiled from the kernels as they are."""
    index = cast(Any, function)._cache._cache_file._load_index()
    return any(key[-1] == SOURCES for key in index)


def _digest() -> str:
    files = sorted(Path(__file__).parent.glob("*.py"))
    return sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


SOURCES = _digest()


class _Cache(FunctionCache):
    """numba's cache notices a change in an entry's own file only; this one in any kernel's."""

    def _index_key(self, signature: Any, codegen: Any) -> tuple[Any, ...]:
        return (*super()._index_key(signature, codegen), SOURCES)  # type: ignore[no-untyped-call]
