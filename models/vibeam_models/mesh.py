"""Where the nodes of a beam mesh lie."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

NEAR = 0.25  # share of a uniform element within which a uniform node gives way to an inserted one
SAME = 1e-9  # share of the length within which two inserted nodes are one


def nodes(length: float, elements: int, inserted: Iterable[float] = ()) -> NDArray[np.float64]:
    """Ascending node positions (k,) in m: ``elements`` uniform ones on [0, length] and every ``inserted`` one.

    A uniform node nearer than a quarter element to an inserted one is left out, so that no element is needlessly
    short; both ends stay. ValueError for ``elements`` < 1 or an inserted node outside [0, length].
    """
    if elements < 1:
        raise ValueError(f"elements: {elements}, a mesh needs at least 1")
    kept = [0.0, length]
    for position in inserted:
        if not 0 <= position <= length:
            raise ValueError(f"no node can stand at {position} m: the beam ends at {length} m")
        if _distance(position, kept) > SAME * length:
            kept.append(float(position))
    uniform = np.linspace(0.0, length, elements + 1)[1:-1]
    kept += [float(x) for x in uniform if _distance(x, kept) > NEAR * length / elements]
    return np.array(sorted(kept))


def _distance(position: float, others: list[float]) -> float:
    return float(np.min(np.abs(np.array(others) - position)))
