"""What a table and a key of the case file are."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field


def key(meaning: str, example: Any = None, default: Any = ..., *, written: bool = True) -> Any:
    """A key: what it means, an example for the template (there as a comment unless ``written``), its default."""
    return Field(default, description=meaning, examples=[example], json_schema_extra={"written": written})


class Table(BaseModel):
    """What all tables share: no unknown keys, never changed."""

    model_config = ConfigDict(extra="forbid", frozen=True)
