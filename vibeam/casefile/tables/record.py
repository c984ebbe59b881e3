"""Tables [record] and [start]: the run of every fidelity through one input over time, and from where."""

from __future__ import annotations

from typing import Any

from vibeam.case.plans import RecordPlan, StartPlan
from vibeam.casefile.tables.declared import table
from vibeam.casefile.tables.maps import LEVELS
from vibeam.casefile.tables.table import less, plan_keys

_RECORD_DOC = """The run of every fidelity through one input over time, in place of [sweep]: how long, what is kept,
realisations, what is varied."""
_START_DOC = (
    "The state at the start of a [record]: plucked, moving or dropped; absent = settled, in static equilibrium."
)
RecordTable: Any = table("RecordTable", _RECORD_DOC, plan_keys(RecordPlan, values=LEVELS))
StartTable: Any = table("StartTable", _START_DOC, plan_keys(StartPlan))
SdofStartTable: Any = less(StartTable, "SdofStartTable", _START_DOC, "height", plain=True)
