"""Entry points of the kernels, as Python calls them: from a library made ahead of time, or compiled by numba.

No kernel is imported before numba is to compile it: programs that find a library need no numba.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from vibeam.flight.libraries.choice import chosen, description


@dataclass(frozen=True)
class Entry:
    """A compiled function, found at its first call."""

    library: str
    module: str
    name: str

    @cached_property
    def function(self) -> Callable[..., Any]:
        """What is called: see ``libraries.choice``."""
        return chosen(self.library, self.module, self.name)

    def __call__(self, *given: Any) -> Any:
        """Call the compiled function."""
        return self.function(*given)


KERNELS = "vibeam.flight.kernels"
tabulate = Entry("tables", f"{KERNELS}.roots.levels", "tabulate")
move, poses_at = (Entry("flight", f"{KERNELS}.entry", name) for name in ("move", "poses_at"))
cover = Entry("certificate", f"{KERNELS}.cover", "cover")
regimes_move, regimes_poses_at = (Entry("regimes", f"{KERNELS}.regimes.entry", name) for name in ("move", "poses_at"))
regimes_cover = Entry("regimes", f"{KERNELS}.regimes.cover", "cover")
run_points = Entry("points", "vibeam.flight.points.kernels.entry", "run")
carry_disturbances = Entry("tangents", "vibeam.flight.points.tangents.entry", "carry")
march = Entry("moreau", f"{KERNELS}.moreau", "march")

ENTRIES = (
    tabulate,
    move,
    poses_at,
    cover,
    regimes_move,
    regimes_poses_at,
    regimes_cover,
    run_points,
    carry_disturbances,
    march,
)


def origin() -> str:
    """Where the kernels come from in this process: ``library`` and its level, or ``numba``."""
    return description(move.library, move.module, move.name)
