"""Keys of a case from measured modal frequencies: least squares, intervals, and what the frequencies cannot separate.

Measured are the [measured.NAME] with quantity = "mode_frequency"; σ is their uncertainty.
Minimised is Σ ((f_model − f_measured)/σ)² over the logarithms of the keys, so that a section, a mass, an inertia, a
rigid zone or a spring stays above 0, from the case's values. Derivatives are central differences of the model, of which
every evaluation is a case of its own: what a fidelity sets itself stays. Where the frequencies do not fix a direction
(``estimates``), keys that take part in it have no value.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vibeam.case.case import Case
from vibeam.case.plans import MeasuredNumber
from vibeam.case.source import of_source
from vibeam.exchange.faults import suggest
from vibeam.runs.result import Result
from vibeam.studies.fit.linear_estimates import Identification, by_logarithms, estimates, spread_of
from vibeam.studies.regression.readings import read
from vibeam_models.arrays import Array

QUANTITY = "mode_frequency"
STEP = 1e-4  # of a logarithm, for differences
FURTHEST = np.log(20.0)  # factor from the start
UNLIKELY = 1e-3  # probability of the misfit below which the intervals do not hold


@of_source
def identify_keys(case: Case, keys: Sequence[str], measured: Sequence[str] = ()) -> Identification:
    """Values of ``keys`` of a case (``"beam.thickness"``), in SI, from its measured modal frequencies.

    ``measured``: names of those used; empty: all. ValueError for a key without a value above 0 in the case, a measured
    frequency without uncertainty, or none at all.

    >>> import vibeam
    >>> number = {"fidelity": "beam", "quantity": "mode_frequency", "number": 1, "value": "7.6 Hz"}
    >>> measured = {"measured.first": number | {"uncertainty": "0.1 %", "source": "a decay"}}
    >>> case = vibeam.load("cases/dtu_neutral.toml", measured | {"beam.elements": 6})
    >>> round(1e3 * vibeam.identify_keys(case, ["beam.thickness"]).rows[0].value, 3)  # mm
    1.034
    """
    from scipy.optimize import least_squares

    start = np.array([_value(case, key) for key in _distinct(keys)])
    used = _used(case, measured)
    value, sigma = (np.array([getattr(each, name) for each in used], float) for name in ("value", "uncertainty"))

    def deviations(values: Array) -> Array:
        try:
            return np.asarray((_frequencies(case, dict(zip(keys, values.tolist(), strict=True)), used) - value) / sigma)
        except ValueError:  # no such case: the search turns back there
            return np.full(len(used), np.inf)

    def slopes(values: Array) -> Array:
        return by_logarithms(deviations, values, STEP)

    _frequencies(case, {}, used)  # a fault of the case itself is told
    found = least_squares(
        lambda at: deviations(start * np.exp(at)), np.zeros(len(keys)), jac=lambda at: slopes(start * np.exp(at)),
        bounds=(-FURTHEST, FURTHEST), xtol=1e-10, ftol=1e-12, gtol=1e-10,
    )  # fmt: skip
    best = start * np.exp(found.x)
    spread = spread_of(slopes(best), None, keys)
    rows = estimates(keys, best.tolist(), spread.half, [case.keys.unit(key) for key in keys])
    left = float(np.sqrt(np.mean((found.fun * sigma / value) ** 2)))
    method = f"{len(used)} measured modal frequencies, least squares"
    return Identification(rows, method, len(used), left, spread.directions, tuple(_notes(used, found.fun, spread.half)))


def _frequencies(case: Case, settings: dict[str, float], used: Sequence[MeasuredNumber]) -> Array:
    """Modal frequencies (Hz) of the case with other values of keys.

    ValueError where these make no case, or there is no such mode.
    """
    result, found = Result(case.with_keys(settings), {}), []
    for each in used:
        reading = read(each, result, "up")
        if reading.fault:
            raise ValueError(f"measured.{each.name}: {reading.fault}")
        found.append(reading.number)
    return np.array(found)


def _used(case: Case, names: Sequence[str]) -> list[MeasuredNumber]:
    known = {name: each for name, each in case.measured.items() if each.quantity == QUANTITY}
    for name in names:
        if name not in known:
            raise ValueError(f"no [measured.{name}] with quantity = {QUANTITY!r}; {suggest(name, known)}")
    used = [known[name] for name in dict.fromkeys(names)] or list(known.values())
    if not used:
        _ = case.sweep  # CaseError of a record case, in which there can be none
        raise ValueError(f"no [measured.NAME] with quantity = {QUANTITY!r}: write what was measured")
    without = [each.name for each in used if not each.uncertainty]
    if without:
        raise ValueError(f"measured.{without[0]}.uncertainty is missing: the weight of a frequency is its uncertainty")
    return used


def _distinct(keys: Sequence[str]) -> Sequence[str]:
    if not keys:
        raise ValueError("no key to identify: name one, such as beam.thickness")
    if len({*keys}) < len(keys):
        raise ValueError(f"{next(key for key in keys if list(keys).count(key) > 1)} is named twice: once is enough")
    return keys


def _value(case: Case, key: str) -> float:
    """Value of a key that the case gives; ValueError where it gives none above 0."""
    found = case.keys.value(key)
    if found is None:
        raise ValueError(f"{key} is not in the case: give it a value to start from")
    if isinstance(found, bool) or not isinstance(found, int | float) or not found > 0:
        raise ValueError(f"{key} = {found!r} is no number above 0 to start from")
    return float(found)


def _notes(used: Sequence[MeasuredNumber], deviations: Array, half: Array) -> list[str]:
    from scipy.stats import chi2

    shown = ", ".join(f"{each.name} {off:+.2g} σ" for each, off in zip(used, deviations.tolist(), strict=True))
    notes = [f"model − measured: {shown}"]
    free = len(used) - int(np.sum(np.isfinite(half)))
    misfit = float(np.sum(deviations**2))
    if free > 0 and chi2.sf(misfit, free) < UNLIKELY:
        told = f"the model misses the frequencies by more than their σ (χ² = {misfit:.3g} for {free} to spare)"
        notes.append(f"{told}: the intervals do not hold")
    if chosen := [each.name for each in used if each.chose]:
        notes.append(f"{', '.join(chosen)}: used as the others, though keys of the case were chosen by them")
    return notes
