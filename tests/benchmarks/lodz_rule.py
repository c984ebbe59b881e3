"""The Łódź group's rule for stable periodic motion of two masses on a massless cantilever that hits a stop.

Błażejczyk-Okolewska, Czołczyński & Kapitaniak (Chaos, Solitons & Fractals 40, 2009) ask for a drive at an even multiple
p of the first natural frequency and a second one at an even multiple q of the drive. Two masses, any stiffness: in
modal coordinates all such systems, with the force on the mass that hits or on the other one, are

    c = (cos θ, sin θ),    l = c  or  (−sin θ, cos θ),    ω₂/ω₁ = p q.

So the rule is tried on all of them: θ, restitution, damping, the mass that is driven and the gap (as a share of the
amplitude without the stop) go through the lists below, and at each (p, q) the share of samples counts that have a
stable motion with one impact in n drive periods, clear of the stop between impacts, proved. ``python lodz_rule.py``
writes ``results/lodz_rule.json`` (some CPU minutes).
"""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import vibeam
from vibeam.periodic.bifurcation_functions import clearances, motions
from vibeam.periodic.multipliers import stability

RESULTS = Path(__file__).parent / "results" / "lodz_rule.json"

RATIOS = np.arange(1.0, 6.01, 0.5)  # of p and q

SHARES = (0.05, 0.2, 0.5, 1.0, 3.0)  # tan² θ: contact mobility of mode 2 over that of mode 1

RESTITUTIONS, DAMPINGS, DRIVEN, GAPS = (0.5, 0.7, 0.9), (0.01, 0.05), (True, False), (0.0, 0.25, 0.5, 0.75)

PERIODS = (1, 2, 3)

CLEAR = 1e-9  # clearance, as a share of the motion's size, that is enough

Sample = tuple[float, float, float, bool]


def system(p: float, q: float, sample: Sample) -> vibeam.ImpactSystem:
    """Two modes, ω₁ = 1, with the drive at p."""
    share, restitution, damping, same = sample
    angle = np.arctan(np.sqrt(share))
    contact = np.array([np.cos(angle), np.sin(angle)])
    load = contact if same else np.array([-np.sin(angle), np.cos(angle)])
    return vibeam.ImpactSystem.from_modes([1.0, p * q], damping, contact, load, restitution=restitution)


def stable(p: float, q: float, sample: Sample, periods: int) -> NDArray[np.bool_]:
    """Whether there is a stable motion with one impact in ``periods``, for each gap."""
    made, gaps = system(p, q, sample), np.array(GAPS)
    omega, drive = np.full(len(gaps), p), np.ones(len(gaps))
    swing = float(np.abs(motions(made, 1, omega[:1], drive[:1], np.zeros(1)).total.unit[0]))
    points = motions(made, periods, omega, drive, gaps * swing)
    clear = np.stack([clearances(made, points, k, ceiling=CLEAR) for k in (0, 1)], axis=1) > 0
    return stability(made, points.total, points.roots, clear).any(axis=1)


def samples() -> list[Sample]:
    """All systems but for p and q."""
    return list(itertools.product(SHARES, RESTITUTIONS, DAMPINGS, DRIVEN))


def share(p: float, q: float, periods: int) -> float:
    """Share of all samples and gaps with such a motion."""
    return float(np.mean([stable(p, q, sample, periods) for sample in samples()]))


def main() -> None:
    """Compute all shares and write them."""
    found: dict[str, Any] = {"samples": len(samples()) * len(GAPS), "ratios": RATIOS.tolist()}
    for periods in PERIODS:
        rows = [[share(p, q, periods) if p * q > 1.2 else None for q in RATIOS] for p in RATIOS]
        found[f"one_impact_in_{periods}"] = [[None if x is None else round(x, 4) for x in row] for row in rows]
    RESULTS.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
