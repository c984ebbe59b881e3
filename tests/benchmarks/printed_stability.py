"""How far the paper's printed stability forms (eq. 29–30 and 35–37) misjudge period 1, against exact multipliers.

    python tests/benchmarks/printed_stability.py    # writes results/printed_stability.json, 10 s

q̈ + 2βq̇ + q = Ω²B sin Ωt, β = 0.015, B = 0.5e-3, gaps 0.5e-3 (that of Fig. 13), 0 and −0.5e-3, R = 0.6 … 1.

``doubling``: Ω at which period 1 doubles with rising Ω, where the least multiplier of the saltation matrix
(``vibeam.orbits``) passes −1; ``difference``: that multiplier there by central differences of the flown impact map,
which shares no formula with either; ``29-30`` and ``35-37``: Ω up to which the printed forms call period 1 stable.
``read``: shares of the last flights of the simulated motion, Ω = 2.29 … 2.5, that each form calls unstable, as one does
who judges a simulation by its last impacts (gap 0.5e-3, R = 0.9: Fig. 13b).
"""

from __future__ import annotations

import json
import sys
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq

import vibeam
from vibeam.extensions.paper.mapping import (
    FixedPoint,
    Form,
    Impact,
    ImpactMap,
    Invariants,
    fixed_points,
    flight_invariants,
    orbit_invariants,
)
from vibeam.extensions.paper.one_mode import Oscillator

sys.path.insert(0, str(Path(__file__).parents[1]))
from support.one_mode_forms import impact_map, iterated

RESULT = Path(__file__).parent / "results" / "printed_stability.json"
BETA, DRIVE = 0.015, 0.5e-3
GAPS, RESTITUTIONS = (0.5e-3, 0.0, -0.5e-3), (0.6, 0.7, 0.8, 0.9, 1.0)
PRINTED: tuple[Form, ...] = ("printed 29-30", "printed 35-37")
SEARCHED = (2.1, 3.5)  # Ω
STEP = 1e-5  # of the differences
READ, SETTLE, FLIGHTS = np.linspace(2.29, 2.5, 211), 400, 64


def main() -> None:
    """Measure and write."""
    rows = [row(gap, restitution) for gap in GAPS for restitution in RESTITUTIONS]
    found = {"rows": rows, "read": read(Oscillator(BETA, DRIVE, GAPS[0], 0.9))}
    RESULT.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    for each in [*rows, found["read"]]:
        print(each)


def row(gap: float, restitution: float) -> dict[str, Any]:
    """Doubling of period 1, and where the printed forms put it."""
    model = Oscillator(BETA, DRIVE, gap, restitution)
    doubling = brentq(lambda omega: least_multiplier(model, omega) + 1, *SEARCHED, xtol=1e-12)
    if not orbit_at(model, doubling).admissible(impact_map(model, doubling)):
        raise ValueError(f"gap {gap}, R = {restitution}: the orbit that doubles passes the stop")
    found = {"gap": gap, "restitution": restitution, "doubling": doubling}
    ends = {form.removeprefix("printed "): last_stable(model, form) for form in PRINTED}
    return found | {"difference": by_differences(model, doubling)} | ends


def last_stable(model: Oscillator, form: Form) -> float:
    """Ω up to which a form calls period 1 stable."""
    return float(brentq(lambda omega: margin(orbit_invariants(orbit_at(model, omega), form)), *SEARCHED))


def least_multiplier(model: Oscillator, omega: float) -> float:
    """Least real part of the multipliers of the one-impact orbit, from its saltation matrix."""
    system = vibeam.ImpactSystem.from_modes(1.0, BETA, 1.0, 1.0, gap=model.gap, restitution=model.restitution)
    return min(m.real for m in vibeam.orbits(system, vibeam.Drive(omega, DRIVE))[0].multipliers)


def margin(found: Invariants) -> float:
    """Jury's margin against real multipliers of modulus 1: 1 + det − |tr|, whatever the sign of the trace."""
    return 1 + found.determinant - abs(found.trace)


def by_differences(model: Oscillator, omega: float) -> float:
    """Least real part of the multipliers of the flown impact map, by central differences."""
    flights, orbit = impact_map(model, omega), orbit_at(model, omega)
    unit = orbit.velocity
    columns = [slope(flights, orbit, by) for by in ((STEP, 0.0), (0.0, STEP * unit))]
    jacobian = np.stack([columns[0], columns[1] / unit], axis=1)
    return float(min(np.linalg.eigvals(jacobian).real))


def slope(flights: ImpactMap, orbit: FixedPoint, by: tuple[float, float]) -> Any:
    """Change of the next impact with a change of this one, over twice the step."""
    ends = [flights.next(Impact(orbit.time + s * by[0], orbit.velocity + s * by[1])) for s in (1, -1)]
    return np.subtract(*((end.time, end.velocity) for end in ends)) / (2 * STEP)


def orbit_at(model: Oscillator, omega: float) -> FixedPoint:
    """One-impact orbit of one drive period with the harder impact."""
    return fixed_points(model, omega)[0]


def read(model: Oscillator) -> dict[str, float]:
    """Shares of single flights of the simulated motion beyond the doubling that the forms call unstable."""
    calls: dict[str, list[bool]] = {form: [] for form in ("29-30", "35-37")}
    for omega in READ:
        impacts = iterated(impact_map(model, float(omega)), Impact(0.0, 0.01), SETTLE + FLIGHTS)[SETTLE:]
        for start, end, following in zip(impacts, impacts[1:], impacts[2:], strict=False):
            calls["29-30"].append(not flight_invariants(model, float(omega), start, end, following).stable)
            calls["35-37"].append(not simplified(model, float(omega), end).stable)
    return {form: float(np.mean(values)) for form, values in calls.items()}


def simplified(model: Oscillator, omega: float, impact: Impact) -> Invariants:
    """Eq. 35–37 as printed, of one impact of any motion, with n = 1."""
    orbit = FixedPoint(model, omega, 1, impact.time % (2 * pi / omega), impact.velocity, np.zeros(2))
    return orbit_invariants(orbit, "printed 35-37")


if __name__ == "__main__":
    main()
