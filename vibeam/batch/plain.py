"""Points of plain systems as the kernels' room takes them: distinct dampings as systems of their own."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.batch.points import Points, changed
from vibeam.flight.points.points import PlainPoints


def plain_points(points: Points, which: NDArray[np.int64]) -> PlainPoints:
    """The points ``which``, their distinct dampings as systems."""
    kinds, system = np.unique(np.stack([points.base[which], points.damping[which]]), axis=1, return_inverse=True)
    bases = [points.bases[int(base)] for base in kinds[0]]
    systems = [changed(b, b.gap, b.restitution, float(d)) for b, d in zip(bases, kinds[1], strict=True)]
    starts = None if points.state is None else points.state[which].reshape(len(which), 2, points.size)
    resting = None if points.resting is None else points.resting[which]
    return PlainPoints(
        systems, system.ravel(), points.omega[which], points.amplitude[which], points.gap[which],
        points.restitution[which], starts, resting,
    )  # fmt: skip
