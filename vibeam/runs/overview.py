"""Overview of a rig and its sweep: sizes, masses, modes, damping and gap in one sentence, and what is implausible."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isfinite, nan
from typing import TYPE_CHECKING

from vibeam.system.number_text import FREQUENCIES, LENGTHS, MASSES, Steps, prefixed

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.systems import ModelProperties

NEAR = (0.3, 3.0)  # shares of the sweep's ends between which a mode answers it


@dataclass(frozen=True)
class Overview:
    """Rig and sweep in SI: ``sizes`` of the beam, its length first, ``mass`` of the beam and ``moving_mass`` in kg.

    ``model``: properties of the finest fidelity; ``sweep``: lowest and highest frequency in Hz. Empty or NaN: not
    known; ``plain``: lengths have no dimension.
    """

    sizes: tuple[float, ...]
    mass: float
    moving_mass: float
    model: ModelProperties
    sweep: tuple[float, float]
    plain: bool = False

    def __str__(self) -> str:
        return "; ".join(self._parts())

    def _parts(self) -> Iterator[str]:
        model, (low, high) = self.model, self.sweep
        if self.sizes:
            yield f"beam {' × '.join(map(_length, self.sizes))}, {_shown(MASSES, self.mass)}"
        if isfinite(self.moving_mass):
            yield f"moving mass {_shown(MASSES, self.moving_mass)}"
        closed = f", with the contact closed at {_hertz(model.closed)}" if isfinite(model.closed) else ""
        yield f"mode 1 at {_hertz(model.first)} (ζ {100 * model.damping_ratio:.3g} %){closed}"
        if isfinite(model.second):
            yield f"mode 2 at {_hertz(model.second)}"
        over = f" = {low / model.first:.3g} … {high / model.first:.3g} × mode 1" if model.first > 0 else ""
        yield f"sweep {_hertz(low)} … {_hertz(high)}{over}"
        yield f"static gap {f'{model.gap:.4g}' if self.plain else _length(model.gap)} at the contact"

    @property
    def first(self) -> str:
        """Frequency of mode 1 with its unit."""
        return _hertz(self.model.first)

    @property
    def beside(self) -> bool:
        """Whether mode 1 as it is lies outside the sweep."""
        return not self.sweep[0] <= self.model.first <= self.sweep[1]

    def warnings(self) -> Iterator[str]:
        """Sentences on a sweep far from the first modes, and on a mode 1 that is overdamped."""
        model, (low, high) = self.model, self.sweep
        known = [each for each in (model.first, model.second, model.closed) if isfinite(each) and each > 0]
        if known and not any(NEAR[0] * low <= each <= NEAR[1] * high for each in known):
            closed = f" ({_hertz(model.closed)} with the contact closed)" if isfinite(model.closed) else ""
            swept = f"the sweep, {_hertz(low)} … {_hertz(high)}"
            yield f"mode 1 at {self.first}{closed} is far from {swept}: look at the units of the rig, or move the sweep"
        if model.damping_ratio >= 1:
            yield f"a damping ratio of {model.damping_ratio:.3g} leaves mode 1 no resonance (1 % is 0.01)"


def overview_of(case: Case, models: Mapping[str, ModelProperties]) -> Overview:
    """The overview of a case by its finest fidelity with the case's own rig."""
    plain = [name for name in models if not (case.fidelities[name].changes or case.fidelities[name].without)]
    name = max(plain or models, key=lambda each: models[each].modes)
    scene, grid = case.scene_of(name), case.sweep.frequency
    ends = float(grid.min()), float(grid.max())
    return Overview(*scene.bulk, models[name], ends, scene.natural_unit is not None)


def _shown(steps: Steps, value: float) -> str:
    unit, factor = prefixed(steps, abs(value))
    return f"{value * factor:.4g} {unit}"


def _length(value: float) -> str:
    return _shown(LENGTHS, value)


def _hertz(value: float) -> str:
    return _shown(FREQUENCIES, value) if isfinite(value) else f"{nan}"
