"""How the entry point of these kernels is compiled: as others, and anew where one of these files has changed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from vibeam.flight.kernels import compiler
from vibeam.flight.kernels.sources import digest
from vibeam.flight.libraries.sources import sources_of

F = TypeVar("F", bound=Callable[..., Any])


def entry(function: F) -> F:
    """A function that Python calls, compiled when it first is and then kept on disk."""
    dispatcher: Any = compiler.entry(function)
    dispatcher._cache._sources = digest(sources_of(function.__module__))
    return cast(F, dispatcher)
