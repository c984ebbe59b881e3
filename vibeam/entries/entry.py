"""What all entries have in common: how pydantic calls them, and how they answer."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema


class Entry(ABC):
    """The reading of one value: pydantic calls ``parse`` and keeps what it returns."""

    @abstractmethod
    def parse(self, value: Any) -> Any:
        """The value in SI units; ValueError, whose text is the fault's message, if it is none."""

    @abstractmethod
    def describe(self) -> str:
        """Unit and range, for the reference table."""

    @abstractmethod
    def schema(self) -> dict[str, Any]:
        """The JSON schema of what ``parse`` takes, as near as one can say it."""

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

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return self.schema()
