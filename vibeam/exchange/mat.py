"""MATLAB's files up to version 7, read by scipy after a look at how large each variable says that it is."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vibeam.exchange.files import FormatError, require_coordinates, require_room, state_of

NESTED = ("cell", "struct", "object")  # classes of variables that hold others
OPAQUE = ("function", "opaque", "unknown")  # of MATLAB's own, which have no values


@dataclass(frozen=True)
class Variable:
    """Variable of a file, not read yet; ``plain``: a full or sparse array."""

    path: Path
    name: str
    plain: bool

    def read(self, **how: Any) -> Any:
        """Its value by ``loadmat`` with the options ``how``; whatever scipy raises where it is damaged."""
        from scipy.io import loadmat

        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return loadmat(self.path, appendmat=False, variable_names=[self.name], **how)[self.name]


def variables(path: Path) -> list[Variable]:
    """The variables of a file, the first of each name; FormatError where it is none, or one is too large."""
    from scipy.io import whosmat

    state_of(path)
    try:
        found = {name: (shape, kind) for name, shape, kind in reversed(whosmat(path, appendmat=False))}
    except Exception as error:  # whatever scipy makes of another file
        raise FormatError(f"is no MATLAB file that can be read: {error}") from None
    for shape, kind in found.values():
        if kind == "sparse":
            require_coordinates(*shape)
        elif kind not in (*NESTED, *OPAQUE):
            require_room(shape, 1)
    return [Variable(path, name, kind not in NESTED) for name, (_, kind) in found.items() if kind not in OPAQUE][::-1]
