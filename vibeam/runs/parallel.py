"""Long work: in threads (``flight.engine.threads``); how far it is, every few seconds, and that it was stopped."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Lock, Thread
from time import process_time

from vibeam.flight.engine.threads import Stopped, cores, run_parallel

__all__ = ["Interrupted", "PointCount", "Stopped", "cores", "heartbeat", "run_parallel"]


class Interrupted(KeyboardInterrupt):
    """Run stopped by Ctrl-C: the message says what is kept and how to continue."""


class PointCount:
    """Counter of the points, or motions, that are there, told as they come."""

    def __init__(self, done: int, total: int, told: Callable[[int, int], None], what: str = "points") -> None:
        self.done, self.total = done, total
        self._told, self._what, self._lock = told, what, Lock()
        told(done, total)

    def add(self, points: int = 1) -> None:
        """Count further ones."""
        with self._lock:
            self.done += points
            self._told(self.done, self.total)

    def stopped(self, path: Path | None) -> Interrupted:
        """Error of a run that is stopped now."""
        there = f"{self.done} of {self.total} {self._what}"
        if path is None or not self.done:
            return Interrupted(f"stopped after {there}: nothing is kept")
        return Interrupted(f"stopped: {there} are kept in {path}: the same command goes on from there")


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
