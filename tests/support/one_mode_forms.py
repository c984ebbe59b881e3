"""Forms of one mode beside its solvers: the slow flow's rates and inverse, iterates of the map, printed verdicts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import nan, pi, sqrt

import numpy as np

from vibeam.extensions.paper.averaging import SlowFlow
from vibeam.extensions.paper.mapping import (
    FixedPoint,
    Form,
    Impact,
    ImpactMap,
    Invariants,
    admissible_orbits,
    flight_solver,
    orbit_invariants,
)
from vibeam.extensions.paper.one_mode import Oscillator

REAL = 1e-7  # imaginary share below which a root of the quartic counts as real: a double root splits by √ε


def rates(flow: SlowFlow, reach: float, phase: float, omega: float) -> tuple[float, float]:
    """(Q̇, ψ̇) at reach Q > 0 and phase ψ (among eq. 18–22)."""
    k, force, gap = flow.resonance, flow.force(omega), flow.oscillator.gap
    shrink = flow.decay * reach + 2 / pi * force * np.cos(phase)
    turn = flow.detuning(omega) + 2 / (pi * reach) * (gap + force * np.sin(phase))
    return float(-2 * k * shrink), float(2 * k * turn)


def frequencies(flow: SlowFlow, reach: float) -> tuple[float, ...]:
    """Frequencies Ω > 0 at which Q = ``reach`` is stationary, ascending: the roots of a quartic in Ω.

    Those far from 2k belong to the formula, not to the resonance.
    """
    k, pressed = flow.resonance, 2 * flow.oscillator.gap / pi
    force, off = 2 / pi * flow.force(2.0 * k), pressed - reach
    quartic = [-(force**2), 0.0, reach**2, 2 * reach * off, off**2 + (flow.decay * reach) ** 2]
    roots = np.roots(np.trim_zeros(np.array(quartic), "f"))
    real = roots[(np.abs(roots.imag) <= REAL * np.abs(roots)) & (roots.real > 0)].real
    return tuple(float(2 * k * ratio) for ratio in np.sort(real))


def backbone(flow: SlowFlow, reach: float) -> float:
    """Frequency Ω of the peak of Q at constant phase: σ_k = −2Δ/πQ."""
    return 2 * flow.resonance * (1 - 2 * flow.oscillator.gap / (pi * reach))


def narrowest(flow: SlowFlow) -> float:
    """Frequency Ω near 2k of the least Δ_MAX: 3σ² + σ + 2β_k² = 0, Ω ≈ 2k(1 − 2β_k²); NaN where there is none."""
    under = 1 - 24 * flow.decay**2
    return 2 * flow.resonance * (5 + sqrt(under)) / 6 if under >= 0 else nan


def impact_map(model: Oscillator, omega: float) -> ImpactMap:
    """Impact map at Ω > 0, with its own flight solver."""
    return ImpactMap(model, omega, flight_solver(model, omega))


def iterated(flights: ImpactMap, impact: Impact, count: int) -> list[Impact]:
    """Next ``count`` impacts."""
    found = []
    for _ in range(count):
        impact = flights.next(impact)
        found.append(impact)
    return found


@dataclass(frozen=True)
class FormVerdict:
    """Stability verdict of the derived and of a printed form on one admissible orbit."""

    orbit: FixedPoint
    derived: Invariants
    printed: Invariants

    @property
    def misjudged(self) -> bool:
        """True where the printed form's verdict is wrong."""
        return self.derived.stable is not self.printed.stable


def verdicts(model: Oscillator, omegas: Iterable[float], form: Form) -> tuple[FormVerdict, ...]:
    """Verdicts on all admissible orbits of one drive period over Ω, in the order of ``omegas``."""
    grid = [float(omega) for omega in omegas]
    solver = flight_solver(model, min(grid))
    found = (orbit for omega in grid for orbit in admissible_orbits(ImpactMap(model, omega, solver)))
    return tuple(FormVerdict(orbit, orbit_invariants(orbit), orbit_invariants(orbit, form)) for orbit in found)
