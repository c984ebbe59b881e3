"""Examples of docstrings as blocks of code: what stands from ``>>>`` to the next empty line."""

from __future__ import annotations

import re
from typing import Any

import griffe

EXAMPLE = re.compile(r"^>>> .*?(?=\n[ \t]*\n|\Z)", re.DOTALL | re.MULTILINE)


def with_blocks(text: str) -> str:
    """A docstring whose examples are blocks of code of Markdown."""
    return EXAMPLE.sub(lambda found: f"\n```pycon\n{found[0].rstrip()}\n```\n", text)


class Examples(griffe.Extension):
    """Examples of every docstring, made blocks of code."""

    def on_object(self, *, obj: Any, **kwargs: Any) -> None:
        """Change the docstring of an object that was just read."""
        if obj.docstring:
            obj.docstring.value = with_blocks(obj.docstring.value)
