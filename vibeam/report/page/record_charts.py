"""Numbers of the page of a record case: histories, impacts, curves over velocity, frequency and the factor."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator, Sequence
from itertools import cycle
from typing import TYPE_CHECKING, Any
from zlib import compress

import numpy as np

from vibeam.case.case import plan_of_record
from vibeam.figures.kinds.impact_velocities import ERRORS, exceedance
from vibeam.figures.record import input_of, kept_place, label_of, signals_of_all, unit_of_signal
from vibeam.figures.style import looks_of, name_of
from vibeam.figures.units import with_unit
from vibeam.report.page.charts import STEPS, packed, rounded
from vibeam.report.page.parts import look_on_page
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.observe.decimation import History
    from vibeam.runs.transient.result import TransientResult

HISTORIES_BYTES, IMPACTS_BYTES = 440_000, 120_000  # of all histories on the page, of all impacts
IMPACT_BYTES = 8.0  # as text
FEWEST, CLOSE = 1024, 512  # bins of a history, of one around a mark at most
WIDE = 2**32 - 1  # steps of an array's range
WINDOW = 24  # impacts around a mark

Impacts = tuple[Array, Array]


def record_data(result: TransientResult) -> dict[str, Any]:
    """All numbers of the page's charts, as plain lists, in SI with the factors to the units shown."""
    case, names, place = result.case, list(result), kept_place(result)
    looks = looks_of(case, names)
    impacts = {name: (result[name].impact_times[place][0], result[name].impact_velocities[place][0]) for name in names}
    hardest = max((float(np.max(speeds, initial=0.0)) for _, speeds in impacts.values()), default=0.0)
    unit, factor = unit_of_signal(case, "m s-1", hardest)
    histories, marks = list(_histories(result)), list(_marks(result, impacts))
    return {
        "span": [0.0, plan_of_record(case).duration],
        "fidelities": [{"name": name, "label": name_of(case, name), **look_on_page(looks[name])} for name in names],
        "signals": list(_signals(result, histories)),
        "histories": _stored(result, histories, marks),
        "impacts": [_impacts(name, *met, IMPACTS_BYTES / max(len(names), 1)) for name, met in impacts.items()],
        "contact_speed": {"unit": unit, "factor": factor},
        "marks": marks,
        "families": {name: charts for name, charts in _families(result).items() if charts},
    }


def _histories(result: TransientResult) -> Iterator[tuple[str, str, History]]:
    """Signal, fidelity (empty: of all) and history of all that the result keeps."""
    for history in list(result.input.values())[:1]:
        if history.peak > 0:
            yield "input", "", history
    for signal in signals_of_all(result, list(result)):
        yield from ((signal, name, own[signal]) for name in result if signal in (own := result[name].history))


def _stored(
    result: TransientResult, histories: Sequence[tuple[str, str, History]], marks: Sequence[dict[str, Any]]
) -> list[dict[str, Any]]:
    """Histories with as many bins as the page has room for, accelerations and then velocities the first with fewer.

    Around the marks those that were merged are there in their own bins too.
    """
    orders = {name: each.order for name, each in signals_of_all(result, list(result)).items()}
    bins = dict.fromkeys(range(-1, 3), max((len(each) for _, _, each in histories), default=FEWEST))
    made = [_history(*each, bins[0]) for each in histories]
    for order in cycle((2, 1, 0, -1)):
        if sum(len(each["data"]) for each in made) <= HISTORIES_BYTES or max(bins.values()) <= FEWEST:
            break
        bins[order] //= 2
        for place, each in enumerate(histories):
            if orders.get(each[0], 0) == order:
                made[place] = _history(*each, bins[order])
    merged = [each for each, own in zip(histories, made, strict=True) if own["bins"] < len(each[2])]
    return made + [_history(*each, CLOSE, (mark["begin"], mark["end"])) for mark in marks for each in merged]


def _history(
    signal: str, fidelity: str, history: History, bins: int, span: tuple[float, float] | None = None
) -> dict[str, Any]:
    """A history in so many ``bins`` at most, of all of it or of those that meet a ``span``, s."""
    begin, end = span or (float(history.edges[0]), float(history.edges[-1]))
    seen = history.within(begin, end, bins)
    width = float(seen.edges[1] - seen.edges[0])
    head = {"signal": signal, "fidelity": fidelity, "begin": float(seen.edges[0]), "width": width}
    return head | enclosing(seen.least, seen.greatest)


