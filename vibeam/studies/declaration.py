"""What is declared of a study that a program brings: its name, what it asks of a case, and how it is run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from vibeam_models.registry import Registry

if TYPE_CHECKING:
    from vibeam.case.case import Case


@dataclass(frozen=True)
class StudyDeclaration:
    """A study: ``run`` takes a case and gives rows, instances of one dataclass; ``meaning``: what they say.

    ``vibeam study NAME CASE`` prints the rows as a table or as JSON, or writes them as CSV. ValueError of ``run`` is a
    case that it cannot take.
    """

    name: str
    run: Callable[[Case], Sequence[Any]]
    meaning: str


STUDIES: Registry[StudyDeclaration] = Registry("study")


def register_study(declaration: StudyDeclaration) -> None:
    """Make a study known to ``vibeam study``; ValueError where the name is taken."""
    STUDIES.add(declaration)
