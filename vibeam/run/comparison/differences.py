"""Differences between fidelities: with either restitution held, and of the finest one from its own limit."""

from __future__ import annotations

from dataclasses import dataclass, field

from vibeam.case.held import Held
from vibeam.system.difference import NAN, Difference


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
    def turning(self) -> tuple[str, ...]:
        """Fidelities whose verdict turns with the choice."""
        return tuple(row.fidelity for row in self.rows if row.turns)
