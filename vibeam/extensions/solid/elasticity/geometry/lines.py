"""Lines of a structured mesh: each runs through the whole body, linear in x between its planes, and none cross."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations, pairwise

import numpy as np

from vibeam_models.arrays import Array

Line = tuple[float, float]  # where it is at the start of a piece, and at its end
SAME = 1e-11  # of the body's size: what is nearer is the same place
SLANT = 0.3  # of the room between two lines: ends no farther apart than that are joined


def continued_lines(needed: Sequence[Iterable[Line]], size: float) -> Array:
    """Places (pieces + 1, lines) of all lines in the planes between consecutive pieces, ascending.

    ``needed``: of each piece its own lines in m; ``size`` (m): none lies beyond ± that. They go on through the
    neighbours, first to the right, then to the left: to the end of another that waits there, or else at the same
    share of the room between that piece's own lines. ValueError where two lines of a piece meet or cross.
    """
    quantum = SAME * size
    pieces = [_ordered({(_round(a, quantum), _round(b, quantum)) for a, b in lines}, size) for lines in needed]
    pieces = _passed(_backwards(_passed(pieces)))
    pieces = _backwards(pieces)
    planes = [[start for start, _ in pieces[0]], *([end for _, end in lines] for lines in pieces)]
    return np.array(planes)[:, 1:-1]


def _round(value: float, quantum: float) -> float:
    return round(value / quantum) * quantum


def _ordered(lines: set[Line], size: float) -> list[Line]:
    """Lines of a piece in ascending order between two outermost ones."""
    ordered = sorted({(-2 * size, -2 * size), *lines, (2 * size, 2 * size)})
    for (start, end), (next_start, next_end) in pairwise(ordered):
        if next_start <= start or next_end <= end:
            raise ValueError("solid: where the beam tapers, edges of section, plate, block or contact cross")
    return ordered


def _backwards(pieces: list[list[Line]]) -> list[list[Line]]:
    return [[(end, start) for start, end in lines] for lines in reversed(pieces)]


def _passed(pieces: list[list[Line]]) -> list[list[Line]]:
    """The pieces with every line that ends at a start of theirs continued through them."""
    done = [pieces[0]]
    for here, following in zip(pieces[1:], [*pieces[2:], []], strict=True):
        arriving = {end for _, end in done[-1]} - {start for start, _ in here}
        waiting = {start for start, _ in following} - {end for _, end in here}
        new = [line for low, high in pairwise(here) for line in _joined(low, high, sorted(arriving), sorted(waiting))]
        done.append(sorted([*here, *new]))
    return done


def _joined(low: Line, high: Line, arriving: Sequence[float], waiting: Sequence[float]) -> list[Line]:
    """Continuations, between two lines, of those that arrive there."""
    left = [start for start in arriving if low[0] < start < high[0]]
    right = [end for end in waiting if low[1] < end < high[1]]
    shares = [(start - low[0]) / (high[0] - low[0]) for start in left]
    ends = [(end - low[1]) / (high[1] - low[1]) for end in right]
    taken = _pairs(shares, ends)
    reached = [right[taken[i]] if i in taken else low[1] + share * (high[1] - low[1]) for i, share in enumerate(shares)]
    return list(zip(left, reached, strict=True))


def _pairs(shares: Sequence[float], ends: Sequence[float]) -> dict[int, int]:
    """End that each line reaches, in their order, as many as there are and the nearest; none where that is slanted."""
    count = min(len(shares), len(ends))
    choices = (
        list(zip(some, others, strict=True))
        for some in combinations(range(len(shares)), count)
        for others in combinations(range(len(ends)), count)
    )
    best = min(choices, key=lambda pairs: sum(abs(shares[i] - ends[j]) for i, j in pairs))
    return dict(best) if all(abs(shares[i] - ends[j]) <= SLANT for i, j in best) else {}
