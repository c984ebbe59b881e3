"""Axes of a grid of case keys, and its points as arrays: systems, drive, gap, restitution, starts of the motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import prod
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.grid_keys import FREQUENCY, GAP, LEVELS, RESTITUTION, SHARE, is_structural
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.fidelity import Model

Indices = Mapping[str, NDArray[np.int64]]
Settings = Mapping[str, float]  # values of keys, SI


@dataclass(frozen=True)
class Axis:
    """One axis: a dotted key of the case and its values in SI (frequencies in Hz), in the order swept."""

    key: str
    values: tuple[float, ...]

    @property
    def structural(self) -> bool:
        """Test whether the system has to be built anew for each value."""
        return is_structural(self.key)


def shape_of(axes: Sequence[Axis]) -> tuple[int, ...]:
    """Number of values of each axis."""
    return tuple(len(axis.values) for axis in axes)


def lines_of(axes: Sequence[Axis]) -> int:
    """Number of lines: points of all axes but the last."""
    return prod(shape_of(axes)[:-1])


def indices(axes: Sequence[Axis], lines: NDArray[np.int64]) -> Indices:
    """Index along each axis of the points of some ``lines``, (lines, points of the last axis) each."""
    *above, last = axes
    size = (len(lines), len(last.values))
    places = np.unravel_index(lines, shape_of(above)) if above else ()
    found = {axis.key: np.broadcast_to(each[:, None], size) for axis, each in zip(above, places, strict=True)}
    return found | {last.key: np.broadcast_to(np.arange(size[1]), size)}


@dataclass(frozen=True)
class Combinations:
    """The distinct ``settings`` among some points, and ``which`` of them each point has."""

    settings: tuple[Settings, ...]
    which: NDArray[np.int64]


def combinations(axes: Sequence[Axis], index: Indices, keys: Sequence[str]) -> Combinations:
    """Combinations of the values of those axes whose keys are among ``keys``."""
    mine = [axis for axis in axes if axis.key in keys]
    size = next(iter(index.values())).shape
    if not mine:
        return Combinations(({},), np.zeros(size, dtype=np.int64))
    flat = np.ravel_multi_index([index[axis.key] for axis in mine], shape_of(mine))
    numbers, which = np.unique(flat, return_inverse=True)
    rows = np.array(np.unravel_index(numbers, shape_of(mine))).T
    settings = ({axis.key: axis.values[at] for axis, at in zip(mine, row, strict=True)} for row in rows)
    return Combinations(tuple(settings), which.reshape(size))


def values_at(axes: Sequence[Axis], index: Indices, key: str) -> NDArray[np.float64] | None:
    """Values of one key at the points; None where it is no axis."""
    axis = next((axis for axis in axes if axis.key == key), None)
    return None if axis is None else np.array(axis.values)[index[key]]


@dataclass(frozen=True)
class GridPoints:
    """Points of some lines, (lines, points of the last axis) each; None: as the system has it.

    ``systems``: of the same number of modes each, ``which`` of them a point has. Frequencies in rad/s, lengths in m.
    """

    systems: tuple[ImpactSystem, ...]
    which: NDArray[np.int64]
    omega: Array
    amplitude: Array
    gap: Array
    restitution: Array | None
    index: Indices

    def systems_of(self, which: NDArray[np.int64]) -> ImpactSystem | NDArray[np.object_]:
        """The one system, or ``which`` of them."""
        return self.systems[0] if len(self.systems) == 1 else np.array(self.systems)[which]

    def system_at(self, place: int) -> ImpactSystem:
        """The system of one point, ``place``: its number in the flattened arrays."""
        base = self.systems[self.which.flat[place]]
        restitution = base.restitution if self.restitution is None else float(self.restitution.flat[place])
        return replace(base, gap=float(self.gap.flat[place]), restitution=restitution)

    def drive_at(self, place: int) -> Drive:
        """The drive of one point."""
        return Drive(float(self.omega.flat[place]), float(self.amplitude.flat[place]))


def grid_points(model: Model, axes: Sequence[Axis], frequency: float | None, lines: NDArray[np.int64]) -> GridPoints:
    """Points of ``lines`` of the grid over a model; ``frequency`` (Hz) where that is no axis.

    Every rule between keys holds. CaseError for a value that the case may not have, ValueError for a case that a grid
    cannot take.
    """
    index = indices(axes, lines)
    along = values_at(axes, index, FREQUENCY)
    size = next(iter(index.values())).shape
    omega = 2 * np.pi * (np.full(size, frequency) if along is None else along)
    structural = [axis.key for axis in axes if axis.structural]
    structures = combinations(axes, index, structural)
    models = [model.at(each).checked() for each in structures.settings]
    for each in models:
        _require_known(each)
    systems = tuple(each.system() for each in models)
    gaps = combinations(axes, index, [*structural, GAP])
    laws = combinations(axes, index, [*structural, RESTITUTION])
    rebounds, share = any(axis.key == RESTITUTION for axis in axes), values_at(axes, index, SHARE)
    amplitude = _amplitudes(combinations(axes, index, [*structural, *LEVELS]), omega, model)
    return GridPoints(
        systems,
        structures.which,
        omega,
        amplitude if share is None else share * amplitude,
        _looked_up(gaps, lambda settings: model.at(settings).checked().system().gap),
        _looked_up(laws, lambda settings: model.at(settings).checked().system().restitution) if rebounds else None,
        index,
    )


def _looked_up(found: Combinations, value: Callable[[Settings], float]) -> Array:
    return np.array([value(settings) for settings in found.settings])[found.which]


def _amplitudes(found: Combinations, omega: Array, model: Model) -> Array:
    amplitude = np.empty(omega.size)
    order = np.argsort(found.which, axis=None, kind="stable")
    parts = np.split(order, np.cumsum(np.bincount(found.which.ravel()))[:-1])
    for settings, mine in zip(found.settings, parts, strict=True):
        amplitude[mine] = model.at(settings).amplitude(omega.ravel()[mine])
    return amplitude.reshape(omega.shape)


def _require_known(model: Model) -> None:
    """ValueError for what a grid cannot take: a gap that changes along a sweep, harmonics, another solver."""
    scene, fidelity = model.scene(), model.fidelity
    found = ["a gap that drifts"] if scene.stop is not None and scene.stop.drift is not None else []
    found += ["a gap that wears"] if scene.stop is not None and scene.stop.wear is not None else []
    found += ["a drive of several harmonics"] if scene.harmonics else []
    found += [f'the solver "{fidelity.solver}"'] if fidelity.solver != "flight" else []
    if found:
        raise ValueError(f"fidelity {fidelity.name}: a map cannot take {' or '.join(found)}")


@dataclass(frozen=True)
class Starts:
    """``count`` random starts a point: displacement of the contact within ``spread`` m of 0 and short of the stop,
    velocity within Ω times that; the same for equal seeds, whatever the blocks.

    >>> import vibeam
    >>> axes, starts = {"sweep.frequency": [15.0]}, vibeam.Starts(count=4, seed=1, spread=1e-4)
    >>> found = vibeam.evaluate("cases/dtu_neutral.toml", "sdof", axes, direction="apart", starts=starts)
    >>> found["period"].tolist()  # all four lead to the same motion
    [[1, 1, 1, 1]]
    """

    count: int
    seed: int
    spread: float


def random_starts(points: GridPoints, first: int, starts: Starts) -> tuple[Array, Array]:
    """Displacement (m) and velocity (m/s) of the contact, (lines, points, starts) each; ``first``: number of the line.

    A pressed stop is short of 0: the displacement is then drawn between −``spread`` and the gap.
    """
    lines, columns = points.omega.shape
    drawn = np.stack(
        [np.random.default_rng([starts.seed, first + line]).random((columns, starts.count, 2)) for line in range(lines)]
    )
    highest = np.clip(points.gap, -starts.spread, starts.spread)[..., None]
    displacement = -starts.spread + (highest + starts.spread) * drawn[..., 0]
    return displacement, starts.spread * points.omega[..., None] * (2 * drawn[..., 1] - 1)


def start_states(points: GridPoints, displacement: Array, velocity: Array) -> Array:
    """States (lines, points, starts, 2n) with that motion of the contact, all of it in the first mode.

    ValueError where that mode does not move the contact, or the systems have different numbers of modes.
    """
    if len({system.size for system in points.systems}) > 1:
        raise ValueError("a start cannot be given to models with different numbers of modes")
    first = np.array([system.contact[0] for system in points.systems])[points.which]
    if not np.all(first):
        raise ValueError("a start moves the first mode alone, and here it does not move the contact")
    n = points.systems[0].size
    state = np.zeros((*displacement.shape, 2 * n))
    state[..., 0], state[..., n] = displacement / first[..., None], velocity / first[..., None]
    return state
