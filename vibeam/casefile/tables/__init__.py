"""The case file, declared once: the parser, its messages, the reference table and the template all read this.

A table is a class, a key a field: its annotation says what it may hold, ``key`` what it means and what to write.
"""

from __future__ import annotations

from vibeam.casefile.tables.beam import AddedMassTable, BeamTable
from vibeam.casefile.tables.cases import BeamCase, SdofCase
from vibeam.casefile.tables.effects import PlatformTable, TorsionTable
from vibeam.casefile.tables.stop import SdofStopTable, StopTable
from vibeam.casefile.tables.sweep import SweepTable
from vibeam.casefile.tables.table import EXTENTS, QUANTITIES, Table, key

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
