"""Declaration of a study: what it asks in the case, its record, rows, sentences, figure; registry of all studies.

Its command with options and help, JSON, CSV and section of a page follow from the declaration.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from inspect import signature
from typing import TYPE_CHECKING, Any

from vibeam.case.study_plans import STUDY_PLANS
from vibeam_models.registry import Home, Registry, loaded

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.case.case import Case
    from vibeam.report.output import StudySheet


@dataclass(frozen=True)
class StudyDeclaration:
    """Study of a case: ``run``, or its ``"module:function"``, takes a case; ValueError for an unsuitable one.

    ``run`` may take ``tell`` (hears lines of text) and ``progress`` (points done, and their total) as well. It returns
    a record of some ``meaning``, whose ``rows`` are instances of one dataclass (absent: the record itself is a list of
    them), ``sentences`` the answer, then what is uncertain, and whose ``figure`` is drawn. ``sheet``: in place of these
    three, the ``StudySheet`` of a record (and its case, where it takes that). ``asks``: frozen dataclass of declared
    keys (``vibeam_models.keys``), the table ``[name]`` of the case, ``case.asked[name]``, each key an option of the
    command. ``first``: a sentence of a quick look, shown beside the progress. ``examples``: lines of its help.
    ``parts``: what takes long in it are ``vibeam.store.shares.evaluate_each``, so that its command has --price, --part
    and --gather.

    >>> import vibeam
    >>> study = vibeam.StudyDeclaration("peaks", lambda case: [vibeam.run(case)["sdof"].peak], "highest points")
    >>> study.of(vibeam.load("cases/dtu_neutral.toml", {"sweep.frequency.points": 3}))[0].frequency
    15.5
    """

    name: str
    run: Callable[..., Any] | str
    meaning: str
    rows: Callable[[Any], Sequence[Any]] | None = None
    sentences: Callable[[Any], Sequence[str]] | None = None
    figure: Callable[[Any], Figure] | None = None
    sheet: Callable[..., StudySheet] | str | None = None
    asks: type[Any] | None = None
    first: Callable[[Case], str] | str | None = None
    examples: tuple[str, ...] = ()
    parts: bool = False

    def of(
        self, case: Case, tell: Callable[[str], None] | None = None, progress: Callable[[int, int], None] | None = None
    ) -> Any:
        """Record of the study of a case."""
        run = loaded(self.run)
        taken = signature(run).parameters
        given = {"tell": tell, "progress": progress}
        return run(case, **{name: each for name, each in given.items() if name in taken and each is not None})

    def shown(self, record: Any, case: Case) -> StudySheet:
        """Sheet of a record of the study of ``case``."""
        if self.sheet is not None:
            made = loaded(self.sheet)
            sheet: StudySheet = made(record, case) if "case" in signature(made).parameters else made(record)
            return sheet
        from vibeam.report.output import StudySheet
        from vibeam.report.tables import rows_of

        rows = list(record if self.rows is None else self.rows(record))
        answer, *notes = list(self.sentences(record) if self.sentences is not None else ()) or [""]
        draw = None if self.figure is None else lambda: self.figure(record)  # type: ignore[misc]
        return StudySheet(answer, [rows_of(self.meaning, rows)], notes, data={"rows": rows}, rows=rows, draw=draw)


@dataclass(frozen=True)
class PageSection:
    """Section of pages of results, its ``name`` their heading and anchor.

    ``home``: function, or its ``"module:function"``, that makes the ``StudySheet`` of a ``StoredResult``, or None where
    it has none; of one that is ``live``, which computes in the reader's browser, the ``LivePart``. A page has one such.
    """

    name: str
    home: Callable[..., Any] | str
    live: bool = False


#: sections that extensions bring
SECTIONS: Registry[PageSection] = Registry("section of a page")


def _own(
    name: str, home: str, sheet: str, meaning: str, *examples: str, first: str | None = None, parts: bool = False
) -> StudyDeclaration:  # fmt: skip
    plan = STUDY_PLANS[name].load() if name in STUDY_PLANS.own else None
    run, shown = f"vibeam.studies.{home}:{name}", f"vibeam.report.{sheet}:sheet"
    return StudyDeclaration(name, run, meaning, sheet=shown, asks=plan, first=first, examples=examples, parts=parts)


STUDIES: Registry[StudyDeclaration] = Registry(
    "study",
    _own(
        "verdict", "verdict", "verdict", "say how much model a case needs: sentence, table, page",
        "vibeam verdict mine.toml", "vibeam verdict mine.toml --only modes --accuracy '1 %'",
        first="vibeam.report.verdict:first_answer",
    ),
    _own(
        "uncertainty", "uncertainty.study", "uncertainty", "carry uncertain inputs through the sweep",
        "vibeam uncertainty mine.toml --set 'uncertain.\"stop.restitution\"=\"± 0.03\"'",
        "vibeam uncertainty mine.toml --samples 256 --out uncertainty.html", parts=True,
    ),
    _own(
        "derive", "derive", "derive", "SDOF parameters from geometry, beside finite elements",
        "vibeam derive mine.toml --set mass.mass='0.5 kg' --json",
    ),
    _own("cost", "cost.study", "cost", "error against CPU time of every solver", "vibeam study cost mine.toml"),
    _own(
        "influence", "effects", "effects", "what each effect changes, and the effects that suffice",
        "vibeam study influence mine.toml",
    ),
    _own(
        "modes_needed", "modes_needed", "modes_needed", "number of modes that is enough",
        "vibeam study modes_needed mine.toml", "vibeam study modes_needed mine.toml --accuracy '1 %'",
        first="vibeam.report.modes_needed:first_answer",
    ),
)  # fmt: skip


def register_study(declaration: StudyDeclaration) -> None:
    """Register a study for ``vibeam study``; ValueError where its name, or that of its table, is taken.

    >>> import vibeam
    >>> peaks = vibeam.StudyDeclaration("peaks", lambda case: [vibeam.run(case)["sdof"].peak], "highest points")
    >>> vibeam.register_study(peaks)  # from then on: vibeam study peaks CASE
    """
    STUDIES.add(declaration)
    if declaration.asks is None:
        return
    from vibeam.casefile.tables.cases import case_table

    if declaration.name in case_table("beam").KEYS:
        STUDIES.remove(declaration.name)
        raise ValueError(f"study {declaration.name!r}: a case has a table of that name: choose another name")
    STUDY_PLANS.add(Home(declaration.name, declaration.asks))
