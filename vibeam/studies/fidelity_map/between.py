"""Fidelity map between its places: interpolation within a kind, exact expressions where kinds meet.

Where the four places around are of one kind, values are interpolated (bilinearly). Where they are not, a boundary runs
between them. A motion with one impact a period, and one without contact, are known there in closed form; of systems
that no closed form takes, motions of period 1 are found by shooting from those at the places around. They are ruled out
where there is none (none stable and clear of the stop; the free motion reaches the stop), and valued exactly where
there is one. Of what remains a sweep keeps the kind that it comes with, which is how hysteresis goes on to a fold.

It is verified at places drawn at random, flown anew with more time to settle.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vibeam.batches.batch import batch
from vibeam.case.grid_keys import FREQUENCY
from vibeam.maps.block import SWEPT, onto_stops
from vibeam.maps.irregular import NO_CONTACT, judged
from vibeam.maps.points import GridPoints, scattered
from vibeam.periodic.lift import response_alone
from vibeam.periodic.modal_sums import sums
from vibeam.periodic.motion_at import shot
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import orbits
from vibeam.periodic.shooting import NoOrbit
from vibeam.periodic.stroboscopic import StroboscopicMap
from vibeam.runs.parallel import run_parallel
from vibeam.studies.fidelity_map.judgement import Codes, ComparedModels, MappedMotions, cheapest, doubtful, motions
from vibeam.system.state import State
from vibeam_models.arrays import Array

UP, DOWN = 0, 1
ONE = 1  # period


@dataclass(frozen=True)
class _Cell:
    """The four places around a place: rows, columns and weights (4,)."""

    rows: NDArray[np.int64]
    columns: NDArray[np.int64]
    weights: Array


def _points(found: ComparedModels, model: MappedMotions, hertz: Array, values: Array) -> GridPoints:
    """Systems and drives of a model at scattered places (1, places): Hz and SI values of the key."""
    return scattered(found.case.model(model.name), {found.plan.axes[-2].key: values, FREQUENCY: hertz})


def labels_between(found: ComparedModels, hertz: Array, values: Array) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Index of the cheapest model that suffices at scattered places (places,), by the map alone: nothing is flown.

    And where that is open (places,): scatter decides, or kinds meet of which one has no closed form.
    """
    asked = found.asked
    cells = [_cell(found.values, found.frequency, value, f) for f, value in zip(hertz, values, strict=True)]
    read = [_read(found, model, hertz, values, cells) for model in found.models]
    unclear = np.any([[_unclear(model, cell) for cell in cells] for model in found.models], axis=0)
    return np.asarray(cheapest(read, asked)[0]), np.asarray(doubtful(read, asked)[0] | unclear)


def _unclear(model: MappedMotions, cell: _Cell) -> bool:
    """Test whether kinds meet around a place of which one has no closed form."""
    kinds = model.kind[:, cell.rows, cell.columns]
    return bool(np.any(kinds != kinds[:, :1]) and np.any(~np.isin(kinds, (ONE, NO_CONTACT))))


def _cell(rows: Array, columns: Array, value: float, hertz: float) -> _Cell:
    row = int(np.clip(np.searchsorted(rows, value) - 1, 0, len(rows) - 2))
    column = int(np.clip(np.searchsorted(columns, hertz) - 1, 0, len(columns) - 2))
    up = (value - rows[row]) / (rows[row + 1] - rows[row])
    across = (hertz - columns[column]) / (columns[column + 1] - columns[column])
    weights = np.array([(1 - up) * (1 - across), (1 - up) * across, up * (1 - across), up * across])
    return _Cell(np.array([row, row, row + 1, row + 1]), np.array([column, column + 1, column, column + 1]), weights)


