"""Several numbers side by side in one register of the processor: a numba type, its arithmetic, loads and comparisons.

A loop over modes that the compiler may or may not turn into vector instructions is written out as such here, once for
every width: ``like`` (a value of the type) says how many. One lane is as good as a plain number.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, lower_builtin, models, register_model, type_callable

DOUBLE, WHOLE, BIT = ir.DoubleType(), ir.IntType(64), ir.IntType(1)
FUSED = ("contract",)  # a product and a sum may be rounded once
FREE_ORDER = ("reassoc", "nsz", "contract")
Lanes = Any  # a value of the type, to those who check types


class LanesType(types.Type):
    """``width`` doubles."""

    def __init__(self, width: int) -> None:
        self.width = width
        super().__init__(name=f"Lanes{width}")


def instruction(function: Callable[..., Any]) -> Any:
    """A function of the processor's: numba asks it for a type and for the code."""
    return intrinsic(function)


def by(code: Callable[[Any, Any], Any]) -> Callable[..., Any]:
    """Code that a builder and the arguments are enough for."""
    return lambda context, builder, signature, args: code(builder, args)


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: LanesType) -> None:
        super().__init__(manager, kind, _vector(kind))  # type: ignore[no-untyped-call]


def _vector(kind: LanesType, element: Any = DOUBLE) -> Any:
    return ir.VectorType(element, kind.width)


def _function(module: Any, kind: Any, name: str) -> Any:
    """One of the compiler's own functions."""
    return cgutils.get_or_insert_function(module, kind, name)  # type: ignore[no-untyped-call]


def _splat(builder: Any, kind: LanesType, value: Any, element: Any = DOUBLE) -> Any:
    """A plain number in every lane."""
    vector, nought = _vector(kind, element), ir.Constant(ir.IntType(32), 0)
    first = builder.insert_element(ir.Constant(vector, ir.Undefined), value, nought)
    mask = ir.Constant(ir.VectorType(ir.IntType(32), kind.width), [0] * kind.width)
    return builder.shuffle_vector(first, ir.Constant(vector, ir.Undefined), mask)


def _constant(kind: LanesType, value: float | int, element: Any = DOUBLE) -> Any:
    return ir.Constant(_vector(kind, element), [value] * kind.width)


def _both(context: Any, builder: Any, kind: LanesType, signature: Any, args: Any) -> list[Any]:
    """Both operands as vectors."""
    return [
        value if isinstance(of, LanesType) else _splat(builder, kind, context.cast(builder, value, of, types.float64))
        for of, value in zip(signature.args, args, strict=True)
    ]


