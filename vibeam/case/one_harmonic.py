"""Refusal of a drive of several harmonics where closed forms, or single runs of solvers, know one."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

from vibeam.case.faults import CaseError

if TYPE_CHECKING:
    from vibeam.case.case import Case


def require_one_harmonic(case: Case, what: str, fidelities: Collection[str] = ()) -> None:
    """CaseError, at its line, where one of these fidelities (none: all) has several harmonics, unknown to ``what``."""
    several = [name for name in fidelities or case.fidelities if case.scene_of(name).harmonics]
    message = f"{what} knows a drive of one harmonic: take drive.harmonic away"
    if case.scene.harmonics and several:
        raise CaseError([case.fault("drive", "harmonic", message=message)])
    if several:
        raise CaseError([case.fault("fidelity", name, message=message) for name in several])
