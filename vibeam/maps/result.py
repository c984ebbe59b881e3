"""Result of a map, or of what is known of it under way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from vibeam.case.plans import MapPlan
from vibeam.maps.evaluate import GridResponse

if TYPE_CHECKING:
    from vibeam.case.case import Case


@dataclass(frozen=True)
class MapResult:
    """A map: quantities of each fidelity (of very many points every so many along the last two axes).

    ``points`` in all, of which ``found`` were in the file; ``done`` of them are computed. ``path``: its file.
    """

    case: Case
    plan: MapPlan
    responses: Mapping[str, GridResponse]
    points: int
    found: int
    done: int
    path: Path

    def __getitem__(self, fidelity: str) -> GridResponse:
        return self.responses[fidelity]
