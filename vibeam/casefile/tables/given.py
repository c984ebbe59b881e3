"""Rules common to cases whose structure is given, by matrices or modes."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Annotated, Any

from vibeam.casefile.fields import TEXT
from vibeam.casefile.tables.drive import MOTIONS, DriveTable, drive_checks, list_checks
from vibeam.casefile.tables.effects import effect_checks, platform_output
from vibeam.casefile.tables.figures import show_table
from vibeam.casefile.tables.stop import stop_table
from vibeam.casefile.tables.sweep import SweepTable
from vibeam.casefile.tables.table import NAME, Table, key, less
from vibeam.exchange.faults import Complaint, KeyPath, as_shown_in_message, suggest
from vibeam.figures import FIGURES

OWN = ("sensor", "contact", "platform")  # outputs that no row of one's own is called
OF_BEAM = ("gain", "moment", "at")  # keys of a beam's drive


def given_rules(case: SimpleNamespace, kind: str) -> Iterator[Complaint]:
    """Complaints about outputs, stop, drive and platform of a case with [``kind``]."""
    table = getattr(case, kind)
    for name in table.outputs or {}:
        if name in OWN or not NAME.fullmatch(name):
            yield (kind, "outputs", name), f"must be letters, digits, - or _, and none of {', '.join(OWN)}"
    vars(case.drive).update(dict.fromkeys(OF_BEAM))
    if table.base is not None and table.force is not None:
        yield (kind, "force"), f"the drive is said twice: keep {kind}.base, of a base that moves, or {kind}.force"
    elif table.force is not None:
        yield from _forced(case, kind)
    else:
        yield from _moved(case, kind)
    yield from effect_checks(case)


def _forced(case: SimpleNamespace, kind: str) -> Iterator[Complaint]:
    for name in (*MOTIONS, "voltage"):
        if getattr(case.drive, name) is not None:
            yield ("drive", name), f"moves a base, and {kind}.force says a force drives it: write force, or {kind}.base"
    if case.drive.force is None:
        yield ("drive", "force"), f'missing ({kind}.force says where it acts): write force = "5 N"'
    if case.platform is not None:
        yield ("platform",), f"moves a base: write {kind}.base in place of {kind}.force"
    yield from list_checks(case.drive, case.sweep.frequency)


def _moved(case: SimpleNamespace, kind: str) -> Iterator[Complaint]:
    if case.drive.force is not None and case.platform is None:
        yield ("drive", "force"), f"acts where {kind}.force says, or on a platform: write it, or add [platform]"
        return
    if getattr(case, kind).base is None:
        yield (
            (kind, "base"),
            f"missing (what a base motion moves): write base, or, for a drive by a force, {kind}.force",
        )
    elif case.platform is None and not any(getattr(case.drive, name) is not None for name in (*MOTIONS, "voltage")):
        yield ("drive",), 'the base motion is missing: write amplitude = "0.05 mm", or velocity or acceleration'
    else:
        yield from drive_checks(case)


def given_output(case: SimpleNamespace, path: KeyPath, output: str | None, kind: str) -> Iterator[Complaint]:
    """A complaint where a motion is asked for that [``kind``] does not name."""
    known = [*OWN, *(getattr(case, kind).outputs or {})]
    if output is not None and output not in known:
        yield path, f"{as_shown_in_message(output)} is no output; {suggest(output, known)}"
    else:
        yield from platform_output(case, path, output)


GivenDriveTable: Any = less(
    DriveTable,
    "GivenDriveTable",
    "The drive, harmonic: a base motion by amplitude, velocity or acceleration, or a force where the structure's table "
    "says. With [platform] a force on that, with [shaker] its voltage. Any of these may be a list, of amplitudes at as "
    "many frequencies.",
    *OF_BEAM,
)


def given_stop_table() -> type[Table]:
    """The stop of a given structure: where it is says the contact row."""
    made: type[Table] = less(stop_table(), "GivenStopTable", stop_table().__doc__ or "", "position")
    return made


class GivenSweepTable(SweepTable):
    """The sweep that every fidelity runs: drive frequencies and, at each, periods to settle and to hold."""

    output: Annotated[str, TEXT] = key(
        "whose displacement is read: sensor, contact, or one of outputs", "sensor", "sensor"
    )


def given_show_table() -> Any:
    """The table of a further figure, whose output is one of those that the case names."""
    meaning = "whose motion is shown: sensor, contact, or one of outputs; absent = the sweep's"
    return show_table("GivenShowTable", tuple(FIGURES), (Annotated[Any, TEXT], key(meaning, "sensor", None)))
