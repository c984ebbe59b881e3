"""What a case's fidelities and its sweep say together with the rig."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

from vibeam.checks.effects import platform_output
from vibeam.reading import Complaint


def plan_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the sweep's grid and, where there is a beam, its output and the modes that are asked for."""
    yield from _grid(case.sweep.frequency)
    if hasattr(case, "beam"):
        yield from platform_output(case, ("sweep", "output"), case.sweep.output)
        yield from _modes(case)


def _grid(grid: SimpleNamespace | tuple[float, ...] | None) -> Iterator[Complaint]:
    if not isinstance(grid, SimpleNamespace) or grid.from_ is None or grid.to is None:
        return
    path = ("sweep", "frequency")
    if grid.from_ > grid.to:
        yield (*path, "to"), 'is below from; to sweep downwards write direction = "down"'
    elif grid.points == 1 and grid.from_ < grid.to:
        yield (*path, "points"), "1 point does not span from … to: make them equal, or take more points"
    elif grid.points is not None and grid.points > 1 and grid.from_ == grid.to:
        yield (*path, "points"), f"{grid.points} points from a frequency to itself: points = 1, or another to"


def _modes(case: SimpleNamespace) -> Iterator[Complaint]:
    most, gives = _most_modes(case)
    for name, fidelity in case.fidelity.items():
        path = ("fidelity", name, "modes")
        if fidelity.reduction == "modal" and fidelity.modes is None:
            yield path, 'missing: reduction = "modal" needs how many; write modes = 8'
        elif fidelity.reduction not in ("modal", None) and fidelity.modes is not None:
            yield path, f'goes with reduction = "modal" alone, not "{fidelity.reduction}"'
        elif fidelity.modes is not None and 0 < most < fidelity.modes:
            yield path, f"{fidelity.modes} are more than the model has: {gives} {most} at most"


def _most_modes(case: SimpleNamespace) -> tuple[int, str]:
    """How many modes the beam can have at most (0: not known), and what gives them."""
    twists = case.torsion is not None
    if case.beam.massless:
        attached = 0 if case.mass is None else 1 + (case.mass.rotary_inertia is not None)
        return attached + len(case.added_mass) + twists, "a massless beam's inertias give"
    return 2 * (case.beam.elements or 0) * (1 + twists), "beam.elements gives"
