"""Quantities of a motion under a record: what a check, a measured number or a comparison may be of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

#: q: unit of the signal; c/s: of the contact's velocity; E: of energy; anything else is the unit itself
TransientUnit = Literal["q", "c/s", "E", "s", "s-1", "1"]


@dataclass(frozen=True)
class TransientQuantity:
    """Number of one motion: long name, unit, and what it is of: a signal, the impacts, the energy or two motions."""

    long_name: str
    unit: TransientUnit
    of: Literal["signal", "impacts", "energy", "pair"]


QUANTITIES: Mapping[str, TransientQuantity] = {
    "peak": TransientQuantity("largest absolute value", "q", "signal"),
    "least": TransientQuantity("least value", "q", "signal"),
    "greatest": TransientQuantity("greatest value", "q", "signal"),
    "peak_time": TransientQuantity("time of the largest absolute value", "s", "signal"),
    "mean": TransientQuantity("mean over the record", "q", "signal"),
    "rms": TransientQuantity("root mean square over the record", "q", "signal"),
    "impacts": TransientQuantity("number of impacts, of contacts where the stop yields", "1", "impacts"),
    "impact_rate": TransientQuantity("impacts a second", "s-1", "impacts"),
    "first_impact": TransientQuantity("time of the first impact", "s", "impacts"),
    "hardest_impact": TransientQuantity("largest velocity just before an impact", "c/s", "impacts"),
    "impact_velocity": TransientQuantity("mean velocity just before impact", "c/s", "impacts"),
    "rest": TransientQuantity("share of the time in contact with a stop", "1", "impacts"),
    "work": TransientQuantity("work of the load on the beam relative to its base", "E", "energy"),
    "lost_at_impacts": TransientQuantity("energy lost to the stop", "E", "energy"),
    "lost_by_damping": TransientQuantity("energy lost by damping", "E", "energy"),
    "energy_left": TransientQuantity("energy at the end", "E", "energy"),
    "horizon": TransientQuantity("time until which the impacts of two fidelities pair", "s", "pair"),
}
