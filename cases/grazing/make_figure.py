"""Draw ``light_mass.png``: fold, doubling and stable motions about resonant grazing, with one, two and eight modes.

Its numbers, and motions flown at a few places, go to ``light_mass.json``.

    python cases/grazing/make_figure.py
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

import vibeam
from vibeam.periodic.modal_sums import sums
from vibeam.periodic.resonant_grazing import _doubling, _fold, _turn

HERE = Path(__file__).parent
TURN = 2 * np.pi
LOW, HIGH, DEEP, TALL = 19.5, 20.2, -4e-4, 4e-4  # Hz; B/B_g − 1
COLUMNS, ROWS = 141, 81
FREQUENCIES, SHARES = (19.8, 19.97), (1e-5, 3e-4)


def grazing(system: vibeam.ImpactSystem, omega: np.ndarray) -> np.ndarray:
    """Base amplitude at which the free motion grazes, m."""
    w, zeta = system.omega[:, None], system.zeta[:, None]
    response = (system.contact * system.load) @ (omega**2 / (w**2 - omega**2 + 2j * zeta * w * omega))
    return system.gap / np.abs(response)


def boundary_drives(system: vibeam.ImpactSystem, omega: np.ndarray) -> list[np.ndarray]:
    """Drives B/B_g of fold and doubling (points,) at frequencies ``omega``, rad/s; NaN where no impact pushes."""
    total, rows = sums(system, omega, 1), []
    for share in (_fold, _doubling):
        numerator, denominator = share(system, total)
        q = numerator / denominator
        rows.append(np.where(q < 0, np.hypot(1 - q * total.g0, q * _turn(system, total)), np.nan))
    return rows


def stable(system: vibeam.ImpactSystem, omega: np.ndarray, share: float) -> np.ndarray:
    """Columns in which a motion with one impact a period is stable and clear of the stop, at B = (1 + share) B_g."""
    found = []
    for w, size in zip(omega, (1 + share) * grazing(system, omega), strict=True):
        orbits = vibeam.orbits(system, vibeam.Drive(float(w), float(size)))
        found.append(any(each.stable and each.admissible for each in orbits))
    return np.array(found)


def panel(axes: plt.Axes, system: vibeam.ImpactSystem) -> None:
    """One model."""
    hertz = np.linspace(LOW, HIGH, 1401)
    omega, places = TURN * hertz, np.linspace(LOW, HIGH, COLUMNS)
    shares = np.linspace(DEEP, TALL, ROWS)
    field = np.array([stable(system, TURN * places, float(share)) for share in shares])
    axes.contourf(places, 1e3 * shares, field, levels=[0.5, 1.5], colors=["#dbe9f6"])
    axes.axhline(0, color="0.3", lw=1, label="grazing")
    for drive, name, colour in zip(
        boundary_drives(system, omega), ("fold", "doubling"), ("#0b5fa5", "#c2410c"), strict=True
    ):
        axes.plot(hertz, 1e3 * (drive - 1), color=colour, label=name)
    for each in vibeam.resonant_grazing(system, (TURN * LOW, TURN * HIGH)):
        step = omega - each.omega
        tangent = np.where(step * each.side > 0, each.slope * step + each.curvature * step**2, np.nan)
        axes.plot(hertz, 1e3 * tangent, color="0.2", ls=":", lw=1)
        axes.plot(each.omega / TURN, 0, "o", color="0.2", ms=4)
    axes.set(xlim=(LOW, HIGH), ylim=(1e3 * DEEP, 1e3 * TALL), xlabel="drive frequency [Hz]")
    axes.set_title(f"{system.size} mode{'s' * (system.size > 1)}", fontsize=10)


def places(system: vibeam.ImpactSystem) -> dict[str, dict[str, float]]:
    """Hz of the places of resonant grazing, and how the drive's excess over grazing begins, per Hz and per Hz²."""
    found = vibeam.resonant_grazing(system, (TURN * LOW, TURN * HIGH))
    rows = ((each.omega / TURN, each.slope * TURN, each.curvature * TURN**2) for each in found)
    keys = ("frequency", "slope", "curvature")
    return {each.kind.name.lower(): dict(zip(keys, row, strict=True)) for each, row in zip(found, rows, strict=True)}


def flown(system: vibeam.ImpactSystem) -> list[dict[str, float]]:
    """Motions that flights from rest settle on, just beyond grazing: period (0: none), impacts a period, m/s."""
    rows = []
    for hertz in FREQUENCIES:
        omega = np.array([TURN * hertz])
        for share in SHARES:
            size = float((1 + share) * grazing(system, omega)[0])
            found = vibeam.sweep(system, omega=omega, amplitude=size, settle=3000, hold=64)
            rows.append({
                "frequency": hertz, "share": share, "period": int(found.period[0]),
                "impacts_per_period": float(found.impacts_per_period[0]), "velocity": float(found.impact_velocity[0]),
            })  # fmt: skip
    return rows


def main() -> None:
    """Draw and write figure and numbers."""
    case = vibeam.load(HERE / "light_mass.toml")
    figure, axes = plt.subplots(1, 3, figsize=(10, 3.4), sharey=True, layout="constrained")
    for each, name in zip(axes, case.fidelities, strict=True):
        panel(each, case.system(name))
    axes[0].set_ylabel("(B/B_g − 1) · 10³")
    axes[0].legend(loc="lower left", fontsize=8, frameon=False)
    figure.savefig(HERE / "light_mass.png", dpi=110)
    systems = {name: case.system(name) for name in case.fidelities}
    numbers: dict[str, Any] = {name: {"places": places(each), "flown": flown(each)} for name, each in systems.items()}
    (HERE / "light_mass.json").write_text(json.dumps(numbers, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
