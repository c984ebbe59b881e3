"""Entry points of the kernels, as Python calls them: from a library made ahead of time, or compiled by numba.

A library is taken where there is one for this machine that was made from the kernels as they are; else numba compiles
them, and one line says why. The environment variable VIBEAM_KERNELS forces one: ``numba``, ``library``, or the name of
a level (``x86-64-v2``). No kernel is imported before numba is to compile it: programs that find a library need
no numba.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from vibeam.flight.engine.loading import LEVELS, WASM, KernelsUnavailable, LibraryUnavailable, function_of, level_of

LOG = logging.getLogger("vibeam")
VARIABLE = "VIBEAM_KERNELS"
CURE = "pip install 'vibeam[jit]'"
KERNELS, POINTS = "vibeam.flight.kernels", "vibeam.flight.points.kernels"


def chosen(library: str, module: str, name: str) -> Callable[..., Any]:
    """The compiled function ``name`` of ``module``.

    KernelsUnavailable where there is none, or for a wrong VIBEAM_KERNELS.
    """
    wanted = os.environ.get(VARIABLE, "")
    if wanted == WASM:
        raise KernelsUnavailable(
            f"{VARIABLE}: the kernels for {WASM} run in web pages (vibeam explore), not here: "
            f"leave it out, or choose one of {', '.join(LEVELS)}"
        )
    if wanted not in ("", "numba", "library", *LEVELS):
        raise KernelsUnavailable(f"{VARIABLE}: {wanted!r} is none of numba, library, {', '.join(LEVELS)}")
    if wanted == "numba":
        return compiled(module, name)
    try:
        return function_of(library, module, name, wanted if wanted in LEVELS else None)
    except LibraryUnavailable as reason:
        if wanted:
            raise KernelsUnavailable(f"{VARIABLE}={wanted}: {reason}") from None
        if find_spec("numba") is None:
            raise KernelsUnavailable(
                f"{reason}, and numba, which would compile the kernels here, is not installed: {CURE}"
            ) from None
        _tell(str(reason))
    return compiled(module, name)


@cache
def _tell(reason: str) -> None:
    LOG.warning("%s: numba compiles the kernels", reason)


def compiled(module: str, name: str) -> Callable[..., Any]:
    """The entry point as numba compiles it; KernelsUnavailable without numba."""
    if find_spec("numba") is None:
        raise KernelsUnavailable(f"numba is not installed: {CURE}")
    from vibeam.flight.engine.compilation import announce

    announce()
    found: Callable[..., Any] = getattr(import_module(module), name)
    return found


@dataclass(frozen=True)
class EntryPoint:
    """A compiled function, found at its first call."""

    library: str
    module: str
    name: str

    @cached_property
    def function(self) -> Callable[..., Any]:
        """The library's function, or numba's; see ``chosen``."""
        return chosen(self.library, self.module, self.name)

    def __call__(self, *given: Any) -> Any:
        """Call the compiled function."""
        return self.function(*given)


tabulate = EntryPoint("tables", f"{KERNELS}.roots.pair", "tabulate")
move, poses_at = (EntryPoint("flight", f"{KERNELS}.entry", name) for name in ("move", "poses_at"))
cover = EntryPoint("certificate", f"{KERNELS}.entry", "cover")
regimes_move, regimes_poses_at, regimes_cover = (
    EntryPoint("regimes", f"{KERNELS}.regimes.entry", name) for name in ("move", "poses_at", "cover")
)
contacts_move, contacts_poses_at, contacts_cover = (
    EntryPoint("contacts", f"{KERNELS}.contacts.entry", name) for name in ("move", "poses_at", "cover")
)
extremes_loaded = EntryPoint("contacts", f"{KERNELS}.contacts.entry", "extremes_loaded")
run_points = EntryPoint("points", f"{POINTS}.entry", "run")
carry_disturbances = EntryPoint("tangents", f"{POINTS}.disturbances", "carry")
carry_frame = EntryPoint("tangent_maps", f"{KERNELS}.tangents.entry", "carry")
march = EntryPoint("moreau", f"{KERNELS}.moreau", "march")

REGIMES = (regimes_move, regimes_poses_at, regimes_cover)
CONTACTS = (contacts_move, contacts_poses_at, contacts_cover)
TANGENTS = (carry_disturbances, carry_frame)
ENTRIES = (tabulate, move, poses_at, cover, *REGIMES, *CONTACTS, extremes_loaded, run_points, *TANGENTS, march)


def origin() -> str:
    """Origin of the kernels in this process: ``library`` and its level, or ``numba``."""
    wanted, place = os.environ.get(VARIABLE, ""), (move.library, move.module, move.name)
    try:
        if wanted == "numba":
            return wanted
        level = wanted if wanted in LEVELS else None
        function_of(*place, level)
        return f"library {level_of(*place, level)}"
    except LibraryUnavailable:
        return "numba"
