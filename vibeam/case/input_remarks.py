"""Remarks on the input of a record case: what of it a fidelity's modes need, and it does not have."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import TYPE_CHECKING

from vibeam.system.number_text import with_unit
from vibeam.system.record_samples import too_coarse

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem
    from vibeam.system.record import Record

COARSE = 0.1  # share of its amplitude by which interpolation may be off in a sine at the highest mode


def input_remarks(case: Case, name: str, seed: int | None = None) -> tuple[str, ...]:
    """Sentences about the input of one fidelity: too coarse for its highest mode, too short for its lowest one.

    They stop nothing: modes beyond a record's samples see its interpolation, and a short record is a short run.
    """
    return tuple(remarks_on(case.input(name, seed), case.system(name), case.record.duration if case.record else 0.0))


def remarks_on(record: Record, system: ImpactSystem, duration: float) -> Iterator[str]:
    """As ``input_remarks``, of a record and a system run for ``duration`` s."""
    if record.start < 0:
        yield f"the input begins at {record.start:.6g} s, the motion at 0: what comes before is left out"
    elif record.start >= duration:
        yield f"the input begins at {record.start:.6g} s, when the motion is over: set record.duration"
    rates = sorted(float(each) for each in system.omega if each > 0)
    if not rates:
        return
    needed = too_coarse(record, rates[-1], COARSE)
    if needed is not None:
        has = 1 / float((record.times[1:] - record.times[:-1]).max())
        yield (
            f"the input has {has:.6g} samples a second, the highest mode, {with_unit(rates[-1] / (2 * pi), 'Hz')}, "
            f"needs {needed:.0f} to be off by {COARSE:.0%} at most: sample faster, or keep fewer modes"
        )
    period = 2 * pi / rates[0]
    if duration < period:
        yield (
            f"the run of {duration:.4g} s is {duration / period:.2g} of a period of the lowest mode, "
            f"{1 / period:.4g} Hz: write a longer record.duration"
        )
