"""Curves that a case reads of files, as they were read: measured references, inputs over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.input_plan import WAYS, InputPlan
from vibeam.exchange.curves.record import Taken, taken_told
from vibeam.exchange.time_series import EVEN, UNITS, samples_of_file
from vibeam.studies.measured_panel import MeasuredCurve, label

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.plans import Reference


def measured_files(case: Case) -> tuple[list[Reference], list[InputPlan]]:
    """Measured references of a case, and its inputs that are files; none of them is read.

    A reference in a file of vibeam's own form, without a window, is measured where the case says so.
    """
    references = [each for each in case.references.values() if each.measured or each.form.window or not each.form.own]
    return references, [*dict.fromkeys(each for each in case.inputs.values() if each.file is not None)]


def measured_curves(case: Case) -> list[MeasuredCurve]:
    """All points of the measured curves of a case, and which it uses; CaseError where a file cannot be read."""
    references, inputs = measured_files(case)
    return [*map(_of_reference, references), *(_of_input(each, case) for each in inputs)]


def _of_reference(reference: Reference) -> MeasuredCurve:
    """Points of a reference; used are those in its window, on the branches that are compared."""
    curve = reference.read()
    compared = {*curve.along(("up", "down") if reference.direction == "both" else (reference.direction,))}
    with taken_told(lambda _: None):
        whole = replace(reference, form=replace(reference.form, window=None)).read()
    used = np.array([point in compared for point in whole.points], dtype=bool)
    head = reference.quantity if curve.taken is None else curve.taken.columns[0].head
    labels = label("frequency", "Hz"), label(head or reference.quantity, reference.form.unit)
    return MeasuredCurve(whole.frequency, whole.value, used, None, labels, f"{reference.name}, {reference.file.name}")


def _of_input(plan: InputPlan, case: Case) -> MeasuredCurve:
    """Samples of a file that drives; used are those that a run takes, at the highest of several speeds."""
    assert case.record is not None
    duration = case.record.duration * (max(case.record.values) if case.record.over == "speed" else 1.0)
    kept = plan.measured(duration).taken
    return _in_run(Path(plan.file or ""), duration, kept, plan.said(*WAYS["file"]))


def _in_run(path: Path, duration: float, kept: Taken, said: Mapping[str, Any]) -> MeasuredCurve:
    """All samples of a file by the keys of a case; used are those that were ``kept``, in a run of ``duration`` s."""
    quantity = said.get("quantity", "acceleration")
    keys = (said.get(each) for each in ("unit", "rate", "scale"))
    _, _, value, clock = samples_of_file(path, said.get("column"), said.get("time"), quantity, *keys)
    zero = kept.zero or 0.0
    first, last = max(kept.start, zero), min(kept.end, zero + duration * (1 + EVEN / len(clock)))
    used = (clock >= first) & (clock <= last)
    labels = label("time", "s"), label(kept.columns[0].head or quantity, UNITS[quantity])
    return MeasuredCurve(clock, value, used, None, labels, kept.file, True)
