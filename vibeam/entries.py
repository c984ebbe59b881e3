"""What one key of a case may hold: each entry reads a value, refuses what it cannot be, and describes itself."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from pydantic import BaseModel, GetCoreSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from vibeam.faults import shown, suggestion
from vibeam.units import Kind, to_si


@dataclass(frozen=True)
class Range:
    """Numbers from ``low`` to ``high``, ``low`` itself only where ``closed``."""

    low: float = -math.inf
    high: float = math.inf
    closed: bool = True

    def check(self, number: float, value: Any) -> None:
        """ValueError, with the value as it was written, if the number is outside."""
        if not (self.low <= number <= self.high) or (number == self.low and not self.closed):
            raise ValueError(f"{shown(value)} {'is outside' if math.isfinite(self.high) else 'must be'} {self}")

    def describe(self) -> str:
        """The range after a unit: ``"> 0"``, ``"in [0, 1]"``, empty where all numbers will do."""
        return f"in {self}" if math.isfinite(self.high) else str(self)

    def __str__(self) -> str:
        if self.low == -math.inf:
            return ""
        if self.high == math.inf:
            return f"{'≥' if self.closed else '>'} {self.low:g}"
        return f"[{self.low:g}, {self.high:.0f}]"


ANY = Range()
POSITIVE = Range(0, closed=False)
NOT_NEGATIVE = Range(0)


class Entry:
    """The reading of one value: pydantic calls ``parse`` and keeps what it returns."""

    def parse(self, value: Any) -> Any:
        """The value in SI units; ValueError, whose text is the fault's message, if it is none."""
        raise NotImplementedError

    def describe(self) -> str:
        """Unit and range, for the reference table."""
        raise NotImplementedError

    def canonical(self, value: Any) -> Any:
        """The parsed value as the canonical text writes it."""
        return value

    def _validated(self, value: Any) -> Any:
        try:
            return self.parse(value)
        except ValueError as error:
            raise PydanticCustomError("entry", "{text}", {"text": str(error)}) from None

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        written = core_schema.plain_serializer_function_ser_schema(self.canonical)
        return core_schema.no_info_plain_validator_function(self._validated, serialization=written)


@dataclass(frozen=True)
class Quantity(Entry):
    """A number of one kind, in SI."""

    kind: Kind
    range: Range = ANY

    def parse(self, value: Any) -> float:
        """As ``Entry.parse``."""
        number = to_si(value, self.kind)
        self.range.check(number, value)
        return number

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return " ".join(filter(None, [self.kind.unit or "number", self.range.describe()]))

    def canonical(self, value: Any) -> Any:
        """As ``Entry.canonical``."""
        return value if self.kind.bare or value is None else f"{value!r} {self.kind.unit}"


@dataclass(frozen=True)
class Count(Entry):
    """A whole number."""

    low: int
    high: int

    def parse(self, value: Any) -> int:
        """As ``Entry.parse``."""
        if not isinstance(value, int) or isinstance(value, bool):
            raise ValueError(f"must be a whole number, not {shown(value)}")
        Range(self.low, self.high).check(value, value)
        return value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return f"whole number {Range(self.low, self.high).describe()}"


@dataclass(frozen=True)
class Flag(Entry):
    """Yes or no."""

    def parse(self, value: Any) -> bool:
        """As ``Entry.parse``."""
        if not isinstance(value, bool):
            raise ValueError(f"must be {self.describe()}, not {shown(value)}")
        return value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return "true | false"


@dataclass(frozen=True)
class Word(Entry):
    """One of a few words."""

    words: tuple[str, ...]

    def parse(self, value: Any) -> str:
        """As ``Entry.parse``."""
        if not isinstance(value, str):
            raise ValueError(f"must be one of {self.describe()}, not {shown(value)}")
        if value not in self.words:
            near = suggestion(value, self.words)
            meant = f"; did you mean {near!r}?" if near else ""
            raise ValueError(f"{shown(value)} is not one of {self.describe()}{meant}")
        return value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return " | ".join(f'"{word}"' for word in self.words)


@dataclass(frozen=True)
class Text(Entry):
    """Free text."""

    def parse(self, value: Any) -> str:
        """As ``Entry.parse``."""
        if not isinstance(value, str):
            raise ValueError(f"must be text in quotes, not {shown(value)}")
        return value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return "text"


