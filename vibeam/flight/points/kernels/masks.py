"""Comparisons of lanes as bits of a whole number, one bit a lane, and choices by them."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types

from vibeam.flight.kernels.lanes.simd import WHOLE, instruction

BIT = ir.IntType(1)


def _bits(builder: Any, width: int, flags: Any) -> Any:
    """A vector of flags as a whole number."""
    return builder.zext(builder.bitcast(flags, ir.IntType(width)), WHOLE)


def _flags(builder: Any, width: int, bits: Any) -> Any:
    """A whole number as a vector of flags."""
    return builder.bitcast(builder.trunc(bits, ir.IntType(width)), ir.VectorType(BIT, width))


def _comparison(order: str) -> Any:
    @instruction
    def compare(typing: Any, a: Any, b: Any) -> Any:
        def lower(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return _bits(builder, a.width, builder.fcmp_ordered(order, args[0], args[1]))

        return types.int64(a, a), lower

    return compare


below, at_most, equal = _comparison("<"), _comparison("<="), _comparison("==")


@instruction
def pick(typing: Any, bits: Any, a: Any, b: Any) -> Any:
    """``a`` in the lanes whose bits are set, ``b`` in the others."""

    def lower(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.select(_flags(builder, a.width, args[0]), args[1], args[2])

    return a(types.int64, a, a), lower


@instruction
def quotient(typing: Any, a: Any, b: Any) -> Any:
    """a / b."""

    def lower(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.fdiv(args[0], args[1])

    return a(a, a), lower


@instruction
def lowest(typing: Any, bits: Any) -> Any:
    """The number of the lowest bit set; of none, 64."""

    def lower(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.cttz(args[0], ir.Constant(BIT, 0))

    return types.int64(types.int64), lower
