"""Heartbeat of long work: a line every few seconds that says how far it is, however long one piece of it takes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Thread
from time import process_time

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
