"""Map of a number of motions under a record over one key or two: any keys, the input's level and speed among them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.grid_keys import AxisPlan
from vibeam.exchange.faults import suggest
from vibeam.maps.axes import SHORT, axis_of, unit_of_key
from vibeam.runs.transient.motions import SCALED
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.studies.variants import Told, asked_number, ensembles
from vibeam_models.arrays import Array, ValueRecord

if TYPE_CHECKING:
    from vibeam.case.case import Case

USUAL = (31, 15)  # values of one key, and of each of two
AROUND = (0.2, 2.0)  # usual range of the level and the speed


@dataclass(frozen=True, eq=False, repr=False)
class RecordMap(ValueRecord):
    """Number of the motions over one axis or two: ``means`` of each fidelity over them, and their standard ``errors``.

    Means over the seeds; NaN where a motion did not run to the record's end, or has no such number; errors NaN of one
    realisation.
    """

    case: Case
    axes: tuple[AxisPlan, ...]
    number: AskedNumber
    means: Mapping[str, Array]
    errors: Mapping[str, Array]
    realisations: int


def record_map(
    case: Case,
    axes: Mapping[str, Sequence[float]],
    quantity: str = "peak",
    fidelities: Sequence[str] | None = None,
    told: Told | None = None,
) -> RecordMap:
    """Fly every fidelity through the case's record at all values of one key or two.

    ``axes``: ``"level"``, ``"speed"`` or dotted keys with their values, SI; ``quantity``: as ``asked_number`` takes it;
    ``fidelities``: None: all. CaseError for a value that the case may not have, ValueError for what is no quantity.

    >>> import vibeam
    >>> tables = {
    ...     "sdof": {"natural_frequency": "1 rad/s", "damping_ratio": 0.02}, "stop": {"gap": 1, "restitution": 0.7},
    ...     "drive": {"shape": "half_sine", "acceleration": 2.0, "duration": "3 s"}, "record": {"duration": "30 s"},
    ...     "fidelity": {"one": {}},
    ... }
    >>> found = vibeam.studies.record_map(vibeam.Case.of(tables), {"stop.gap": [1.0, 2.0, 9.0]}, "impacts")
    >>> float(found.means["one"][-1])
    0.0
    """
    number = asked_number(case, quantity)
    names = list(fidelities or case.fidelities)
    if unknown := [name for name in names if name not in case.fidelities]:
        raise ValueError(f"--fidelity: no fidelity {unknown[0]!r}; {suggest(unknown[0], case.fidelities)}")
    made = tuple(AxisPlan(key, tuple(map(float, each)), unit_of_key(case, key)) for key, each in axes.items())
    points = [_settings(dict(zip(axes, point, strict=True))) for point in product(*axes.values())]
    variants = [(own.with_keys(each), name) for name in names for own in (case.alone(name),) for each in points]
    found = ensembles(variants, [number], told)
    shape = tuple(len(each.values) for each in made)
    rows = [each.mean(number) for each in found]
    parts = {name: rows[at * len(points) : (at + 1) * len(points)] for at, name in enumerate(names)}
    means = {name: np.array([each.mean for each in own]).reshape(shape) for name, own in parts.items()}
    errors = {name: np.array([each.error for each in own]).reshape(shape) for name, own in parts.items()}
    return RecordMap(case, made, number, means, errors, found[0].seconds.size)


def _settings(point: Mapping[str, float]) -> dict[str, Any]:
    """Keys of the case at a point of the plane: its record varies level or speed there by one value, or nothing."""
    scaled = {key: value for key, value in point.items() if key in SCALED}
    [(over, value)] = list(scaled.items()) or [("level", 1.0)]
    others = {key: each for key, each in point.items() if key not in scaled}
    return {"record.over": over, "record.values": [value], **others}


def axes_asked(
    case: Case, over: str | None, low: str | None, high: str | None, points: Sequence[int] | None
) -> dict[str, tuple[float, ...]]:
    """Axes as options say them: ``over`` one key or two, their first and last values, each list split at commas.

    Of level and speed 0.2 to 2 where nothing is said. ValueError names the option.
    """
    keys = [SHORT.get(word.strip(), word.strip()) for word in (over or "level").split(",")]
    if not 1 <= len(keys) <= 2 or len(set(keys)) < len(keys) or set(keys) == set(SCALED):
        raise ValueError(f"--over: write a key, or two: stop.gap,level; not {over!r}")
    ends = [_ends(flag, given, len(keys)) for flag, given in (("--from", low), ("--to", high))]
    counts = list(points or USUAL[len(keys) - 1 :][:1])
    counts = counts * len(keys) if len(counts) == 1 else counts
    if len(counts) != len(keys):
        raise ValueError(f"--points: {len(counts)} numbers for {len(keys)} keys")
    return {
        key: axis_of(case, key, first, last, count, AROUND if key in SCALED else (np.nan, np.nan)).values
        for key, first, last, count in zip(keys, *ends, counts, strict=True)
    }


def _ends(flag: str, given: str | None, count: int) -> list[str | None]:
    if given is None:
        return [None] * count
    found: list[str | None] = [part.strip() for part in given.split(",")]
    if len(found) != count:
        raise ValueError(f"{flag}: {len(found)} values for {count} keys: write one each, with commas between")
    return found
