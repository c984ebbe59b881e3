"""The function of a library that ``engine.call`` calls: one pointer to slots in, a status out.

It is written around what numba made of an entry point: an optimised LLVM module, and a signature as the manifest names
it. All that is known here of numba's inside (version as in ``constraints.txt``): an overload's ``library`` and
``fndesc``, and its calling convention: int32 status of (results*, exception**, all arguments taken apart), of an array
(meminfo, parent, items, bytes of an item, data, lengths…, strides…).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from inspect import signature
from itertools import count
from typing import Any

from numba import types

from vibeam.flight.engine.call import NUMBERS, Kind, axes_of, leaves
from vibeam.flight.engine.entries import EntryPoint

NAMES = {types.float64: "d", types.int64: "q"}
TYPES = {"d": "double", "q": "i64"}


@dataclass(frozen=True)
class Compiled:
    """One entry point."""

    entry: EntryPoint
    text: str  # its module in LLVM's language, with all that it calls
    symbol: str
    arguments: list[Any]
    results: list[str]
    names: list[Any]  # of the arguments


def compiled(entry: EntryPoint) -> Compiled:
    """The one specialisation that an entry point was compiled to; RuntimeError where there is none or several."""
    overloads = entry.function.overloads  # type: ignore[attr-defined]
    if len(overloads) != 1:
        raise RuntimeError(f"{entry.module}.{entry.name}: compiled for {len(overloads)} signatures, not one")
    [(given, found)] = overloads.items()
    answer = found.signature.return_type
    results = [] if answer == types.none else [NAMES[each] for each in answer.types]
    names = [_name(*each) for each in zip(signature(entry.function.py_func).parameters, given, strict=True)]  # type: ignore[attr-defined]
    text, symbol = found.library.get_llvm_str(), found.fndesc.llvm_func_name
    return Compiled(entry, text, symbol, [_kind(each) for each in given], results, names)


def _name(name: str, argument: Any) -> Any:
    """Name of an argument as the manifest has it: of a named tuple, with its class and its fields."""
    if isinstance(argument, types.BaseTuple):
        fields, kinds = argument.fields, iter(argument)  # type: ignore[attr-defined, call-overload]
        class_name = argument.instance_class.__name__  # type: ignore[attr-defined]
        return [name, class_name, *(_name(*each) for each in zip(fields, kinds, strict=True))]
    return name


def _kind(argument: Any) -> Any:
    """Kind of an argument as the manifest names it (``engine.loading``)."""
    if isinstance(argument, types.BaseTuple):
        return [_kind(each) for each in argument]  # type: ignore[attr-defined]
    if isinstance(argument, types.Array):
        if argument.layout != "C" or not argument.mutable:
            raise RuntimeError(f"{argument}: a library takes writable arrays in C order")
        return f"{NAMES[argument.dtype].replace('d', 'f').replace('q', 'i')}8:{argument.ndim}"
    return NAMES[argument]


def wrapper(compiled: Compiled, name: str) -> str:
    """LLVM module with ``i32 name(i64* slots)``: takes the slots apart and calls the kernel."""
    lines = _Lines(compiled)
    given = ", ".join(["ptr %results", "ptr %fault", *lines.given])
    taken = ", ".join(["ptr", "ptr", *(each.split()[0] for each in lines.given)])
    body = [
        f'declare i32 @"{compiled.symbol}"({taken})',
        f"define i32 @{name}(ptr %slots) {{",
        f"  %results = alloca {lines.whole if compiled.results else 'ptr'}",
        "  %fault = alloca ptr",
        "  store ptr null, ptr %fault",
        *lines.before,
        f'  %status = call i32 @"{compiled.symbol}"({given})',
        *lines.after,
        "  ret i32 %status",
        "}",
    ]
    return "\n".join(body)


class _Lines:
    """Instructions around the call, written as the slots are gone through in their order (see ``engine.call``).

    Numbers first, then room for the results, then arrays; the call has them in the kernel's order.
    """

    def __init__(self, compiled: Compiled) -> None:
        self.whole = "{" + ", ".join(TYPES[each] for each in compiled.results) + "}"
        self.before, self.after = list[str](), list[str]()
        self._names, self._slots = count(), count()
        arguments = list(enumerate(compiled.arguments))
        passed = {i: self._taken_apart(kind) for i, kind in arguments if kind in NUMBERS}
        for i, kind in enumerate(compiled.results):
            self._store(i, TYPES[kind])
        passed |= {i: self._taken_apart(kind) for i, kind in arguments if kind not in NUMBERS}
        self.given = [each for i, _ in arguments for each in passed[i]]

    def _taken_apart(self, kind: Kind) -> list[str]:
        """Arguments of the kernel for a number, an array or a tuple."""
        found: list[str] = []
        for each in leaves(kind):
            found += [self._load(TYPES[each])] if each in NUMBERS else self._array(axes_of(each))
        return found

    def _array(self, axes: int) -> list[str]:
        """meminfo, parent, items, bytes of an item, data, lengths, strides of an array in C order."""
        data = self._load("ptr")
        lengths = [self._load("i64") for _ in range(axes)]
        strides, step = ["i64 8"], "i64 8"
        for length in reversed(lengths[1:]):
            step = self._product(step, length)
            strides.insert(0, step)
        items = reduce(self._product, lengths)
        return ["ptr null", "ptr null", items, "i64 8", data, *lengths, *strides]

    def _product(self, a: str, b: str) -> str:
        name = f"%v{next(self._names)}"
        self.before.append(f"  {name} = mul i64 {a.split()[1]}, {b.split()[1]}")
        return f"i64 {name}"

    def _load(self, kind: str) -> str:
        name = f"%v{next(self._names)}"
        self.before.append(f"  {name}.at = getelementptr i64, ptr %slots, i64 {next(self._slots)}")
        self.before.append(f"  {name} = load {kind}, ptr {name}.at")
        return f"{kind} {name}"

    def _store(self, index: int, kind: str) -> None:
        name = f"%r{index}"
        self.after.append(f"  {name}.from = getelementptr {self.whole}, ptr %results, i32 0, i32 {index}")
        self.after.append(f"  {name} = load {kind}, ptr {name}.from")
        self.after.append(f"  {name}.at = getelementptr i64, ptr %slots, i64 {next(self._slots)}")
        self.after.append(f"  store {kind} {name}, ptr {name}.at")
