"""Lines and marks of one branch over frequency: every piece in the style of its class of motion."""

from __future__ import annotations

from matplotlib.axes import Axes

from vibeam.figures.axes import mark_failed
from vibeam.figures.style import Look, line
from vibeam.observe.branches import BranchPiece, MotionClass, pieces
from vibeam.system.response import FrequencyResponse
from vibeam_models.arrays import Array

ALONE = "period 1, at one frequency alone"


def draw_branch(
    axes: Axes, response: FrequencyResponse, direction: str, look: Look, across: float = 1.0, upward: float = 1.0,
    values: Array | None = None, failed_row: int | None = None, name: str | None = None,
) -> set[object]:  # fmt: skip
    """Draw the amplitude, or ``values`` (points,), and return what the legend has to explain.

    ``across``, ``upward``: factors to the displayed units; ``failed_row``: that of the marks of failed points along the
    upper edge, None: left out; ``name``: with which the pieces' own names begin.
    """
    drawn = response.amplitude if values is None else values
    found: set[object] = set()
    for index, piece in enumerate(pieces(response, values)):
        keys = line(piece.kind, direction, look, len(piece), len(response))
        own = None if name is None else f"{name}-{direction}-{index}-{piece.kind.name.lower()}"
        frequency = response.frequency[piece.points] * across
        if piece.kind is not MotionClass.FAILED:
            axes.plot(frequency, drawn[piece.points] * upward, gid=own, **keys)
        elif failed_row is not None:
            mark_failed(axes, frequency, failed_row, gid=own, **keys)
        found.add(_explained(piece))
    return found


def _explained(piece: BranchPiece) -> object:
    return ALONE if piece.kind is MotionClass.PERIOD_ONE and len(piece) == 1 else piece.kind
