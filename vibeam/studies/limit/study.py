"""Limit N → ∞ of a case's rig, for each thing that can be held."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import isfinite, nan
from typing import TYPE_CHECKING, Literal

import numpy as np

from vibeam.case.source import of_source
from vibeam.runs.closed_motions import unsuited, without_closed_forms
from vibeam.studies.limit.sequences import (
    ModeSequence,
    ObservedLimit,
    models,
    modes_by_contact_time,
    observed_limit,
    of_collision,
    of_restitution,
    with_law,
    with_restitution,
)
from vibeam_models.laws import ContactLaw
from vibeam_models.scene import RigScene

if TYPE_CHECKING:
    from vibeam.case.case import Case


COUNTS = (1, 2, 4, 8, 16, 32, 64)
SPEED = 0.05  # m/s of the contact at first touch
WITHIN = 0.01  # share of the limit at which there are modes enough

HELD: dict[Literal["contact", "first mode"], str] = {
    "contact": "R = {0:g} at the contact",
    "first mode": "R₁ = {0:g} of mode 1",
}

NO_MOTION = "no stable motion with one impact a drive period at this frequency in {0}"


@dataclass(frozen=True)
class LimitRow:
    """One quantity with one thing held: its ``values`` in ``counts`` modes, SI units.

    ``limit`` with its ``uncertainty``, NaN where it is refused, for the reason ``why``; ``rate`` p of N⁻ᵖ.
    ``frequency`` (Hz) of the exact motion or ``speed`` (m/s) of the collision that it is of, NaN where of neither.
    ``extrapolated``: the limit is not the last value. ``enough``: least of the counts from which every value is within
    1 % of the limit, 0 without. ``by_contact_time``: number of modes with less than one period in the contact time.
    """

    held: str
    quantity: str
    unit: str
    frequency: float
    speed: float
    counts: tuple[int, ...]
    values: tuple[float, ...]
    rate: float
    limit: float
    uncertainty: float
    extrapolated: bool
    enough: int
    by_contact_time: int
    why: str


@of_source
def limit(
    case: Case, counts: Sequence[int] = COUNTS, frequency: float | None = None, speed: float = SPEED,
    laws: Iterable[ContactLaw] = (),
) -> list[LimitRow]:  # fmt: skip
    """Limits of a case's rig over ``counts`` modes, each twice the one before.

    ``frequency`` (Hz) of the exact motions, None: the sweep's middle; ``speed`` (m/s) of collisions; ``laws``: further
    stops that yield. ValueError for a case without modes to add, a wrong count or a drive that no closed form takes.
    """
    scene = case.scene
    if scene.given_mode is not None or not isinstance(scene, RigScene):
        raise ValueError("a single degree of freedom given directly has no more modes")
    if list(counts) != [counts[0] * 2**k for k in range(len(counts))] or counts[0] < 1:
        raise ValueError(f"counts: {list(counts)} must each be twice the one before")
    at = float(np.median(case.sweep.frequency)) if frequency is None else frequency
    rows = [] if scene.stop.law is not None else list(_of_coefficient(case, scene, counts, at))
    own = () if scene.stop.law is None else (scene.stop.law,)
    for law in (*own, *laws):
        rows += _of_law(scene, law, counts, speed)
    return rows


def _of_coefficient(case: Case, scene: RigScene, counts: Sequence[int], at: float) -> Iterable[LimitRow]:
    """Rows with R and with R₁ held."""
    omega = 2 * np.pi * at
    if why := without_closed_forms(scene, np.array([omega])):
        raise ValueError(why)
    base = float(np.ravel(case.amplitude_of(next(iter(case.fidelities)), np.array([omega])))[0])
    for held, label in HELD.items():
        own, text = with_restitution(scene, held), label.format(scene.stop.usual_restitution)
        try:
            found = models(own, counts)
        except ValueError as refusal:
            yield _refused(text, counts, str(refusal))
            continue
        if why := next(filter(None, map(unsuited, found)), ""):
            raise ValueError(why)
        for sequence in of_restitution(found, held, omega, base, case.sweep.output):
            yield _row(text, counts, sequence, frequency=at if sequence.unit != "1" else nan)


def _of_law(scene: RigScene, law: ContactLaw, counts: Sequence[int], speed: float) -> list[LimitRow]:
    """Rows of one collision with a stop that yields."""
    text = f'law "{law.name}"'
    found = models(with_law(scene, law), counts)
    sequences = list(of_collision(found, speed))
    lasted = next(each.values[-1] for each in sequences if each.quantity == "contact time")
    enough = modes_by_contact_time(found[-1], lasted) if lasted > 0 else 0
    return [_row(text, counts, each, speed=speed, by_contact_time=enough) for each in sequences]


def _row(
    held: str, counts: Sequence[int], found: ModeSequence, *, frequency: float = nan, speed: float = nan,
    by_contact_time: int = 0,
) -> LimitRow:  # fmt: skip
    seen = ObservedLimit(nan, nan, nan, why=found.why) if found.why else observed_limit(counts, found.values)
    missing = [f"{count} modes" for count, value in zip(counts, found.values, strict=True) if not isfinite(value)]
    lost = NO_MOTION.format(", ".join(missing)) if missing else ""
    why = "; ".join(filter(None, [found.why, lost])) or seen.why
    return LimitRow(
        held, found.quantity, found.unit, frequency, speed, tuple(counts), found.values, seen.rate, seen.limit,
        seen.uncertainty, seen.extrapolated, _enough(counts, found.values, seen), by_contact_time, why,
    )  # fmt: skip


def _refused(held: str, counts: Sequence[int], why: str) -> LimitRow:
    values = (nan,) * len(counts)
    return LimitRow(held, "all", "1", nan, nan, tuple(counts), values, nan, nan, nan, False, 0, 0, why)


def _enough(counts: Sequence[int], values: Sequence[float], seen: ObservedLimit) -> int:
    """Least number of modes from which on every value is within 1 % of the limit, its uncertainty included; else 0."""
    if not isfinite(seen.limit) or not seen.limit:
        return 0
    off = np.abs(np.asarray(values) - seen.limit) + seen.uncertainty
    far = np.flatnonzero(~(off <= WITHIN * abs(seen.limit)))
    first = int(far[-1]) + 1 if len(far) else 0
    return counts[first] if first < len(counts) else 0
