"""Motions of a result under a record as tidy tables: a row a motion, a row an impact, each column with its unit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibeam.report.output import plain, write_csv

if TYPE_CHECKING:
    from vibeam.runs.transient.result import TransientResult


def write_motions(result: TransientResult, path: Path) -> list[Path]:
    """Write the numbers of all motions to ``path``, their impacts beside it as ``…_impacts.csv``; the files."""
    parts, units = result.columns()
    motions: list[dict[str, Any]] = []
    for part in parts:
        heads = [_head(name, units.get(name, "1")) for name in part]
        motions += (dict(zip(heads, plain(row), strict=True)) for row in zip(*part.values(), strict=True))
    write_csv(motions, path)
    struck = [plain(row) for row in impacts(result)]
    if not struck:
        return [path]
    beside = path.with_name(f"{path.stem.removesuffix('_motions')}_impacts.csv")
    write_csv(struck, beside)
    return [path, beside]


def impacts(result: TransientResult) -> Iterator[dict[str, Any]]:
    """Every impact of every motion."""
    speed = "m/s" if result.case.scene.natural_unit is None else "1/s"
    for name, own in result.items():
        for i, value in enumerate(result.factors):
            for j, seed in enumerate(result.seeds or (0,)):
                known = (own.impact_times[i][j], own.impact_velocities[i][j], own.impact_contacts[i][j])
                for time, velocity, contact in zip(*known, strict=True):
                    head = {"fidelity": name, result.over: value, "seed": seed}
                    yield head | {"time (s)": time, f"velocity ({speed})": velocity, "contact": contact + 1}


def _head(name: str, unit: str) -> str:
    shown = unit.replace(" s-2", "/s²").replace(" s-1", "/s").replace("s-2", "1/s²").replace("s-1", "1/s")
    return name if unit == "1" else f"{name} ({shown})"
