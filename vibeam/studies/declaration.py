"""Declaration of a further study: its name, its function, the meaning of its rows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from vibeam_models.registry import Registry

if TYPE_CHECKING:
    from vibeam.case.case import Case


@dataclass(frozen=True)
class StudyDeclaration:
    """Further study: ``run`` takes a case and returns rows, instances of one dataclass; ``meaning`` of the rows.

    ``vibeam study NAME CASE`` prints the rows as a table or as JSON, or writes them as CSV. ``run`` raises ValueError
    for an unsuitable case.
    """

    name: str
    run: Callable[[Case], Sequence[Any]]
    meaning: str


STUDIES: Registry[StudyDeclaration] = Registry("study")


def register_study(declaration: StudyDeclaration) -> None:
    """Register a study for ``vibeam study``; ValueError where the name is taken."""
    STUDIES.add(declaration)
