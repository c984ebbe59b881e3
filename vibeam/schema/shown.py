"""The tables of what is shown beside the curves, and of the chain that it is measured through."""

from __future__ import annotations

from typing import Annotated

from vibeam import units
from vibeam.entries.lists import Each, Several
from vibeam.entries.range import POSITIVE, Range
from vibeam.entries.single import Count, Flag, Quantity, Word
from vibeam.observe.filters import FAMILIES, HIGHEST_ORDER
from vibeam.plans import FigurePlan
from vibeam.schema.table import Table, key
from vibeam.schema.words import (
    FORMATS,
    MOST_POINTS,
    OUTPUTS,
    QUANTITIES,
    Frequency,
    Length,
    Periods,
)
from vibeam.settings import Names
from vibeam.show import KINDS, LIMITS


class ShowTable(Table):
    """A further figure beside the frequency-response curves, one table each."""

    kind: Annotated[str, Word(tuple(KINDS))] = key(
        "; ".join(f"{name}: {kind.meaning}" for name, kind in KINDS.items()), "portrait"
    )
    fidelities: Annotated[tuple[str, ...], Names("fidelities")] = key("whose; absent = all", ["sdof"], ())
    frequency: Annotated[tuple[float, ...] | None, Several(Frequency, alone=True, limit=12)] = key(
        "drive frequency, or several, a panel each", "15.3 Hz", None
    )
    periods: Annotated[int | None, Count(1, MOST_POINTS)] = key(
        "drive periods shown; absent = as many as the kind needs", 4, None
    )
    settle: Annotated[int | None, Periods] = key("drive periods left out before; absent = the sweep's", 500, None)
    quantity: Annotated[str | None, Word(QUANTITIES + LIMITS)] = key(
        "of a curve one of the response's, of boundaries one of the last two", "reach", None
    )
    output: Annotated[str | None, Word(OUTPUTS)] = key(
        "whose displacement; absent = the sweep's output", "contact", None, written=False
    )
    near: Annotated[float | None, Frequency] = key(
        "of ringing: where it is looked for; modes below two thirds of it are taken off", "101 Hz", None, written=False
    )
    highest: Annotated[int | None, Count(1, 100)] = key(
        "of harmonics: the last order; absent = 8", 8, None, written=False
    )
    subdivision: Annotated[int | None, Count(1, 64)] = key(
        "of harmonics: 2 shows orders ½, 1, 1½ …; absent = 1, whole orders", 2, None, written=False
    )


class FigureTable(Table):
    """How all figures of the case are written; absent = what the defaults say."""

    format: Annotated[tuple[str, ...], Each(Word(FORMATS), alone=True)] = key(
        "file format, or several", ["png", "svg"], FigurePlan.format, written=False
    )
    width: Annotated[float | None, Quantity(units.LENGTH, Range(0.04, 1.0))] = key(
        "of each figure; absent = by its number of panels", "140 mm", None, written=False
    )
    title: Annotated[bool, Flag()] = key("whether it has a title", False, True, written=False)


class MeasurementTable(Table):
    """The measuring chain through which histories, portraits, spectra, ringing and restitution are seen; absent = they
    are exact. Velocities are central differences of the record.
    """

    sampling: Annotated[float, Frequency] = key("samples a second", "5 kHz")
    low_pass: Annotated[str | None, Word(FAMILIES)] = key(
        "analog filter before sampling; absent = none", "bessel", None
    )
    order: Annotated[int | None, Count(1, HIGHEST_ORDER)] = key("of the filter", 4, None)
    cut_off: Annotated[float | None, Frequency] = key(
        "of the filter: gain 1/√2, or of an elliptic one where it leaves the ripple", "500 Hz", None
    )
    ripple: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "dB, of an elliptic filter's pass band; absent = 0.1", 0.1, None, written=False
    )
    attenuation: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "dB, of an elliptic filter's stop band; absent = 60", 60, None, written=False
    )
    quantisation: Annotated[float | None, Length] = key("step of the converter; absent = none", "1 µm", None)
    noise: Annotated[float | None, Length] = key("rms, white, on the samples; absent = none", "1 µm", None)
    seed: Annotated[int | None, Count(0, 2**31 - 1)] = key("of the noise, which needs one", 1, None)


class SdofMeasurementTable(MeasurementTable):
    """The measuring chain of the single degree of freedom."""

    quantisation: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "step of the converter, in the unit of the motion; absent = none", 1e-6, None
    )
    noise: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "rms, white, on the samples, in the unit of the motion; absent = none", 1e-6, None
    )
