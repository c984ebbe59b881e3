"""Figure kind ``modal``: modes of each fidelity, platform and torsion included (paper Fig. 17)."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from vibeam.case.case import Case
from vibeam.case.plans import ShowPlan
from vibeam.figures.page import plain
from vibeam.figures.sheet import Column, Comparison, Sheet
from vibeam.figures.style import name_of
from vibeam.figures.units import units_for
from vibeam.system.number_text import percent

MOST = 12  # largest number of modes drawn; the numbers are of all


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One sheet, by frequency."""
    system = case.system(fidelity)
    order = np.argsort(system.omega)
    row = system.row(case.sweep.output)
    columns = {
        "mode": Column(np.arange(1.0, system.size + 1), "1", "number of the mode, by frequency"),
        "mode_frequency": Column(system.omega[order] / (2 * np.pi), "Hz", "natural frequency of the mode"),
        "mode_damping": Column(system.zeta[order], "1", "damping ratio of the mode"),
        "contact_value": Column(system.contact[order], "kg(-1/2)", "mass-normalised shape at the contact"),
        "output_value": Column(row[order], "kg(-1/2)", "mass-normalised shape at the output"),
        "load": Column(system.load[order], *_load(case.scene_of(fidelity))),
    }
    return [Sheet(fidelity, float("nan"), columns)]


def _load(scene: Any) -> tuple[str, str]:
    """Unit and name of the loads: what the base, a force or a moment does to each mode."""
    base = getattr(scene, "base", None)
    if base is None or base.on_beam is None:
        return "kg(1/2)", "force per base acceleration"
    if base.on_beam[1]:
        return "kg(-1/2) m(-1)", "modal force per moment"
    return "kg(-1/2)", "modal force per force"


def size(plan: ShowPlan) -> tuple[float, float]:
    """One column a fidelity."""
    return (1.5 * len(plan.fidelities) + 1.4, 3.2)


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw a table: a row a mode, in each column frequency and damping ratio of one fidelity."""
    units, axes = units_for(result), figure.subplots()
    count = min(MOST, max(len(sheet["mode"]) for sheet in shown))
    axes.axis("off")
    cells = [[_cell(sheet, mode, units.frequency_factor, units.frequency) for sheet in shown] for mode in range(count)]
    table = axes.table(
        cells, rowLabels=[f"mode {mode + 1}" for mode in range(count)],
        colLabels=[plain(name_of(result.case, sheet.fidelity)) for sheet in shown],
        loc="center", cellLoc="right",
    )  # fmt: skip
    table.auto_set_font_size(False)
    table.scale(1.0, 1.3)
    table.set_fontsize(8)


def _cell(sheet: Sheet, mode: int, factor: float, unit: str) -> str:
    if mode >= len(sheet["mode"]):
        return ""
    return f"{sheet['mode_frequency'][mode] * factor:.5g} {unit}, {percent(float(sheet['mode_damping'][mode]))}"