def _arithmetic(symbol: Callable[..., Any], name: str) -> None:
    """Teach numba one binary operator, between lanes and with plain numbers."""

    def typing(context: Any) -> Callable[..., Any]:
        def typer(a: Any, b: Any) -> Any:
            kinds = [each for each in (a, b) if isinstance(each, LanesType)]
            plain = all(isinstance(each, (LanesType, types.Number)) for each in (a, b))
            return kinds[0] if kinds and plain else None

        return typer

    def lower(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        a, b = _both(context, builder, signature.return_type, signature, args)
        return getattr(builder, name)(a, b, flags=FUSED)

    type_callable(symbol)(typing)
    for pair in ((LanesType, LanesType), (LanesType, types.Number), (types.Number, LanesType)):
        lower_builtin(symbol, *pair)(lower)  # type: ignore[no-untyped-call]


for _symbol, _name in (
    (operator.add, "fadd"), (operator.iadd, "fadd"), (operator.sub, "fsub"), (operator.isub, "fsub"),
    (operator.mul, "fmul"),
):  # fmt: skip
    _arithmetic(_symbol, _name)


def _address(context: Any, builder: Any, kind: LanesType, array: Any, cells: Any, at: Any) -> Any:
    """Address of ``width`` numbers of a flat array."""
    data = context.make_array(array)(context, builder, cells).data
    return builder.bitcast(builder.gep(data, [at]), _vector(kind).as_pointer())


@instruction
def load(typing: Any, cells: Any, at: Any, like: Any) -> Any:
    """cells[at], cells[at + 1], …: as many as ``like`` has."""

    def lower(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        found = builder.load(_address(context, builder, like, cells, args[0], args[1]))
        found.align = 8
        return found

    return like(cells, types.intp, like), lower


@instruction
def store(typing: Any, cells: Any, at: Any, value: Any) -> Any:
    """cells[at], cells[at + 1], … = value."""

    def lower(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        builder.store(args[2], _address(context, builder, value, cells, args[0], args[1])).align = 8
        return context.get_dummy_value()

    return types.none(cells, types.intp, value), lower


@instruction
def every(typing: Any, value: Any, like: Any) -> Any:
    """A plain number in every lane."""
    return like(types.float64, like), by(lambda builder, args: _splat(builder, like, args[0]))


def _of_width(width: int) -> Any:
    @instruction
    def nought(typing: Any) -> Any:
        kind = LanesType(width)
        return kind(), by(lambda builder, args: _constant(kind, 0.0))

    return nought


one, eight = _of_width(1), _of_width(8)


@instruction
def width(typing: Any, like: Any) -> Any:
    """Number of lanes."""
    return types.intp(like), by(lambda builder, args: ir.Constant(WHOLE, like.width))


@instruction
def total(typing: Any, value: Any) -> Any:
    """The sum of all lanes, in any order."""

    def lower(builder: Any, args: Any) -> Any:
        kind = ir.FunctionType(DOUBLE, [DOUBLE, _vector(value)])
        add = _function(builder.module, kind, f"llvm.vector.reduce.fadd.v{value.width}f64")
        return builder.call(add, [ir.Constant(DOUBLE, -0.0), args[0]], fastmath=FREE_ORDER)

    return types.float64(value), by(lower)


@instruction
def size(typing: Any, value: Any) -> Any:
    """|value|."""

    def lower(builder: Any, args: Any) -> Any:
        kind = ir.FunctionType(_vector(value), [_vector(value)])
        return builder.call(_function(builder.module, kind, f"llvm.fabs.v{value.width}f64"), args)

    return value(value), by(lower)


def _extreme(order: str) -> Any:
    @instruction
    def extreme(typing: Any, a: Any, b: Any) -> Any:
        return a(a, a), by(lambda builder, args: builder.select(builder.fcmp_ordered(order, *args), *args))

    return extreme


larger, smaller = _extreme(">"), _extreme("<")

MAGIC = 6755399441055744.0  # 1.5·2⁵²: adding it rounds to a whole number, which then stands in the last bits


@instruction
def whole(typing: Any, value: Any) -> Any:
    """The nearest whole number, for |value| < 2⁵¹, as a number whose last bits hold it: see ``plain``."""
    return value(value), by(lambda builder, args: builder.fadd(args[0], _constant(value, MAGIC)))


@instruction
def plain(typing: Any, marked: Any) -> Any:
    """The whole number that ``whole`` found."""
    return marked(marked), by(lambda builder, args: builder.fsub(args[0], _constant(marked, MAGIC)))


@instruction
def scaled(typing: Any, value: Any, marked: Any) -> Any:
    """value · 2ⁿ for the whole number n ≥ −1022 that ``whole`` found, by its exponent bits."""

    def lower(builder: Any, args: Any) -> Any:
        bits = builder.bitcast(args[1], _vector(value, WHOLE))
        bits = builder.add(builder.shl(bits, _constant(value, 52, WHOLE)), _constant(value, 1023 << 52, WHOLE))
        return builder.fmul(args[0], builder.bitcast(bits, _vector(value)))

    return value(value, marked), by(lower)


@instruction
def quarter(typing: Any, own: Any, other: Any, marked: Any, ahead: Any) -> Any:
    """A turn by n quarters: ``own`` where n is even, else ``other``; minus that where bit 1 of n + ``ahead`` is set."""

    def lower(builder: Any, args: Any) -> Any:
        bits = builder.bitcast(args[2], _vector(own, WHOLE))
        odd = builder.icmp_unsigned("!=", builder.and_(bits, _constant(own, 1, WHOLE)), _constant(own, 0, WHOLE))
        found = builder.bitcast(builder.select(odd, args[1], args[0]), _vector(own, WHOLE))
        turned = builder.add(bits, _splat(builder, own, args[3], WHOLE))
        sign = builder.shl(builder.and_(turned, _constant(own, 2, WHOLE)), _constant(own, 62, WHOLE))
        return builder.bitcast(builder.xor(found, sign), _vector(own))

    return own(own, own, marked, types.int64), by(lower)


def _bits(builder: Any, width: int, flags: Any) -> Any:
    """A vector of flags as a whole number, one bit a lane."""
    return builder.zext(builder.bitcast(flags, ir.IntType(width)), WHOLE)


def _comparison(order: str) -> Any:
    @instruction
    def compare(typing: Any, a: Any, b: Any) -> Any:
        return types.int64(a, a), by(lambda builder, args: _bits(builder, a.width, builder.fcmp_ordered(order, *args)))

    return compare


below, at_most, equal = _comparison("<"), _comparison("<="), _comparison("==")


@instruction
def pick(typing: Any, bits: Any, a: Any, b: Any) -> Any:
    """``a`` in the lanes whose bits are set, ``b`` in the others."""

    def lower(builder: Any, args: Any) -> Any:
        flags = builder.bitcast(builder.trunc(args[0], ir.IntType(a.width)), ir.VectorType(BIT, a.width))
        return builder.select(flags, args[1], args[2])

    return a(types.int64, a, a), by(lower)


@instruction
def quotient(typing: Any, a: Any, b: Any) -> Any:
    """a / b."""
    return a(a, a), by(lambda builder, args: builder.fdiv(*args))


@instruction
def lowest(typing: Any, bits: Any) -> Any:
    """The number of the lowest bit set; of none, 64."""
    return types.int64(types.int64), by(lambda builder, args: builder.cttz(args[0], ir.Constant(BIT, 0)))
