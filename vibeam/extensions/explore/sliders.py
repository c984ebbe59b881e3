"""Sliders of a page: keys of a case with their units and ranges, and what each moves in every fidelity."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from math import ceil, floor, log10, pi
from typing import Any

import numpy as np

from vibeam.case.case import Case
from vibeam.exchange.faults import CaseError
from vibeam.extensions.explore.drive import (
    DriveLevel,
    drive_amplitude,
    drive_level,
    frequency_range,
    motion_without_stop,
    slider_frequencies,
)
from vibeam.extensions.explore.own_numbers import Affine, damping_factor, gap, own_number, restitution, says
from vibeam.system.number_text import FREQUENCIES, begun, prefixed, shown_in
from vibeam_models.arrays import Array

#: ends of a range as shares of the way from the case's value to a bound that is refused
SHARES = (1.0, 0.99, 0.95, 0.9, 0.75, 0.5, 0.25, 0.1)
TIMES, MOST_DAMPING = 3.0, 5.0  # largest drive and damping over the case's
DIGITS = 1e4  # steps of a coefficient of restitution
DRIVES = {
    "voltage": "voltage of the shaker", "amplitude": "amplitude of the base", "velocity": "velocity of the base",
    "acceleration": "acceleration of the base", "force": "force", "moment": "moment",
}  # fmt: skip
PLACES = {"contact": "R at the contact", "first mode": "R₁ of mode 1", "": "R"}


@dataclass(frozen=True)
class Slider:
    """Slider of a page: the ``key`` of the case that it moves, from ``low`` to ``high`` about the case's ``value``, SI.

    Shown as ``factor`` times that in ``unit``. ``of``: by fidelity, a and b of its own number a + b·key: the gap at its
    contact (m), R there, the level of its drive, the factor on its damping. ``places``: what it snaps to; None: all.
    ``keys``: all keys of the case that it multiplies, where it is a factor, with their values.
    """

    name: str
    key: str
    label: str
    unit: str
    factor: float
    value: float
    low: float
    high: float
    of: Mapping[str, Affine] = field(default_factory=dict)
    places: Array | None = None
    keys: Mapping[str, float] = field(default_factory=dict)

    def settings(self, value: float) -> dict[str, float]:
        """Keys of the case, with their values (SI) at ``value`` of the slider."""
        return {key: value * each for key, each in self.keys.items()} if self.keys else {self.key: value}


@dataclass(frozen=True)
class CaseSliders:
    """Sliders of a case by name; ``fixed``: why there is none for a key, by its name.

    ``refused``: fidelities that do not follow a slider, each with the reason: a page cannot fly them.
    """

    sliders: Mapping[str, Slider]
    fixed: Mapping[str, str]
    refused: Mapping[str, str]


def case_sliders(case: Case) -> CaseSliders:
    """All sliders of a case; ValueError where the case itself cannot be built."""
    found, fixed = {"frequency": _frequency(case)}, dict[str, str]()
    refused = dict[str, str]()
    for name, make in (("drive", _drive), ("gap", _gap), ("restitution", _restitution), ("damping", _damping)):
        try:
            found[name], lost = make(case)
            refused |= lost
        except ValueError as why:
            fixed[name] = str(why)
    return CaseSliders(found, fixed, refused)


def _frequency(case: Case) -> Slider:
    (low, high), swept = frequency_range(case), case.sweep.frequency
    own = case.scene.natural_unit
    unit, factor = prefixed(FREQUENCIES, high, usual=-1) if own is None else ("", 2 * pi / own)
    grid = slider_frequencies(case)
    tables = any("power" not in drive_amplitude(case, name, grid) for name in case.fidelities)
    value = float(swept[len(swept) // 2])
    label = "Drive frequency" if own is None else "Drive frequency Ω/ω"
    places = grid if tables else None
    return Slider("frequency", "sweep.frequency", label, unit, factor, value, low, high, places=places)


Made = tuple[Slider, dict[str, str]]


def _drive(case: Case) -> Made:
    scene: Any = case.scene
    own, levels = DriveLevel.of(scene.base), {name: drive_level(case, name) for name in case.fidelities}
    if not own.level:
        raise ValueError(f"{own.key} is 0, which gives its slider no length")
    of = {
        name: (each.level, 0.0) if each.key != own.key or says(case.fidelities[name], own.key) else (0.0, 1.0)
        for name, each in levels.items()
    }
    what = begun(DRIVES[own.key.partition(".")[2]])
    keys = {}
    if own.listed:
        what += ", times the case's"
        keys = {f"{own.key}.{at}": float(each) for at, each in enumerate(case.keys.value(own.key))}
    unit, factor = shown_in("" if own.listed else case.keys.unit(own.key), own.level)
    high = _allowed(case, own.level, TIMES * own.level, lambda value: {own.key: value} if not keys else {})
    return Slider("drive", own.key, what, unit, factor, own.level, 0.0, high, of, keys=keys), {}


def _gap(case: Case) -> Made:
    key, value = "stop.gap", float(case.keys.value("stop.gap"))
    size = abs(value) or _size(case)
    of, refused = _numbers(case, key, gap, (0.0, 1.0, value, value + size))
    low, high = (-size, 4 * size) if value > 0 else (-3 * size, 3 * size) if value < 0 else (-size, size)
    low, high = (_allowed(case, value, end, lambda each: {key: each}) for end in (low, high))
    place = "" if case.scene.natural_unit is not None else f" at the {case.keys.value('stop.gap_at') or 'contact'}"
    unit, factor = shown_in(case.keys.unit(key), size)
    return Slider("gap", key, f"Gap{place}", unit, factor, value, low, high, of), refused


def _size(case: Case) -> float:
    """Length of a slider about a gap of 0: half of the largest motion without a stop, with one digit; m."""
    largest = motion_without_stop(case, next(iter(case.fidelities)), "contact") / 2
    if not largest:
        raise ValueError("stop.gap is 0, and nothing says how long its slider is")
    digit = 10.0 ** floor(log10(largest))
    return floor(largest / digit) * digit


def _restitution(case: Case) -> Made:
    key, given = "stop.restitution", case.keys.value("stop.restitution")
    if given is None:
        law = case.keys.value("stop.law")
        raise ValueError(f'the stop has the law "{law}", which says its loss by other keys')
    value = float(given)
    near = (value + sign * step for step in (0.1, 0.05, 0.02, 0.01, 0.001) for sign in (1, -1))
    of, refused = _numbers(case, key, restitution, (0.0, 1.0, value, *near))
    held = [((0.0 - a) / b, (1.0 - a) / b) for a, b in of.values() if b > 0]
    low = ceil(max([0.0, *(each[0] for each in held)]) * DIGITS - 1e-9) / DIGITS
    high = floor(min([1.0, *(each[1] for each in held)]) * DIGITS + 1e-9) / DIGITS
    low, high = (_allowed(case, value, end, lambda each: {key: each}) for end in (low, high))
    whose = case.keys.value("stop.restitution_of") if case.scene.natural_unit is None else None
    return Slider("restitution", key, PLACES[whose or ""], "", 1.0, value, low, high, of), refused


def _damping(case: Case) -> Made:
    keys = dict(_damping_keys(case))
    if not any(keys.values()):
        raise ValueError("the case has no damping ratio above 0 that could be multiplied")
    of, refused = _moved(case, lambda name: damping_factor(case, name, keys))
    low, high = (
        _allowed(case, 1.0, end, lambda each: {key: each * own for key, own in keys.items()}, built=False)
        for end in (0.0, MOST_DAMPING)
    )
    label = "Damping, times the case's"
    return Slider("damping", next(iter(keys)), label, "", 1.0, 1.0, low, high, of, keys=keys), refused


def _damping_keys(case: Case) -> Iterator[tuple[str, float]]:
    """Damping ratios of the case, and that of a platform which moves with the beam."""
    for table in ("beam", "sdof", "matrices", "modes"):
        for key in (f"{table}.damping_ratio", f"{table}.damping"):
            given = case.keys.value(key)
            if isinstance(given, tuple):
                yield from ((f"{key}.{at}", float(each)) for at, each in enumerate(given))
            elif isinstance(given, float | int):
                yield key, float(given)
    if case.keys.value("platform.coupling") == "two-way":
        yield "platform.damping_ratio", float(case.keys.value("platform.damping_ratio"))


def _numbers(case: Case, key: str, read: Any, probes: Iterable[float]) -> tuple[dict[str, Affine], dict[str, str]]:
    """Own numbers of the fidelities that follow a key, and why others do not."""
    wanted = tuple(dict.fromkeys(probes))
    return _moved(case, lambda name: own_number(case, name, key, read, wanted))


def _moved(case: Case, number: Callable[[str], Affine | None]) -> tuple[dict[str, Affine], dict[str, str]]:
    """Numbers of all fidelities that have one, and why others have none; ValueError where no fidelity moves."""
    found, lost = {}, {}
    for name in case.fidelities:
        try:
            if made := number(name):
                found[name] = made
        except ValueError as why:
            lost[name] = str(why)
    if not any(slope for _, slope in found.values()):
        raise ValueError("; ".join(dict.fromkeys(lost.values())) or "every fidelity has a value of its own")
    return found, lost


Settings = Callable[[float], Mapping[str, float]]


def _allowed(case: Case, value: float, end: float, settings: Settings, built: bool = True) -> float:
    """The end of a range, or the farthest tried place before it that the case may have."""
    for share in SHARES:
        place = end if share == 1 else value + share * (end - value)
        if _may_be(case, settings(place), built):
            return place
    return value


def _may_be(case: Case, settings: Mapping[str, float], built: bool) -> bool:
    """Test whether the rules of a case allow keys at other values; ``built``: and every fidelity can be built."""
    omega = 2 * np.pi * case.sweep.frequency
    try:
        for name, fidelity in case.fidelities.items():
            mine = {key: value for key, value in settings.items() if not says(fidelity, key)}
            made = case.model(name).at(mine).checked()
            if built:
                made.system()
                made.amplitude(omega)
    except (CaseError, ValueError):
        return False
    return True
