"""Memory that is free on this machine: what does not fit is refused before it is made, what is large is confirmed."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

GIGABYTE = 1e9
LARGE = 2 << 30  # bytes from which on memory is taken where that was confirmed alone
_CONFIRMED: ContextVar[bool] = ContextVar("confirmed", default=False)
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


@contextmanager
def large_memory() -> Iterator[None]:
    """Context in which computations may take 2 GiB of memory or more; elsewhere they are refused before they begin.

    >>> import vibeam
    >>> with vibeam.large_memory():
    ...     found = vibeam.identify_response([9.0, 10.0, 11.0, 12.0], [1.0, 2.0, 1.0, 0.5])
    """
    token = _CONFIRMED.set(True)
    try:
        yield
    finally:
        _CONFIRMED.reset(token)


def check_room(what: str, needed: float, cure: str) -> None:
    """ValueError, with the ``cure``, where ``what`` takes more bytes than are free, or 2 GiB without confirmation."""
    free, said = free_bytes(), f"{what}: needs {needed / GIGABYTE:.2g} GB of memory"
    if free is not None and needed > free:
        raise ValueError(f"{said}, {free / GIGABYTE:.2g} GB are free: {cure}")
    if needed >= LARGE and not _CONFIRMED.get():
        raise ValueError(f"{said}: {cure}, or go on: --yes (in Python within vibeam.large_memory())")
