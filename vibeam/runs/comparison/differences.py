"""Differences between fidelities, with either restitution held and from the own limit, and the sentences on them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from math import isfinite

from vibeam.case.held import Held
from vibeam.runs.comparison.limit import GIVEN
from vibeam.system.curves import NAN, Difference
from vibeam.system.number_text import percent, signed


@dataclass(frozen=True)
class OwnLimit:
    """Distance of a fidelity from its own limit, ``held`` and with the ``other`` choice; ``why``: it is not known.

    Computed with ``modes`` modes on ``elements`` elements.
    """

    held: Difference = field(default_factory=Difference)
    other: Difference = field(default_factory=Difference)
    modes: int = 0
    elements: int = 0
    why: str = ""


@dataclass(frozen=True)
class BothChoices:
    """Difference of a fidelity from the finest as ``held`` and with the ``other`` choice; ``why``: it is not known.

    ``uncertainty`` of the peak's (of the rms without one), held and other: the share that the finest's distance from
    its limit has in it, NaN where unknown. ``turns``: the peaks differ in opposite directions under the two choices,
    in each by more than that. ``small``: it is small against the difference held.
    """

    fidelity: str
    held: Difference
    other: Difference
    uncertainty: tuple[float, float] = (NAN, NAN)
    turns: bool = False
    small: bool = True
    why: str = ""


@dataclass(frozen=True)
class HeldComparison:
    """Comparison with the fidelity ``finest``: what is ``held``, the ``other`` choice (None: there is none)."""

    finest: str
    held: Held
    other: Held | None
    rows: tuple[BothChoices, ...]
    limit: OwnLimit
    cpu_seconds: float

    @property
    def what(self) -> str:
        """Held restitution, in a sentence."""
        return self.held.label if self.held.coefficient is not None else f"the {self.held.label}"

    @property
    def turning(self) -> tuple[str, ...]:
        """Fidelities whose verdict turns with the choice."""
        return tuple(row.fidelity for row in self.rows if row.turns)


NOTHING = 1e-4  # difference in amplitude below which two fidelities are one
PAIRS = 3  # largest number of fidelities whose differences stand in one line


def headline(found: HeldComparison) -> str:
    """First line of a comparison: what is held, and whose verdict turns with the other choice."""
    if found.other is None or not found.rows:
        return f"Held in every fidelity: {found.held.label}."
    if found.turning:
        return (
            f"The verdict on {listed(found.turning)} turns with what is held: {found.held.label} here, "
            f"or {found.other.label}."
        )
    unknown = [row.fidelity for row in found.rows if not isfinite(row.other.peak)]
    if len(unknown) == len(found.rows):
        return f"Held: {found.held.label}. What {found.other.label} held instead would give is not known."
    but = f"; of {listed(unknown)} that is not known" if unknown else ""
    return f"Held: {found.held.label}. With {found.other.label} held instead no verdict turns{but}."


def both_peaks(found: HeldComparison, most: int = PAIRS) -> str:
    """Peaks with the other choice beside those held, in one line; empty where none is known, or more than ``most``."""
    known = [row for row in found.rows if isfinite(row.other.peak)]
    if found.other is None or not known or len(known) > most:
        return ""
    there = ", ".join(f"{row.fidelity} {signed(row.other.peak)}" for row in known)
    here = ", ".join(signed(row.held.peak) for row in known)
    return f"{found.other.symbol} held instead: {there} at peak (here {here})"


def doubts(found: HeldComparison) -> Iterator[str]:
    """Sentences on what is uncertain, with what to do: verdicts that turn, a distance from the limit that counts."""
    if found.turning and found.other is not None:
        key = f"'stop.restitution_of=\"{found.other.restitution_of}\"'"
        yield f"{headline(found)[:-1]}: --set {key} compares so."
    if _near(found):
        yield f"{_own_limit(found)}."


def settled(found: HeldComparison) -> Iterator[str]:
    """Sentences on a comparison beside its ``doubts``."""
    yield from () if found.turning else (headline(found),)
    yield from _unknown(found)
    yield from () if _near(found) else filter(None, [_own_limit(found)])


def _near(found: HeldComparison) -> list[BothChoices]:
    """Fidelities whose differences are not large beside the finest one's distance from its limit."""
    return [row for row in found.rows if not row.small and abs(_of(row)) > NOTHING]


def _unknown(found: HeldComparison) -> Iterator[str]:
    if found.other is None:
        return
    reasons: dict[str, list[str]] = {}
    for row in found.rows:
        if row.why and row.why != found.limit.why:
            reasons.setdefault(row.why, []).append(row.fidelity)
    for why, names in reasons.items():
        yield f"{listed(names)} with {found.other.label} held: not known ({why})"


def _own_limit(found: HeldComparison) -> str:
    if found.other is None and not found.held.law:
        return ""
    own, name = found.limit, found.finest
    if own.why:
        cure = "" if own.why == GIVEN else ": compare it with more modes"
        return f"{name}: distance from its own limit not estimated ({own.why}){cure}"
    near = [f"{row.fidelity} ({signed(_of(row))} ± {percent(row.uncertainty[0])})" for row in _near(found)]
    but = f"; that is not small against {listed(near)}: {_cure(found)}" if near else ""
    return f"{name} is off its own limit by {_distance(own)}{but}"


def _distance(own: OwnLimit) -> str:
    peak = f"{signed(own.held.peak)} at the peak, " if isfinite(own.held.peak) else ""
    return f"{peak}{percent(own.held.rms)} rms (estimated at {own.held.points} of {own.held.total} frequencies)"


def _of(row: BothChoices) -> float:
    return row.held.peak if isfinite(row.held.peak) else row.held.rms


def _cure(found: HeldComparison) -> str:
    own = found.limit
    if found.other is not None and abs(own.other.peak) < abs(own.held.peak) / 2:
        return f"take more modes, or hold {found.other.symbol} ({signed(own.other.peak)})"
    return "take more modes"


def listed(names: Sequence[str]) -> str:
    """Names listed in a sentence; empty without any."""
    return " and ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))
