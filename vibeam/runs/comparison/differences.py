"""Differences between fidelities with either restitution held, and the sentences on them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isfinite

from vibeam.case.held import Held
from vibeam.system.curves import NAN
from vibeam.system.number_text import signed

SURE = 1e-4  # differences smaller than this share have no sign
PAIRS = 3  # largest number of fidelities whose differences stand in one line


@dataclass(frozen=True)
class BothChoices:
    """Difference of a fidelity's peak from the finest's as ``held`` and with the ``other`` choice; ``why``: not known.

    ``turns``: the peaks differ in opposite directions under the two choices.
    """

    fidelity: str
    held: float = NAN
    other: float = NAN
    why: str = ""

    @property
    def turns(self) -> bool:
        """True where the peak is too high with one choice and too low with the other."""
        return min(abs(self.held), abs(self.other)) > SURE and self.held * self.other < 0


@dataclass(frozen=True)
class HeldComparison:
    """Comparison with the fidelity ``finest``: what is ``held``, the ``other`` choice (None: there is none)."""

    finest: str
    held: Held
    other: Held | None
    rows: tuple[BothChoices, ...]

    @property
    def what(self) -> str:
        """Held restitution, in a sentence."""
        return self.held.label if self.held.coefficient is not None else f"the {self.held.label}"

    @property
    def turning(self) -> tuple[str, ...]:
        """Fidelities whose verdict turns with the choice."""
        return tuple(row.fidelity for row in self.rows if row.turns)


def headline(found: HeldComparison) -> str:
    """First line of a comparison: what is held, and whose verdict turns with the other choice."""
    if found.other is None or not found.rows:
        return f"Held in every fidelity: {found.held.label}."
    if found.turning:
        return (
            f"The verdict on {listed(found.turning)} turns with what is held: {found.held.label} here, "
            f"or {found.other.label}."
        )
    unknown = [row.fidelity for row in found.rows if not isfinite(row.other)]
    if len(unknown) == len(found.rows):
        return f"Held: {found.held.label}. What {found.other.label} held instead would give is not known."
    but = f"; of {listed(unknown)} that is not known" if unknown else ""
    return f"Held: {found.held.label}. With {found.other.label} held instead no verdict turns{but}."


def both_peaks(found: HeldComparison, most: int = PAIRS) -> str:
    """Peaks with the other choice beside those held, in one line; empty where none is known, or more than ``most``."""
    known = [row for row in found.rows if isfinite(row.other)]
    if found.other is None or not known or len(known) > most:
        return ""
    there = ", ".join(f"{row.fidelity} {signed(row.other)}" for row in known)
    here = ", ".join(signed(row.held) for row in known)
    return f"{found.other.symbol} held instead: {there} at peak (here {here})"


def doubts(found: HeldComparison) -> Iterator[str]:
    """Sentences on what is uncertain, with what to do: verdicts that turn."""
    if found.turning and found.other is not None:
        key = f"'stop.restitution_of=\"{found.other.restitution_of}\"'"
        yield f"{headline(found)[:-1]}: --set {key} compares so."


def settled(found: HeldComparison) -> Iterator[str]:
    """Sentences on a comparison beside its ``doubts``."""
    yield from () if found.turning else (headline(found),)
    if found.other is None:
        return
    reasons: dict[str, list[str]] = {}
    for row in found.rows:
        if row.why:
            reasons.setdefault(row.why, []).append(row.fidelity)
    for why, names in reasons.items():
        yield f"{listed(names)} with {found.other.label} held: not known ({why})"


def listed(names: Sequence[str]) -> str:
    """Names listed in a sentence; empty without any."""
    return " and ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))
