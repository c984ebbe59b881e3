"""Tables of a case that say what is on a beam: dimensions that they may leave out, the beam they are of, its places."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from types import SimpleNamespace
from typing import Any

from vibeam_models.beams.beam import CANTILEVER, Support, end_supports, holds, stiffnesses
from vibeam_models.beams.shapes import SHAPES, Shape, foreign_dimensions
from vibeam_models.keys import declared, defaults_of, keys_of


def dimension(kind: str, name: str, end: str = "") -> Any:
    """One dimension of a shape, the beam's own where it is absent; ``end``: that at the stretch's end."""
    key = keys_of(SHAPES[kind])[name]
    meaning = f"{name} at the end of the stretch, to which it tapers; absent = as at its start" if end else key.meaning
    return declared(replace(key, meaning=meaning), None)


def shape_of(table: Any, own: Shape) -> Shape:
    """The shape that a table says by its ``shape`` and dimensions; what is absent is that of ``own``."""
    kind = type(own) if table.shape is None else SHAPES[table.shape]
    inherited = {each.name: getattr(own, each.name) for each in fields(own)} if isinstance(own, kind) else {}
    given = {name: getattr(table, name, None) for name in keys_of(kind)}
    return kind(**inherited | {name: value for name, value in given.items() if value is not None})


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
    """Length of the beam that a table is of, for a message."""
    return f"{'beam' if table.on != 'opposite' else 'opposite'}.length is {carrier.length:g} m"


@dataclass(frozen=True)
class _Either:
    """Values of the first table that has them."""

    first: Any
    second: Any

    def __getattr__(self, name: str) -> Any:
        own = getattr(self.first, name, None)
        return getattr(self.second, name, None) if own is None else own


def stretch_faults(table: Any, case: Any) -> Iterator[tuple[str, str]]:
    """Faults of a table with ``start`` and ``end``: the wrong way round, beyond the beam it is of."""
    carrier = beam_of(table, case)
    if carrier is None:
        yield NO_OPPOSITE
    elif None not in (table.start, table.end) and table.end <= table.start:
        yield "end", f"{table.end:g} m is not beyond start, {table.start:g} m"
    elif None not in (table.end, carrier.length) and table.end > carrier.length:
        yield "end", f"{table.end:g} m is beyond the tip: {length_of(table, carrier)}"


def dimension_faults(table: Any, carrier: Any) -> Iterator[tuple[str, str]]:
    """Faults of the dimensions of a table's ``shape``: of other shapes, missing, or such that they do not go together.

    They are those of the beam ``carrier`` where they are absent, as long as its shape is the same.
    """
    own = carrier.shape or "rectangle"
    name = table.shape or own
    kind = SHAPES[name]
    yield from foreign_dimensions(table, name)
    if name == own:
        yield from kind.faults(_Either(table, carrier))
        return
    for key, declaration in keys_of(kind).items():
        if getattr(table, key) is None and key not in defaults_of(kind):
            yield key, f'missing ({declaration.meaning}): write {key} = "{declaration.example}"'
    yield from kind.faults(table)


def is_free(case: Any, on: str) -> bool:
    """Test whether a beam of a case, ``"beam"`` or ``"opposite"``, can move as a rigid body, as far as can be read."""
    carrier = beam_of(SimpleNamespace(on=on), case)
    if carrier is None or carrier.length is None:
        return False
    ends = (case.beam if on == "beam" else case.opposite).ends or CANTILEVER
    own = [each for each in case.support if each.on == on and each.position is not None]
    more = (Support(each.position, *stiffnesses(each)) for each in own)
    return not holds((*end_supports(ends, carrier.length), *more))
