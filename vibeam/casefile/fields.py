"""Entries of the case file that hold one value, or several in a row: quantities, counts, flags, words, texts."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from vibeam.casefile.quantities import ANY, NUMBER_WITH_UNIT, RATIO, SI, Dimension, Range, UnitSystem, to_si
from vibeam.exchange.faults import as_shown_in_message, suggestion
from vibeam_models.extensions import absent

JsonSchema = dict[str, Any]


class Entry(ABC):
    """Reading of one value."""

    @abstractmethod
    def read(self, value: Any, units: UnitSystem | None) -> Any:
        """Value in SI units; ValueError, whose text is the fault's message, if it is none.

        ``units``: those of numbers without one; None: they need one.
        """

    @abstractmethod
    def describe(self) -> str:
        """Unit and range, for the reference of keys."""

    @abstractmethod
    def schema(self) -> JsonSchema:
        """JSON schema of what is read, as near as one can say it."""

    def parse(self, value: Any) -> Any:
        """Value in SI units, in a case whose numbers are in these; errors as ``read``."""
        return self.read(value, SI)

    def canonical(self, value: Any) -> Any:
        """Plain data of TOML and JSON that reads as the value."""
        return value

    def nondimensional(self) -> Entry:
        """Entry without a unit, for a case that has none; frequencies, times and angles keep theirs."""
        return self

    def refusal(self, value: Any, article: str = "") -> ValueError:
        """Fault of a value that is none of this kind."""
        return ValueError(f"must be {article}{self.describe()}, not {as_shown_in_message(value)}")


def _unchanged(value: Any) -> Any:
    return value


@dataclass(frozen=True, eq=False)
class ValueEntry(Entry):
    """Entry without units: ``reading`` gives the value of what is written, or None where that is none of the kind.

    ``said`` and ``json``: its description and JSON schema; ``written``: its plain data.
    """

    reading: Callable[[Any], Any]
    said: str
    json: JsonSchema
    written: Callable[[Any], Any] = _unchanged

    def read(self, value: Any, units: UnitSystem | None) -> Any:
        """As ``Entry.read``."""
        found = self.reading(value)
        if found is None:
            raise self.refusal(value)
        return found

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return self.said

    def schema(self) -> JsonSchema:
        """As ``Entry.schema``."""
        return dict(self.json)

    def canonical(self, value: Any) -> Any:
        """As ``Entry.canonical``."""
        return self.written(value)


FLAG = ValueEntry(lambda value: value if isinstance(value, bool) else None, "true | false", {"type": "boolean"})


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise ValueError(f"must be text in quotes, not {as_shown_in_message(value)}")
    return value


TEXT = ValueEntry(_text, "text", {"type": "string"})


@dataclass(frozen=True)
class Quantity(Entry):
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

    def schema(self) -> JsonSchema:
        """As ``Entry.schema``: a number in SI units, or text that begins with one."""
        text = {"type": "string", "pattern": NUMBER_WITH_UNIT}
        return {"anyOf": [{"type": "number"} | self.range.schema(), text]} if self.kind.bare else text

    def canonical(self, value: Any) -> Any:
        """As ``Entry.canonical``."""
        return value if self.kind.bare or value is None else f"{value!r} {self.kind.unit}"

    def nondimensional(self) -> Quantity:
        """As ``Entry.nondimensional``."""
        return self if self.kind.unit in ("Hz", "rad", "s") else Quantity(RATIO, self.range)


@dataclass(frozen=True)
class Count(Entry):
    """A whole number."""

    low: int
    high: int

    def read(self, value: Any, units: UnitSystem | None = None) -> int:
        """As ``Entry.read``."""
        if not isinstance(value, int) or isinstance(value, bool):
            raise ValueError(f"must be a whole number, not {as_shown_in_message(value)}")
        Range(self.low, self.high).check(value, value)
        return value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return f"whole number {Range(self.low, self.high).describe()}"

    def schema(self) -> JsonSchema:
        """As ``Entry.schema``."""
        return {"type": "integer", "minimum": self.low, "maximum": self.high}


@dataclass(frozen=True)
class Word(Entry):
    """One of a few words, those that are registered now."""

    words: Collection[str]

    def read(self, value: Any, units: UnitSystem | None = None) -> str:
        """As ``Entry.read``."""
        if not isinstance(value, str):
            raise self.refusal(value, "one of ")
        if value not in self.words:
            near = suggestion(value, self.words)
            meant = f"; did you mean {near!r}?" if near else ""
            if why := absent(value):
                raise ValueError(f"{as_shown_in_message(value)}: {why}")
            raise ValueError(f"{as_shown_in_message(value)} is not one of {self.describe()}{meant}")
        return value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return " | ".join(f'"{word}"' for word in self.words)

    def schema(self) -> JsonSchema:
        """As ``Entry.schema``."""
        return {"enum": list(self.words)}


@dataclass(frozen=True)
class Several(Entry):
    """A list of at least one quantity; also one ``alone``, which then is a list of one, or a word instead."""

    each: Quantity
    alone: bool = False
    words: tuple[str, ...] = ()
    limit: int = 1_000_000
    ascending: bool = False

    def read(self, value: Any, units: UnitSystem | None) -> str | tuple[float, ...]:
        """As ``Entry.read``: the word or the numbers."""
        if isinstance(value, list):
            return self._numbers(value, units)
        if self.words and isinstance(value, str):
            return Word(self.words).read(value)
        if self.words or not self.alone:
            raise self.refusal(value)
        return (self.each.read(value, units),)

    def _numbers(self, values: list[Any], units: UnitSystem | None) -> tuple[float, ...]:
        if not 0 < len(values) <= self.limit:
            raise ValueError(f"a list of {len(values)} numbers is outside [1, {self.limit}]")
        numbers = tuple(_items(self.each, values, "number", units))
        if self.ascending and any(one >= two for one, two in pairwise(numbers)):
            raise ValueError("the list must ascend, each number once; the direction is said elsewhere")
        return numbers

    def nondimensional(self) -> Several:
        """As ``Entry.nondimensional``."""
        return replace(self, each=self.each.nondimensional())

    def describe(self) -> str:
        """As ``Entry.describe``."""
        one = [self.each.describe()] if self.alone else []
        return " | ".join([*(f'"{word}"' for word in self.words), *one, f"list of {self.each.describe()}"])

    def schema(self) -> JsonSchema:
        """As ``Entry.schema``."""
        several = {"type": "array", "items": self.each.schema(), "minItems": 1, "maxItems": self.limit}
        one = [self.each.schema()] if self.alone else []
        words = [Word(self.words).schema()] if self.words else []
        return {"anyOf": [*words, *one, several]} if words or one else several


@dataclass(frozen=True)
class OneOrSeveral(Entry):
    """A quantity, or a list of at least one."""

    each: Quantity

    def read(self, value: Any, units: UnitSystem | None) -> Any:
        """As ``Entry.read``: a number, or a tuple of numbers."""
        return (Several(self.each) if isinstance(value, list) else self.each).read(value, units)

    def nondimensional(self) -> OneOrSeveral:
        """As ``Entry.nondimensional``."""
        return OneOrSeveral(self.each.nondimensional())

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return f"{self.each.describe()} | list of them"

    def schema(self) -> JsonSchema:
        """As ``Entry.schema``."""
        return {"anyOf": [self.each.schema(), Several(self.each).schema()]}


@dataclass(frozen=True)
class Each(Entry):
    """A list of at least one entry of a kind, each only once; also one ``alone``. ``called``: a list of what it is."""

    of: Entry
    alone: bool = False
    called: str = ""

    def read(self, value: Any, units: UnitSystem | None = None) -> tuple[Any, ...]:
        """As ``Entry.read``."""
        if self.alone and isinstance(value, str):
            return (self.of.parse(value),)
        if not isinstance(value, list) or not value:
            shown = "an empty list" if value == [] else as_shown_in_message(value)
            raise ValueError(f"must be a {self.describe()}, not {shown}")
        found = tuple(_items(self.of, value, "entry"))
        if len(set(found)) < len(found):
            raise ValueError("names one of its entries twice")
        return found

    def describe(self) -> str:
        """As ``Entry.describe``."""
        one = self.of.describe()
        return f"{one} | list of them" if self.alone and not self.called else f"list of {self.called or one}"

    def schema(self) -> JsonSchema:
        """As ``Entry.schema``."""
        several = {"type": "array", "items": self.of.schema(), "minItems": 1, "uniqueItems": True}
        return {"anyOf": [self.of.schema(), several]} if self.alone else several


def _items(entry: Entry, values: list[Any], called: str, units: UnitSystem | None = SI) -> Iterator[Any]:
    for number, value in enumerate(values, 1):
        try:
            yield entry.read(value, units)
        except ValueError as error:
            raise ValueError(f"{called} {number} of the list: {error}") from None
