"""Tell, through the logger "vibeam", which kernels are compiled: it takes minutes, once, and would look like a hang.

numba reports each compilation as it begins, whatever call asks for it, and none where its cache has the kernel. The
level is WARNING, so that a program which configures no logging sees the line on stderr, as matplotlib does for its
cache of fonts.
"""

from __future__ import annotations

import logging
from functools import cache
from typing import Any

from numba.core import event

LOG = logging.getLogger("vibeam")

PLAIN, POINTS = "vibeam.flight.kernels", "vibeam.flight.points.kernels"
REGIMES, CONTACTS = f"{PLAIN}.regimes.entry", f"{PLAIN}.contacts.entry"
FLIGHT = ("the flight kernels", "about a minute")
IN_REGIMES = ("the kernels of yielding stops, R(v), second stops and coupled damping", "one to two minutes")
KERNELS = {  # by entry point: what is compiled, and about how long that takes on a common machine
    f"{PLAIN}.roots.pair.tabulate": ("the tables of the exact flow", "some seconds"),
    f"{PLAIN}.entry.move": FLIGHT,
    f"{PLAIN}.entry.poses_at": FLIGHT,
    f"{PLAIN}.entry.cover": ("the kernels of certificates", "about half a minute"),
    f"{PLAIN}.moreau.march": ("time stepping", "some seconds"),
    f"{REGIMES}.move": IN_REGIMES,
    f"{REGIMES}.poses_at": IN_REGIMES,
    f"{REGIMES}.cover": ("the kernels of their certificates", "about half a minute"),
    f"{CONTACTS}.move": ("the kernels of several contacts", "one to two minutes"),
    f"{CONTACTS}.poses_at": ("the kernels of several contacts", "one to two minutes"),
    f"{CONTACTS}.extremes_loaded": ("the kernels of several contacts", "one to two minutes"),
    f"{CONTACTS}.cover": ("the kernels of several contacts", "one to two minutes"),
    f"{PLAIN}.tangents.entry.carry": ("the kernels of tangent maps", "about half a minute"),
    f"{POINTS}.entry.run": ("the kernels of batches", "one to two minutes"),
    f"{POINTS}.disturbances.carry": ("the kernels of Lyapunov exponents", "about a minute"),
}


class _Announcer(event.Listener):
    """Names each set of kernels once, when the first of its entry points begins to compile."""

    def __init__(self) -> None:
        self._depth = 0  # compilation holds numba's global lock: no two threads come here at once
        self._told: set[tuple[str, str]] = set()

    def on_start(self, event: Any) -> None:
        """A kernel begins to compile: an entry point, or what it calls."""
        function = event.data["dispatcher"].py_func
        known = KERNELS.get(f"{function.__module__}.{function.__qualname__}")
        if self._depth == 0 and known is not None and known not in self._told:
            self._told.add(known)
            LOG.warning("compiling %s (first use only, %s)", *known)
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """A kernel is compiled, or was given up."""
        self._depth -= 1


@cache
def announce() -> None:
    """From now on, tell what is compiled."""
    event.register("numba:compile", _Announcer())  # type: ignore[no-untyped-call]
