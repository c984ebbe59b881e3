"""The tables of each kind of case: a beam on the bench, a single degree of freedom, a structure that is given."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path as File
from types import SimpleNamespace
from typing import Any, ClassVar

from vibeam.case.plans import RecordPlan, StartPlan
from vibeam.case.study_plans import STUDY_PLANS
from vibeam.casefile import quantities as units
from vibeam.casefile.field_tables import settings
from vibeam.casefile.fields import TEXT, Quantity, Word
from vibeam.casefile.kinds import KINDS, MODELS
from vibeam.casefile.quantities import POSITIVE, UNIT_SYSTEMS
from vibeam.casefile.tables.beam import BeamTable, MassTable, SensorTable
from vibeam.casefile.tables.declared import Field, Later, Table, key, table
from vibeam.casefile.tables.drive import DriveTable, SdofDriveTable, sdof_drive_checks
from vibeam.casefile.tables.effects import effect_tables, own_table, with_effects
from vibeam.casefile.tables.expectations import ExpectTable, MeasuredTable
from vibeam.casefile.tables.figures import FigureTable, MeasurementTable, SdofMeasurementTable, show_table
from vibeam.casefile.tables.maps import LEVELS, MapTable, SdofMapTable
from vibeam.casefile.tables.outputs import OutputTable
from vibeam.casefile.tables.references import ReferenceTable
from vibeam.casefile.tables.stop import sdof_stop_table, stop_table
from vibeam.casefile.tables.studies import CostTable, FitTable, InfluenceTable
from vibeam.casefile.tables.sweep import BeamFidelityTable, FidelityTable, SdofFidelityTable, SdofSweepTable, SweepTable
from vibeam.casefile.tables.table import Ratio, less, plan_keys
from vibeam.exchange.faults import Complaint, KeyPath
from vibeam.figures import FIGURES
from vibeam_models.effects import EFFECTS
from vibeam_models.laws import LAWS
from vibeam_models.registry import Home


def sdof_rules(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Complaints about the drive."""
    yield from sdof_drive_checks(case)


def sdof_output(case: SimpleNamespace, path: KeyPath, output: str | None) -> Iterator[Complaint]:
    """A complaint where a motion is asked for that is another's."""
    if output not in ("sensor", "contact", None):
        yield path, f'a single degree of freedom has no "{output}": write "sensor"'


class SdofTable(Table):
    """A single degree of freedom in place of beam, mass and sensor: the paper's model, nondimensional."""

    natural_frequency = key(
        Quantity(units.ANGULAR_FREQUENCY, POSITIVE),
        "of free motion, with its unit; 1 rad/s = nondimensional time",
        "1 rad/s",
        1.0,
    )
    damping_ratio = key(Ratio, "β, of critical", 0.015)


_RECORD = """The run of every fidelity through one input over time, in place of [sweep]: how long, what is kept,
realisations, what is varied."""
_START = "The state at the start of a [record]: plucked, moving or dropped; absent = settled, in static equilibrium."
RecordTable = table("RecordTable", _RECORD, plan_keys(RecordPlan, values=LEVELS))
StartTable = table("StartTable", _START, plan_keys(StartPlan))
SdofStartTable = less(StartTable, "SdofStartTable", _START, "height", plain=True)

ASIDE: Any = {"physics": False, "numbers": False}  # no part of the rig, nor of what its sweeps compute


class AnyCase(Table):
    """First keys of every kind of case; ``kind``: its name among ``KINDS``."""

    kind: ClassVar[str] = "beam"

    title = key(
        TEXT, "what the case is; absent = the name of its file", "DTU impacting beam, neutral gap, 0.6 V", "", **ASIDE
    )
    source = key(TEXT, "where it comes from", "Rebouças, Santos & Thomsen 2018, Fig. 31(b)", "", **ASIDE)
    units = key(
        Word(tuple(UNIT_SYSTEMS)),
        "units of the numbers that are written without one, SI: m, kg, s, N, Pa, Hz; absent = every number with a "
        "dimension needs its unit, 0 alone does not",
        "SI",
        None,
        **ASIDE,
    )


Parts = dict[str, Field]  # keys of a case


def _measured(measurement: Any, sweep: Any, start: Any, fidelity: Any) -> Parts:
    """The tables of what is run on a rig, and how it is seen."""
    return {
        "measurement": key(measurement, "the measuring chain", None, None, numbers=False),
        "sweep": key(sweep, "the sweep of every fidelity", None, None, physics=False),
        "record": key(RecordTable, "the run through an input over time", None, None, physics=False),
        "start": key(start, "the state at its start", None, None),
        "fidelity": key(fidelity, "models of the rig", physics=False, many=dict),
    }


