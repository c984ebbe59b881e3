"""Rules that tables of a case share which say what is on a beam: which beam, and where on it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from vibeam_models.beams.support import Support, end_supports, holds, stiffnesses

NO_OPPOSITE = ("on", 'there is no opposite beam: add [opposite], or write on = "beam"')


def beam_of(table: Any, case: Any) -> Any:
    """The table of the beam that another table is of, with what [beam] says where [opposite] does not; None: none."""
    if table.on != "opposite":
        return case.beam
    return None if case.opposite is None else _Either(case.opposite, case.beam)


def place_faults(table: Any, case: Any) -> Iterator[tuple[str, str]]:
    """Faults of a table with a ``position``: beyond the tip of the beam it is of."""
    carrier = beam_of(table, case)
    if carrier is None:
        yield NO_OPPOSITE
    elif None not in (table.position, carrier.length) and table.position > carrier.length:
        yield "position", f"{table.position:g} m is beyond the tip: {length_of(table, carrier)}"


def length_of(table: Any, carrier: Any) -> str:
    """What a message says of the length of the beam that a table is of."""
    return f"{'beam' if table.on != 'opposite' else 'opposite'}.length is {carrier.length:g} m"


@dataclass(frozen=True)
class _Either:
    """Values of the first table that has them."""

    first: Any
    second: Any

    def __getattr__(self, name: str) -> Any:
        own = getattr(self.first, name, None)
        return getattr(self.second, name, None) if own is None else own


def stretch_faults(table: Any, carrier: Any) -> Iterator[tuple[str, str]]:
    """Faults of a table with ``start`` and ``end``: the wrong way round, beyond the beam it is of."""
    length = carrier.length
    if None not in (table.start, table.end) and table.end <= table.start:
        yield "end", f"{table.end:g} m is not beyond start, {table.start:g} m"
    elif None not in (table.end, length) and table.end > length:
        yield "end", f"{table.end:g} m is beyond the tip: {length_of(table, carrier)}"


def rigid_body_faults(ends: str, length: float | None, case: Any, on: str) -> Iterator[tuple[str, str]]:
    """Faults of the ends of a beam of ``length`` m that nothing holds, with its supports."""
    supports = [each for each in case.support if each.on == on]
    places = [each.position for each in supports if each.stiffness is None or each.stiffness > 0]
    if None in (length, *places) or length is None:
        return
    more = (Support(each.position, *stiffnesses(each)) for each in supports)
    if not holds((*end_supports(ends, length), *more)):
        own = "[[support]]" if on == "beam" else '[[support]] with on = "opposite"'
        yield "ends", f'"{ends}" leaves the beam to move as a rigid body: hold an end, or add {own}'
