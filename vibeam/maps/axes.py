"""Axes of a map: the keys that short words stand for, their names, usual ranges, values as options give them, cells."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.case.grid_keys import DISPLACEMENT, FREQUENCY, GAP, LEVELS, RESTITUTION, SHARE, VELOCITY, AxisPlan
from vibeam.casefile import quantities as units
from vibeam.casefile.quantities import UnitError, to_si
from vibeam.exchange.faults import CaseError
from vibeam.periodic.modal_sums import sums
from vibeam.runs.transient.motions import SCALED
from vibeam.system.number_text import with_unit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vibeam.case.case import Case

SHORT = {"frequency": FREQUENCY, "gap": GAP, "restitution": RESTITUTION}  #: "drive": whichever level the case has
WIDE = 2.0  # usual gaps, in amplitudes without the stop
DRIVEN = (0.2, 2.0)  # usual range of a drive, in its own value

NAMES = {
    FREQUENCY: "drive frequency",
    GAP: "gap",
    RESTITUTION: "restitution R",
    SHARE: "share of the drive",
    DISPLACEMENT: "initial displacement of the contact",
    VELOCITY: "initial velocity of the contact",
    "drive.voltage": "drive voltage",
    "drive.amplitude": "base amplitude",
    "drive.velocity": "base velocity",
    "drive.acceleration": "base acceleration",
    "drive.force": "drive force",
    "drive.moment": "drive moment",
}

PLAIN = {  # without dimensions
    GAP: "gap Δ",
    "drive.amplitude": "base amplitude B",
    "drive.velocity": "base velocity ΩB",
    "drive.acceleration": "base acceleration Ω²B",
}


def name_of_key(case: Case, key: str) -> str:
    """Name of a key in words: a gap's says where it is measured."""
    if case.scene.natural_unit is not None and key in PLAIN:
        return PLAIN[key]
    if key == GAP and case.scene.stop is not None:
        return f"gap at the {getattr(case.scene.stop, 'gap_at', 'contact')}"
    table, _, name = key.rpartition(".")
    words = key.replace(".", " ") if name != table else name
    return NAMES.get(key, words.replace("_", " "))


def own_value(case: Case, key: str) -> float:
    """The case's own value of a key; NaN where it has none, or a list."""
    if key == SHARE:
        return 1.0
    own = case.keys.value(key) if key not in (FREQUENCY, DISPLACEMENT, VELOCITY) else None
    return float(own) if isinstance(own, int | float) else float("nan")


def axes_over(
    case: Case, over: str, low: str | float | None, high: str | float | None, points: Sequence[int], fidelity: str,
    plane: bool = True,
) -> tuple[AxisPlan, ...]:  # fmt: skip
    """Axes of a plane of frequency and another key, or of one of the two alone.

    ``over``: "gap", "frequency,gap", any dotted key: the frequency is there anyhow of a ``plane``, over the case's own
    range. ``low``, ``high``: of the other key, with its unit (None: around the case's own, for gap and drive alone).
    ``points``: of each word in the order of ``over``, then of the frequency; one for all. ``fidelity``: whose motion
    without the stop the usual gaps are of. ValueError names the option.
    """
    words = [part.strip() for part in over.split(",") if part.strip()]
    keys = [_key(case, word) for word in words]
    others = [key for key in keys if key != FREQUENCY]
    if not words or len(set(keys)) < len(keys) or len(others) > 1 or (plane and not others):
        beside = "one key beside the frequency, gap or frequency,gap" if plane else "frequency, or one other key"
        raise ValueError(f"--over: write {beside}, not {over!r}; more axes have a table [map.NAME]")
    order = keys if FREQUENCY in keys or not plane else [*keys, FREQUENCY]
    if len(points) not in (1, len(order)):
        raise ValueError(f"--points: {len(points)} numbers for {len(order)} axes")
    count = dict(zip(order, points if len(points) > 1 else [*points] * len(order), strict=True))
    found = [axis_of(case, key, low, high, count[key], _usual(case, key, fidelity)) for key in others]
    if FREQUENCY not in order:
        return tuple(found)
    ends = (low, high) if not others else (None, None)
    return *found, _frequencies(case, *ends, count[FREQUENCY])


def points_of(over: str, rows: int, columns: int) -> tuple[int, int]:
    """Numbers of values in the order of ``over``: ``columns`` of the frequency, ``rows`` of the other key."""
    first = over.partition(",")[0].strip()
    return (columns, rows) if first in ("frequency", FREQUENCY) else (rows, columns)


