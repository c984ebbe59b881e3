"""Reading of a few numbers off an exact motion under a record: those asked for alone, the same as a run stores them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibeam.case.transient_quantities import QUANTITIES
from vibeam.runs.transient.energies import energy_balance
from vibeam.runs.transient.signals import FORCE, share_in_contact
from vibeam.runs.transient.transient import ENERGIES, IMPACTS
from vibeam.system.response import Ended

OF_SAMPLES = ("mean", "rms")  # quantities that samples over the whole record are read for


@dataclass(frozen=True)
class AskedNumber:
    """Number of a motion: a quantity, and the ``signal`` that it is of (empty: of none)."""

    quantity: str
    signal: str = ""

    def __str__(self) -> str:
        words = self.quantity.replace("_", " ")
        return f"{words} of {self.signal}" if self.signal else words


def suits(asked: Sequence[AskedNumber]) -> bool:
    """Test whether all numbers asked for can be read so."""
    return all(each.quantity not in OF_SAMPLES and each.signal != FORCE for each in asked)


def few_numbers(path: Any, record: Any, asked: Sequence[AskedNumber], duration: float) -> list[float]:
    """Numbers of an exact motion under a record of ``duration`` s; NaN of one that did not run to its end."""
    if path.ended is not Ended.COMPLETE:
        return [float("nan")] * len(asked)
    signals = list(dict.fromkeys(each.signal for each in asked if each.signal))
    extremes = _extremes(path, signals)
    energy = energy_balance(path, record) if any(each.quantity in ENERGIES for each in asked) else None
    return [_number(path, each, extremes, energy, duration) for each in asked]


def _extremes(path: Any, signals: list[str]) -> Mapping[tuple[str, str], float]:
    """Values of each quantity of an extreme, by it and the signal."""
    if not signals:
        return {}
    from vibeam.flight.extremes import extremes

    found = extremes(path, signals)
    parts = {"least": found.least[:, 0], "greatest": found.greatest[:, 0], "peak": found.peak}
    parts["peak_time"] = found.peak_time
    return {(name, signal): float(part[at]) for name, part in parts.items() for at, signal in enumerate(signals)}


def _number(path: Any, asked: AskedNumber, extremes: Any, energy: Any, duration: float) -> float:
    quantity = asked.quantity
    if QUANTITIES[quantity].of == "signal":
        return float(extremes[quantity, asked.signal])
    if quantity in ENERGIES:
        return float(np.sum(getattr(energy, ENERGIES[quantity])))
    if quantity == "rest":
        return share_in_contact(path)
    count = len(path.impact_times)
    if quantity in IMPACTS:
        known = path.impact_times if quantity == "first_impact" else path.impact_velocities
        return float(IMPACTS[quantity](known)) if count else float("nan")
    return count / duration if quantity == "impact_rate" else float(count)
