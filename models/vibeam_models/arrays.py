"""Names of the array types that every room speaks of; records that hold arrays, equal by value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from math import isnan
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Flags = NDArray[np.bool_]
Index = NDArray[np.int64]

WIDE = {"f": np.float64, "c": np.complex128, "i": np.int64, "u": np.int64}  # kinds that are compared as the widest one
ENTRIES, LETTERS = 4, 60  # of an array and of another value that a repr shows


class ValueRecord:
    """Record that may hold arrays: equal to one of its class where all fields are, every entry and NaN to NaN.

    Equal records have one hash, so they can be keys of a dict. A field with ``compare=False`` has no part in either.
    The repr is one line with the sizes of arrays. For dataclasses with ``eq=False, repr=False``.
    """

    def __eq__(self, other: object) -> bool:
        return _compared(self) == _compared(other) if type(other) is type(self) else NotImplemented

    def __hash__(self) -> int:
        return hash(_compared(self))

    def __repr__(self) -> str:
        known: Any = self
        parts = [f"{each.name}={_short(getattr(self, each.name))}" for each in fields(known) if each.repr]
        return f"{type(self).__name__}({', '.join(parts)})"


def _compared(value: Any) -> Any:
    """Value in a form that compares and hashes as a whole: arrays by shape and content, −0 as 0, every NaN as one."""
    if isinstance(value, np.ndarray):
        wide = value.astype(WIDE.get(value.dtype.kind, value.dtype))
        return wide.shape, (np.where(np.isnan(wide), np.nan, wide + 0) if wide.dtype.kind in "fc" else wide).tobytes()
    made = getattr(type(value), "__dataclass_params__", None)
    if made is not None and (made.eq or isinstance(value, ValueRecord)):
        return type(value), *(_compared(getattr(value, each.name)) for each in fields(value) if each.compare)
    if isinstance(value, Mapping):
        return frozenset((key, _compared(each)) for key, each in value.items())
    if isinstance(value, tuple | list):
        return tuple(map(_compared, value))
    return "NaN" if isinstance(value, float) and isnan(value) else value


def _short(value: Any) -> str:
    if isinstance(value, np.ndarray):
        few = value.ndim == 1 and value.size <= ENTRIES
        return f"[{', '.join(map(_short, value.tolist()))}]" if few else f"array{value.shape}"
    if isinstance(value, float | complex):
        return f"{value:.6g}"
    if isinstance(value, Mapping):
        return f"{{{', '.join(map(str, value))}}}"
    if isinstance(value, tuple | list) and len(repr(value)) > LETTERS:
        return f"{len(value)} × {type(value[0]).__name__}"
    return text if len(text := repr(value)) <= LETTERS else f"{type(value).__name__}(…)"
