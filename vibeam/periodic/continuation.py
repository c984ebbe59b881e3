"""Continuation of a boundary in a second parameter."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from vibeam.periodic.bifurcation_functions import NAMES, Line
from vibeam.periodic.boundaries import BRANCHES, Boundary, boundary, bracketed
from vibeam.system.impact_system import ImpactSystem

WIDTHS = 10.0 ** np.arange(-7.0, -1.9, 0.5)  # search windows around the guess, as shares of the scale
HALVINGS = 6


def follow(system: ImpactSystem, start: Boundary, parameter: str, values: ArrayLike) -> tuple[Boundary, ...]:
    """Follow the boundary ``start`` through ``values`` of a second ``parameter`` (omega, amplitude or gap), in order.

    Each is located to round-off in ``start.parameter``, guessed from the two before it; steps too long for that are
    halved. Where it goes through a fold the two motions change their order, and ``branch`` with it. The curve ends
    before the first value at which no root is found near the guess: at an extreme of ``parameter``, where it does not
    turn back, and where the impact velocity vanishes, beyond which the stop would have to pull (a fold meets
    GRAZING there, G₀ = 0: for one mode at Ω = 2ω√(1 − ζ²)). ValueError where the two parameters are the same or
    unknown.
    """
    if parameter not in NAMES or parameter == start.parameter:
        raise ValueError(f"parameter: {parameter!r} must be one of {', '.join(NAMES)} other than {start.parameter!r}")
    line = Line(system, start.periods, start.parameter, start.omega, start.amplitude, start.gap)
    known = [(float(getattr(start, parameter)), float(getattr(start, start.parameter)))]
    curve: list[Boundary] = []
    last = start
    for value in np.asarray(values, dtype=float):
        found = _continued(line, parameter, last, known, float(value), HALVINGS)
        if found is None:
            break
        curve.append(last := found)
    return tuple(curve)


def _continued(
    line: Line, parameter: str, last: Boundary, known: list[tuple[float, float]], value: float, halvings: int
) -> Boundary | None:
    """Boundary at ``value``, by way of the middle where the step is too long; ``known`` takes intermediate ones."""
    found = _nearest_root(line.moved(parameter, value), last, known, value)
    if found is not None:
        known.append((value, float(getattr(found, line.name))))
        return found
    middle = (known[-1][0] + value) / 2
    between = None if halvings == 0 else _continued(line, parameter, last, known, middle, halvings - 1)
    return None if between is None else _continued(line, parameter, between, known, value, halvings - 1)


def _nearest_root(line: Line, last: Boundary, known: list[tuple[float, float]], value: float) -> Boundary | None:
    """Root nearest to the guess, on the branch of the ``last`` one, else on the other."""
    guess = _guess(known, value)
    branches = sorted(BRANCHES[last.kind], key=lambda branch: branch != last.branch)
    for width in _scale(line, guess, known) * WIDTHS:
        for branch in branches:
            root = bracketed(line, last.kind, branch, *_window(line, guess, width))
            if root is not None:
                return boundary(line, last.kind, branch, root)
    return None


def _scale(line: Line, guess: float, known: list[tuple[float, float]]) -> float:
    """Scale of a parameter; that of the gap, which may be 0, is the motion under the drive alone."""
    if line.name == "gap":
        total = line.at(np.array([guess])).total
        return abs(guess) + float(np.abs(total.unit[0] * line.amplitude))
    return max(abs(guess), abs(known[0][1]))


def _window(line: Line, guess: float, width: float) -> tuple[float, float]:
    """Search window around the guess; frequencies stay positive."""
    low = max(guess - width, guess / 2) if line.name == "omega" else guess - width
    return low, guess + width


def _guess(known: list[tuple[float, float]], value: float) -> float:
    """Linear extrapolation from the last two points."""
    (x1, y1), (x0, y0) = known[-1], known[-2] if len(known) > 1 else known[-1]
    return y1 if x1 == x0 else y1 + (y1 - y0) * (value - x1) / (x1 - x0)
