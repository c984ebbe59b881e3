"""Cases for the tests of what is shown: the DTU beam with one figure, and a nondimensional model without contact."""

from __future__ import annotations

from typing import Any

import numpy as np
from observed import NEUTRAL
from stand_in import SI

import vibeam
from vibeam.case.case import Case
from vibeam.casefile.read import parse
from vibeam.figures.sheet import Sheet, sheet_at

BETA, DRIVE = 0.015, 0.5e-3
SDOF = f"""[sdof]
damping_ratio = {BETA}
[stop]
gap = 1.0
restitution = 0.9
[drive]
amplitude = {DRIVE}
[sweep]
frequency = ["1.8 rad/s", "2.1 rad/s"]
direction = "up"
settle = 400
hold = 4
[fidelity.sdof]
"""


def beam(kind: str, **keys: Any) -> Case:
    """The neutral rig with the figure ``it`` of a kind; keys with __ for dots, those of the figure without a table."""
    own = {key if "__" in key else f"show__it__{key}": value for key, value in keys.items()}
    named = {key.replace("__", "."): value for key, value in own.items()}
    return vibeam.load(NEUTRAL, set=SI | {"show.it.kind": kind} | named)


def sheet(case: Case, fidelity: str, frequency: float | None) -> Sheet:
    """The numbers of the figure ``it``."""
    found = sheet_at(case, case.shows["it"], fidelity, frequency, ())
    assert not found.fault, found.fault
    return found


def free(*lines: str) -> Case:
    """A model that never touches its stop, with further lines."""
    return parse("\n".join([SDOF, *lines]) + "\n")


def forced(omega: float) -> float:
    """Its amplitude: Ω²B/|1 − Ω² + 2iβΩ|."""
    return float(omega**2 * DRIVE / np.abs(complex(1 - omega**2, 2 * BETA * omega)))
