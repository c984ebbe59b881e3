"""Whether a process works: CPU time of it and its descendants, which a busy machine delays but does not change."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

IDLE = 60.0  # seconds without any CPU time, and without being ready for it, after which a process waits for ever

READY = "RD"  # states in /proc: on a processor or queued for one; reading or writing


class Idleness:
    """Watches a process: ask ``lasts`` now and then."""

    def __init__(self, process: int, idle: float = IDLE) -> None:
        self.process, self.idle = process, idle
        self.worked, self.since = -1, time.monotonic()

    def lasts(self) -> bool:
        """Whether neither the process nor any that it began has worked, or was ready to, for ``idle`` seconds."""
        worked, ready = activity(self.process)
        if ready or worked != self.worked:
            self.worked, self.since = worked, time.monotonic()
        return time.monotonic() - self.since > self.idle


def activity(process: int) -> tuple[int, bool]:
    """CPU time of a process and all that it began, in clock ticks, and whether one of them is ready for more.

    That of a process which has ended and was waited for is its parent's.
    """
    ticks, ready = 0, False
    for folder in _family(Path(f"/proc/{process}")):
        with suppress(OSError):  # it has ended meanwhile
            ticks += sum(map(int, _fields(folder)[11:15]))  # user, system, and both of children that were waited for
            ready |= any(_fields(task)[0] in READY for task in (folder / "task").iterdir())
    return ticks, ready


def _family(folder: Path) -> Iterator[Path]:
    yield folder
    with suppress(OSError):
        for task in (folder / "task").iterdir():
            for child in (task / "children").read_text().split():
                yield from _family(Path(f"/proc/{child}"))


def _fields(folder: Path) -> list[str]:
    """Fields of ``stat`` after the name, which is in brackets and may hold anything: state first."""
    return (folder / "stat").read_text().rpartition(")")[2].split()
