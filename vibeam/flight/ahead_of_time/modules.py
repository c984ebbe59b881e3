"""What numba made of an entry point: its optimised LLVM module, and its signature as the manifest names it.

All that is known here of numba's inside (version as in ``constraints.txt``): an overload's ``library`` and ``fndesc``,
and its calling convention: int32 status of (results*, exception**, all arguments taken apart), of an array (meminfo,
parent, items, bytes of an item, data, lengths…, strides…).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numba import types

from vibeam.flight.entries import Entry

NAMES = {types.float64: "d", types.int64: "q"}


@dataclass(frozen=True)
class Compiled:
    """One entry point."""

    entry: Entry
    text: str  # its module in LLVM's language, with all that it calls
    symbol: str
    arguments: list[Any]
    results: list[str]


def compiled(entry: Entry) -> Compiled:
    """The one specialisation that an entry point was compiled to; RuntimeError where there is none or several."""
    overloads = entry.function.overloads  # type: ignore[attr-defined]
    if len(overloads) != 1:
        raise RuntimeError(f"{entry.module}.{entry.name}: compiled for {len(overloads)} signatures, not one")
    [(signature, found)] = overloads.items()
    answer = found.signature.return_type
    results = [] if answer == types.none else [NAMES[each] for each in answer.types]
    return Compiled(
        entry, found.library.get_llvm_str(), found.fndesc.llvm_func_name, [_kind(each) for each in signature], results
    )


def _kind(argument: Any) -> Any:
    """As the manifest names it (``libraries.manifest``)."""
    if isinstance(argument, types.BaseTuple):
        return [_kind(each) for each in argument]  # type: ignore[attr-defined]
    if isinstance(argument, types.Array):
        if argument.layout != "C" or not argument.mutable:
            raise RuntimeError(f"{argument}: a library takes writable arrays in C order")
        return f"{NAMES[argument.dtype].replace('d', 'f').replace('q', 'i')}8:{argument.ndim}"
    return NAMES[argument]