def enclosing(least: Array, greatest: Array) -> dict[str, Any]:
    """Both in steps of 1/65535 of their common range, rounded outward, so that no value lies outside; compressed."""
    low, high = float(np.min(least, initial=np.inf)), float(np.max(greatest, initial=-np.inf))
    step = (high - low) / STEPS if high > low else 0.0
    scaled = [(each - low) / step if step else 0 * each for each in (least, greatest)]
    below, above = (
        np.clip(side(each), 0, STEPS).astype(int) for side, each in zip((np.floor, np.ceil), scaled, strict=True)
    )
    words = (np.diff(below, prepend=0) & STEPS, above - below)
    planes = np.concatenate([part for each in words for part in (each & 255, each >> 8)]).astype(np.uint8)
    return {"low": low, "step": step, "bins": len(below), "data": b64encode(compress(planes.tobytes(), 9)).decode()}


def _impacts(name: str, times: Array, speeds: Array, room: float) -> dict[str, Any]:
    """Impacts of a fidelity, the times in 32 bits; of too many for the page the hardest."""
    order, met = np.sort(np.argsort(-speeds, kind="stable")[: int(room / IMPACT_BYTES)]), len(speeds)
    times, speeds = times[order], speeds[order]
    low, span = (float(times[0]), float(times[-1] - times[0])) if len(times) else (0.0, 0.0)
    whole = np.rint((times - low) / span * WIDE if span > 0 else 0 * times).astype("<u4")
    packed_times = {"low": low, "step": span / WIDE, "data": b64encode(whole.tobytes()).decode(), "wide": True}
    return {"fidelity": name, "time": packed_times, "velocity": packed(speeds), "met": met}


def _signals(result: TransientResult, histories: Sequence[tuple[str, str, History]]) -> Iterator[dict[str, Any]]:
    case, known = result.case, signals_of_all(result, list(result))
    for name in dict.fromkeys(signal for signal, _, _ in histories):
        label, unit, order = "input", "1", 0
        if name == "input":
            label, unit = input_of(case)
        else:
            label, unit, order = label_of(known[name]), known[name].unit, known[name].order
        largest = max(each.peak for signal, _, each in histories if signal == name)
        shown, factor = unit_of_signal(case, unit, largest)
        yield {"name": name, "label": label, "order": order, "unit": shown, "factor": factor}


def _marks(result: TransientResult, impacts: dict[str, Impacts]) -> Iterator[dict[str, Any]]:
    """Parts of the record that are worth a look: the first impact, each fidelity's largest value."""
    case, place, duration = result.case, kept_place(result), plan_of_record(result.case).duration
    first = min((float(times[0]) for times, _ in impacts.values() if len(times)), default=None)
    if first is not None:
        yield _mark("first impact", first, impacts.values(), duration)
    for name in result:
        at = float(result[name].peak_time[place, 0, 0])
        if np.isfinite(at):
            yield _mark(f"peak of {name_of(case, name)}", at, [impacts[name]], duration)


def _mark(label: str, at: float, impacts: Any, duration: float) -> dict[str, Any]:
    """A part of the record around ``at`` (s), as wide as it takes to have some impacts."""
    near = np.sort(np.abs(np.concatenate([times for times, _ in impacts]) - at))
    half = min(float(near[WINDOW]) if len(near) > WINDOW else duration / 40, duration / 8)
    return {"label": label, "begin": max(at - half, 0.0), "end": min(at + half, duration)}


def _families(result: TransientResult) -> dict[str, list[dict[str, Any]]]:
    """Charts of curves over a number, by the section of the page that they stand in."""
    return {
        "velocities": list(_velocities(result)),
        "factor": list(_over_factor(result)) if len(result.factors) > 1 else [],
        "spectra": list(_spectra(result)),
    }


def _curve(fidelity: str, x: Array, y: Array, error: Array, marks: bool = False, steps: bool = False) -> dict[str, Any]:
    """Curve with the band of two standard errors."""
    values = {"x": x, "y": y, "low": y - ERRORS * error, "high": y + ERRORS * error}
    return {
        "fidelity": fidelity,
        "marks": marks,
        "steps": steps,
        **{key: rounded(each, 5) for key, each in values.items()},
    }


def _chart(label: str, across: str, up: str, logs: tuple[bool, bool], note: str, curves: Any) -> dict[str, Any]:
    drawn = [each for each in curves if any(value is not None for value in each["y"])]
    return {
        "label": label,
        "across": across,
        "up": up,
        "logs": dict(zip("xy", logs, strict=True)),
        "note": note,
        "curves": drawn,
    }


