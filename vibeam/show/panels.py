"""What the figures share: titles, axis labels, whose sheets are in which colour, where the stop is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from vibeam.report.style import coloured

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from vibeam.case import Case
    from vibeam.report.units import Units
    from vibeam.show.plan import Sheet, ShowPlan


def titled(axes: Axes, units: Units, frequency: float) -> None:
    """The panel's frequency (Hz)."""
    number = f"{frequency * units.frequency_factor:.5g}"
    axes.set_title(f"{number} Hz" if units.frequency else f"Ω/ω = {number}")


def labelled(axes: Axes, what: str, unit: str, across: bool = False) -> None:
    """An axis with its unit, the one across or the one upward."""
    text = f"{what} ({unit})" if unit else what
    (axes.set_xlabel if across else axes.set_ylabel)(text)


def sheets_at(frequency: float, plan: ShowPlan, shown: Sequence[Sheet]) -> list[tuple[Sheet, str]]:
    """Each fidelity's sheet of one frequency (Hz), with its colour."""
    sheets = {sheet.fidelity: sheet for sheet in reversed(shown) if sheet.frequency == frequency}
    return coloured(sheets[name] for name in plan.fidelities)


def stop_at(case: Case, plan: ShowPlan) -> list[float]:
    """Where the output is when the contact touches the stop, each place once; none where modes make it no one place."""
    found = set()
    for name in plan.fidelities:
        system = case.system(name)
        row = system.output(plan.output)
        if system.size == 1:
            found.add(float(system.gap * row[0] / system.contact[0]))
        elif plan.output == "contact":
            found.add(float(system.gap))
    return sorted(found)
