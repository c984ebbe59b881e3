"""One way to compile: cached on disk, without the interpreter's lock, IEEE arithmetic as written, no allocation.

Kernels get all their arrays from Python and make none: numba then counts no references, which in loops of a few
nanoseconds cost more than the arithmetic.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit

F = TypeVar("F", bound=Callable[..., Any])


def kernel(function: F) -> F:
    """Compile a kernel when it is first called."""
    return cast(F, njit(cache=True, nogil=True, error_model="numpy", _nrt=False)(function))
