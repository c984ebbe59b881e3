"""Samples of the uncertain inputs, and the response of a fidelity to each of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import thread_time
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.fidelity import gap_drift, gap_wear, system
from vibeam.runs.parallel import heartbeat, run_parallel
from vibeam.runs.sweep import sweep
from vibeam.system.response import FrequencyResponse, complete
from vibeam_models.arrays import Array
from vibeam_models.base_motion import drive_amplitude

if TYPE_CHECKING:
    from threading import Event

    from vibeam.case.case import Case
    from vibeam.case.fidelity import Model
    from vibeam.case.plans import Uncertain


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
    def of_amplitude(
        cls, fidelity: str, inputs: Array, frequency: Array, amplitude: Array, seconds: Array
    ) -> Responses:
        """Responses known by their amplitudes (m, points) at frequencies (points,) Hz alone."""
        filled = np.where(np.isfinite(amplitude), amplitude, -np.inf)
        top, some = np.argmax(filled, axis=1), np.isfinite(amplitude).any(axis=1)
        peak = np.where(some, filled[np.arange(len(filled)), top], np.nan)
        at = np.where(some, frequency[top], np.nan)
        unknown = np.full(len(inputs), np.nan)
        return cls(fidelity, inputs, amplitude, peak, at, unknown, unknown, unknown, seconds)

    @property
    def failed(self) -> int:
        """Number of samples with a point that failed."""
        return int(np.count_nonzero(np.isnan(self.amplitude).any(axis=1)))


@dataclass(frozen=True)
class Coarse:
    """A cheaper sweep: every so many frequencies, at most so many periods left out and read."""

    every: int = 8
    settle: int = 60
    hold: int = 10


@dataclass(frozen=True)
class Sampler:
    """Sweeps of a case at other values of its uncertain inputs; ``coarse``: of fewer frequencies and periods."""

    case: Case
    keys: tuple[str, ...]
    coarse: Coarse | None = None

    def nominal(self, fidelity: str) -> Responses:
        """Response at the case's own values."""
        return self._gathered(fidelity, (), np.empty((1, 0)))

    def __call__(self, fidelity: str, inputs: Array, tell: Callable[[str], None] | None = None) -> Responses:
        """Responses to inputs (m, d), several at once; CaseError for a value that the case may not have.

        ``tell``: hears every few seconds how many are there.
        """
        for extreme in (inputs.min(axis=0), inputs.max(axis=0)):
            self.case.model(fidelity).at(dict(zip(self.keys, extreme, strict=True))).checked()
        return self._gathered(fidelity, self.keys, inputs, tell)

    def _gathered(
        self, fidelity: str, keys: Sequence[str], inputs: Array, tell: Callable[[str], None] | None = None
    ) -> Responses:
        model = self.case.model(fidelity)
        rows: list[tuple[Array, Array]] = [(np.empty(0), np.empty(0))] * len(inputs)

        def one(index: int, stop: Event) -> None:
            rows[index] = self._row(model.at(dict(zip(keys, inputs[index], strict=True))))

        with heartbeat(tell, lambda: f"{fidelity}: {sum(len(each) > 0 for each, _ in rows)} of {len(rows)} sweeps"):
            run_parallel(one, list(range(len(inputs))))
        amplitudes, numbers = (np.stack(each) for each in zip(*rows, strict=True))
        return Responses(fidelity, inputs, amplitudes, *numbers.T)

    def _row(self, model: Model) -> tuple[Array, Array]:
        begin = thread_time()
        response = self._swept(model)
        top, changes = response.peak, _changes(response)
        numbers = (top.amplitude, top.frequency, _jump(response), *changes, thread_time() - begin)
        return np.where(complete(response), response.amplitude, np.nan), np.array(numbers)

    def _swept(self, model: Model) -> FrequencyResponse:
        fidelity, plan, coarse = model.fidelity, self.case.sweep, self.coarse
        scene = model.scene()
        omega = np.sort(2 * np.pi * plan.frequency)[:: coarse.every if coarse else 1]
        found: Any = sweep(
            system(scene, fidelity),
            omega=omega,
            amplitude=drive_amplitude(scene, omega),
            direction="down" if plan.direction == "down" else "up",
            settle=min(plan.settle, coarse.settle) if coarse else plan.settle,
            hold=min(plan.hold, coarse.hold) if coarse else plan.hold,
            solver=fidelity.solver,
            options=fidelity.options,
            output=plan.output,
            drift=None if gap_drift(scene, omega) is None else lambda at: np.asarray(gap_drift(scene, at)),
            wear=gap_wear(scene),
            harmonics=scene.harmonics,
        )
        return found  # type: ignore[no-any-return]


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
