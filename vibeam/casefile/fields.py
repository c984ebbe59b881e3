"""Entries that hold one value: a quantity, a count, a flag, a word, a text."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema
from pydantic_core.core_schema import ValidationInfo

from vibeam.casefile.quantities import FREQUENCY, RATIO, Dimension, to_si
from vibeam.casefile.unit_systems import SI, UnitSystem
from vibeam.exchange.faults import as_shown_in_message, suggestion


class Entry(ABC):
    """The reading of one value: pydantic calls ``read`` with the units of the case, and keeps what it returns."""

    @abstractmethod
    def parse(self, value: Any) -> Any:
        """The value in SI units; ValueError, whose text is the fault's message, if it is none."""

    def read(self, value: Any, units: UnitSystem | None) -> Any:
        """As ``parse``, in a case whose numbers without a unit are in ``units``; None: they need one."""
        return self.parse(value)

    @abstractmethod
    def describe(self) -> str:
        """Unit and range, for the reference table."""

    @abstractmethod
    def schema(self) -> dict[str, Any]:
        """The JSON schema of what ``parse`` takes, as near as one can say it."""

    def canonical(self, value: Any) -> Any:
        """The parsed value as plain data of TOML and JSON."""
        return value

    def nondimensional(self) -> Entry:
        """The same without a unit, for a case that has none; frequencies keep theirs."""
        return self

    def _validated(self, value: Any, info: ValidationInfo) -> Any:
        try:
            return self.read(value, info.context)
        except ValueError as error:
            raise PydanticCustomError("entry", "{text}", {"text": str(error)}) from None

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        written = core_schema.plain_serializer_function_ser_schema(self.canonical)
        return core_schema.with_info_plain_validator_function(self._validated, serialization=written)

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return self.schema()


class EntryInUnits(Entry):
    """The reading of a value whose numbers may have a dimension: ``read`` says it, ``parse`` takes them as SI."""

    def parse(self, value: Any) -> Any:
        """As ``Entry.parse``."""
        return self.read(value, SI)

    @abstractmethod
    def read(self, value: Any, units: UnitSystem | None) -> Any:
        """As ``Entry.read``."""


@dataclass(frozen=True)
class Range:
    """Numbers from ``low`` to ``high``, ``low`` itself only where ``closed``."""

    low: float = -math.inf
    high: float = math.inf
    closed: bool = True

    def check(self, number: float, value: Any) -> None:
        """ValueError, with the value as it was written, if the number is outside."""
        if not (self.low <= number <= self.high) or (number == self.low and not self.closed):
            raise ValueError(
                f"{as_shown_in_message(value)} {'is outside' if math.isfinite(self.high) else 'must be'} {self}"
            )

    def describe(self) -> str:
        """The range after a unit: ``"> 0"``, ``"in [0, 1]"``, empty where all numbers will do."""
        return f"in {self}" if math.isfinite(self.high) else str(self)

    def schema(self) -> dict[str, float]:
        """The range as JSON schema has it."""
        low = {"minimum" if self.closed else "exclusiveMinimum": self.low} if math.isfinite(self.low) else {}
        return low | ({"maximum": self.high} if math.isfinite(self.high) else {})

    def __str__(self) -> str:
        if self.low == -math.inf:
            return ""
        if self.high == math.inf:
            return f"{'≥' if self.closed else '>'} {self.low:g}"
        return f"[{self.low:g}, {self.high:.7g}]"


ANY = Range()
POSITIVE = Range(0, closed=False)
NOT_NEGATIVE = Range(0)


NUMBER_WITH_UNIT = r"^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?(\s|[A-Za-zµμ%]|1\s*/|$)"


@dataclass(frozen=True)
class Quantity(EntryInUnits):
    """A number of one kind, in SI."""

    kind: Dimension
    range: Range = ANY

    def read(self, value: Any, units: UnitSystem | None) -> float:
        """As ``Entry.read``."""
        number = to_si(value, self.kind, units)
        self.range.check(number, value)
        return number

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return " ".join(filter(None, [self.kind.unit or "number", self.range.describe()]))

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``: a number in SI units, or text that begins with one."""
        text = {"type": "string", "pattern": NUMBER_WITH_UNIT}
        return {"anyOf": [{"type": "number"} | self.range.schema(), text]} if self.kind.bare else text

    def canonical(self, value: Any) -> Any:
        """As ``Entry.canonical``."""
        return value if self.kind.bare or value is None else f"{value!r} {self.kind.unit}"

    def nondimensional(self) -> Quantity:
        """As ``Entry.nondimensional``."""
        return self if self.kind is FREQUENCY else Quantity(RATIO, self.range)


@dataclass(frozen=True)
class Count(Entry):
    """A whole number."""

    low: int
    high: int

    def parse(self, value: Any) -> int:
        """As ``Entry.parse``."""
        if not isinstance(value, int) or isinstance(value, bool):
            raise ValueError(f"must be a whole number, not {as_shown_in_message(value)}")
        Range(self.low, self.high).check(value, value)
        return value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return f"whole number {Range(self.low, self.high).describe()}"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"type": "integer", "minimum": self.low, "maximum": self.high}


@dataclass(frozen=True)
class Flag(Entry):
    """Yes or no."""

    def parse(self, value: Any) -> bool:
        """As ``Entry.parse``."""
        if not isinstance(value, bool):
            raise ValueError(f"must be {self.describe()}, not {as_shown_in_message(value)}")
        return value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return "true | false"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"type": "boolean"}


@dataclass(frozen=True)
class Word(Entry):
    """One of a few words."""

    words: Collection[str]

    def parse(self, value: Any) -> str:
        """As ``Entry.parse``."""
        if not isinstance(value, str):
            raise ValueError(f"must be one of {self.describe()}, not {as_shown_in_message(value)}")
        if value not in self.words:
            near = suggestion(value, self.words)
            meant = f"; did you mean {near!r}?" if near else ""
            raise ValueError(f"{as_shown_in_message(value)} is not one of {self.describe()}{meant}")
        return value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return " | ".join(f'"{word}"' for word in self.words)

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"enum": list(self.words)}


@dataclass(frozen=True)
class Text(Entry):
    """Free text."""

    def parse(self, value: Any) -> str:
        """As ``Entry.parse``."""
        if not isinstance(value, str):
            raise ValueError(f"must be text in quotes, not {as_shown_in_message(value)}")
        return value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return "text"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"type": "string"}
