"""What a table and a key of the case file are."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from vibeam.casefile import quantities as units
from vibeam.casefile.fields import NOT_NEGATIVE, POSITIVE, Count, Quantity, Range


def key(meaning: str, example: Any = None, default: Any = ..., *, written: bool = True) -> Any:
    """A key: what it means, an example for the template (there as a comment unless ``written``), its default."""
    return Field(default, description=meaning, examples=[example], json_schema_extra={"written": written})


class Table(BaseModel):
    """What all tables share: no unknown keys, never changed."""

    model_config = ConfigDict(extra="forbid", frozen=True)


DIRECTIONS = ("up", "down", "both")

QUANTITIES = ("amplitude", "reach", "maximum", "minimum", "impact_velocity", "impacts_per_period", "period")

EXTENTS = ("peak", "peak_frequency", "period_one_from", "period_one_to")  # of a whole branch

OF_INFLUENCE = (*EXTENTS, "ringing", "ringing_frequency", "apparent_restitution")

OUTPUTS = ("sensor", "contact", "tip", "platform")

ACCURATE = ("amplitude", "reach", "maximum", "minimum", "impact_velocity")  # what an accuracy can be asked of

FORMATS = ("png", "svg", "pdf")  # of figures

LAWS = ("restitution", "velocity restitution", "linear", "hertz", "hunt-crossley")

MOST_ELEMENTS = 2000

MOST_POINTS = 1_000_000


Length = Place = Quantity(units.LENGTH, POSITIVE)

Ratio = Quantity(units.RATIO, NOT_NEGATIVE)

Unity = Quantity(units.RATIO, Range(0, 1))

Within = Quantity(units.RATIO, Range(1e-4, 1))

Frequency = Quantity(units.FREQUENCY, POSITIVE)

Speed = Quantity(units.SPEED, POSITIVE)

Periods = Count(0, MOST_POINTS)