def _asked(show: Any, map_: Any) -> Parts:
    """The tables of what is asked of a case: comparisons, figures, maps, studies."""
    chosen = (
        "keys whose values measured numbers chose, by their names: calibrated by these, the model predicts the others"
    )
    uncertain = "inputs that are uncertain: normal about the case's own value, or uniform in a range"
    inputs = {"mass.mass": "± 2 g", "stop.restitution": "0.6 … 0.8"}
    fit = "what vibeam fit estimates, and from what"
    return {
        "reference": key(ReferenceTable, "curves to check against", None, {}, many=dict, **ASIDE),
        "expect": key(ExpectTable, "numbers to check against", None, {}, many=dict, **ASIDE),
        "measured": key(MeasuredTable, "numbers that were measured", None, {}, many=dict, **ASIDE),
        "chosen_by": key(settings("[names]"), chosen, {"platform.mass": ["decay", "peak"]}, None, **ASIDE),
        "show": key(show, "further figures", None, {}, many=dict, **ASIDE),
        "map": key(map_, "maps over keys of the case", None, {}, many=dict, **ASIDE),
        "uncertain": key(settings(), uncertain, inputs, None, **ASIDE),
        "figure": key(FigureTable, "how figures are written", None, FigureTable(), **ASIDE),
        "cost": key(CostTable, "what vibeam verdict --only solvers does", None, CostTable(), **ASIDE),
        "fit": key(FitTable, fit, None, None, **ASIDE),
    } | {name: _study(name, home) for name, home in STUDY_PLANS.items()}


def _study(name: str, home: Home) -> Field:
    """The table of a study that has a plan; of an extension's study no case has it that does not say it."""
    keys = plan_keys(home.load())
    made = table(f"{name.capitalize()}Table", f"Plan of vibeam {name}.", keys)
    absent = name not in STUDY_PLANS.own or any(field.required for field in keys.values())
    return Field(made, f"what vibeam {name} does", None, None if absent else made(), **ASIDE)


def _influence() -> Parts:
    told = "what vibeam verdict --only effects does"
    return {"influence": key(InfluenceTable, told, None, InfluenceTable(), **ASIDE)}


def _own(name: str, home: str | type[Any]) -> Later:
    """Table that is declared elsewhere, where a case first names it."""
    return Later(lambda: own_table(Home(name, home)))


def _beam() -> type[AnyCase]:
    mass = key(with_effects("mass", MassTable), "attached to the beam; absent = a bare beam", None, None)
    outputs = key(OutputTable, "further outputs", None, None, many=dict)
    show = show_table("ShowTable", tuple(FIGURES))
    return _case(
        "beam",
        "A beam on the bench.",
        {"beam": key(with_effects("beam", BeamTable)), "mass": mass},
        effect_tables("beam"),
        {"stop": key(stop_table())},
        {"sensor": key(SensorTable), "output": outputs, "drive": key(DriveTable)},
        effect_tables("base"),
        {name: key(_own(name, each.table), each.meaning, None, None) for name, each in MODELS.items()},
        _measured(MeasurementTable, SweepTable, StartTable, BeamFidelityTable),
        _asked(show, MapTable),
        _influence(),
    )


def _sdof() -> type[AnyCase]:
    title = key(TEXT, "what the case is; absent = the name of its file", "single degree of freedom", "", **ASIDE)
    source = key(TEXT, "where it comes from", "Rebouças, Santos & Thomsen 2018, eq. 1", "", **ASIDE)
    return _case(
        "sdof",
        "A single degree of freedom by itself.",
        {"title": title, "source": source, "sdof": key(SdofTable)},
        {"stop": key(sdof_stop_table()), "drive": key(SdofDriveTable)},
        _measured(SdofMeasurementTable, SdofSweepTable, SdofStartTable, SdofFidelityTable),
        _asked(show_table("ShowTable", tuple(FIGURES)), SdofMapTable),
    )


def _given(kind: str, doc: str, own: Any) -> type[AnyCase]:
    from vibeam.casefile.tables.given import GivenDriveTable, GivenSweepTable, given_show_table, given_stop_table

    return _case(
        kind,
        doc,
        {kind: key(own), "stop": key(given_stop_table()), "drive": key(GivenDriveTable)},
        effect_tables("base"),
        _measured(MeasurementTable, GivenSweepTable, StartTable, FidelityTable),
        _asked(given_show_table(), MapTable),
        _influence(),
    )


def _matrices() -> type[AnyCase]:
    from vibeam.casefile.tables.given import MatricesTable

    return _given("matrices", "A structure by its own matrices.", MatricesTable)


def _modes() -> type[AnyCase]:
    from vibeam.casefile.tables.given import ModesTable

    return _given("modes", "A structure by its modes.", ModesTable)


def _case(kind: str, doc: str, *parts: Parts) -> type[AnyCase]:
    made: type[Any] = table(f"{kind.capitalize()}Case", doc, AnyCase, *parts, kind=kind)
    return made


CASES = {"beam": _beam, "sdof": _sdof, "matrices": _matrices, "modes": _modes}


def case_table(kind: str) -> type[AnyCase]:
    """The declaration of a kind of case, with the effects, laws, studies and figures that are registered now."""
    return _declared(kind, *(tuple(known.items()) for known in (EFFECTS, LAWS, STUDY_PLANS)), tuple(FIGURES))


@lru_cache(maxsize=32)
def _declared(
    kind: str, effects: Registered, laws: Registered, studies: Registered, figures: tuple[str, ...]
) -> type[AnyCase]:
    if kind in CASES:
        return CASES[kind]()
    return _given(kind, KINDS[kind].meaning, _own(kind, KINDS[kind].table))


Registered = tuple[tuple[str, Home], ...]
