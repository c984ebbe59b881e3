"""What was taken of files of measured data, told to a command that listens: once a file."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vibeam.exchange.curves.taken import Taken

Told = tuple[Callable[[str], None], "list[Taken]"]
_TOLD: ContextVar[Told | None] = ContextVar("taken", default=None)


def tell(taken: Taken | None) -> None:
    """Tell what was taken of a file to whoever listens, unless it was told before."""
    told = _TOLD.get()
    if told is not None and taken is not None and taken not in told[1]:
        told[1].append(taken)
        told[0](f"{taken.file}: {taken}")


def all_taken() -> dict[str, list[Taken]]:
    """All that was told so far in this context, as ``taken``; empty where nothing was."""
    told = _TOLD.get()
    return {"taken": told[1]} if told and told[1] else {}


@contextmanager
def taken_told(listener: Callable[[str], None]) -> Iterator[None]:
    """Context in which a ``listener`` is told, in a line, what is taken of each file."""
    token = _TOLD.set((listener, []))
    try:
        yield
    finally:
        _TOLD.reset(token)
