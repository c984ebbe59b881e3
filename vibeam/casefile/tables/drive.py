"""Tables of the drive, and the rules between their keys: a base motion, a force or a voltage, said once; harmonics."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

from vibeam.case.input_plan import InputPlan
from vibeam.casefile.field_tables import flat
from vibeam.casefile.fields import Entry, OneOrSeveral, Quantity, Several
from vibeam.casefile.quantities import ANY
from vibeam.casefile.tables.declared import table
from vibeam.casefile.tables.input import COLUMN, LOADS, PEAKS, START, DensityEntry
from vibeam.casefile.tables.table import Frequency, declared_entry, less, plan_keys
from vibeam.exchange.faults import Complaint, as_shown_in_message
from vibeam.figures import FIGURES
from vibeam.solvers import SOLVERS
from vibeam_models.base import Base
from vibeam_models.keys import keys_of


def harmonic_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about further harmonics: their lists, and what beside them knows one harmonic alone."""
    if case.record is not None:
        return
    yield from _lists(case.drive)
    if case.drive.harmonic is not None and getattr(case, "platform", None) is not None:
        said = "[platform] filters each harmonic its own way, which is not computed: take harmonic, or it, away"
        yield ("drive", "harmonic"), said
    elif case.drive.harmonic is not None and getattr(case, "further_stop", None):
        yield ("drive", "harmonic"), "is carried to one contact, and there is a further_stop: take one of the two away"
    driven = _driven(case)
    yield from _solvers(case, driven)
    yield from _figures(case, driven)


def _lists(drive: SimpleNamespace) -> Iterator[Complaint]:
    if drive.harmonic is None:
        if drive.harmonic_share is not None or drive.harmonic_phase is not None:
            yield ("drive", "harmonic"), "missing (the orders that shares and phases are of): write harmonic = [2]"
        return
    if drive.harmonic_share is None:
        yield ("drive", "harmonic_share"), 'missing (how large each is): write harmonic_share = ["5 %"]'
    for name in ("harmonic_share", "harmonic_phase"):
        given = getattr(drive, name)
        if given is not None and len(given) != len(drive.harmonic):
            yield ("drive", name), f"{len(given)} numbers, and harmonic has {len(drive.harmonic)}"


def _driven(case: SimpleNamespace) -> dict[str, SimpleNamespace]:
    """Fidelities that several harmonics drive: those of the case, or of their own."""
    found = {}
    for name, fidelity in case.fidelity.items():
        own = "drive.harmonic" in dict(flat(fidelity.set or {}))
        shared = case.drive.harmonic is not None and "drive.harmonic" not in (fidelity.without or ())
        if own or shared:
            found[name] = fidelity
    return found


def _solvers(case: SimpleNamespace, driven: dict[str, SimpleNamespace]) -> Iterator[Complaint]:
    able = " or ".join(f'"{each}"' for each, declared in SOLVERS.items() if declared.harmonics)
    for name, fidelity in driven.items():
        if fidelity.solver is not None and not SOLVERS[fidelity.solver].harmonics:
            said = f"{as_shown_in_message(fidelity.solver)} knows a drive of one harmonic: write {able}, or take "
            yield ("fidelity", name, "solver"), f"{said}drive.harmonic away"


def _figures(case: SimpleNamespace, driven: dict[str, SimpleNamespace]) -> Iterator[Complaint]:
    for name, show in (case.show or {}).items():
        several = [each for each in show.fidelities or tuple(case.fidelity) if each in driven]
        if show.kind is not None and FIGURES[show.kind].one_harmonic and several:
            said = f'kind = "{show.kind}" knows a drive of one harmonic, and {", ".join(several)} has several'
            yield ("show", name, "kind"), f"{said}: name others in fidelities, or take drive.harmonic away"


MOTIONS = ("amplitude", "velocity", "acceleration")  # of the base
SIZES = (*MOTIONS, *LOADS, "voltage")  # what may be a list over drive.frequency
NEAR = 1e-9  # share of the table's ends by which the sweep may lie outside, rounded


