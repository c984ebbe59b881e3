"""The tables of two kinds of case: a beam on the bench, a single degree of freedom, with its own table."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path as File
from types import SimpleNamespace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from vibeam.casefile import quantities as units
from vibeam.casefile.field_tables import settings
from vibeam.casefile.fields import POSITIVE, TEXT, Each, Quantity, Word
from vibeam.casefile.tables.beam import BeamTable, MassTable, SensorTable
from vibeam.casefile.tables.drive import DriveTable, SdofDriveTable, sdof_drive_checks
from vibeam.casefile.tables.effects import effect_tables, with_effects
from vibeam.casefile.tables.expectations import ExpectTable, MeasuredTable
from vibeam.casefile.tables.figures import FigureTable, MeasurementTable, SdofMeasurementTable, ShowTable
from vibeam.casefile.tables.maps import MapTable, SdofMapTable
from vibeam.casefile.tables.outputs import OutputTable
from vibeam.casefile.tables.references import ReferenceTable
from vibeam.casefile.tables.stop import sdof_stop_table, stop_table
from vibeam.casefile.tables.studies import CostTable, FitTable, InfluenceTable
from vibeam.casefile.tables.sweep import FidelityTable, SdofFidelityTable, SdofSweepTable, SweepTable
from vibeam.casefile.tables.table import ACCURATE, Ratio, Table, Within, key, table
from vibeam.casefile.unit_systems import UNIT_SYSTEMS
from vibeam.exchange.faults import Complaint, KeyPath
from vibeam_models.effects import EFFECTS
from vibeam_models.laws import LAWS
from vibeam_models.registry import Home


def sdof_rules(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Complaints about the drive, and about [cost]: there is one mode."""
    yield from sdof_drive_checks(case)
    if case.cost is not None and case.cost.modes:
        yield ("cost", "modes"), "a single degree of freedom has one mode: leave this out"


def sdof_output(case: SimpleNamespace, path: KeyPath, output: str | None) -> Iterator[Complaint]:
    """A complaint where a motion is asked for that is another's."""
    if output not in ("sensor", "contact", None):
        yield path, f'a single degree of freedom has no "{output}": write "sensor"'


class SdofTable(Table):
    """A single degree of freedom in place of beam, mass and sensor: the paper's model, nondimensional."""

    natural_frequency: Annotated[float, Quantity(units.ANGULAR_FREQUENCY, POSITIVE)] = key(
        "of free motion, with its unit; 1 rad/s = nondimensional time", "1 rad/s", 1.0
    )
    damping_ratio: Annotated[float, Ratio] = key("β, of critical", 0.015)


ASIDE: Any = {"physics": False, "numbers": False}  # no part of the rig, nor of what its sweeps compute


class AnyCase(Table):
    """First keys of every kind of case; ``kind``: its name among ``KINDS``."""

    kind: ClassVar[str] = "beam"

    if TYPE_CHECKING:  # what stands further down in every kind
        stop: Any
        drive: Any
        sweep: Any
        fidelity: Any
        show: Any
        map: Any
        cost: Any
        fit: Any
        figure: Any
        uncertain: Any
        measurement: Any
        reference: Any
        expect: Any
        measured: Any
        chosen_by: Any

    title: Annotated[str, TEXT] = key(
        "what the case is; absent = the name of its file", "DTU impacting beam, neutral gap, 0.6 V", "", **ASIDE
    )
    source: Annotated[str, TEXT] = key(
        "where it comes from", "Rebouças, Santos & Thomsen 2018, Fig. 31(b)", "", **ASIDE
    )
    units: Annotated[str | None, Word(tuple(UNIT_SYSTEMS))] = key(
        "units of the numbers that are written without one, SI: m, kg, s, N, Pa, Hz; absent = every number with a "
        "dimension needs its unit, 0 alone does not",
        "SI",
        None,
        written=False,
        **ASIDE,
    )
    accuracy: Annotated[float | None, Within] = key(
        "relative error allowed, against the full model: vibeam run then takes the cheapest fidelity within it",
        "1 %",
        None,
        written=False,
        **ASIDE,
    )
    accuracy_of: Annotated[tuple[str, ...] | None, Each(Word(ACCURATE))] = key(
        "the quantities that this holds for; absent = the amplitude alone",
        ["amplitude", "reach"],
        None,
        written=False,
        **ASIDE,
    )


class _Carrier(Table):
    beam: Any
    mass: MassTable | None


class _Rig(Table):
    sensor: SensorTable
    output: dict[str, OutputTable] | None = key("further outputs", None, None, written=False)
    drive: DriveTable


