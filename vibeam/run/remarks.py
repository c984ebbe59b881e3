"""Remarks on results: fidelities that never touch the stop, and a restitution that is ill-posed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from vibeam.run.comparison.wording import listed
from vibeam.run.summary import compare
from vibeam.system.response import complete

if TYPE_CHECKING:
    from vibeam.run.overview import Overview
    from vibeam.run.result import Result
    from vibeam.system.response import Branches


YIELDS = 'let the stop yield (law = "linear" or "hertz")'

BARE = (
    "a coefficient of restitution at a contact without a mass of its own is ill-posed: with each mode more, mode 1 has "
    f"less of the contact's mobility, and in the end none. Put a mass at the contact, or {YIELDS}."
)

NEGATIVE = (
    "R₁ < 0, mode 1 goes on into the stop after an impact: one coefficient of restitution is ill-posed where so little "
    f"of the contact's mobility is mode 1's. Take fewer modes, put a mass at the contact, or {YIELDS}."
)


def remarks(result: Result) -> list[str]:
    """Remarks on fidelities that never touch the stop, and on those whose mode 1 sees R₁ < 0."""
    clear = [name for name, branches in result.items() if _stays_clear(branches)]
    notes = [f"{listed(clear)}: no impact at any frequency: {_cure(result.overview)}"] if clear else []
    return [*notes, *ill_posed({row.fidelity: row.first_mode_restitution for row in compare(result)})]


def _cure(overview: Overview | None) -> str:
    """What brings a rig to its stop: where the sweep leaves mode 1 out, to sweep over it."""
    if overview is None or not overview.beside:
        return "narrow the gap, or drive harder"
    return f"sweep over mode 1, at {overview.first}, narrow the gap, or drive harder"


def ill_posed(first_mode: Mapping[str, float]) -> list[str]:
    """Remark on fidelities with R₁ < 0; ``first_mode``: R₁ by name, NaN where the law has no coefficient."""
    below = [f"{name} ({value:.2g})" for name, value in first_mode.items() if value < 0]
    return [f"{listed(below)}: {NEGATIVE}"] if below else []


def _stays_clear(branches: Branches) -> bool:
    """Test whether every point is complete and none touches the stop."""
    return all(np.all(complete(each) & (each.period == -1)) for _, each in branches.items())