@dataclass(frozen=True)
class Options(Entry):
    """A table of names and plain values, whose meaning is another's: a solver's options."""

    def parse(self, value: Any) -> dict[str, str | float]:
        """As ``Entry.parse``."""
        if not isinstance(value, dict):
            raise ValueError(f"must be {self.describe()}, not {shown(value)}")
        wrong = [name for name, each in value.items() if not _is_plain(each)]
        if wrong:
            raise ValueError(f"{', '.join(wrong)}: must be a finite number or text in quotes")
        return dict(value)

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return "table { name = value, … }"


def _is_plain(value: Any) -> bool:
    return isinstance(value, str) or (isinstance(value, int | float) and math.isfinite(value))


@dataclass(frozen=True)
class Several(Entry):
    """A list of at least one quantity; also one alone, or a word instead, where ``alone`` or ``words`` say so."""

    each: Quantity
    alone: bool = False
    words: tuple[str, ...] = ()
    limit: int = 1_000_000
    ascending: bool = False

    def parse(self, value: Any) -> str | tuple[float, ...]:
        """As ``Entry.parse``: the word or the numbers."""
        if isinstance(value, list):
            return self._numbers(value)
        if self.words:
            return self._word(value)
        return (self.each.parse(value),) if self.alone else self._refuse(value)

    def _word(self, value: Any) -> str:
        return Word(self.words).parse(value) if isinstance(value, str) else str(self._refuse(value))

    def _refuse(self, value: Any) -> Any:
        raise ValueError(f"must be {self.describe()}, not {shown(value)}")

    def _numbers(self, values: list[Any]) -> tuple[float, ...]:
        if not 0 < len(values) <= self.limit:
            raise ValueError(f"a list of {len(values)} numbers is outside [1, {self.limit}]")
        numbers = tuple(self._item(index, value) for index, value in enumerate(values))
        if self.ascending and any(one >= two for one, two in pairwise(numbers)):
            raise ValueError("the list must ascend, each number once; the direction is said elsewhere")
        return numbers

    def _item(self, index: int, value: Any) -> float:
        try:
            return self.each.parse(value)
        except ValueError as error:
            raise ValueError(f"number {index + 1} of the list: {error}") from None

    def describe(self) -> str:
        """As ``Entry.describe``."""
        one = [self.each.describe()] if self.alone else []
        return " | ".join([*(f'"{word}"' for word in self.words), *one, f"list of {self.each.describe()}"])


@dataclass(frozen=True)
class Each(Entry):
    """A list of at least one entry of a kind, each only once."""

    of: Entry

    def parse(self, value: Any) -> tuple[Any, ...]:
        """As ``Entry.parse``."""
        if not isinstance(value, list) or not value:
            raise ValueError(f"must be a {self.describe()}, not {shown(value) if value != [] else 'an empty list'}")
        found = tuple(self._item(index, each) for index, each in enumerate(value))
        if len(set(found)) < len(found):
            raise ValueError("names one of its entries twice")
        return found

    def _item(self, index: int, value: Any) -> Any:
        try:
            return self.of.parse(value)
        except ValueError as error:
            raise ValueError(f"entry {index + 1} of the list: {error}") from None

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return f"list of {self.of.describe()}"


@dataclass(frozen=True)
class TableOr(Entry):
    """A table of its own (a model), or a list instead."""

    table: type[BaseModel]
    several: Several

    def parse(self, value: Any) -> Any:
        """As ``Entry.parse``, of the list alone: the table is read by its model."""
        if not isinstance(value, list):
            raise ValueError(f"must be {{ {', '.join(self._names())} }} or a {self.describe()}, not {shown(value)}")
        return self.several.parse(value)

    def _names(self) -> list[str]:
        return [field.alias or name for name, field in self.table.model_fields.items()]

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return self.several.describe()

    def canonical(self, value: Any) -> Any:
        """As ``Entry.canonical``."""
        return value.model_dump(by_alias=True) if isinstance(value, BaseModel) else value

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        def either(value: Any, inner: Any) -> Any:
            return inner(value) if isinstance(value, dict) else self._validated(value)

        written = core_schema.plain_serializer_function_ser_schema(self.canonical)
        inner = handler.generate_schema(self.table)
        return core_schema.no_info_wrap_validator_function(either, inner, serialization=written)
