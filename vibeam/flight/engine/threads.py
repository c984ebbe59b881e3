"""Threads at work: each with working arrays of its own, and heard between pieces of long work.

There a signal, a computation that is to stop, or the end of a time is noticed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from threading import Event, local
from typing import Any, Generic, TypeVar, cast

import numpy as np

from vibeam.flight.kernels import layout

Clock = Callable[[], float]
_STOP: ContextVar[Event | None] = ContextVar("stop", default=None)
_TIME: ContextVar[tuple[Clock, float] | None] = ContextVar("time", default=None)
Arrays = TypeVar("Arrays", bound=tuple[Any, ...])


class Stopped(Exception):
    """A task saw its stop signal and left; never seen outside ``vibeam.runs.parallel``."""


class OutOfTime(Exception):
    """Work that did not end within its time; the message says where it was."""


@contextmanager
def stopping_at(stop: Event) -> Iterator[None]:
    """Within it, in this thread, long work raises ``Stopped`` soon after ``stop`` is set."""
    token = _STOP.set(stop)
    try:
        yield
    finally:
        _STOP.reset(token)


@contextmanager
def ending_at(clock: Clock, deadline: float) -> Iterator[None]:
    """Within it, in this thread, long work raises ``OutOfTime`` soon after ``clock()`` has passed ``deadline``."""
    token = _TIME.set((clock, deadline))
    try:
        yield
    finally:
        _TIME.reset(token)


def pause() -> None:
    """``Stopped`` or ``OutOfTime`` where this thread's work is to end; Ctrl-C needs no call, Python raises it."""
    stop, time = _STOP.get(), _TIME.get()
    if stop is not None and stop.is_set():
        raise Stopped
    if time is not None and time[0]() > time[1]:
        raise OutOfTime("the time was up")


def unpaused(move: Callable[..., tuple[int, float]], *given: object) -> tuple[int, float]:
    """Outcome and value of ``move``, called with the same arguments until it no longer pauses."""
    outcome, value = move(*given)
    while outcome == layout.PAUSED:
        pause()
        outcome, value = move(*given)
    return outcome, value


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
