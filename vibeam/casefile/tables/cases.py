"""The two kinds of case: a beam on the bench, and a single degree of freedom."""

from __future__ import annotations

from typing import Annotated

from vibeam.casefile.field_lists import Each
from vibeam.casefile.fields import Text, Word
from vibeam.casefile.tables.beam import AddedMassTable, BeamTable, MassTable, SdofTable, SensorTable
from vibeam.casefile.tables.drive import DriveTable, SdofDriveTable
from vibeam.casefile.tables.effects import ClampTable, GravityTable, PlatformTable, ShakerTable, TorsionTable
from vibeam.casefile.tables.expectations import ExpectTable, ReferenceTable
from vibeam.casefile.tables.figures import FigureTable, MeasurementTable, SdofMeasurementTable, ShowTable
from vibeam.casefile.tables.stop import SdofStopTable, StopTable
from vibeam.casefile.tables.studies import CostTable, InfluenceTable
from vibeam.casefile.tables.sweep import FidelityTable, SdofFidelityTable, SdofSweepTable, SweepTable
from vibeam.casefile.tables.table import ACCURATE, Table, Within, key


class _Case(Table):
    """What both kinds begin with."""

    title: Annotated[str, Text()] = key(
        "what the case is; absent = the name of its file", "DTU impacting beam, neutral gap, 0.6 V", ""
    )
    source: Annotated[str, Text()] = key("where it comes from", "Rebouças, Santos & Thomsen 2018, Fig. 31(b)", "")
    accuracy: Annotated[float | None, Within] = key(
        "relative error allowed, of the finest fidelity's: vibeam run then takes what is cheapest, place by place",
        "1 %",
        None,
        written=False,
    )
    accuracy_of: Annotated[tuple[str, ...] | None, Each(Word(ACCURATE))] = key(
        "the quantities that this holds for; absent = the amplitude alone", ["amplitude", "reach"], None, written=False
    )


class BeamCase(_Case):
    """A beam on the bench."""

    beam: BeamTable
    mass: MassTable | None = key("attached to the beam; absent = a bare beam", None, None)
    added_mass: tuple[AddedMassTable, ...] = key("further point masses", None, (), written=False)
    clamp: ClampTable | None = None
    gravity: GravityTable | None = None
    torsion: TorsionTable | None = None
    stop: StopTable
    sensor: SensorTable
    drive: DriveTable
    platform: PlatformTable | None = None
    shaker: ShakerTable | None = None
    measurement: MeasurementTable | None = None
    sweep: SweepTable
    fidelity: dict[str, FidelityTable]
    reference: dict[str, ReferenceTable] = key("curves to check against", None, {}, written=False)
    expect: dict[str, ExpectTable] = key("numbers to check against", None, {}, written=False)
    show: dict[str, ShowTable] = key("further figures", None, {}, written=False)
    figure: FigureTable = key("how figures are written", None, FigureTable(), written=False)
    cost: CostTable = key("what vibeam cost does", None, CostTable(), written=False)
    influence: InfluenceTable = key("what vibeam influence does", None, InfluenceTable(), written=False)


class SdofCase(_Case):
    """A single degree of freedom by itself."""

    title: Annotated[str, Text()] = key(
        "what the case is; absent = the name of its file", "single degree of freedom", ""
    )
    source: Annotated[str, Text()] = key("where it comes from", "Rebouças, Santos & Thomsen 2018, eq. 1", "")
    sdof: SdofTable
    stop: SdofStopTable
    drive: SdofDriveTable
    measurement: SdofMeasurementTable | None = None
    sweep: SdofSweepTable
    fidelity: dict[str, SdofFidelityTable]
    reference: dict[str, ReferenceTable] = key("curves to check against", None, {}, written=False)
    expect: dict[str, ExpectTable] = key("numbers to check against", None, {}, written=False)
    show: dict[str, ShowTable] = key("further figures", None, {}, written=False)
    figure: FigureTable = key("how figures are written", None, FigureTable(), written=False)
    cost: CostTable = key("what vibeam cost does", None, CostTable(), written=False)
