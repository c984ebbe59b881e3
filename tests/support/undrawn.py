"""A figure whose curves are made and whose files are written, and that is neither laid out nor drawn."""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from typing import Any


class Undrawn:
    """Stands in for ``page.composed``: a file holds its metadata, a stamp among them, and blanks."""

    def __init__(self, make: Callable[[], Any]) -> None:
        self.figure = make()

    def set_layout_engine(self, engine: object) -> None:
        """Nothing is laid out."""

    def savefig(self, content: BytesIO, *, format: str, dpi: float, metadata: dict[str, Any]) -> None:
        content.write((b"\x89PNG" if format == "png" else b"") + str(metadata).encode() + b" " * 2000)
