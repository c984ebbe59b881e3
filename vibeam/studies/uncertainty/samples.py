"""Samples of the uncertain inputs, and the sweeps of the fidelities at each of them, many side by side."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from time import thread_time
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.fidelity import gap_drift, gap_wear, system
from vibeam.runs.comparison.errors import Asked, ResponseComparison, asked_of
from vibeam.runs.comparison.places import places_of
from vibeam.runs.comparison.responses import Response, compared
from vibeam.runs.parallel import heartbeat
from vibeam.runs.side_by_side import SystemSweep, sweep_side_by_side
from vibeam.runs.sweep import SweepPoints, SweepSettings
from vibeam.store.blocks import Values
from vibeam.store.shares import are_shared, evaluate_each
from vibeam.system.response import FrequencyResponse, complete
from vibeam_models.arrays import Array, Flags
from vibeam_models.base_motion import drive_amplitude

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Model
    from vibeam.case.study_plans import Uncertain

TOGETHER = 64  # samples of a block: lanes are filled, and all threads have some
STEPS = 256  # blocks at least of a computation that is shared


def inputs_of(uncertain: Sequence[Uncertain], shares: Array) -> Array:
    """Values (…, d) of the inputs at shares (…, d) in (0, 1) of their distributions, by their inverse functions."""
    from scipy.stats import norm

    columns = [
        each.first + each.second * norm.ppf(share)
        if each.kind == "normal"
        else each.first + (each.second - each.first) * share
        for each, share in zip(uncertain, np.moveaxis(shares, -1, 0), strict=True)
    ]
    return np.stack(columns, axis=-1)


@dataclass(frozen=True)
class Responses:
    """Responses of one fidelity to m inputs: ``amplitude`` (m, points) in the sweep's first direction.

    NaN where a point failed. ``peak`` (m,) and ``peak_frequency`` (m,) Hz; ``jump`` (m,) Hz: where period 1 around the
    peak ends in the way of the sweep; ``begin`` (m,) Hz: where impacts begin; ``doubling`` (m,) Hz: where period 1
    becomes 2; NaN where that does not happen, or before the first point. ``amplitude_error`` (m,) and ``end_error``
    (m,): beside the finest fidelity, of ends of branches and kinds to the sweep's grid; ``suffices`` (m,) beside
    that: 1 it does, 0 it does not, NaN: the grid leaves it open. Of the finest itself NaN, NaN and 1.
    ``seconds`` (m,): CPU time of each, the model's making included.
    """

    fidelity: str
    amplitude: Array
    peak: Array
    peak_frequency: Array
    jump: Array
    begin: Array
    doubling: Array
    amplitude_error: Array
    end_error: Array
    suffices: Array
    seconds: Array

    @property
    def failed(self) -> int:
        """Number of samples with a point that failed."""
        return int(np.count_nonzero(np.isnan(self.amplitude).any(axis=1)))


@dataclass(frozen=True)
class Sampler:
    """Sweeps of a case at other values of its uncertain inputs."""

    case: Case
    keys: tuple[str, ...]

    @cached_property
    def _models(self) -> Mapping[str, Model]:
        return {name: self.case.model(name) for name in self.case.fidelities}

    def nominal(self, fidelity: str) -> Responses:
        """Response at the case's own values, to the bit that of the run."""
        begun = thread_time()
        asked = _sweep_of(self._models[fidelity], self.case)
        making = thread_time() - begun
        row = _values({fidelity: asked.alone()}, making, asked_of(self.case))
        return _gathered(fidelity, [{key: value[None] for key, value in row.items()}])

    def each(
        self, inputs: Array, asked: Mapping[str, Flags], tell: Callable[[str], None] | None = None
    ) -> dict[str, Responses]:
        """Responses to those of inputs (m, d) that each fidelity is ``asked`` for (m,): one round of evaluations.

        ``tell``: hears every few seconds how many are there. CaseError for a value that the case may not have.
        """
        for name in asked:
            for extreme in (inputs.min(axis=0), inputs.max(axis=0)):
                self._at(name, extreme).checked()
        step = self._together(asked, len(inputs))
        blocks, found = range(0, len(inputs), step), dict[int, Values]()

        def block(first: int) -> Values:
            here = slice(first, first + step)
            return self._block(inputs[here], {name: which[here] for name, which in asked.items()})

        with heartbeat(tell, lambda: f"{min(step * len(found), len(inputs))} of {len(inputs)} samples"):
            each = [(name, which.tobytes()) for name, which in asked.items()]
            of = repr([self.case.numbers, self.keys, inputs.tobytes(), step, *each])
            evaluate_each("sweeps", of, blocks, block, found.__setitem__)
        return {name: _gathered(name, [found[first] for first in blocks]) for name in asked}

    def _at(self, fidelity: str, values: Array) -> Model:
        return self._models[fidelity].at(dict(zip(self.keys, values, strict=True)))

    def _together(self, asked: Mapping[str, Flags], samples: int) -> int:
        """Samples of a block; one where no fidelity is swept in lanes."""
        if not any(_sweep_of(self._models[name], self.case).in_lanes for name in asked):
            return 1
        return max(1, min(TOGETHER, samples // STEPS)) if are_shared() else TOGETHER

    def _block(self, inputs: Array, asked: Mapping[str, Flags]) -> Values:
        """Values of samples next to each other; the fidelities of a sample are made together, of one structure."""
        places = [(at, name) for at in range(len(inputs)) for name in asked if asked[name][at]]
        begun = thread_time()
        sweeps = [_sweep_of(self._at(name, inputs[at]), self.case) for at, name in places]
        making = (thread_time() - begun) / len(sweeps)
        swept = dict(zip(places, sweep_side_by_side(sweeps), strict=True))
        rows = [
            _values({name: swept[at, name] for name in asked if (at, name) in swept}, making, asked_of(self.case))
            for at in range(len(inputs))
        ]
        keys = {key for row in rows for key in row}
        return {key: np.stack([row[key] for row in rows if key in row]) for key in sorted(keys)}


def _sweep_of(model: Model, case: Case) -> SystemSweep:
    """Sweep of a fidelity in the case's first direction."""
    fidelity, plan, scene = model.fidelity, case.sweep, model.scene()
    omega = np.sort(2 * np.pi * plan.frequency)[:: -1 if plan.direction == "down" else 1]
    made, drift = system(scene, fidelity), gap_drift(scene, omega)
    points = SweepPoints.of(omega, drive_amplitude(scene, omega), drift=drift)
    settings = SweepSettings(
        plan.settle, plan.hold, fidelity.solver, plan.output, fidelity.options, gap_wear(scene), scene.harmonics
    )
    return SystemSweep(made, points, settings.checked(made))


def _values(responses: Mapping[str, FrequencyResponse], making: float, asked: Asked) -> Values:
    """Numbers kept of the responses of one sample by fidelity, the finest last; ``making``: CPU time of a model."""
    found: dict[str, Any] = {}
    places = {name: Response({"": places_of(each)}) for name, each in responses.items()}
    *_, top_places = places.values()
    for name, response in responses.items():
        amplitude, top = np.where(complete(response), response.amplitude, np.nan), response.peak
        seconds = making + float(response.cpu_seconds.sum())
        alone = places[name] is top_places
        off = (np.nan, np.nan, 1.0) if alone else errors_of(compared(places[name], top_places, asked.frequency), asked)
        numbers = (top.amplitude, top.frequency, _jump(response), *_changes(response), *off, seconds)
        found[f"{name} amplitude"] = amplitude[np.argsort(response.frequency)]
        found[f"{name} numbers"] = np.array(numbers)
    return found


def errors_of(found: ResponseComparison, asked: Asked) -> tuple[float, float, float]:
    """Amplitude error, the larger of frequency error and widest difference in kind; 1 where it suffices, NaN: open."""
    enough = found.suffices(asked)
    return found.amplitude_error, max(found.frequency_error, found.kind_width), np.nan if enough is None else enough


def _gathered(fidelity: str, blocks: Sequence[Values]) -> Responses:
    amplitude, numbers = (
        np.concatenate([block[key] for block in blocks if key in block])
        for key in (f"{fidelity} amplitude", f"{fidelity} numbers")
    )
    return Responses(fidelity, amplitude, *numbers.T)


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
