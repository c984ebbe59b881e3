"""Figure kind ``response_spectrum``: densities of an output under noise, with intervals, over the case's realisations.

Below, the ratio of each fidelity's to the last one's on the same realisations, and the coherence of input and output:
what impacts take from it is not the linear part's. The first tenth of each motion, from its start, is left out.
"""

from __future__ import annotations

from functools import lru_cache
from threading import Event
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vibeam.case.case import Case, plan_of_record, quantity_of
from vibeam.case.plans import ShowPlan
from vibeam.figures.panels import is_empty, labelled, say
from vibeam.figures.record import RecordResult, record_motion
from vibeam.figures.sheet import Column, Columns, NoMotion, Sheet, sheet_of
from vibeam.figures.style import Look, looks_of, name_of
from vibeam.flight.engine.threads import run_parallel
from vibeam.observe.response_spectrum import response_spectrum, spectrum_ratio, transfer_function
from vibeam_models.arrays import Array

LEFT_OUT = 0.1  # share of each motion before it is read
HIGHEST = 10.0  # frequency shown where none is given, in the lowest natural one of the last fidelity
SAMPLES, MOST = 2.5, 2_000_000  # samples a period of the highest mode, at least; in all, at most
RATIO = "density over that of the last fidelity, on the same realisations"
size = (6.8, 7.4)  # inches: three panels, one above another


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One sheet, over frequency."""
    return [sheet_of(fidelity, lambda: _columns(case, fidelity, plan))]


def _columns(case: Case, name: str, plan: ShowPlan) -> Columns:
    rate, highest = _rate(case, plan)
    load, values = _samples(case, name, plan, rate)
    last = values if name == plan.fidelities[-1] else _samples(case, plan.fidelities[-1], plan, rate)[1]
    segment = _segment(plan, rate, values.shape[1])
    own = response_spectrum(values, rate, segment=segment)
    ratio = spectrum_ratio(values, last, rate, segment=segment)
    passed = transfer_function(load, values, rate, segment=segment)
    seen = own.frequency <= highest
    if not seen.any():
        raise NoMotion(f"up_to: {highest:g} Hz is below the first line, {own.frequency[0]:.4g} Hz: longer segments")
    found = {
        "frequency": (own.frequency, "Hz", "frequency"),
        "density": (
            own.density,
            "q2/Hz",
            "power spectral density of the output, one-sided, the square of its unit over Hz",
        ),
        "density_low": (own.low, "q2/Hz", "its interval of 95 %, from"),
        "density_high": (own.high, "q2/Hz", "its interval of 95 %, to"),
        "density_ratio": (ratio.ratio, "1", RATIO),
        "ratio_low": (ratio.low, "1", "its interval of 95 %, from"),
        "ratio_high": (ratio.high, "1", "its interval of 95 %, to"),
        "coherence": (passed.coherence, "1", "coherence of input and output"),
        "coherence_low": (passed.coherence_low, "1", "its interval of 95 %, from"),
        "coherence_high": (passed.coherence_high, "1", "its interval of 95 %, to"),
        "gain": (np.abs(passed.gain), "1", "size of the transfer function, the output's unit over the input's"),
    }
    return {key: Column(numbers[seen], unit, said) for key, (numbers, unit, said) in found.items()}


def _rate(case: Case, plan: ShowPlan) -> tuple[float, float]:
    """Samples a second that fold no mode of any fidelity, nor the input, onto what is shown; the highest one, Hz."""
    modes = [case.system(name).omega / (2 * np.pi) for name in plan.fidelities]
    record = case.input(plan.fidelities[-1], *plan_of_record(case).seeds[:1])
    highest = plan.own["up_to"] or HIGHEST * float(np.min(modes[-1][modes[-1] > 0]))
    knots = len(record.coefficients) / record.duration
    return max(knots, SAMPLES * max(highest, *(float(np.max(each)) for each in modes))), float(highest)


def _segment(plan: ShowPlan, rate: float, samples: int) -> int | None:
    spacing = plan.own["resolution"]
    return None if spacing is None else min(round(rate / spacing), samples)


@lru_cache(maxsize=4)
def _samples(case: Case, name: str, plan: ShowPlan, rate: float) -> tuple[Array, Array]:
    """Samples (m, n) of the input and of the output over the realisations, as many as fit."""
    whole = plan_of_record(case)
    times = LEFT_OUT * whole.duration + np.arange(int((1 - LEFT_OUT) * whole.duration * rate)) / rate
    seeds = whole.seeds[: max(1, int(MOST / len(times)))] or (None,)
    case.system(name)  # there before threads ask

    def sampled(seed: int | None, stop: Event) -> tuple[Array, Array]:
        path = record_motion(case, name, plan, seed)
        return path.drive.at(times), path.at(times, plan.output)

    loads, values = zip(*run_parallel(sampled, seeds), strict=True)
    return np.array(loads), np.array(values)


def draw(figure: Figure, result: RecordResult, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw densities, ratios and coherences with their intervals as bands."""
    case, known = result.case, [each for each in shown if not each.fault]
    upper, middle, lower = figure.subplots(3, 1, sharex=True, height_ratios=(2, 1, 1))
    looks = looks_of(case, plan.fidelities)
    for sheet in known:
        look, label = looks[sheet.fidelity], name_of(case, sheet.fidelity)
        _band(upper, sheet, ("density", "density_low", "density_high"), look, label)
        if sheet.fidelity != plan.fidelities[-1]:
            _band(middle, sheet, ("density_ratio", "ratio_low", "ratio_high"), look, label)
        _band(lower, sheet, ("coherence", "coherence_low", "coherence_high"), look, label)
    for axes in (upper, middle, lower):
        if is_empty(axes):
            say(axes, next((each.fault for each in shown if each.fault), "one fidelity alone"))
        elif axes is not lower:
            axes.set_yscale("log")
    lower.set_ylim(0.0, 1.02)
    unit = "unit²/Hz" if case.scene.natural_unit else _unit(case, plan)
    labelled(upper, f"spectral density of the {plan.output}", unit)
    labelled(middle, f"ratio to that of\n{name_of(case, plan.fidelities[-1])}", "")
    labelled(lower, "coherence\nwith the input", "")
    labelled(lower, "frequency", "Hz", across=True)


def _unit(case: Case, plan: ShowPlan) -> str:
    unit = {"m": "m", "m s-1": "(m/s)", "m s-2": "(m/s²)", "rad": "rad", "1": ""}[quantity_of(case, plan.output).unit]
    return f"{unit}²/Hz" if unit else "1/Hz"


def _band(axes: Axes, sheet: Sheet, names: tuple[str, str, str], look: Look, label: str) -> None:
    across, (middle, low, high) = sheet["frequency"], (sheet[name] for name in names)
    keys: dict[str, Any] = look.keys(0.9)
    axes.plot(across, middle, label=label, **keys)
    axes.fill_between(across, low, high, color=look.colour, alpha=0.2, linewidth=0)


def caption(plan: ShowPlan) -> str:
    """Caption of the figure."""
    return f"density of the {plan.output} under noise; 95 % band at each frequency"
