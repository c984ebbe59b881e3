"""Samples of the uncertain inputs, and the response of a fidelity to each of them: by a sweep, or by a surrogate.

As control variates they may be off by any amount (jumps, folds), if only they follow the peak of the sweep. The closed
form is the largest stable motion with one impact a period, or none: which of the motions a sweep would be on is not
asked. The surface is fitted by least squares to runs of its own, so that it is
independent of those that an estimate is made of.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement
from time import thread_time
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.fidelity import gap_drift, gap_wear, system
from vibeam.periodic.motions import closed_curve, unsuited
from vibeam.runs.closed_motions import without_closed_forms
from vibeam.runs.parallel import heartbeat
from vibeam.runs.sweep import sweep
from vibeam.store.blocks import Values
from vibeam.store.shares import evaluate_each, sharing
from vibeam.system.response import FrequencyResponse, complete
from vibeam_models.arrays import Array
from vibeam_models.base_motion import drive_amplitude

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Model
    from vibeam.case.study_plans import Uncertain


def inputs_of(uncertain: Sequence[Uncertain], shares: Array) -> Array:
    """Values (m, d) of the inputs at shares (m, d) in (0, 1) of their distributions, by their inverse functions."""
    from scipy.stats import norm

    columns = [
        each.first + each.second * norm.ppf(share)
        if each.kind == "normal"
        else each.first + (each.second - each.first) * share
        for each, share in zip(uncertain, shares.T, strict=True)
    ]
    return np.column_stack(columns)


@dataclass(frozen=True)
class Responses:
    """Responses of one fidelity to ``inputs`` (m, d): ``amplitude`` (m, points) in the sweep's first direction.

    NaN where a point failed. ``peak`` (m,) and ``peak_frequency`` (m,) Hz; ``jump`` (m,) Hz: where period 1 around the
    peak ends in the way of the sweep; ``begin`` (m,) Hz: where impacts begin; ``doubling`` (m,) Hz: where period 1
    becomes 2; NaN where that does not happen, or before the first point. ``seconds`` (m,): CPU time of each, the
    model's making included.
    """

    fidelity: str
    inputs: Array
    amplitude: Array
    peak: Array
    peak_frequency: Array
    jump: Array
    begin: Array
    doubling: Array
    seconds: Array

    @classmethod
    def of_peaks(cls, fidelity: str, inputs: Array, peak: Array, seconds: Array) -> Responses:
        """Responses known by their peaks (m,) alone."""
        unknown = np.full(len(inputs), np.nan)
        return cls(fidelity, inputs, peak[:, None], peak, unknown, unknown, unknown, unknown, seconds)

    @property
    def failed(self) -> int:
        """Number of samples with a point that failed."""
        return int(np.count_nonzero(np.isnan(self.amplitude).any(axis=1)))


EVERY, SETTLE, HOLD = 8, 60, 10  # of a coarse sweep: every so many frequencies, most periods left out and read


@dataclass(frozen=True)
class Sampler:
    """Sweeps of a case at other values of its uncertain inputs; ``coarse``: of fewer frequencies and periods."""

    case: Case
    keys: tuple[str, ...]
    coarse: bool = False

    def nominal(self, fidelity: str) -> Responses:
        """Response at the case's own values."""
        with sharing(None):
            return replace(self, keys=())(fidelity, np.empty((1, 0)))

    def __call__(self, fidelity: str, inputs: Array) -> Responses:
        """Responses to inputs (m, d), several at once; CaseError for a value that the case may not have."""
        return self.each({fidelity: inputs})[fidelity]

    def each(self, asked: Mapping[str, Array], tell: Callable[[str], None] | None = None) -> dict[str, Responses]:
        """Responses of fidelities, by name, to inputs (m, d) each, as ``__call__``: one round of evaluations.

        ``tell``: hears every few seconds how many are there.
        """
        models, rows = {name: self.case.model(name) for name in asked}, dict[tuple[str, int], Values]()
        for name, inputs in asked.items():
            for extreme in (inputs.min(axis=0), inputs.max(axis=0)):
                models[name].at(dict(zip(self.keys, extreme, strict=True))).checked()
        every = [(name, at) for name, inputs in asked.items() for at in range(len(inputs))]

        def row(place: tuple[str, int]) -> Values:
            name, at = place
            return self._row(models[name].at(dict(zip(self.keys, asked[name][at], strict=True))))

        with heartbeat(tell, lambda: f"{len(rows)} of {len(every)} sweeps"):
            of = repr([self.case.numbers, self.keys, *((name, own.tobytes()) for name, own in asked.items())])
            evaluate_each("sweeps", of, every, row, rows.__setitem__)
        return {name: _gathered(name, own, [rows[name, at] for at in range(len(own))]) for name, own in asked.items()}

    def _row(self, model: Model) -> Values:
        begin = thread_time()
        response = self._swept(model)
        top, changes = response.peak, _changes(response)
        numbers = (top.amplitude, top.frequency, _jump(response), *changes, thread_time() - begin)
        amplitude = np.where(complete(response), response.amplitude, np.nan)
        return {"amplitude": amplitude, "numbers": np.array(numbers)}

    def _swept(self, model: Model) -> FrequencyResponse:
        fidelity, plan, coarse = model.fidelity, self.case.sweep, self.coarse
        scene = model.scene()
        omega = np.sort(2 * np.pi * plan.frequency)[:: EVERY if coarse else 1]
        found: Any = sweep(
            system(scene, fidelity),
            omega=omega,
            amplitude=drive_amplitude(scene, omega),
            direction="down" if plan.direction == "down" else "up",
            settle=min(plan.settle, SETTLE) if coarse else plan.settle,
            hold=min(plan.hold, HOLD) if coarse else plan.hold,
            solver=fidelity.solver,
            options=fidelity.options,
            output=plan.output,
            drift=None if gap_drift(scene, omega) is None else lambda at: np.asarray(gap_drift(scene, at)),
            wear=gap_wear(scene),
            harmonics=scene.harmonics,
        )
        return found  # type: ignore[no-any-return]