def _read(
    found: ComparedModels, model: MappedMotions, hertz: Array, values: Array, cells: list[_Cell]
) -> MappedMotions:
    """The motions of a model at scattered places (ways, 1, places), as far as the map says."""
    count = len(cells)
    value, error, kind = np.zeros((2, 1, count)), np.zeros((2, 1, count)), np.zeros((2, 1, count), dtype=np.int64)
    coexist = np.ones((1, count), dtype=np.int64)
    points = _points(found, model, hertz, values)
    for place, cell in enumerate(cells):
        kinds = model.kind[:, cell.rows, cell.columns]
        mixed = bool(np.any(kinds != kinds[:, :1]))
        known = None
        if mixed:
            once = [model.state[way, cell.rows, cell.columns][kinds[way] == ONE] for way in (UP, DOWN)]
            known = _Known(points, place, found.plan.output, found.plan.quantity, np.concatenate(once))
        for way in (UP, DOWN):
            at = way, 0, place
            kind[at] = kinds[way, 0] if known is None else _kind(kinds[way], cell.weights, way, known)
            value[at], error[at] = _value(model, way, cell, int(kind[at]), known)
        count_here = model.count[cell.rows, cell.columns]
        same = np.all(count_here == count_here[0])
        coexist[0, place] = count_here[0] if same else 1 + int(_differ(kind[:, 0, place], value[:, 0, place]))
    return replace(model, value=value, error=error, kind=kind, count=coexist, exponent=np.full(value.shape, np.nan))


def _differ(kinds: Codes, values: Array) -> bool:
    return bool(kinds[UP] != kinds[DOWN] or abs(values[UP] - values[DOWN]) > 1e-2 * np.abs(values).max())


class _Known:
    """Motions in closed form at one place, or by shooting; asked for only where kinds meet.

    ``starts`` (m, 2n): states of motions of period 1 at the places around.
    """

    def __init__(self, points: GridPoints, place: int, output: str, quantity: str, starts: Array) -> None:
        self.system, self.drive = points.system_at(place), points.drive_at(place)
        self.output, self.quantity, self.starts = output, quantity, starts

    @cached_property
    def section(self) -> StroboscopicMap:
        """The stroboscopic map here."""
        return StroboscopicMap(self.system, self.drive)

    @cached_property
    def one(self) -> list[Orbit]:
        """Stable motions with impacts that repeat after one period and keep clear of the stop between them."""
        found = self._shot() if self.system.beyond_plain else orbits(self.system, self.drive)
        return [orbit for orbit in found if orbit.stable and orbit.admissible and len(orbit.times)]

    def _shot(self) -> Iterator[Orbit]:
        """Motions near those at the places around."""
        for start in self.starts:
            with suppress(NoOrbit):
                yield shot(self.section, State(*start.reshape(2, -1)), ONE)

    def rules_out(self, kind: int) -> bool:
        """Test whether there is no motion of a kind here."""
        return self.touches if kind == NO_CONTACT else kind == ONE and not self.one

    @cached_property
    def touches(self) -> bool:
        """The motion that the drive alone makes reaches a stop."""
        if not self.system.beyond_plain:
            total = sums(self.system, np.array([self.drive.omega]), 1)
            return bool(abs(total.unit[0]) * self.drive.amplitude + total.offset > self.system.gap)
        alone, drive = response_alone(self.system, self.drive, 0.0), self.drive
        if not np.isfinite(alone.displacement).all():
            return False
        return bool(self.section.runner.steady([drive.omega], drive.amplitude, alone, 0, 1, self.output)[0].impacts[0])

    def keeps(self, kind: int) -> bool:
        """Test whether a sweep that comes with this kind keeps it here."""
        return kind in (ONE, NO_CONTACT) and not self.rules_out(kind)

    def value(self, nearest: float) -> float:
        """The quantity of the motion with one impact a period that is nearest to ``nearest``."""
        each = [orbit.reach if self.quantity == "reach" else orbit.amplitude(self.output) for orbit in self.one]
        return min(each, key=lambda value: abs(value - nearest))


