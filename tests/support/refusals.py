"""What a constructor or a call refuses: a table of wrong arguments in one loop."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any


def answers(call: Callable[[Any], object], given: Iterable[Any], said: str) -> list[tuple[Any, str]]:
    """What is not refused by a ValueError that matches ``said``, each with what came instead."""
    found = []
    for wrong in given:
        try:
            answer = repr(call(wrong))
        except ValueError as error:
            answer = str(error)
            if re.search(said, answer):
                continue
        found.append((wrong, answer))
    return found


def other_answers(call: Callable[[Any], object], wrong: Mapping[str, Any]) -> list[tuple[Any, str]]:
    """``answers`` of a table: what each argument is to be refused with → the argument."""
    return [each for said, one in wrong.items() for each in answers(call, [one], said)]