SQUARES = {"m": "m²/Hz", "m s-1": "(m/s)²/Hz", "m s-2": "(m/s²)²/Hz", "N": "N²/Hz", "1": "1/Hz"}
BAND = "Band: two standard errors over the realisations."


def _velocities(result: TransientResult) -> Iterator[dict[str, Any]]:
    every = [each for name in result for row in result[name].impact_velocities for each in row]
    unit, factor = unit_of_signal(
        result.case, "m s-1", max((float(np.max(each, initial=0.0)) for each in every), default=0.0)
    )
    shown = kept_place(result)
    for place in sorted(range(len(result.factors)), key=lambda each: each != shown):
        found = {name: exceedance(result, name, place) for name in result}
        curves = [
            _curve(name, each.velocity * factor, each.rate, each.error, steps=True) for name, each in found.items()
        ]
        label = f"at {result.over} {result.factors[place]:g}"
        chart = _chart(
            label,
            with_unit("Velocity before impact", unit),
            "Impacts that are harder (1/s)",
            (False, True),
            _band(result),
            curves,
        )
        if chart["curves"]:
            yield chart


def _band(result: TransientResult) -> str:
    return BAND if len(result.seeds) > 1 else ""


def _over(values: Array) -> tuple[Array, Array]:
    """Mean over the seeds (…, s, …) on axis 1 and its standard error, of what is finite."""
    known = np.isfinite(values)
    many = np.maximum(known.sum(axis=1), 1)
    mean = np.where(known, values, 0.0).sum(axis=1) / many
    spread = np.where(known, (values - np.expand_dims(mean, 1)) ** 2, 0.0).sum(axis=1)
    error = np.sqrt(spread / np.maximum(many - 1, 1) / many)
    empty = ~known.any(axis=1)
    return np.where(empty, np.nan, mean), np.where(empty | (many < 2), np.nan, error)


QUANTITIES = (
    ("impact_rate", "Impacts a second", "s-1"),
    ("hardest_impact", "Velocity of the hardest impact", "m s-1"),
    ("lost_at_impacts", "Energy lost to the stop", "J"),
    ("lost_by_damping", "Energy lost by damping", "J"),
)


def _over_factor(result: TransientResult) -> Iterator[dict[str, Any]]:
    """Peaks of all signals, then impacts and energies, against what the case varies."""
    signals = {each.name: each for name in result for each in result[name].signals}
    asked = [("peak", f"Peak of {label_of(each)}", each.unit, key) for key, each in signals.items()]
    for quantity, label, unit, signal in [*asked, *((*each, None) for each in QUANTITIES)]:
        found = {
            name: _over(result[name].of(quantity, signal))
            for name in result
            if signal is None or signal in _names(result, name)
        }
        largest = max((float(np.nanmax(each, initial=0.0)) for each, _ in found.values()), default=0.0)
        shown, factor = unit_of_signal(result.case, unit, largest) if unit != "s-1" else ("1/s", 1.0)
        x = np.asarray(result.factors)
        curves = [_curve(name, x, mean * factor, error * factor, True) for name, (mean, error) in found.items()]
        chart = _chart(label, result.over, with_unit(label, shown), (False, False), _band(result), curves)
        if chart["curves"]:
            yield chart


def _names(result: TransientResult, name: str) -> list[str]:
    return [each.name for each in result[name].signals]


def _spectra(result: TransientResult) -> Iterator[dict[str, Any]]:
    """Densities of each signal at the value of the factor whose histories are shown, means over the seeds."""
    place = kept_place(result)
    for key, signal in {each.name: each for name in result for each in result[name].signals}.items():
        curves = []
        for name in result:
            own, done = result[name], np.flatnonzero(result[name].complete[place])
            if key in _names(result, name) and len(done):
                lines = own.frequency[place, done[0]]
                mean, error = _over(own.spectrum[place : place + 1, done, own.signal(key)])
                known = np.isfinite(lines)
                curves.append(_curve(name, lines[known], mean[0][known], error[0][known]))
        unit = SQUARES.get(signal.unit, f"({signal.unit})²/Hz")
        note = " ".join(filter(None, ["One-sided density by Welch's method.", _band(result)]))
        chart = _chart(
            label_of(signal),
            "Frequency (Hz)",
            with_unit(f"Density of {label_of(signal)}", unit),
            (True, True),
            note,
            curves,
        )
        if chart["curves"]:
            yield chart
