"""Overview of rig and load before a run under a record: one sentence, and what is implausible."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.case import plan_of_record
from vibeam.runs.systems import Overview, properties_of
from vibeam.system.number_text import TIMES, prefixed, with_unit
from vibeam.system.record_samples import too_coarse
from vibeam_models.arguments import counted

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.transient.motions import MotionMaker
    from vibeam.system.impact_system import ImpactSystem
    from vibeam.system.record import Record


COARSE = 0.1  # share of its amplitude by which interpolation may be off in a sine at the highest mode


@dataclass(frozen=True)
class RecordOverview(Overview):
    """Overview of a case under a record: its ``load`` and the number of ``motions`` that are still to be flown."""

    load: Record | None = None
    duration: float = 0.0
    motions: int = 0
    remarks: tuple[str, ...] = ()  # on the load, for the modes that there are

    def _driven(self) -> Iterator[str]:
        if self.load is not None and not self.load.peak:
            yield "no load: the motion is free"
        elif self.load is not None:
            of = "base acceleration" if self.load.quantity == "acceleration" else self.load.quantity
            unit = {"acceleration": "m/s^2", "force": "N", "moment": "N m"}[self.load.quantity]
            size = f"{self.load.peak:.4g}" if self.plain else with_unit(self.load.peak, unit)
            yield f"{of} up to {size}, {_time(self.load.duration)}"
        yield f"{counted(self.motions, 'motion')} of {_time(self.duration)}"

    def warnings(self) -> Iterator[str]:
        """Sentence on a load that ends later than the motion."""
        if self.load is not None and self.load.start < self.duration < self.load.end * (1 - 1e-9):
            ends = f"the load lasts {_time(self.load.end)}, the motion ends at {_time(self.duration)}"
            yield f"{ends}: set record.duration"
        yield from self.remarks
        if self.model.damping_ratio >= 1:
            yield f"a damping ratio of {self.model.damping_ratio:.3g} leaves mode 1 no resonance (1 % is 0.01)"


def overview_of_record(makers: Mapping[str, MotionMaker], motions: int) -> RecordOverview:
    """Overview by the finest fidelity with the case's own rig, ``motions`` still to be flown."""
    own = [name for name, each in makers.items() if not (each.fidelity.changes or each.fidelity.without)]
    name = max(own or makers, key=lambda each: makers[each].system(0)[0].size)
    maker = makers[name]
    system = maker.system(0)[0]
    scene, properties = maker.case.scene_of(name), properties_of(maker.case, name, system)
    load = maker.load(largest_level(maker.case), 0)
    plain = scene.natural_unit is not None
    remarks = tuple(remarks_on(load, system, maker.duration))
    return RecordOverview(*scene.bulk, properties, (0.0, 0.0), plain, load, maker.duration, motions, remarks)


def remarks_on(record: Record, system: ImpactSystem, duration: float) -> Iterator[str]:
    """Remarks on an input: too coarse for the highest mode, too short for the lowest, of a run of ``duration`` s.

    They stop nothing: modes beyond a record's samples see its interpolation, and a short record is a short run.
    """
    if record.start < 0:
        yield f"the input begins at {record.start:.6g} s, the motion at 0: what comes before is left out"
    elif record.start >= duration:
        yield f"the input begins at {record.start:.6g} s, when the motion is over: say drive.start or record.duration"
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


def largest_level(case: Case) -> int:
    """Number of the value whose load is the largest: the first where another key than the level is varied."""
    plan = plan_of_record(case)
    return int(np.argmax(np.abs(plan.values))) if plan.over == "level" else 0


def _time(value: float) -> str:
    unit, factor = prefixed(TIMES, value)
    return f"{value * factor:.4g} {unit}"