def drive_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the drive of a beam, with or without a platform."""
    if case.record is None:
        yield from (_without_platform(case) if case.platform is None else _driven_platform(case))
        yield from list_checks(case)
    elif None not in (case.drive.at, case.drive.force or case.drive.moment):
        yield from place_checks(case, "force" if case.drive.moment is None else "moment")


def sdof_drive_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the drive of a single degree of freedom."""
    if case.record is not None:
        return
    said = [name for name in MOTIONS if getattr(case.drive, name) is not None]
    if said:
        yield from _said_once(case.drive, said)
    else:
        yield ("drive", "amplitude"), "missing (of the base B, in the unit of the motion): write amplitude = 0.0005"
    yield from list_checks(case)


def _without_platform(case: SimpleNamespace) -> Iterator[Complaint]:
    drive = case.drive
    ways = [*(name for name in (*MOTIONS, *LOADS) if getattr(drive, name) is not None), *_by_voltage(drive)]
    loads = [name for name in ways if name in LOADS]
    if loads and drive.at is None:
        on, or_else = (", or on a platform", ", or add [platform]") if loads[0] == "force" else ("", "")
        yield ("drive", loads[0]), f'acts on the beam{on}: write at = "120 mm"{or_else}'
    elif drive.at is not None and ways and not loads:
        yield ("drive", "at"), 'is where a force or a moment acts on the beam: write force = "1 N", or take at away'
    elif len(ways) == 1 and loads:
        yield from place_checks(case, loads[0])
    else:
        yield from _said_once(drive, ways)


def _by_voltage(drive: SimpleNamespace) -> list[str]:
    """The shaker's keys as one way to say the base motion."""
    said = [name for name in ("voltage", "gain") if getattr(drive, name) is not None]
    return [" and ".join(said)] if said else []


def _said_once(drive: SimpleNamespace, ways: list[str]) -> Iterator[Complaint]:
    """One way to say the drive, a base motion where there is no other."""
    if len(ways) > 1:
        what = "drive" if set(ways) & {*LOADS} else "base motion"
        yield ("drive", ways[0]), f"the {what} is said twice: keep {ways[0]}, or {ways[1]}"
    elif not ways:
        yield (
            ("drive",),
            "the base motion is missing: write voltage and gain, or amplitude, velocity or acceleration; "
            "or force or moment with at",
        )
    elif ways[0] in ("voltage", "gain"):
        other = "gain" if ways[0] == "voltage" else "voltage"
        yield ("drive", other), f"missing: {ways[0]} needs it beside it"


def place_checks(case: SimpleNamespace, load: str) -> Iterator[Complaint]:
    """Complaints about the place of a load on the beam, with a mass there where the beam itself has none."""
    at, length = case.drive.at, case.beam.length
    if length is not None and at > length:
        yield ("drive", "at"), f"{at:g} m is beyond the tip: beam.length is {length:g} m"
    elif case.beam.massless and load == "moment":
        yield ("drive", "moment"), "turns a beam without mass: take beam.massless out, or write force"
    elif case.beam.massless:
        carried = [case.mass, *(case.added_mass or ())]
        if at not in [each.position for each in carried if each is not None]:
            yield ("drive", "at"), "a massless beam has no inertia there: take the place of a mass, or massless out"


def _driven_platform(case: SimpleNamespace) -> Iterator[Complaint]:
    """On a platform the drive is a shaker's voltage, a force, or a base motion that holds at one frequency."""
    drive, calibrated = case.drive, case.platform.calibrated_at
    names = ("voltage", "gain", *MOTIONS, "force")
    said = [name for name in names if getattr(drive, name) is not None]
    for name in ("at", "moment"):
        if getattr(drive, name) is not None:
            yield ("drive", name), f"is of a drive on the beam, and [platform] moves its base: take {name}, or it, away"
    if case.shaker is not None:
        for name in said:
            if name != "voltage":
                yield (
                    ("drive", name),
                    "the shaker's voltage says the drive already: keep voltage, or take [shaker] away",
                )
        if "voltage" not in said:
            yield ("drive",), 'the shaker needs its voltage: write voltage = "… V"'
    elif "force" in said:
        for name in said:
            if name != "force":
                yield ("drive", name), f"the drive is said twice: keep force, or {name}"
    else:
        ways = [name for name in said if name in MOTIONS]
        yield from _said_once(drive, [*ways, *_by_voltage(drive)])
        for name in (each for each in ways if isinstance(getattr(drive, each), tuple)):
            told = "a base motion over frequency has the platform in it: take [platform] out, or give its force"
            yield ("drive", name), told
    by_itself = case.shaker is not None or "force" in said
    if calibrated is None and not by_itself:
        yield (("platform", "calibrated_at"), 'missing (where the drive\'s motion holds): write calibrated_at = "… Hz"')
    elif calibrated is not None and by_itself:
        yield ("platform", "calibrated_at"), "goes with a base motion alone: a force or a shaker says the drive already"


