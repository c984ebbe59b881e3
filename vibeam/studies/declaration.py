"""Declaration of a study: its name, its function, the meaning of its rows, its command; registry of all studies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from vibeam_models.registry import Registry, loaded

if TYPE_CHECKING:
    from vibeam.case.case import Case


@dataclass(frozen=True)
class StudyDeclaration:
    """Study of a case: ``run``, or its ``"module:function"``, takes a case; ValueError for an unsuitable one.

    It returns rows, instances of one dataclass, of some ``meaning``: ``vibeam study NAME CASE`` prints them as a table
    or as JSON, or writes them as CSV. A study with an ``own_command``, ``vibeam NAME CASE``, returns any record.
    """

    name: str
    run: Callable[[Case], Any] | str
    meaning: str
    own_command: bool = False

    def of(self, case: Case) -> Any:
        """The study of a case."""
        return loaded(self.run)(case)


def _own(name: str, home: str, meaning: str) -> StudyDeclaration:
    return StudyDeclaration(name, f"vibeam.studies.{home}:{name}", meaning, own_command=True)


STUDIES: Registry[StudyDeclaration] = Registry(
    "study",
    _own("check", "regression.check", "differences to references and expected numbers"),
    _own("stability", "stability.study", "existence and stability of periodic motions over frequency and gap or drive"),
    _own("verdict", "verdict.study", "the cheapest model that suffices over two keys, and where models differ in kind"),
    StudyDeclaration("map", "vibeam.maps.run:run_map", "motions over any keys of a case", own_command=True),
    _own("cost", "cost.study", "accuracy and CPU time of every fidelity by every solver"),
    _own("limit", "limit.study", "what converges with more and more modes, at which rate, and what has no limit"),
    _own("influence", "influence.study", "change by each effect, and its cost"),
    _own("uncertainty", "uncertainty.study", "bands, sensitivity and errors by the inputs that are uncertain"),
    _own("fit", "fit.study", "keys estimated from measured curves, with intervals"),
    _own("derive", "derive", "SDOF parameters from geometry, beside their finite-element values"),
    _own("modes", "modes", "modes of the finite-element beam"),
    _own("reduce", "reduce.study", "what a reduction loses, by its number of coordinates"),
)


def register_study(declaration: StudyDeclaration) -> None:
    """Register a study for ``vibeam study``; ValueError where the name is taken."""
    STUDIES.add(declaration)
