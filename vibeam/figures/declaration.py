"""Declaration of a kind of figure: its module, its content, its keys of [show.NAME]."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from vibeam_models.keys import Key


@dataclass(frozen=True)
class FigureKind:
    """Kind of figure: ``home``, its module (or the name, imported when asked for), and what it shows.

    The module has ``columns(case, fidelity, frequency, plan)``, the numbers at one frequency, or ``sheets(case,
    fidelity, plan)``, all of one fidelity (kept in the results file; neither: the sweep has them), and ``draw(figure,
    result, plan, sheets)``, which makes the figure of them; ``size(plan)`` (inches) and ``caption(plan)``, or one of
    either for all plans, where the usual ones will not do.

    ``keys``: of the table, by name, that are its own: what it may have beside what it ``takes``; what it ``needs`` it
    must have. ``reads``: its columns that [expect.NAME] and [measured.NAME] compare with a number, and their units (q,
    q/s: of the output and its rate), ``entries``: the column by which one of them is chosen (none: their mean is
    meant). ``exact``: True where the motion must be exact between events. ``derivatives``: it shows outputs that are
    velocities or accelerations too. ``transient``: True where no settled motion will do. ``record``: it is drawn of a
    case with [record], ``sweep``: of one with [sweep]; of one of both ``record_keys`` are all keys that its table may
    have beside [record]. ``one_harmonic``: True where it knows a drive of one harmonic alone. ``ending``: of the file
    that it has in place of a picture; its module then has ``write(path, sheets, mark)`` in place of ``draw``.
    ``quantities``: those over frequency that it computes itself, and their units: one is the key ``quantity``, and
    [expect.NAME] may compare it too; its module then has ``numbers(case, fidelity, frequency, quantity)``.
    ``of_beam``: True where it shows the beam itself. ``refuses``: True where it cannot show all systems:
    ``refusal(case, fidelity, system)`` of its module then says why, or is empty.

    >>> import vibeam
    >>> vibeam.FigureKind("mine", "mine.figure", "what it shows", needs=("frequency",)).known
    ('frequency',)
    """

    name: str
    home: str | Any
    meaning: str
    needs: tuple[str, ...] = ()
    takes: tuple[str, ...] = ()
    reads: Mapping[str, str] = field(default_factory=dict)
    entries: str = ""
    exact: bool = False
    transient: bool = False
    derivatives: bool = False
    one_harmonic: bool = False
    record: bool = False
    record_keys: tuple[str, ...] = ()
    sweep: bool = True
    ending: str = ""
    quantities: Mapping[str, str] = field(default_factory=dict)
    of_beam: bool = False
    refuses: bool = False
    keys: Mapping[str, Key] = field(default_factory=dict)

    @property
    def known(self) -> tuple[str, ...]:
        """Keys that its table may have beside ``kind`` and ``fidelities``."""
        return (*self.needs, *self.takes, *self.keys)

    def needed(self, record: bool) -> tuple[str, ...]:
        """Keys that its table must have in a case with [``record``], or with [sweep]."""
        return () if record and self.sweep else self.needs

    def allowed(self, record: bool) -> tuple[str, ...]:
        """Keys that its table may have in a case with [``record``], or with [sweep]."""
        if not (self.record and self.sweep):
            return self.known
        of_records = set(self.record_keys) - {*self.needs, *self.takes}
        return self.record_keys if record else tuple(each for each in self.known if each not in of_records)
