"""The words, kinds and ranges that several tables of a case share."""

from __future__ import annotations

from vibeam import units
from vibeam.entries.range import NOT_NEGATIVE, POSITIVE, Range
from vibeam.entries.single import Count, Quantity

DIRECTIONS = ("up", "down", "both")
QUANTITIES = ("amplitude", "reach", "maximum", "minimum", "impact_velocity", "impacts_per_period", "period")
EXTENTS = ("peak", "peak_frequency", "period_one_from", "period_one_to")  # of a whole branch
OF_INFLUENCE = (*EXTENTS, "ringing", "ringing_frequency", "apparent_restitution")
OUTPUTS = ("sensor", "contact", "tip", "platform")
ACCURATE = ("amplitude", "reach", "maximum", "minimum", "impact_velocity")  # what an accuracy can be asked of
FORMATS = ("png", "svg", "pdf")  # of figures
REDUCTIONS = ("static_mode", "modal", "full")
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
