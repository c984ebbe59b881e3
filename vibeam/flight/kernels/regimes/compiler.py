"""Entry points of this engine: compiled when a scene first asks for it, cached apart from the flight kernels'."""

from __future__ import annotations

from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit
from numba.core.caching import FunctionCache

from vibeam.flight.kernels.compiler import OPTIONS
from vibeam.flight.kernels.compiler import SOURCES as FLIGHT_SOURCES

F = TypeVar("F", bound=Callable[..., Any])


def entry(function: F) -> F:
    """A function that Python calls, compiled when it first is and then kept on disk."""
    dispatcher = njit(**OPTIONS, cache=True)(function)
    dispatcher._cache = _Cache(function)  # type: ignore[no-untyped-call]
    return cast(F, dispatcher)


def _digest() -> str:
    files = sorted(Path(__file__).parent.glob("*.py"))
    return sha256(b"".join(file.read_bytes() for file in files)).hexdigest() + FLIGHT_SOURCES


SOURCES = _digest()


class _Cache(FunctionCache):
    """Notices a change in any kernel, here or among the flight's."""

    def _index_key(self, signature: Any, codegen: Any) -> tuple[Any, ...]:
        return (*super()._index_key(signature, codegen), SOURCES)  # type: ignore[no-untyped-call]