def _gathered(fidelity: str, inputs: Array, rows: Sequence[Values]) -> Responses:
    amplitude, numbers = (np.stack([row[part] for row in rows]) for part in ("amplitude", "numbers"))
    return Responses(fidelity, inputs, amplitude, *numbers.T)


def _jump(response: FrequencyResponse) -> float:
    found = response.period_one
    if found is None:
        return float("nan")
    return found[1] if response.frequency[-1] >= response.frequency[0] else found[0]


def _changes(response: FrequencyResponse) -> tuple[float, float]:
    """First frequencies (Hz), in the way of the sweep, with impacts after none and with period 2 after 1; NaN: none."""
    done = complete(response)
    struck = done & (response.impacts_per_period > 0)
    once, twice = struck & (response.period == 1), struck & (response.period == 2)
    return _first(response, done & ~struck, struck), _first(response, once, twice)


def _first(response: FrequencyResponse, before: Any, after: Any) -> float:
    found = np.flatnonzero(before[:-1] & after[1:])
    return float(response.frequency[found[0] + 1]) if len(found) else float("nan")


@dataclass(frozen=True)
class ClosedFormPeaks:
    """Closed-form peaks of a case at other values of its uncertain inputs, over the frequencies of its sweep."""

    case: Case
    keys: tuple[str, ...]

    def __call__(self, fidelity: str, inputs: Array) -> Responses:
        """Responses to inputs (m, d): their peaks alone; NaN where a system has no closed form."""
        model, omega = self.case.model(fidelity), np.sort(2 * np.pi * self.case.sweep.frequency)
        peak, seconds = np.empty(len(inputs)), np.empty(len(inputs))
        for number, values in enumerate(inputs):
            begin = thread_time()
            scene = model.at(dict(zip(self.keys, values, strict=True))).scene()
            base = np.broadcast_to(np.asarray(drive_amplitude(scene, omega), dtype=float), omega.shape)
            peak[number] = closed_curve(system(scene, model.fidelity), omega, base, self.case.sweep.output).peak
            seconds[number] = thread_time() - begin
        return Responses.of_peaks(fidelity, inputs, peak, seconds)


def known(case: Case, fidelity: str) -> bool:
    """Test whether a fidelity's drive, gap and output have closed forms."""
    made, omega = case.system(fidelity), 2 * np.pi * case.sweep.frequency
    refused = without_closed_forms(case.scene_of(fidelity), omega) or unsuited(made)
    return not refused and made.derivative(case.sweep.output) is None


RUNS = 3  # a coefficient
FAR = 2.0  # standard deviations of an input, beyond which a surface goes on straight: few of its runs are there


@dataclass(frozen=True)
class Surface:
    """Polynomial Σ ``coefficients`` · terms of the inputs about ``middle`` in units of ``scale``.

    ``seconds``: CPU time of the runs that it is fitted to.
    """

    middle: Array
    scale: Array
    coefficients: Array
    seconds: float

    @classmethod
    def of(cls, model: Callable[[str, Array], Responses], fidelity: str, inputs: Array) -> Surface | None:
        """Surface through a model's peaks at ``inputs`` (m, d); None where too few of them have a peak."""
        found = model(fidelity, inputs)
        known = np.isfinite(found.peak)
        middle, spread = inputs.mean(axis=0), inputs.std(axis=0)
        scale = np.where(spread > 0, spread, 1.0)
        rows = terms((inputs - middle) / scale)
        if known.sum() < 2 * rows.shape[1]:
            return None
        coefficients = np.asarray(np.linalg.lstsq(rows[known], found.peak[known], rcond=None)[0], dtype=float)
        return cls(middle, scale, coefficients, float(found.seconds.sum()))

    def __call__(self, fidelity: str, inputs: Array) -> Responses:
        """Responses to inputs (m, d): their peaks alone."""
        begin = thread_time()
        peak = terms((inputs - self.middle) / self.scale) @ self.coefficients
        each = np.full(len(inputs), (thread_time() - begin) / max(len(inputs), 1))
        return Responses.of_peaks(fidelity, inputs, peak, each)


def runs(inputs: int) -> int:
    """Number of runs that a surface over so many inputs is fitted to."""
    return RUNS * (inputs + 1) * (inputs + 2) // 2


def terms(x: Array) -> Array:
    """Terms (m, k) of a polynomial of degree two in x (m, d), whose second degree stays beyond ±FAR as it is there."""
    columns, near = [np.ones(len(x)), *x.T], np.clip(x, -FAR, FAR)
    columns += [near[:, i] * near[:, j] for i, j in combinations_with_replacement(range(x.shape[1]), 2)]
    return np.column_stack(columns)
