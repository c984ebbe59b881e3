"""Figure kind ``restitution``: the contact's own coefficient beside the apparent ones of the output.

Five readings of every impact (paper Fig. 25–26, Table 1): the contact's, the velocities next to the impact, extrema
near it, the slow part extrapolated to it, and the velocity of mode 1, the slow component of the motion.
"""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from vibeam.case.case import Case
from vibeam.case.plans import ShowPlan
from vibeam.figures import RESTITUTIONS
from vibeam.figures.page import plain
from vibeam.figures.panels import across_frequency, drawn, is_empty, labelled, say
from vibeam.figures.settled_motion import MeasuredWindow, chain_or_exact, measured_window
from vibeam.figures.sheet import Column, Columns, Comparison, NoMotion, Sheet
from vibeam.figures.style import looks, name_of, nested
from vibeam.figures.units import units_for
from vibeam.observe.motion import impacts_within
from vibeam.observe.restitution import (
    ApparentRestitution,
    adjacent_restitution,
    extrapolated_restitution,
    extremum_restitution,
    mode_restitution,
    true_restitution,
)
from vibeam.observe.slow_motion import further_modes, slow_part

PERIODS = 12
SAMPLES = 500  # samples a drive period, of a motion that is not measured
WINDOW = 0.08  # window of the extremum, in drive periods: 5 ms near 15.5 Hz
FIT = 0.9  # window of the slow part's fit, in drive periods; an impact nearby ends it
GUARD = 0.016  # drive periods left out next to impacts, where a filter smears: 1 ms near 15.5 Hz
SHOWN = (-0.5, 2.0)  # largest value drawn: a reading beside an impact is unbounded
BESIDE = 2  # further modes fitted beside the slow part

MEANING = {
    "true_restitution": "of the contact",
    "adjacent_restitution": "of the output's velocities next to the impact",
    "extremum_restitution": "of the output's extreme velocities before and after",
    "extrapolated_restitution": "of the output's slow part, extrapolated to the impact",
    "first_mode_restitution": "of the velocity of the mode that takes most of the impulse",
}


def columns(case: Case, name: str, frequency: float, plan: ShowPlan) -> Columns:
    """Readings of every impact at one ``frequency``, Hz."""
    chain = chain_or_exact(case, name, SAMPLES * frequency)
    found = measured_window(case, name, frequency, plan, plan.periods or PERIODS, chain)
    if found.path.system.contact_law.yields:
        raise NoMotion("a stop that yields has no instant of impact to read restitution at")
    if not len(found.hits):
        raise NoMotion("no impacts: there is no restitution to read")
    read = _readings(found, 1 / frequency)
    inside = (read["true_restitution"].time >= found.begin) & (read["true_restitution"].time < found.end)
    columns = {
        kind: Column(each.coefficient[inside], "1", f"apparent restitution: {MEANING[kind]}")
        for kind, each in read.items()
    }
    return {"impact_time": Column(found.hits[:, 0] - found.begin, "s", "times of the impacts")} | columns


def _readings(found: MeasuredWindow, period: float) -> dict[str, ApparentRestitution]:
    """Readings of all impacts of the path: impacts outside the window still bound the stretches inside."""
    path, record = found.path, found.record
    hits = impacts_within(path, path.t_start, path.t_end)[:, 0]
    system, near = path.system, {"delay": found.delay}
    order = np.argsort(system.omega)
    main = int(np.argmax(system.contact**2))
    slow = 1 + int(np.flatnonzero(order == main)[0])
    beside = None
    if slow < system.size and np.any(system.zeta[order[slow : slow + BESIDE]] < 1):
        beside = further_modes(system, slow + 1, slow + BESIDE)
    return {
        "true_restitution": true_restitution(path),
        "adjacent_restitution": adjacent_restitution(
            record.time, record.velocity, hits, skip=0 if found.exact else 1, **near
        ),
        "extremum_restitution": extremum_restitution(
            record.time, record.velocity, hits, window=WINDOW * period, **near
        ),
        "extrapolated_restitution": extrapolated_restitution(
            record.time, record.displacement, hits, slow_part(system, path.drive, slow), window=FIT * period,
            guard=GUARD * period, beside=beside, **near,
        ),
        "first_mode_restitution": mode_restitution(path, main),
    }  # fmt: skip


def size(plan: ShowPlan) -> tuple[float, float]:
    """One panel a fidelity."""
    return (2.7 * len(plan.fidelities) + 0.8 if len(plan.fidelities) > 1 else 5.8, 4.4)


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw all readings over frequency, a panel a fidelity; a band is the spread between impacts."""
    case, units = result.case, units_for(result, plan.output)
    grid = figure.subplots(1, len(plan.fidelities), sharex=True, sharey=True, squeeze=False)[0]
    for axes, name in zip(grid, plan.fidelities, strict=True):
        own = [sheet for sheet in shown if sheet.fidelity == name]
        axes.set_title(plain(name_of(case, name)))
        for index, (kind, look) in enumerate(looks(RESTITUTIONS)):
            label = kind.removesuffix("_restitution").replace("_", " ")
            keys = look.keys() | {"linewidth": nested(index, len(RESTITUTIONS))}
            drawn(axes, own, kind, 1.0, units.frequency_factor, label=label, **keys)
        across_frequency(axes, units)
        if is_empty(axes):
            say(axes, _nothing(own))
    low, high = grid[0].get_ylim()
    beyond = low < SHOWN[0] or high > SHOWN[1]
    grid[0].set_ylim(max(low, SHOWN[0]), min(high, SHOWN[1]))
    cut = f"apparent restitution, drawn from {SHOWN[0]:g} to {SHOWN[1]:g}".replace("-", "−")
    labelled(grid[0], cut if beyond else "apparent restitution", "")


def _nothing(own: list[Sheet]) -> str:
    """Why a panel is empty: the one reason of all frequencies, if there is one."""
    faults = {sheet.fault for sheet in own}
    return faults.pop() if len(faults) == 1 else "no restitution to read at any frequency"
