"""Fineness of fidelities: which of them is the reference of those that model the same rig."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from vibeam.case.case import Case


def alike(case: Case, names: Iterable[str], beside: str) -> list[str]:
    """Fidelities with the same rig as ``beside``, whatever each makes of it."""
    own = case.fidelities
    return [name for name in names if own[name].rig == own[beside].rig]


def plain(case: Case) -> list[str]:
    """Fidelities that change nothing of the case's own rig."""
    return [name for name, each in case.fidelities.items() if not (each.rig or each.without)]


def fineness(case: Case, name: str, modes: int) -> tuple[bool, int]:
    """Rank of a fidelity of so many modes: a solid of several is finer than any beam, then the number of modes."""
    return modes > 1 and case.scene_of(name).in_three_dimensions, modes


def finest(case: Case, modes: Mapping[str, int]) -> str:
    """Finest of the fidelities whose numbers of ``modes`` are given by name, the first of several."""
    return max(modes, key=lambda name: fineness(case, name, modes[name]))
