"""Coexisting motions of a map: points told apart by what was read off them, each motion with a name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.case.grid_keys import STARTS
from vibeam.system.quantities import Ended
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.maps.evaluate import GridResponse
    from vibeam.maps.result import MapResult


READ = ("maximum", "minimum", "impact_velocity")  # by which motions of equal period and impacts are told apart
SAME = 1e-3  # share of the largest value among them within which two readings are of one motion
FAILED = -1
LETTERS = "abcdefghijklmnopqrstuvwxyz"


@dataclass(frozen=True)
class CoexistingMotion:
    """A motion that some starts lead to: its name, its period (0: none, −1: no contact), impacts in that, how many
    starts lead to it and what share of all that is."""

    fidelity: str
    direction: str
    name: str
    period: int
    impacts: int
    starts: int
    share: float
    amplitude: float


@dataclass(frozen=True)
class Labelled:
    """Motions of one fidelity and way, the commonest first, and which of them each point has (−1: the point failed).

    ``which`` has the shape of the points, random starts last.
    """

    motions: tuple[CoexistingMotion, ...]
    which: NDArray[np.int64]


def label(response: GridResponse, way: int) -> Labelled:
    """Tell the motions apart that different starts lead to at the same values of all other axes.

    Motions are the same where period, impacts in it and extremes and velocity agree; all that do not repeat count as
    one. So motions that differ by a shift of whole drive periods are one motion. Over other axes a motion is known by
    its name, which says impacts and periods, and, where several there have the same, a letter by amplitude.
    """
    values = {name: response.values[name][way] for name in ("period", "impacts_per_period", "ended", *READ)}
    dimensions = [number for number, key in enumerate(response.axes) if key in STARTS]
    dimensions += list(range(len(response.axes), values["period"].ndim))
    apart = {name: _starts_last(each, dimensions) for name, each in values.items()}
    which = np.full(apart["period"].shape, FAILED)
    found: dict[str, _Found] = {}
    for place in range(len(which)):
        for name, group, motion in at_one_place({key: each[place] for key, each in apart.items()}):
            known = found.setdefault(name, _Found(len(found), motion))
            which[place][group] = known.number
            known.add(len(group), motion.amplitude)
    total = max(sum(each.starts for each in found.values()), 1)
    order = sorted(found, key=lambda name: (-found[name].starts, found[name].number))
    place_of = {found[name].number: number for number, name in enumerate(order)} | {FAILED: FAILED}
    renumbered = np.vectorize(place_of.__getitem__, otypes=[np.int64])(which)
    motions = tuple(
        CoexistingMotion(
            response.fidelity, response.ways[way], name, found[name].kind.period, found[name].kind.impacts,
            found[name].starts, found[name].starts / total, found[name].amplitude,
        )
        for name in order
    )  # fmt: skip
    return Labelled(motions, _back(renumbered, values["period"].shape, dimensions))


def motions_of(result: MapResult) -> list[CoexistingMotion]:
    """Motions of all fidelities of a map with starts of its own."""
    return [motion for response in result.responses.values() for motion in label(response, 0).motions]


@dataclass(frozen=True)
class _Kind:
    period: int
    impacts: int
    amplitude: float


@dataclass
class _Found:
    """A name met so far: its number, its first motion, starts that lead to it and the sum of their amplitudes."""

    number: int
    kind: _Kind
    starts: int = 0
    total: float = 0.0

    def add(self, starts: int, amplitude: float) -> None:
        self.starts, self.total = self.starts + starts, self.total + starts * amplitude

    @property
    def amplitude(self) -> float:
        return self.total / self.starts


def _starts_last(values: NDArray[Any], dimensions: Sequence[int]) -> NDArray[Any]:
    """Values as (places, starts)."""
    last = np.moveaxis(values, dimensions, range(-len(dimensions), 0))
    places = int(np.prod(last.shape[: last.ndim - len(dimensions)]))
    return last.reshape(places, -1)


def _back(values: NDArray[Any], shape: tuple[int, ...], dimensions: Sequence[int]) -> NDArray[Any]:
    """Reverse of ``_starts_last``."""
    others = [number for number in range(len(shape)) if number not in dimensions]
    moved = values.reshape([shape[number] for number in (*others, *dimensions)])
    return np.moveaxis(moved, range(-len(dimensions), 0), dimensions)


def at_one_place(flat: dict[str, NDArray[Any]]) -> Iterator[tuple[str, NDArray[np.int64], _Kind]]:
    """Motions at one place: name, the starts that lead there, what it is."""
    period = np.where(flat["period"] < 0, -1, flat["period"]).astype(np.int64)
    impacts = np.where(period > 0, np.rint(np.nan_to_num(flat["impacts_per_period"]) * np.maximum(period, 1)), 0)
    known = flat["ended"] == Ended.COMPLETE.code
    amplitude = (flat["maximum"] - flat["minimum"]) / 2
    groups: list[tuple[_Kind, NDArray[np.int64]]] = []
    for kind in sorted({*zip(period[known].tolist(), impacts[known].astype(int).tolist(), strict=True)}):
        mine = np.flatnonzero(known & (period == kind[0]) & (impacts == kind[1]))
        parts = _apart(mine, np.array([flat[name][mine] for name in READ])) if kind[0] > 0 else [mine]
        groups += [(_Kind(*kind, float(np.mean(amplitude[part]))), part) for part in parts]
    for name, (kind_of_group, group) in zip(_names([each for each, _ in groups]), groups, strict=True):
        yield name, group, kind_of_group


def _apart(points: NDArray[np.int64], readings: Array) -> list[NDArray[np.int64]]:
    """Split points where a reading leaps by more than ``SAME`` of the largest extreme, or of the largest velocity."""
    parts = [np.arange(len(points))]
    known = np.abs(np.nan_to_num(readings))
    extremes, velocity = float(known[:2].max(initial=0.0)), float(known[2].max(initial=0.0))
    for row, size in zip(np.nan_to_num(readings), (extremes, extremes, velocity), strict=True):
        limit, split = SAME * size, []
        for part in parts:
            order = part[np.argsort(row[part], kind="stable")]
            split += np.split(order, np.flatnonzero(np.diff(row[order]) > limit) + 1)
        parts = split
    return [np.sort(points[part]) for part in parts]


def _names(kinds: Sequence[_Kind]) -> list[str]:
    """Names: impacts and periods, with letters from the largest amplitude down where several have the same."""
    plain = [_name(each.period, each.impacts) for each in kinds]
    found = []
    for name, kind in zip(plain, kinds, strict=True):
        twins = [other.amplitude for twin, other in zip(plain, kinds, strict=True) if twin == name]
        place = sorted(twins, reverse=True).index(kind.amplitude)
        letter = LETTERS[place] if place < len(LETTERS) else str(place)
        found.append(f"{name}, {letter}" if len(twins) > 1 else name)
    return found


def _name(period: int, impacts: int) -> str:
    if period == 0:
        return "not periodic"
    if period < 0:
        return "no contact"
    struck = "1 impact" if impacts == 1 else f"{impacts} impacts" if impacts else "contact without impacts"
    return f"{struck} in {'1 period' if period == 1 else f'{period} periods'}"


def counted(labelled: Labelled) -> NDArray[np.int64]:
    """Number of different motions among the starts of each point: the last dimension of ``which``."""
    return np.asarray(
        np.sum([np.any(labelled.which == each, axis=-1) for each in range(len(labelled.motions))], axis=0, dtype=int)
    )
