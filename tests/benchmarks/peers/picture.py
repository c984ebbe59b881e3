"""The picture of the results: cost against error with one degree of freedom, cost against the number of modes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

COLOURS = {"vibeam": "black", "heyoka": "C0", "diffrax": "C2", "Siconos": "C1", "SUNDAE CVODE": "C3", "scipy": "C4"}

MARKERS = "os^D"


def draw(results: dict[str, Any], target: Path) -> None:
    """Write it."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(15, 4.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    precision(left, results.get("sdof", {"rows": []})["rows"])
    scaling(right, [section for name, section in results.items() if name.startswith("modes-")])
    figure.savefig(target, dpi=110)


def precision(axes: Any, rows: list[dict[str, Any]]) -> None:
    """Cost an impact over the error of the impact velocity."""
    drawn: dict[str, int] = {}
    for row in rows:
        if "failed" in row:
            continue
        marker = MARKERS[drawn.setdefault(row["peer"], 0) % len(MARKERS)]
        drawn[row["peer"]] += 1
        error, colour = max(row["error_median"], 1e-16), COLOURS.get(row["peer"], "grey")
        axes.loglog(error, row["cost_us"], marker, color=colour, label=row["name"])
    axes.set(xlabel="median error of impact velocity", ylabel="CPU µs an impact", title="nominal SDOF sweep")
    axes.set_xlim(1e-16, 1)
    if rows:
        axes.legend(fontsize=7, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    axes.grid(True, which="major", alpha=0.3)


def scaling(axes: Any, sections: list[dict[str, Any]]) -> None:
    """Cost an impact over the number of modes."""
    found: dict[str, list[tuple[int, float, str]]] = {}
    for section in sections:
        for row in section["rows"]:
            if "failed" not in row:
                found.setdefault(row["name"], []).append((section["modes"], row["cost_us"], row["peer"]))
    lines = ("-", "--", ":", "-.")
    drawn: dict[str, int] = {}
    for name, points in found.items():
        modes, costs, peers = zip(*sorted(points), strict=True)
        style = lines[drawn.setdefault(peers[0], 0) % len(lines)]
        drawn[peers[0]] += 1
        axes.loglog(modes, costs, style, marker=".", color=COLOURS.get(peers[0], "grey"), label=name)
    axes.set(xlabel="modes", ylabel="CPU µs an impact", title="DTU rig, neutral gap")
    ticks = sorted({section["modes"] for section in sections})
    axes.set_xticks(ticks, [str(n) for n in ticks])
    axes.xaxis.set_minor_locator(_none())
    axes.grid(True, which="major", alpha=0.3)
    if found:
        axes.legend(fontsize=7, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    axes.set_ylim(np.array(axes.get_ylim()) * (0.7, 1.5))


def _none() -> Any:
    from matplotlib.ticker import NullLocator

    return NullLocator()
