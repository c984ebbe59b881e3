"""Numbers read off a result under a record: of a signal, the impacts, an energy, or of two fidelities."""

from __future__ import annotations

from math import isclose, isfinite

import numpy as np

from vibeam.case.plans import ResultNumber
from vibeam.case.transient_quantities import QUANTITIES
from vibeam.runs.transient.comparison import compared
from vibeam.runs.transient.result import TransientResult
from vibeam.runs.transient.statistics import SampleMean, mean_of, paired
from vibeam.runs.transient.transient import Transient
from vibeam.studies.regression.number_read import NAN, NumberRead
from vibeam.system.response import Ended
from vibeam_models.arrays import Array

SAME = 1e-9  # relative difference of values that are one


def read_transient(reading: ResultNumber, result: TransientResult) -> NumberRead:
    """Number of a reading: of one seed, or the mean over all, of which a note says the standard error.

    With ``against`` the paired difference from that fidelity on the same realisations, as a share of its mean.
    """
    at, fault = _value(reading, result)
    if fault:
        return NumberRead(NAN, fault, absent=True)
    if QUANTITIES[reading.quantity].of == "pair":
        return _horizon(reading, result, at)
    ours = _row(reading, result, result[reading.fidelity], at)
    if reading.against is None:
        return _read(mean_of(ours), result[reading.fidelity], at)
    return _read(paired(ours, _row(reading, result, result[reading.against], at)), result[reading.fidelity], at)


def _value(reading: ResultNumber, result: TransientResult) -> tuple[int, str]:
    """Index of the value that is meant, or why there is none."""
    if reading.at is None:
        return 0, ""
    for number, value in enumerate(result.factors):
        if isclose(value, reading.at, rel_tol=SAME):
            return number, ""
    return 0, f"{result.over} = {reading.at:g} is not among record.values"


def _row(reading: ResultNumber, result: TransientResult, of: Transient, at: int) -> Array:
    """Numbers of the realisations that are meant."""
    mode = None if reading.number is None else int(reading.number)
    if mode is not None and not 1 <= mode <= of.modes:
        return np.full(1, np.nan)
    signal = reading.output if QUANTITIES[reading.quantity].of == "signal" else None
    found = of.of(reading.quantity, signal, mode)[at]
    return np.asarray(found if reading.seed is None else found[[result.seeds.index(reading.seed)]])


def _read(found: SampleMean, of: Transient, at: int) -> NumberRead:
    if not isfinite(found.mean):
        ended = [Ended.of_code(int(code)) for code in of.ended[at]]
        why = next((each.value for each in ended if each is not Ended.COMPLETE), "there is none")
        return NumberRead(NAN, why)
    error = f"± {found.error:.2g} of {found.n} realisations" if isfinite(found.error) else ""
    return NumberRead(found.mean, note=error)


def _horizon(reading: ResultNumber, result: TransientResult, at: int) -> NumberRead:
    """Horizon of agreement of two fidelities, s: of one seed, or the earliest."""
    assert reading.against is not None  # the case says so
    ours, other = result[reading.fidelity], result[reading.against]
    found = compared(ours, other, result.periods[reading.against], {}).horizon[at]
    if reading.seed is not None:
        found = found[[result.seeds.index(reading.seed)]]
    known = found[np.isfinite(found)]
    return NumberRead(float(known.min())) if len(known) else NumberRead(NAN, "no motion of both is complete")
