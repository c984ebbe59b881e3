"""``solve_ivp`` as another processor might have it: every state and every event moved by a unit in the last place."""

from __future__ import annotations

from itertools import cycle
from typing import Any

import numpy as np
import scipy.integrate

ENDS = cycle((np.inf, -np.inf, -np.inf, np.inf, -np.inf, np.inf, np.inf, -np.inf))  # up and down, in no simple order


def install() -> None:
    """Put the nudged one in the place of scipy's, for all that take it from there afterwards."""
    exact = scipy.integrate.solve_ivp
    if getattr(exact, "nudged", False):
        return

    def solve_ivp(*given: Any, **options: Any) -> Any:
        return nudge(exact(*given, **options))

    solve_ivp.nudged = True  # type: ignore[attr-defined]
    scipy.integrate.solve_ivp = solve_ivp


def nudge(found: Any) -> Any:
    """The result with its states, and the times of its events, a unit in the last place higher or lower."""
    found.y = moved(found.y)
    if found.status == 1:  # ended by an event: its time is a root, no end that was asked for
        found.t[-1] = moved(found.t[-1:])[0]
    if found.t_events is not None:
        found.t_events = [moved(each) for each in found.t_events]
        found.y_events = [moved(each) for each in found.y_events]
    return found


def moved(values: Any) -> Any:
    """An array with each number replaced by its neighbour."""
    return np.nextafter(values, next(ENDS)) if np.size(values) else values
