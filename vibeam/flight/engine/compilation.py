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
KERNELS = {  # by the module of the entry point: what is compiled, and about how long that takes on a common machine
    "vibeam.flight.kernels.roots.levels": ("the tables of the exact flow", "some seconds"),
    "vibeam.flight.kernels.entry": ("the flight kernels", "about a minute"),
    "vibeam.flight.kernels.cover": ("the kernels of certificates", "about half a minute"),
    "vibeam.flight.points.kernels.entry": ("the kernels of batches", "one to two minutes"),
    "vibeam.flight.points.tangents.entry": ("the kernels of Lyapunov exponents", "about a minute"),
    "vibeam.flight.kernels.moreau": ("time stepping", "some seconds"),
    "vibeam.flight.kernels.regimes.entry": (
        "the kernels of yielding stops, R(v), second stops and coupled damping",
        "one to two minutes",
    ),
    "vibeam.flight.kernels.regimes.cover": ("the kernels of their certificates", "about half a minute"),
}


class _Announcer(event.Listener):
    """Names each set of kernels once, when the first of its entry points begins to compile."""

    def __init__(self) -> None:
        self._depth = 0  # compilation holds numba's global lock: no two threads come here at once
        self._told: set[str] = set()

    def on_start(self, event: Any) -> None:
        """A kernel begins to compile: an entry point, or what it calls."""
        module = event.data["dispatcher"].py_func.__module__
        if self._depth == 0 and module in KERNELS and module not in self._told:
            self._told.add(module)
            what, time = KERNELS[module]
            LOG.warning("compiling %s (first use only, %s)", what, time)
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """A kernel is compiled, or was given up."""
        self._depth -= 1


@cache
def announce() -> None:
    """From now on, tell what is compiled."""
    event.register("numba:compile", _Announcer())  # type: ignore[no-untyped-call]