def list_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about lists beside the frequencies that they are of, which the sweep does not leave."""
    drive = case.drive
    for name in PEAKS:
        value = getattr(drive, name, None)
        if value is not None and min(value if isinstance(value, tuple) else (value,)) < 0:
            yield ("drive", name), "must be ≥ 0: it is the amplitude of a sine"
    lists = {name: getattr(drive, name) for name in SIZES if isinstance(getattr(drive, name, None), tuple)}
    if drive.frequency is None:
        for name in lists:
            yield ("drive", name), f'a list needs its frequencies: write frequency = ["… Hz", …], one for each {name}'
        return
    if not lists:
        if any(getattr(drive, name, None) is not None for name in SIZES):
            yield ("drive", "frequency"), "is of a list of as many amplitudes, and there is none: take it away"
        return
    for name, values in lists.items():
        if len(values) != len(drive.frequency):
            yield ("drive", name), f"{len(values)} numbers for {len(drive.frequency)} frequencies"
    yield from _inside(drive.frequency, _ends(getattr(case.sweep, "frequency", None)))


def _ends(grid: Any) -> tuple[float, ...]:
    """First and last frequency of the sweep, those that could be read."""
    ends = (grid[0], grid[-1]) if isinstance(grid, tuple) else (getattr(grid, "from_", None), getattr(grid, "to", None))
    return tuple(end for end in ends if end is not None)


def _inside(table: tuple[float, ...], ends: tuple[float, ...]) -> Iterator[Complaint]:
    for end in ends:
        if not table[0] * (1 - NEAR) <= end <= table[-1] * (1 + NEAR):
            said = f"the table is of {table[0]:g} … {table[-1]:g} Hz, and the sweep has {end:g} Hz: lengthen the table"
            yield ("drive", "frequency"), said
            return


DRIVE = """The drive, harmonic or an input over time. With [sweep] a base motion by voltage and gain, amplitude,
velocity or acceleration; or a force or a moment at a place of the beam. With [platform] a force on that, with [shaker]
voltage alone. Any of these but gain may be a list, of amplitudes at as many frequencies. With [record] an input over
time: a file, a shape, or a random one by its density; none where [start] says what moves."""
SDOF_DRIVE = (
    "The base motion of the single degree of freedom: amplitude, or velocity or acceleration, or one of these as a\n"
    "list over frequency; with [record] a file, a shape, or a random input by its density."
)
_NUMBERS = {name: cast(Quantity, declared_entry(keys_of(Base)[name])) for name in SIZES}
_SIGNED = {name: replace(_NUMBERS[name], range=ANY) for name in PEAKS}  # a pulse has a direction
_LISTS: dict[str, Entry] = {name: OneOrSeveral(each) for name, each in (_NUMBERS | _SIGNED).items()}
_FREQUENCY = Several(Frequency, alone=True, ascending=True)
_INPUT = plan_keys(InputPlan, column=COLUMN, time=COLUMN, start=START, density=DensityEntry())
DriveTable = table("DriveTable", DRIVE, plan_keys(Base, frequency=_FREQUENCY, **_LISTS), _INPUT)
SdofDriveTable = less(DriveTable, "SdofDriveTable", SDOF_DRIVE, "voltage", "gain", *LOADS, "at", plain=True)