class _Plan(Table):
    measurement: MeasurementTable | None = key("the measuring chain", None, None, written=False, numbers=False)
    sweep: SweepTable = key("the sweep of every fidelity", physics=False)
    fidelity: dict[str, FidelityTable] = key("models of the rig", physics=False)


class _Checks(Table):
    reference: dict[str, ReferenceTable] = key("curves to check against", None, {}, written=False, **ASIDE)
    expect: dict[str, ExpectTable] = key("numbers to check against", None, {}, written=False, **ASIDE)
    measured: dict[str, MeasuredTable] = key("numbers that were measured", None, {}, written=False, **ASIDE)
    chosen_by: Annotated[dict[str, Any] | None, settings("[names]")] = key(
        "keys whose values measured numbers chose, by their names: calibrated by these, the model predicts the others",
        {"platform.mass": ["decay", "peak"]},
        None,
        written=False,
        **ASIDE,
    )
    show: dict[str, ShowTable] = key("further figures", None, {}, written=False, **ASIDE)
    map: dict[str, MapTable] = key("maps over keys of the case", None, {}, written=False, **ASIDE)
    uncertain: Annotated[dict[str, Any] | None, settings()] = key(
        "inputs that are uncertain: normal about the case's own value, or uniform in a range",
        {"mass.mass": "± 2 g", "stop.restitution": "0.6 … 0.8"},
        None,
        written=False,
        **ASIDE,
    )
    figure: FigureTable = key("how figures are written", None, FigureTable(), written=False, **ASIDE)
    cost: CostTable = key("what vibeam cost does", None, CostTable(), written=False, **ASIDE)
    fit: FitTable | None = key("what vibeam fit estimates, and from what", None, None, written=False, **ASIDE)


class _Influence(Table):
    influence: InfluenceTable = key("what vibeam influence does", None, InfluenceTable(), written=False, **ASIDE)


class BeamCase(_Influence, _Checks, _Plan, _Rig, _Carrier, AnyCase):
    """Case of a beam on the bench, without stop and effects: ``beam_case`` adds these."""

    stop: Any


class _Single(Table):
    title: Annotated[str, TEXT] = key(
        "what the case is; absent = the name of its file", "single degree of freedom", "", **ASIDE
    )
    source: Annotated[str, TEXT] = key("where it comes from", "Rebouças, Santos & Thomsen 2018, eq. 1", "", **ASIDE)
    sdof: SdofTable

    kind: ClassVar[str] = "sdof"


class _SinglePlan(Table):
    drive: SdofDriveTable
    measurement: SdofMeasurementTable | None = key("the measuring chain", None, None, written=False, numbers=False)
    sweep: SdofSweepTable = key("the sweep of every fidelity", physics=False)
    fidelity: dict[str, SdofFidelityTable] = key("models of the rig", physics=False)


class _SingleChecks(_Checks):
    map: dict[str, SdofMapTable] = key(  # type: ignore[assignment]
        "maps over keys of the case", None, {}, written=False, **ASIDE
    )


class SdofCase(_SingleChecks, _SinglePlan, _Single, AnyCase):
    """Case of a single degree of freedom by itself, without stop: ``sdof_case`` adds it."""

    stop: Any


Registered = tuple[tuple[str, Home], ...]


def beam_case() -> type[BeamCase]:
    """The declaration of a beam's case, with the effects and contact laws that are registered now."""
    return _beam_case(tuple(EFFECTS.items()), tuple(LAWS.items()))


def sdof_case() -> type[SdofCase]:
    """The declaration of the case of a single degree of freedom, with the contact laws that are registered now."""
    return _sdof_case(tuple(LAWS.items()))


@lru_cache(maxsize=8)
def _beam_case(effects: Registered, laws: Registered) -> type[BeamCase]:
    stop = {"stop": (stop_table(), ...)}
    mass = with_effects("mass", MassTable) | None, key("attached to the beam; absent = a bare beam", None, None)
    carrier = {"beam": (with_effects("beam", BeamTable), ...), "mass": mass}
    parts = (AnyCase, carrier, effect_tables("beam"), stop, _Rig, effect_tables("base"), _Plan, _Checks, _Influence)
    made: type[BeamCase] = table("BeamCase", "A beam on the bench.", *parts)
    return made


@lru_cache(maxsize=8)
def _sdof_case(laws: Registered) -> type[SdofCase]:
    parts = (AnyCase, _Single, {"stop": (sdof_stop_table(), ...)}, _SinglePlan, _SingleChecks)
    made: type[SdofCase] = table("SdofCase", "A single degree of freedom by itself.", *parts)
    return made
