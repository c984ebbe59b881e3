"""Memory that is free on this machine, so that what does not fit is told before it is made."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

GIGABYTE = 1e9
INFO = Path("/proc/meminfo")
GROUPS = (  # limit and use of a container's processes: cgroup 2, then 1
    (Path("/sys/fs/cgroup/memory.max"), Path("/sys/fs/cgroup/memory.current")),
    (Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"), Path("/sys/fs/cgroup/memory/memory.usage_in_bytes")),
)


def free_bytes() -> float | None:
    """Memory that may still be taken, in bytes: of the machine, the container, the process; None where none says."""
    return min(_limits(), default=None)


def _limits() -> Iterator[float]:
    for line in _read(INFO).splitlines():
        if line.startswith("MemAvailable:"):
            yield 1024 * float(line.split()[1])
    for most, used in GROUPS:
        limit, taken = _read(most).strip(), _read(used).strip()
        if limit.isdigit() and taken.isdigit():
            yield float(limit) - float(taken)
    yield from _of_process()


def _of_process() -> Iterator[float]:
    """Memory that ``ulimit -v`` leaves."""
    yield from ()  # all under Windows
    if sys.platform != "win32":
        from resource import RLIM_INFINITY, RLIMIT_AS, getrlimit

        most = getrlimit(RLIMIT_AS)[0]
        taken = _read(Path("/proc/self/statm")).split()
        if most != RLIM_INFINITY and taken:
            yield most - float(taken[0]) * os.sysconf("SC_PAGE_SIZE")


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="ascii")
    except (OSError, ValueError):
        return ""


def check_room(what: str, needed: float, cure: str) -> None:
    """ValueError where ``what`` takes more bytes than are free, with both sizes and the ``cure``."""
    free = free_bytes()
    if free is not None and needed > free:
        raise ValueError(
            f"{what}: needs {needed / GIGABYTE:.2g} GB of memory, {free / GIGABYTE:.2g} GB are free: {cure}"
        )
