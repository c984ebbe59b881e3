"""Dimensions of a section as keys of a table that may leave them out, and the shape that the table then says."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from vibeam_models.beams.shapes import SHAPES, Shape
from vibeam_models.keys import declared, keys_of


def dimension(kind: str, name: str, end: str = "") -> Any:
    """One dimension of a shape, the beam's own where it is absent; ``end``: that at the stretch's end."""
    key = keys_of(SHAPES[kind])[name]
    meaning = f"{name} at the end of the stretch, to which it tapers; absent = as at its start" if end else key.meaning
    return declared(replace(key, meaning=meaning, written=False), None)


def shape_of(table: Any, own: Shape) -> Shape:
    """The shape that a table says by its ``shape`` and dimensions; what is absent is that of ``own``."""
    kind = type(own) if table.shape is None else SHAPES[table.shape]
    inherited = {each.name: getattr(own, each.name) for each in fields(own)} if isinstance(own, kind) else {}
    given = {name: getattr(table, name, None) for name in keys_of(kind)}
    return kind(**inherited | {name: value for name, value in given.items() if value is not None})
