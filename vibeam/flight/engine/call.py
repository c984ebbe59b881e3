"""Calling a function of a library with numbers, numpy arrays and (nested) named tuples of them.

The function takes one pointer to 8-byte slots: the numbers of the call, room for its results, then every array as its
address and the length of each axis. Slots of an array, or of a tuple of arrays, are filled again only where it is not
the one of the thread's last call: filling costs more than calling.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator, Sequence
from operator import is_not, itemgetter
from struct import Struct
from threading import local
from typing import Any

import numpy as np

Kind = str | list[Any]  # see ``loading.manifest``
NUMBERS = ("d", "q")
KEPT = 1 << 20  # bytes of arrays that are kept alive for the next call at most
_address, _first_byte = ctypes.addressof, ctypes.c_char.from_buffer
NOTHING = object()  # no argument is this one


class Call:
    """A function of a library, called as the kernel that it was compiled from."""

    def __init__(
        self, function: Callable[[int], int], name: str, arguments: Sequence[Kind], results: Sequence[str]
    ) -> None:
        self.name, self._function = name, function
        numbers = [i for i, kind in enumerate(arguments) if kind in NUMBERS]
        arrays = [i for i, kind in enumerate(arguments) if kind not in NUMBERS]
        self._numbers_of, self._arrays_of = _picker(numbers), _picker(arrays)
        self._numbers = Struct("=" + "".join(str(arguments[i]) for i in numbers))
        self._results = Struct("=" + "".join(results))
        self._groups, end = [], self._numbers.size + self._results.size
        for i in arrays:
            self._groups.append(_Group(arguments[i], end))
            end += self._groups[-1].slots.size
        self._size, self._local = end // 8, local()

    def __call__(self, *given: Any) -> Any:
        """Its results, as a tuple; None where it has none. TypeError for an array of another type or layout."""
        try:
            frame = self._local.frame
        except AttributeError:
            frame = self._local.frame = _Slots(self._size, len(self._groups))
        arrays = self._arrays_of(given)
        if any(map(is_not, arrays, frame.kept)):
            self._fill(frame, arrays)
        self._numbers.pack_into(frame.slots, 0, *self._numbers_of(given))
        if self._function(frame.address):
            raise RuntimeError(f"{self.name}: the compiled kernel failed")
        return self._results.unpack_from(frame.slots, self._numbers.size) or None

    def _fill(self, frame: _Slots, arrays: Sequence[Any]) -> None:
        """Fill the slots of those that are not kept from the last call."""
        for i, (group, value) in enumerate(zip(self._groups, arrays, strict=True)):
            if value is not frame.kept[i]:
                frame.kept[i] = NOTHING
                try:
                    small = group.fill(frame.slots, value)
                except TypeError as fault:
                    raise TypeError(f"{self.name}: {fault}") from None
                frame.kept[i] = value if small else NOTHING


class _Slots:
    """The slots of one function and thread, and what they were filled from."""

    def __init__(self, size: int, groups: int) -> None:
        self.slots = (ctypes.c_int64 * size)()
        self.address = _address(self.slots)
        self.kept: list[Any] = [NOTHING] * groups


class _Group:
    """The slots, from byte ``at`` on, of one argument: an array, or a tuple of arrays and numbers."""

    def __init__(self, kind: Kind, at: int) -> None:
        parts = list(leaves(kind))
        self.at, self._arrays = at, [None if each in NUMBERS else (np.dtype(each[:2]), axes_of(each)) for each in parts]
        self.slots = Struct("=" + "".join(each if each in NUMBERS else "q" * (1 + axes_of(each)) for each in parts))

    def fill(self, slots: Any, value: Any) -> bool:
        """Fill them; whether the arrays are so small that they may be kept. TypeError for what does not fit."""
        found: list[Any] = []
        size = 0
        for array, item in zip(self._arrays, items_of(value), strict=True):
            if array is None:
                found.append(item)
                continue
            dtype, axes = array
            fits = isinstance(item, np.ndarray) and item.dtype == dtype and item.ndim == axes
            if not (fits and item.flags.carray):
                raise TypeError(f"needs a writable array {dtype} of {axes} axes in C order, not {_description(item)}")
            found.append(_address(_first_byte(item)) if item.size else 0)
            found.extend(item.shape)
            size += item.nbytes
        self.slots.pack_into(slots, self.at, *found)
        return size < KEPT


def leaves(kind: Kind) -> Iterator[str]:
    """The kinds in a tuple, nested ones too, in order."""
    if isinstance(kind, str):
        yield kind
    else:
        for each in kind:
            yield from leaves(each)


def axes_of(kind: str) -> int:
    """The number of axes of an array."""
    return int(kind[3:])


def items_of(value: Any) -> Iterator[Any]:
    """The items of a tuple, nested ones too, in order."""
    if isinstance(value, tuple):
        for each in value:
            yield from items_of(each)
    else:
        yield value


def _picker(places: Sequence[int]) -> Callable[[tuple[Any, ...]], Sequence[Any]]:
    """The values at these places, as a sequence."""
    if len(places) > 1:
        return itemgetter(*places)
    return lambda given: [given[i] for i in places]


def _description(value: Any) -> str:
    if not isinstance(value, np.ndarray):
        return type(value).__name__
    order, access = value.flags.c_contiguous, value.flags.writeable
    return f"{value.dtype} of {value.ndim} axes (in C order: {order}, writable: {access})"
