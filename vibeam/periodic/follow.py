"""A boundary followed as a second parameter changes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.periodic.boundaries import Boundary, boundary, bracketed
from vibeam.periodic.line import NAMES, Line
from vibeam.system import ImpactSystem

Array = NDArray[np.float64]
WIDTHS = 10.0 ** np.arange(-7.0, -1.9, 0.5)  # shares of the parameter by which a root is looked for around its guess
HALVINGS = 6


def follow(system: ImpactSystem, start: Boundary, parameter: str, values: ArrayLike) -> tuple[Boundary, ...]:
    """``start`` at every one of ``values`` of a second ``parameter`` (omega, amplitude or gap), in their order.

    Each is located to round-off in ``start.parameter``, guessed from the two before it; steps too long for that are
    halved. The curve ends before the first value at which no root is found near the guess; it does not turn back at an
    extreme of ``parameter``. ValueError where the two parameters are the same or unknown.
    """
    if parameter not in NAMES or parameter == start.parameter:
        raise ValueError(f"parameter: {parameter!r} must be one of {', '.join(NAMES)} other than {start.parameter!r}")
    line = Line(system, start.periods, start.parameter, start.omega, start.amplitude, start.gap)
    known = [(float(getattr(start, parameter)), float(getattr(start, start.parameter)))]
    curve: list[Boundary] = []
    for value in np.asarray(values, dtype=float):
        found = _reached(line, parameter, start, known, float(value), HALVINGS)
        if found is None:
            break
        curve.append(found)
    return tuple(curve)


def _reached(
    line: Line, parameter: str, start: Boundary, known: list[tuple[float, float]], value: float, halvings: int
) -> Boundary | None:
    """The boundary at ``value``, by way of the middle where the step is too long; what is found joins ``known``."""
    found = _next(line.moved(parameter, value), start, known, value)
    if found is not None:
        known.append((value, float(getattr(found, start.parameter))))
        return found
    middle = (known[-1][0] + value) / 2
    if halvings == 0 or _reached(line, parameter, start, known, middle, halvings - 1) is None:
        return None
    return _reached(line, parameter, start, known, value, halvings - 1)


def _next(line: Line, start: Boundary, known: list[tuple[float, float]], value: float) -> Boundary | None:
    guess = _guess(known, value)
    unit = max(abs(guess), abs(known[0][1]))
    for width in unit * WIDTHS:
        root = bracketed(line, start.kind, start.branch, *_window(line, guess, width))
        if root is not None:
            return boundary(line, start.kind, start.branch, root)
    return None


def _window(line: Line, guess: float, width: float) -> tuple[float, float]:
    """Frequencies stay positive."""
    low = max(guess - width, guess / 2) if line.name == "omega" else guess - width
    return low, guess + width


def _guess(known: list[tuple[float, float]], value: float) -> float:
    """The straight line through the last two points."""
    (x1, y1), (x0, y0) = known[-1], known[-2] if len(known) > 1 else known[-1]
    return y1 if x1 == x0 else y1 + (y1 - y0) * (value - x1) / (x1 - x0)
