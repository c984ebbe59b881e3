"""Stretch of a signal: its ends as a command has them, with units of time or frequency, and its parameters."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from vibeam.casefile.quantities import FREQUENCY, RATIO, TIME, suits, to_si
from vibeam.studies.identification.estimates import Identification
from vibeam.studies.identification.signal_kind import identify_signal


def identify_stretch(path: Path, since: str | None, until: str | None, **said: Any) -> Identification:
    """Parameters of the signal of a file as ``identify_signal``, from one time or frequency to another.

    The ends are numbers in s or Hz, or have a unit, which must be one of the signal's abscissa; ValueError as there.
    """
    ends = {"--from": since, "--to": until}
    kinds = {name: _kind(text) for name, text in ends.items() if text}
    found = [to_si(text, kinds[name]) if text else None for name, text in ends.items()]
    made = identify_signal(path, stretch=(found[0], found[1]), **said)
    wrong = {kind.unit for kind in kinds.values()} - {"", "s" if made.of == "decay" else "Hz"}
    if wrong:
        raise ValueError(f"{' and '.join(kinds)} in {wrong.pop()}, and it is a {made.of}: say another unit, or none")
    return made


def _kind(text: str) -> Any:
    """Kind of a quantity that is a time where it is neither a plain number nor a frequency."""
    return RATIO if suits(text, RATIO) and "%" not in text else FREQUENCY if suits(text, FREQUENCY) else TIME
