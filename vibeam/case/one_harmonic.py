"""Refusal of a drive of several harmonics where closed forms, or single runs of solvers, know one."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vibeam.case.case import Case


def require_one_harmonic(case: Case, what: str) -> None:
    """ValueError where a fidelity is driven by several harmonics, which ``what`` does not know."""
    several = [name for name in case.fidelities if case.scene_of(name).harmonics]
    if several:
        who = f"fidelity {', '.join(several)}"
        raise ValueError(f"{who}: {what} knows a drive of one harmonic: take drive.harmonic away")
