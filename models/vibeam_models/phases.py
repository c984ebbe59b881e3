"""Phases of what takes long before a sweep begins, told to whoever listens: mesh, order, factors, modes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

LARGE = 20_000  # coordinates from which on phases are told

Listener = Callable[[str], None]
_LISTENER: ContextVar[Listener | None] = ContextVar("phases", default=None)


def phase(doing: str, coordinates: int) -> None:
    """Tell that ``doing`` begins, of a structure of so many coordinates; of a small one nobody is told."""
    listener = _LISTENER.get()
    if listener is not None and coordinates >= LARGE:
        listener(f"{doing}: {format(coordinates, ',').replace(',', ' ')} coordinates")


@contextmanager
def phases_told(listener: Listener) -> Iterator[None]:
    """Context in which a ``listener`` is told of each phase."""
    token = _LISTENER.set(listener)
    try:
        yield
    finally:
        _LISTENER.reset(token)
