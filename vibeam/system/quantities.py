"""Quantities of a frequency response: long names, units, dimensions; the reasons for which its points end."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Literal, Self

VELOCITIES_KEPT = 16  # last impact velocities stored for each point

#: q: unit of the output; q/s: of its rate; c and c/s: of the contact's displacement and velocity; E: of energy;
#: anything else is the unit itself
Unit = Literal["q", "q/s", "c", "c/s", "E", "Hz", "s", "s-1", "1"]


@dataclass(frozen=True)
class OutputUnits:
    """Units: of displacements (``"1"`` of a model without dimensions), of the output that is read and of its rate."""

    length: str = "m"
    output: str = "m"
    rate: str = "m s-1"


METRES, PLAIN = OutputUnits(), OutputUnits("1", "1", "s-1")


@dataclass(frozen=True)
class DatasetQuantity:
    """Description of one data set: the paper's name if it has one, its unit, its dimension beyond the frequency."""

    long_name: str
    unit: Unit
    dimension: Literal["impact", "mode", "branch"] | None = None


LAYOUT: Mapping[str, DatasetQuantity] = {
    "frequency": DatasetQuantity("drive frequency, Ω/2π", "Hz"),
    "amplitude": DatasetQuantity("amplitude of the output, ½(max − min)", "q"),
    "reach": DatasetQuantity("largest distance of the contact point from the stop, Q = Δ − min q", "c"),
    "maximum": DatasetQuantity("maximum of the output", "q"),
    "minimum": DatasetQuantity("minimum of the output", "q"),
    "impacts_per_period": DatasetQuantity("impacts a drive period", "1"),
    "impact_velocity": DatasetQuantity("mean velocity just before impact, q̇₋", "c/s"),
    "impact_velocities": DatasetQuantity("last velocities just before impact, q̇₋, oldest first", "c/s", "impact"),
    "period": DatasetQuantity("drive periods after which the motion repeats; 0: it does not; −1: no contact", "1"),
    "rest": DatasetQuantity("share of the time at rest on the stop", "1"),
    "mode_energy": DatasetQuantity("time-mean energy of each mode", "E", "mode"),
    "ended": DatasetQuantity("why the computation ended", "1"),
    "impacts": DatasetQuantity("impacts computed, settling included", "1"),
    "evaluations": DatasetQuantity("evaluations of the contact displacement", "1"),
    "cpu_seconds": DatasetQuantity("CPU time of the point", "s"),
}


#: of maps and batches, beyond those of a response
FURTHER: Mapping[str, DatasetQuantity] = {
    "energy": DatasetQuantity("time-mean energy of all modes", "E"),
    "lyapunov": DatasetQuantity("largest Lyapunov exponent", "s-1"),
    "lyapunov_error": DatasetQuantity("standard error of the largest Lyapunov exponent", "s-1"),
    "strobes": DatasetQuantity("output at the end of the last drive periods", "q"),
    "error": DatasetQuantity("standard error of the mean of motions that do not repeat", "q"),
    "kind": DatasetQuantity("period, or -1 no contact, 0 no repeat, -2 failed", "1"),
    "admissible": DatasetQuantity("1: clear of the stop between impacts, proved", "1"),
    "stable": DatasetQuantity("1: clear, and all multipliers within the unit circle", "1"),
}


def unit_of(quantity: DatasetQuantity, units: OutputUnits) -> str:
    """Unit as text."""
    plain = units.length == "1"
    named = {
        "q": units.output,
        "q/s": units.rate,
        "c": units.length,
        "c/s": "s-1" if plain else f"{units.length} s-1",
        "E": "s-2" if plain else "J",
    }
    return named.get(quantity.unit, quantity.unit)


class CodedEnum(Enum):
    """Enumeration whose members have numbers in arrays, kernels and files: their order."""

    code: int

    def __init__(self, _: object) -> None:
        self.code = len(type(self).__members__)

    @classmethod
    def of_code(cls, code: int) -> Self:
        """Member with a given number."""
        return list(cls)[code]


class Ended(CodedEnum):
    """Reason why a computation ended: the value is the message, the order is the code in kernels and files.

    >>> import vibeam
    >>> vibeam.Ended.COMPLETE.code, vibeam.Ended.of_code(0).value
    (0, 'ran to the end')
    """

    COMPLETE = "ran to the end"
    EVENT_LIMIT = "stopped at the limit of impacts: raise it, or look for an endless chatter (R = 1 on a pressed stop)"
    PENETRATED = "the start lies beyond the stop: start from a state with contact displacement ≤ gap"
    NOT_FINITE = "a number overflowed: the response grew beyond all bounds"
    NOT_RUN = "not run yet"
    NO_ORBIT = "no stable motion of the kind this solver looks for at this frequency"
    UNRESOLVED = (
        "the next event was not found in bounded work: some modes, or the contact's own damping, are far too fast "
        "beside it; keep fewer modes, or damp the contact less"
    )
