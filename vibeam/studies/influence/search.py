"""Search for the smallest sufficient set of effects: all sets where they are few, else by elimination."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations
from math import inf

EXACT = 6  # largest number of effects for which all sets are tried

Worst = Callable[[frozenset[str]], float]


def smallest(effects: Sequence[str], worst: Worst) -> tuple[frozenset[str], bool]:
    """Find the set, and whether it is proved to be the smallest.

    ``worst``: the largest change of a set in units of its tolerance, sufficient where it is at most 1; ∞ for an
    invalid set. Of several equally small sets the one with the least change.
    """
    if len(effects) <= EXACT:
        return _of_all(effects, worst), True
    return _one_by_one(effects, worst), False


def _of_all(effects: Sequence[str], worst: Worst) -> frozenset[str]:
    for size in range(len(effects)):
        best, least = min(((frozenset(kept), worst(frozenset(kept))) for kept in combinations(effects, size)),
                          key=lambda pair: pair[1])  # fmt: skip
        if least <= 1:
            return best
    return frozenset(effects)


def _one_by_one(effects: Sequence[str], worst: Worst) -> frozenset[str]:
    """Eliminate the effect with the least influence among those left, as long as the rest is sufficient."""
    kept = frozenset(effects)
    while kept:
        away = [(worst(kept - {name}), index, name) for index, name in enumerate(effects) if name in kept]
        least, _, name = min(away, default=(inf, 0, ""))
        if least > 1:
            break
        kept -= {name}
    return kept
