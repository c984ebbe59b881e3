"""A case with other values of some keys, as a fidelity sees it."""

from __future__ import annotations

import tomllib
from functools import lru_cache
from typing import TYPE_CHECKING

from vibeam.casefile.read import parse

if TYPE_CHECKING:
    from vibeam.case.case import Case

Settings = tuple[tuple[str, float], ...]
KEPT = 512  # cases


@lru_cache(maxsize=KEPT)
def varied(text: str, path: str, fidelity: str, settings: Settings) -> Case:
    """Case of a narrowed ``text`` with those keys set, in SI; they win over what the fidelity sets itself.

    CaseError where a value is none that the case may have.
    """
    tables = tomllib.loads(text)
    own = "set" in tables["fidelity"][fidelity]
    return parse(text, path, {_place(key, fidelity, own): _plain(value) for key, value in settings})


def _place(key: str, fidelity: str, own: bool) -> str:
    """Where a key is set: in the case, or among the fidelity's own, which come after the case's."""
    return f'fidelity.{fidelity}.set."{key}"' if own and not key.startswith("fidelity.") else key


def _plain(value: float) -> float | int:
    """A whole number as such: some keys count."""
    return int(value) if value.is_integer() else value
