"""Threads at work, since kernels run without the interpreter's lock: each with working arrays of its own.

They are heard between pieces of long work: there a signal, a computation that is to stop, or the end of a time is
noticed.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar, copy_context
from threading import Event, current_thread, local, main_thread
from typing import Any, Generic, TypeVar, cast

import numpy as np

from vibeam.flight.kernels import layout

Clock = Callable[[], float]
_STOP: ContextVar[Event | None] = ContextVar("stop", default=None)
_TIMES: ContextVar[tuple[tuple[Clock, float], ...]] = ContextVar("times", default=())
Arrays = TypeVar("Arrays", bound=tuple[Any, ...])


Item = TypeVar("Item")
Made = TypeVar("Made")


class Stopped(Exception):
    """A task saw its stop signal and left; never seen outside ``run_parallel``."""


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
    """Within it, in this thread, long work raises ``OutOfTime`` soon after ``clock()`` has passed ``deadline``.

    A time within another does not lengthen it: the first that is up ends the work.
    """
    token = _TIMES.set((*_TIMES.get(), (clock, deadline)))
    try:
        yield
    finally:
        _TIMES.reset(token)


def pause() -> None:
    """``Stopped`` or ``OutOfTime`` where this thread's work is to end; Ctrl-C needs no call, Python raises it."""
    stop = _STOP.get()
    if stop is not None and stop.is_set():
        raise Stopped
    if any(clock() > deadline for clock, deadline in _TIMES.get()):
        raise OutOfTime("the time was up")


def run_parallel(task: Callable[[Item, Event], Made], items: Sequence[Item], workers: int | None = None) -> list[Made]:
    """Compute ``task(item, stop)`` for every item, one thread a core; results in the order of the items.

    The first failure, or Ctrl-C, sets ``stop``, waits until the running tasks have left (by raising ``Stopped``, as
    solvers do within a fraction of a second), and is raised. One task at a time within a thread that another call has
    begun runs in that thread, where the signal of that call reaches it. The end of a time (``ending_at``) holds in all.
    """
    from concurrent.futures import FIRST_EXCEPTION, Future, ThreadPoolExecutor, wait

    stop = Event()
    if (workers == 1 or len(items) <= 1) and current_thread() is not main_thread():
        return [task(item, stop) for item in items]

    def stoppable(item: Item) -> Made:
        with stopping_at(stop):
            return task(item, stop)

    with ThreadPoolExecutor(workers or cores(), thread_name_prefix="vibeam") as pool:
        futures: list[Future[Made]] = []
        try:  # the first task may be stopped before the last is handed over
            futures.extend(pool.submit(copy_context().run, stoppable, item) for item in items)
            wait(futures, return_when=FIRST_EXCEPTION)
        finally:
            if len(futures) < len(items) or any(not each.done() or each.exception() for each in futures):
                stop.set()
                pool.shutdown(cancel_futures=True)
    for future in futures:
        failure = None if future.cancelled() else future.exception()
        if failure is not None and not isinstance(failure, Stopped):
            raise failure
    return [future.result() for future in futures]


def cores() -> int:
    """Number of processor cores available to this process."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def unpaused(move: Callable[..., tuple[int, float]], *given: object) -> tuple[int, float]:
    """Outcome and value of ``move``, called with the same arguments until it no longer pauses."""
    outcome, value = layout.PAUSED, 0.0
    while outcome == layout.PAUSED:
        pause()
        outcome, value = move(*given)
    return outcome, value


def resumed(go_on: Callable[[int], tuple[int, int]]) -> int:
    """Outcome of ``go_on``, called from 0 and then from where it got to until it no longer pauses."""
    outcome, first = layout.PAUSED, 0
    while outcome == layout.PAUSED:
        pause()
        outcome, first = go_on(first)
    return outcome


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
