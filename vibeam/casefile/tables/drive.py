"""Tables of the drive; rules between their keys: a base motion, a force or a voltage, said once."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Annotated

from vibeam.case.faults import Complaint
from vibeam.casefile import quantities as units
from vibeam.casefile.fields import NOT_NEGATIVE, POSITIVE, Quantity
from vibeam.casefile.tables.table import Ratio, Table, key


def drive_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the drive of a beam, with or without a platform."""
    yield from (_base_motion(case.drive) if case.platform is None else _driven_platform(case))


def _base_motion(drive: SimpleNamespace) -> Iterator[Complaint]:
    shaker = [name for name in ("voltage", "gain") if getattr(drive, name) is not None]
    if drive.force is not None:
        yield ("drive", "force"), "acts on a platform: add [platform], or take force away"
        return
    if drive.amplitude is not None and shaker:
        yield ("drive", "amplitude"), f"the base motion is said twice: keep amplitude, or {' and '.join(shaker)}"
    elif drive.amplitude is None and not shaker:
        yield ("drive",), "the base motion is missing: write voltage and gain, or amplitude"
    elif len(shaker) == 1 and drive.amplitude is None:
        other = "gain" if shaker == ["voltage"] else "voltage"
        yield ("drive", other), f"missing: {shaker[0]} needs it beside it"


def _driven_platform(case: SimpleNamespace) -> Iterator[Complaint]:
    """On a platform the drive is a shaker's voltage, a force, or a base motion that holds at one frequency."""
    drive, calibrated = case.drive, case.platform.calibrated_at
    said = [name for name in ("voltage", "gain", "amplitude", "force") if getattr(drive, name) is not None]
    if case.shaker is not None:
        for name in said:
            if name != "voltage":
                yield (
                    ("drive", name),
                    "the shaker's voltage says the drive already: keep voltage, or take [shaker] away",
                )
        if "voltage" not in said:
            yield ("drive",), 'the shaker needs its voltage: write voltage = "0.6 V"'
    elif "force" in said:
        for name in said:
            if name != "force":
                yield ("drive", name), f"the drive is said twice: keep force, or {name}"
    else:
        yield from _base_motion(drive)
    by_itself = case.shaker is not None or "force" in said
    if calibrated is None and not by_itself:
        yield (
            ("platform", "calibrated_at"),
            'missing (where the drive\'s motion holds): write calibrated_at = "15.5 Hz"',
        )
    elif calibrated is not None and by_itself:
        yield ("platform", "calibrated_at"), "goes with a base motion alone: a force or a shaker says the drive already"


class DriveTable(Table):
    """The base motion amplitude · sin Ωt: say either voltage and gain, or amplitude; with [platform] also force, with
    [shaker] voltage alone.
    """

    voltage: Annotated[float | None, Quantity(units.VOLTAGE, NOT_NEGATIVE)] = key(
        "amplitude of the shaker's voltage", "0.6 V", None
    )
    gain: Annotated[float | None, Quantity(units.PER_VOLT, POSITIVE)] = key(
        "γ of eq. 46: base amplitude over mode shape at the mass, length and voltage", 5.16e-4, None
    )
    amplitude: Annotated[float | None, Quantity(units.LENGTH, NOT_NEGATIVE)] = key(
        "of the base, instead of voltage and gain", "0.05 mm", None, written=False
    )
    force: Annotated[float | None, Quantity(units.FORCE, NOT_NEGATIVE)] = key(
        "on the platform, instead of all of these; needs [platform]", "5 N", None, written=False
    )


class SdofDriveTable(Table):
    """The base motion of the single degree of freedom."""

    amplitude: Annotated[float, Ratio] = key("of the base B, in the unit of the motion", 0.5e-3)
