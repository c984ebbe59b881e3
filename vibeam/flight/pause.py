"""Between pieces of long work: where a signal, or a computation that is to stop, is heard."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from threading import Event

from vibeam.flight.kernels.layout import PAUSED


class Stopped(Exception):
    """A task saw its stop signal and left; never seen outside ``vibeam.run.parallel``."""


_STOP: ContextVar[Event | None] = ContextVar("stop", default=None)


@contextmanager
def stopping_at(stop: Event) -> Iterator[None]:
    """Within it, in this thread, long work raises ``Stopped`` soon after ``stop`` is set."""
    token = _STOP.set(stop)
    try:
        yield
    finally:
        _STOP.reset(token)


def pause() -> None:
    """``Stopped`` where this thread's work is to stop; Ctrl-C needs no call, Python raises it by itself."""
    stop = _STOP.get()
    if stop is not None and stop.is_set():
        raise Stopped


def unpaused(move: Callable[..., tuple[int, float]], *given: object) -> tuple[int, float]:
    """What ``move`` comes to in the end: it is called with the same arguments until it no longer pauses."""
    outcome, value = move(*given)
    while outcome == PAUSED:
        pause()
        outcome, value = move(*given)
    return outcome, value
