"""Long work: in threads, since kernels run without the interpreter's lock; how far it is, every few seconds."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import copy_context
from threading import Event, Thread, current_thread, main_thread
from time import process_time
from typing import TypeVar

from vibeam.flight.engine.threads import Stopped, stopping_at

__all__ = ["Interrupted", "Stopped", "cores", "heartbeat", "run_parallel"]
Item = TypeVar("Item")
Made = TypeVar("Made")


class Interrupted(KeyboardInterrupt):
    """Run stopped by Ctrl-C: the message says what is kept and how to continue."""


def run_parallel(task: Callable[[Item, Event], Made], items: Sequence[Item], workers: int | None = None) -> list[Made]:
    """Compute ``task(item, stop)`` for every item, one thread a core; results in the order of the items.

    The first failure, or Ctrl-C, sets ``stop``, waits until the running tasks have left (by raising ``Stopped``, as
    solvers do within a fraction of a second), and is raised. One task at a time within a thread that another call has
    begun runs in that thread, where the signal of that call reaches it. The end of a time (``ending_at``) holds in all.
    """
    from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait

    stop = Event()
    if (workers == 1 or len(items) <= 1) and current_thread() is not main_thread():
        return [task(item, stop) for item in items]

    def stoppable(item: Item) -> Made:
        with stopping_at(stop):
            return task(item, stop)

    with ThreadPoolExecutor(workers or cores(), thread_name_prefix="vibeam") as pool:
        futures = [pool.submit(copy_context().run, stoppable, item) for item in items]
        try:
            wait(futures, return_when=FIRST_EXCEPTION)
        finally:
            if not all(future.done() and future.exception() is None for future in futures):
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


EVERY = 10.0  # s between two lines


@contextmanager
def heartbeat(tell: Callable[[str], None] | None, where: Callable[[], str]) -> Iterator[None]:
    """Within it, ``tell`` hears ``where()`` and the CPU time since its begin every ``EVERY`` seconds, from a thread."""
    if tell is None:
        yield
        return
    over, begun = Event(), process_time()

    def beat() -> None:
        while not over.wait(EVERY):
            tell(f"{where()}, {process_time() - begun:.0f} s of CPU time")

    thread = Thread(target=beat, name="vibeam heartbeat", daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
