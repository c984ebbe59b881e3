"""Figure kind ``spectrogram``: an output's density over time and frequency, of the motion under the first realisation.

Power of Hann windows of eight periods of the first mode, half of it overlapping, by scipy's short-time transform.
"""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from vibeam.case.case import Case, plan_of_record
from vibeam.case.plans import ShowPlan
from vibeam.figures.panels import labelled, say
from vibeam.figures.record import RecordResult, record_motion
from vibeam.figures.sheet import Column, Columns, Sheet, sheet_of
from vibeam.figures.style import name_of
from vibeam_models.arrays import Array

TURNS = 8  # periods of the first mode in a window
HIGHEST = 24  # largest frequency shown, in multiples of the first mode's
SAMPLES, MOST = 2.5, 2_000_000  # samples a period of the highest mode, at most in all
ROWS, COLUMNS = 160, 320  # of the picture
DECIBELS = 70.0  # below the largest density that are shown


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One sheet, over time."""
    return [sheet_of(fidelity, lambda: _columns(case, fidelity, plan))]


def _columns(case: Case, name: str, plan: ShowPlan) -> Columns:
    from scipy.signal import ShortTimeFFT

    path, record = record_motion(case, name, plan), plan_of_record(case)
    system = path.system
    rates = np.sort(system.omega[np.isfinite(system.omega) & (system.omega > 0)]) / (2 * np.pi)
    first = float(rates[0]) if len(rates) else 1 / record.duration
    rate = min(SAMPLES * max(float(rates[-1]) if len(rates) else 0.0, HIGHEST * first), MOST / record.duration)
    values = path.at(np.arange(int(rate * record.duration)) / rate, plan.output)
    wide = max(8, min(int(TURNS / first * rate), len(values) // 4))
    hop = max(1, wide // 2 if len(values) // wide > COLUMNS else len(values) // COLUMNS)
    made = ShortTimeFFT(np.hanning(wide), hop, rate, scale_to="psd")
    power = made.spectrogram(values - values.mean())
    times, seen = made.t(len(values)), made.f <= HIGHEST * first
    inside = (times >= 0) & (times <= record.duration)
    density = 2 * power[np.ix_(seen, inside)]
    shown = _merged(_merged(density, ROWS, 0), COLUMNS, 1)
    squares = "density, square of the output's unit over Hz: a row of times a frequency"
    return {
        "time": Column(_merged(times[inside], COLUMNS, 0), "s", "time"),
        "frequency": Column(_merged(made.f[seen], ROWS, 0), "Hz", "frequency"),
        "density": Column(shown.ravel(), "1", squares),
        "impact_time": Column(path.impact_times, "s", "times of the impacts"),
    }


def _merged(values: Array, most: int, axis: int) -> Array:
    """Means of equally many successive entries along an axis, so that there are at most ``most``."""
    many = -(-values.shape[axis] // most)
    starts = np.arange(0, values.shape[axis], many)
    parts = np.split(values, starts[1:].tolist(), axis=axis)
    return np.stack([each.mean(axis=axis) for each in parts], axis=axis)


def size(plan: ShowPlan) -> tuple[float, float]:
    """One panel above another."""
    return (7.6, 1.2 + 2.0 * len(plan.fidelities))


def draw(figure: Figure, result: RecordResult, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw a panel a fidelity, all in the colours of one scale; ticks below: impacts."""
    grid = figure.subplots(len(plan.fidelities), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    known = {each.fidelity: each for each in shown if not each.fault}
    top = max((float(np.max(each["density"], initial=0.0)) for each in known.values()), default=0.0)
    for axes, name in zip(grid, plan.fidelities, strict=True):
        labelled(axes, f"{name_of(result.case, name)}\nfrequency", "Hz")
        if name not in known or not top > 0:
            say(axes, next((each.fault for each in shown if each.fidelity == name), "nothing to show"))
            continue
        sheet = known[name]
        level = 10 * np.log10(np.maximum(sheet["density"] / top, 1e-30)).reshape(len(sheet["frequency"]), -1)
        keys = {"vmin": -DECIBELS, "vmax": 0.0, "cmap": "magma", "rasterized": True}
        mesh = axes.pcolormesh(sheet["time"], sheet["frequency"], level, shading="nearest", **keys)
        if 0 < len(hits := sheet["impact_time"]) <= COLUMNS:
            axes.plot(hits, 0 * hits, "|", color="0.2", markersize=4, clip_on=False)
    labelled(grid[-1], "time", "s", across=True)
    if known and top > 0:
        figure.colorbar(mesh, ax=grid.tolist(), label="dB below the largest")


def caption(plan: ShowPlan) -> str:
    """Caption of the figure."""
    return f"spectrogram of the {plan.output}; ticks, where few: impacts"
