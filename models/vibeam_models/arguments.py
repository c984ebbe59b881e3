"""Numbers as constructors are given them: text, truth values and complex numbers are none."""

from __future__ import annotations

from collections.abc import Iterable
from math import isfinite, nan
from numbers import Number, Real
from typing import Any

import numpy as np

from vibeam_models.arrays import Array

FLOAT = np.dtype(float)
NUMERIC = "fiu"  # kinds of arrays that hold real numbers
TRUTH = (bool, np.bool_)


def real(value: Any) -> float | None:
    """``value`` as a finite float; None where it is none."""
    if type(value) is not float:
        if isinstance(value, np.ndarray) and value.ndim == 0:
            value = value[()]
        if not isinstance(value, Real) or isinstance(value, TRUTH):
            return None
        try:
            value = float(value)
        except OverflowError:
            return None
    return value if isfinite(value) else None


def whole(value: Any) -> int | None:
    """``value`` as an int, 10.0 too; None where it is none."""
    if type(value) is int:
        return value
    if isinstance(value, int | np.integer) and not isinstance(value, TRUTH):
        return int(value)
    number = real(value)
    return int(number) if number is not None and number.is_integer() else None


def read_only(value: Any) -> Array | None:
    """``value`` as a C-contiguous array of floats that nobody writes to, of any shape; None where it is none.

    A copy, unless the array is such a one already.
    """
    if type(value) is np.ndarray and value.base is None and value.dtype is FLOAT:
        flags = value.flags
        if not flags.writeable and flags.c_contiguous:
            return value
    given = real_array(value)
    if given is None:
        return None
    own = np.array(given, dtype=float, order="C")
    own.setflags(write=False)
    return own


def real_array(value: Any) -> Array | None:
    """``value`` as an array of floats of any shape, itself where it is one; None where it holds anything else."""
    try:
        given = np.asarray(value)
    except (ValueError, TypeError):
        return None
    return given.astype(float, copy=False) if given.dtype.kind in NUMERIC else None


def floats(name: str, value: Any) -> Array:
    """``value`` as an array of floats of any shape; ValueError, which names it, where it holds anything else."""
    given = real_array(value)
    if given is None:
        raise ValueError(f"{name}: must be a number or an array of numbers, not {shown(value)}")
    return given


def number(
    name: str, value: Any, faults: list[str],
    *, least: float | None = None, above: float | None = None, most: float | None = None,
) -> float:  # fmt: skip
    """``value`` as a float within the bounds; where it is none, NaN, and a line in ``faults`` that says so."""
    found = real(value)
    low = above is None or (found is not None and found > above)
    low = low and (least is None or (found is not None and found >= least))
    if found is not None and low and (most is None or found <= most):
        return found
    faults.append(f"{name}: {shown(value)} must be {_range(least, above, most)}")
    return nan


def settle(record: Any, subject: str, **bounds: dict[str, float]) -> None:
    """Keep these fields of a frozen record as floats within their ``bounds``; ValueError with every fault."""
    faults: list[str] = []
    for name, bound in bounds.items():
        object.__setattr__(record, name, number(name, getattr(record, name), faults, **bound))
    refuse(subject, faults)


def _range(least: float | None, above: float | None, most: float | None) -> str:
    if most is not None:
        return f"in {'(' if least is None else '['}{above if least is None else least:g}, {most:g}]"
    if least is None and above is None:
        return "a finite number"
    return f"a finite number {'above' if least is None else '≥'} {above if least is None else least:g}"


def count(name: str, value: Any, faults: list[str], least: int = 0, most: int | None = None) -> int:
    """``value`` as an int in the bounds; where it is none, ``least``, and a line in ``faults`` that says so."""
    found = whole(value)
    if found is not None and found >= least and (most is None or found <= most):
        return found
    bound = f"≥ {least}" if most is None else f"from {least} to {most}"
    faults.append(f"{name}: {shown(value)} must be a whole number {bound}")
    return least


def word(name: str, value: Any, known: Iterable[str], faults: list[str]) -> str:
    """``value`` where it is one of the ``known`` words; else the first of them, and a line in ``faults``."""
    words = list(known)
    if isinstance(value, str) and value in words:
        return value
    told = " or ".join(words) if len(words) < 3 else f"one of {', '.join(words)}"
    faults.append(f"{name}: {shown(value)} must be {told}")
    return words[0]


def shown(value: Any) -> str:
    """A value in a message: numbers and text as they are, anything else by its kind."""
    text = repr(value) if isinstance(value, str) else str(value)
    return (
        text if isinstance(value, str | Number | np.bool_ | None) and len(text) <= 40 else f"a {type(value).__name__}"
    )


def counted(number_of: float, what: str) -> str:
    """``1 mode``, ``2 modes``."""
    return f"{number_of:.0f} {what}{'' if number_of == 1 else 's'}"


def require(name: str, value: Any, kind: type[Any], none_too: bool = False) -> None:
    """ValueError unless ``value`` is of that class, or None where that is allowed."""
    if not (isinstance(value, kind) or (none_too and value is None)):
        raise ValueError(f"{name}: must be a {kind.__name__}, not {shown(value)}")


def refuse(subject: str, faults: list[str]) -> None:
    """ValueError with every fault in one line, where there is one."""
    if faults:
        raise ValueError("; ".join(f"{subject}: {fault}" if subject else fault for fault in faults))
