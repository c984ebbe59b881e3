"""The function of a library that ``engine.call`` calls: one pointer to slots in, a status out.

It is written around what numba made of an entry point: an optimised LLVM module, and a signature as the manifest names
it. All that is known here of numba's inside (version as in ``constraints.txt``): an overload's ``library`` and
``fndesc``, and its calling convention: int32 status of (results*, exception**, all arguments taken apart), of an array
(meminfo, parent, items, bytes of an item, data, lengths…, strides…).
"""

from __future__ import annotations

from dataclasses import dataclass
from inspect import signature
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
    lines.write()
    result = "{" + ", ".join(TYPES[each] for each in compiled.results) + "}" if compiled.results else "ptr"
    given = ", ".join(["ptr %results", "ptr %fault", *lines.given])
    taken = ", ".join(["ptr", "ptr", *(each.split()[0] for each in lines.given)])
    body = [
        f'declare i32 @"{compiled.symbol}"({taken})',
        f"define i32 @{name}(ptr %slots) {{",
        f"  %results = alloca {result}",
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
    """Instructions around the call, written as the slots are gone through in their order (see ``engine.call``)."""

    def __init__(self, compiled: Compiled) -> None:
        self.compiled = compiled
        self.before: list[str] = []
        self.after: list[str] = []
        self.given: list[str] = []
        self._names = iter(range(10**6))

    def write(self) -> None:
        """Numbers first, then room for the results, then arrays; the call has them in the kernel's order."""
        arguments, results = self.compiled.arguments, self.compiled.results
        numbers = [i for i, kind in enumerate(arguments) if kind in NUMBERS]
        passed: dict[int, list[str]] = {}
        for slot, i in enumerate(numbers):
            passed[i] = [self._load(slot, TYPES[arguments[i]])]
        slot = len(numbers)
        for i, kind in enumerate(results):
            self._store(slot + i, i, TYPES[kind])
        slot += len(results)
        for i, kind in enumerate(arguments):
            if i not in passed:
                passed[i], slot = self._taken_apart(kind, slot)
        self.given = [each for i in range(len(arguments)) for each in passed[i]]

    def _taken_apart(self, kind: Kind, slot: int) -> tuple[list[str], int]:
        """Arguments of the kernel for an array or tuple whose slots begin there, and the slot behind them."""
        found: list[str] = []
        for each in leaves(kind):
            if each in NUMBERS:
                found.append(self._load(slot, TYPES[each]))
                slot += 1
                continue
            axes = axes_of(each)
            found += self._array(slot, axes)
            slot += 1 + axes
        return found, slot

    def _array(self, slot: int, axes: int) -> list[str]:
        """meminfo, parent, items, bytes of an item, data, lengths, strides of an array in C order."""
        data = self._load(slot, "ptr")
        lengths = [self._load(slot + 1 + axis, "i64") for axis in range(axes)]
        strides, step = ["i64 8"], "i64 8"
        for length in reversed(lengths[1:]):
            step = self._product(step, length)
            strides.insert(0, step)
        items, size = lengths[0], lengths[0]
        for length in lengths[1:]:
            items = size = self._product(size, length)
        return ["ptr null", "ptr null", items, "i64 8", data, *lengths, *strides]

    def _product(self, a: str, b: str) -> str:
        name = f"%v{next(self._names)}"
        self.before.append(f"  {name} = mul i64 {a.split()[1]}, {b.split()[1]}")
        return f"i64 {name}"

    def _load(self, slot: int, kind: str) -> str:
        name = f"%v{next(self._names)}"
        self.before.append(f"  {name}.at = getelementptr i64, ptr %slots, i64 {slot}")
        self.before.append(f"  {name} = load {kind}, ptr {name}.at")
        return f"{kind} {name}"

    def _store(self, slot: int, index: int, kind: str) -> None:
        name, whole = f"%r{index}", "{" + ", ".join(TYPES[each] for each in self.compiled.results) + "}"
        self.after.append(f"  {name}.from = getelementptr {whole}, ptr %results, i32 0, i32 {index}")
        self.after.append(f"  {name} = load {kind}, ptr {name}.from")
        self.after.append(f"  {name}.at = getelementptr i64, ptr %slots, i64 {slot}")
        self.after.append(f"  store {kind} {name}, ptr {name}.at")