def _key(case: Case, word: str) -> str:
    if word != "drive":
        return SHORT.get(word, word)
    order = sorted(LEVELS, key=lambda key: key == "drive.gain")  # a gain beside a voltage is no level of its own
    known = {key: case.keys.value(key) for key in order}
    found = [key for key, value in known.items() if value is not None]
    if not found:
        raise ValueError("--over: the case has no drive that could vary: name a key of it")
    return SHARE if isinstance(known[found[0]], tuple) else found[0]


def _frequencies(case: Case, low: str | float | None, high: str | float | None, count: int) -> AxisPlan:
    grid = case.sweep.frequency
    ends = [
        default if given is None else _value(case, flag, given, FREQUENCY)
        for flag, given, default in (("--from", low, float(grid.min())), ("--to", high, float(grid.max())))
    ]
    if not ends[0] < ends[1]:
        raise ValueError("sweep.frequency: a map needs a range of frequencies, there is one")
    return AxisPlan(FREQUENCY, tuple(np.linspace(ends[0], ends[1], count).tolist()), "Hz")


def axis_of(
    case: Case, key: str, low: str | float | None, high: str | float | None, count: int, usual: tuple[float, float]
) -> AxisPlan:
    """Axis of a key from ``low`` to ``high``, with its unit; None: as is ``usual``, NaN where nothing is.

    ValueError names the option.
    """
    try:
        unit = unit_of_key(case, key)
    except ValueError as fault:
        raise ValueError(f"--over: {fault}") from None
    ends = []
    for flag, given, default in (("--from", low, usual[0]), ("--to", high, usual[1])):
        if given is None and np.isnan(default):
            raise ValueError(f"{flag}: missing, for {key} has no usual range: write {flag} with its unit")
        ends.append(default if given is None else _value(case, flag, given, key))
    if not ends[0] < ends[1]:
        texts = [with_unit(end, unit) for end in ends]
        cure = ": the other end is the usual one: write both" * (None in (low, high))
        raise ValueError(f"--from, --to: {key} must ascend, not go from {texts[0]} to {texts[1]}{cure}")
    return AxisPlan(key, tuple(np.linspace(ends[0], ends[1], count).tolist()), unit)


def unit_of_key(case: Case, key: str) -> str:
    """Unit of a key's values, SI; empty of what scales the case's own load."""
    return "" if key in _scaling(case) else case.keys.unit(key)


def _scaling(case: Case) -> tuple[str, ...]:
    return (SHARE,) if case.record is None else SCALED


def _value(case: Case, flag: str, given: str | float, key: str) -> float:
    kinds = {FREQUENCY: units.FREQUENCY, **dict.fromkeys(_scaling(case), units.RATIO)}
    try:
        return to_si(given, kinds[key]) if key in kinds else case.keys.number(key, given)
    except (ValueError, UnitError) as fault:
        raise ValueError(f"{flag}: {fault}") from None


def _usual(case: Case, key: str, fidelity: str) -> tuple[float, float]:
    """Usual range: of a drive some of its own, of gaps around 0 some amplitudes without the stop; NaN of other keys."""
    own = own_value(case, key)
    if key in (SHARE, *LEVELS) and own > 0:
        return own * DRIVEN[0], own * DRIVEN[1]
    if key != GAP:
        return float("nan"), float("nan")
    grid = case.sweep.frequency
    omega = np.asarray(2 * np.pi * np.linspace(grid.min(), grid.max(), 101))
    swing = np.abs(sums(case.system(fidelity), omega, 1).unit) * case.amplitude_of(fidelity, omega)
    half = max(WIDE * float(np.median(swing)) / _at_contact(case), 2 * abs(own))
    try:
        case.model(fidelity).at({GAP: -half}).checked()
    except CaseError:  # nothing would fit between two stops
        return 0.0, half
    return -half, half


def _at_contact(case: Case) -> float:
    """The contact's gap over the case's, which may be at the sensor."""
    from vibeam.case.reduced_structure import reduced_structure

    scene: Any = case.scene
    if scene.given_mode is not None or scene.stop.gap_at == "contact":
        return 1.0
    return float(reduced_structure(scene, "static_mode", None)[1])


def cells(values: NDArray[Any]) -> NDArray[Any]:
    """Values as rows of cells: one row where there is one axis."""
    return values[None, :] if values.ndim == 1 else values


def edges(centres: NDArray[np.float64]) -> NDArray[np.float64]:
    """Edges of the cells round ``centres``, (points + 1,): half-way between neighbours."""
    if len(centres) == 1:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    inner = (centres[1:] + centres[:-1]) / 2
    return np.concatenate([[2 * centres[0] - inner[0]], inner, [2 * centres[-1] - inner[-1]]])
