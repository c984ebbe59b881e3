"""Long work: in threads (``flight.engine.threads``); how far it is, every few seconds, and that it was stopped."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Thread
from time import process_time

from vibeam.flight.engine.threads import Stopped, cores, run_parallel

__all__ = ["Interrupted", "Stopped", "cores", "heartbeat", "run_parallel"]


class Interrupted(KeyboardInterrupt):
    """Run stopped by Ctrl-C: the message says what is kept and how to continue."""


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
