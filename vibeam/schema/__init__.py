"""The case file, declared once: the parser, its messages, the reference table and the template all read this.

A table is a class, a key a field: its annotation says what it may hold, ``key`` what it means and what to write.
"""

from __future__ import annotations

from vibeam.schema.cases import BeamCase, SdofCase
from vibeam.schema.plan import SweepTable
from vibeam.schema.rig import AddedMassTable, BeamTable, PlatformTable, StopTable, TorsionTable
from vibeam.schema.sdof import SdofStopTable
from vibeam.schema.table import Table, key
from vibeam.schema.words import EXTENTS, QUANTITIES

__all__ = [
    "EXTENTS",
    "QUANTITIES",
    "AddedMassTable",
    "BeamCase",
    "BeamTable",
    "PlatformTable",
    "SdofCase",
    "SdofStopTable",
    "StopTable",
    "SweepTable",
    "Table",
    "TorsionTable",
    "key",
]