def _kind(kinds: Codes, weights: Array, way: int, known: _Known) -> int:
    """Kind at a place around which kinds differ: first what the sweep comes with, then the likeliest left."""
    before = kinds[[0, 2]] if way == UP else kinds[[1, 3]]
    share = weights[[0, 2]] if way == UP else weights[[1, 3]]
    coming = int(before[int(np.argmax(share))])
    if known.keeps(coming):
        return coming
    left = [int(kind) for kind in np.unique(kinds) if not known.rules_out(int(kind))]
    left = left or [int(kind) for kind in np.unique(kinds)]
    return max(left, key=lambda kind: float(weights[kinds == kind].sum()))


def _value(model: MappedMotions, way: int, cell: _Cell, kind: int, known: _Known | None) -> tuple[float, float]:
    """Value and its standard error, from the places around that are of the kind, or in closed form."""
    around = model.kind[way, cell.rows, cell.columns] == kind
    weights = np.where(around, np.maximum(cell.weights, 1e-9), 0.0)
    total = weights.sum()
    weights = weights / total if total > 0 else cell.weights
    value = float(weights @ model.value[way, cell.rows, cell.columns])
    error = float(weights @ model.error[way, cell.rows, cell.columns])
    if known is not None and kind == ONE and known.one:
        return known.value(value), 0.0
    return value, error


SEED = 20090101
LONGER = 2  # times the case's settling


@dataclass(frozen=True)
class Verification:
    """Places (m,): Hz, SI values of the key, label by the map and by flying all models anew.

    ``decided``: where neither hangs on the scatter of motions that do not repeat, nor kinds meet around the place of
    which one has no closed form.
    """

    frequency: Array
    key: Array
    predicted: NDArray[np.int64]
    flown: NDArray[np.int64]
    decided: NDArray[np.bool_]

    @property
    def right(self) -> int:
        """Number of the decided places where both agree."""
        return int(np.sum((self.predicted == self.flown) & self.decided))


def verified(found: ComparedModels, count: int, seed: int = SEED) -> Verification:
    """Fly all models anew at ``count`` places drawn from the whole plane, not from its grid."""
    draw = np.random.default_rng(seed).random((2, count))
    hertz = found.frequency[0] + draw[0] * np.ptp(found.frequency)
    values = found.values[0] + draw[1] * np.ptp(found.values)
    again = run_parallel(lambda model, _: _flown(found, model, hertz, values), found.models[::-1])[::-1]
    predicted, unclear = labels_between(found, hertz, values)
    decided = ~(unclear | doubtful(again, found.asked)[0])
    return Verification(hertz, values, predicted, cheapest(again, found.asked)[0], decided)


def _flown(found: ComparedModels, model: MappedMotions, hertz: Array, values: Array) -> MappedMotions:
    """Both ways from the state of the nearest place that the sweep passed before."""
    points, plan = _points(found, model, hertz, values), found.plan
    rows = np.abs(found.values[:, None] - values).argmin(axis=0)
    left = np.clip(np.searchsorted(found.frequency, hertz) - 1, 0, len(found.frequency) - 2)
    responses = []
    for way, columns in enumerate((left, left + 1)):
        state = onto_stops(points, 0, model.state[way, rows, columns])
        responses.append(batch(
            points.systems_of(points.which[0]), points.omega[0], points.amplitude[0], gap=points.gap[0],
            restitution=None if points.restitution is None else points.restitution[0], state=state,
            settle=LONGER * plan.settle, hold=plan.hold, output=plan.output,
        ))  # fmt: skip
    swept = {name: np.stack([getattr(each, name) for each in responses])[None] for name in (plan.quantity, *SWEPT)}
    read = judged(points, swept, plan.quantity, plan.hold, plan.output)
    moved = {name: np.moveaxis(each, 1, 0) for name, each in read.items()}
    return motions(model.name, model.modes, moved, plan.quantity)
