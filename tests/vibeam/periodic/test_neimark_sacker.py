"""Neimark–Sacker bifurcations of motions with one, two and three impacts, against a map of a program of its own.

The Poincaré map over one span is integrated by DOP853 with the impacts as events, its fixed point found by Newton's
method, its Jacobian by finite differences: a complex pair must leave the unit circle at the frequency found.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from bounded import Bound
from scipy.integrate import solve_ivp
from settled_orbits import closed_multipliers, settled

from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import boundaries
from vibeam.periodic.follow import follow
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import orbits
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State

Array = np.ndarray

ASIDE = 3e-4  # share of the frequency to either side of it


class Rig(NamedTuple):
    """Two modes, found by searching random systems; a settled motion with ``impacts`` a span at ``begin`` rad/s."""

    omega: float
    zeta: float
    contact: float
    load: float
    gap: float
    restitution: float
    begin: float
    to: float
    periods: int
    impacts: int

    @property
    def system(self) -> ImpactSystem:
        return ImpactSystem.from_modes(
            [1.0, self.omega], self.zeta, [1.0, self.contact], [1.0, self.load], gap=self.gap,
            restitution=self.restitution,
        )  # fmt: skip


AMPLITUDE = 0.3

RIGS = {
    "two impacts a period": Rig(4.87, 0.01, 0.44, -0.44, 0.15, 0.73, 0.73, 0.70, 1, 2),
    "two impacts, harder": Rig(4.58, 0.01, 1.01, 0.25, -0.04, 0.88, 1.48, 1.47, 1, 2),
    "three impacts a period": Rig(3.44, 0.01, 1.5, 0.24, 0.11, 0.84, 1.24, 1.0, 1, 3),
    "two impacts in two periods": Rig(3.71, 0.005, 1.34, -0.44, -0.16, 0.71, 3.2, 3.26, 2, 2),
}


def mapped(system: ImpactSystem, omega: float, amplitude: float, begin: float, end: float, start: Array) -> Array:
    """The state (2n,) at ``end`` from that at ``begin``, by Runge–Kutta with the impacts as events."""
    n, c, w = system.size, system.contact, system.omega
    restored, damped = w**2, 2 * system.zeta * w

    def rate(t: float, y: Array) -> Array:
        push = system.load * omega**2 * amplitude * np.sin(omega * t)
        return np.concatenate([y[n:], push - damped * y[n:] - restored * y[:n]])

    def gap(t: float, y: Array) -> float:
        return float(system.gap - c @ y[:n])

    gap.terminal, gap.direction = True, -1  # type: ignore[attr-defined]
    t, y = begin, start.copy()
    within = Bound()
    while within(t < end):
        flown = solve_ivp(rate, (t, end), y, "DOP853", events=gap, rtol=1e-12, atol=1e-14, first_step=1e-4)
        t, y = float(flown.t[-1]), flown.y[:, -1].copy()
        if flown.status == 1:
            y[n:] -= c * (1 + system.restitution) * (c @ y[n:]) / (c @ c)
            y[:n] -= c * max(0.0, c @ y[:n] - system.gap + 1e-14) / (c @ c)
    return y


def jacobian(system: ImpactSystem, omega: float, amplitude: float, begin: float, end: float, y: Array) -> Array:
    """Central differences of the map."""
    columns = []
    for i in range(len(y)):
        step = np.zeros(len(y))
        step[i] = 3e-6 * amplitude
        ends = [mapped(system, omega, amplitude, begin, end, y + sign * step) for sign in (1, -1)]
        columns.append((ends[0] - ends[1]) / (2 * step[i]))
    return np.stack(columns, axis=1)


def own_multipliers(
    system: ImpactSystem, omega: float, amplitude: float, periods: int, time: float, state: State
) -> Array:
    """Eigenvalues of the map at its own fixed point, from half way between two impacts; the state given is near it."""
    begin = time + 1e-3 * 2 * np.pi / omega
    end = begin + periods * 2 * np.pi / omega
    y = mapped(system, omega, amplitude, time, begin, np.concatenate([state.displacement, state.velocity]))
    for _ in range(3):
        matrix = jacobian(system, omega, amplitude, begin, end, y)
        off = mapped(system, omega, amplitude, begin, end, y) - y
        y = y - np.linalg.solve(matrix - np.eye(len(y)), off)
        if np.abs(off).max() < 1e-9 * amplitude:
            break
    return np.linalg.eigvals(matrix)


def radius(values: Array) -> float:
    """The largest modulus of a complex pair."""
    return float(np.abs(values[np.abs(values.imag) > 1e-6]).max())


def crossing(low: tuple[float, Array], high: tuple[float, Array]) -> float:
    """The frequency at which the pair's modulus is 1, linearly between two."""
    (a, first), (b, second) = low, high
    r, s = radius(first) - 1, radius(second) - 1
    assert r * s < 0
    return a - r * (b - a) / (s - r)


def start_of(rig: Rig) -> Orbit:
    found = settled(rig.system, Drive(rig.begin, AMPLITUDE), rig.periods, settle=600)
    assert len(found.times) == rig.impacts
    return found


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name == "two impacts a period" else name for name in RIGS]
)
def test_several_impacts(name: str) -> None:
    rig = RIGS[name]
    at = next(each for each in follow(start_of(rig), "omega", rig.to).boundaries if each.kind is Kind.NEIMARK_SACKER)
    assert "complex multipliers" in at.kind.value
    seen = []
    for share in (-ASIDE, ASIDE):
        omega = at.value * (1 + share)
        (orbit,) = orbits(rig.system, Drive(omega, AMPLITUDE), rig.periods, start=at.orbit)
        np.testing.assert_allclose(np.abs(closed_multipliers(orbit)), np.abs(orbit.multipliers), rtol=1e-7)
        values = own_multipliers(rig.system, omega, AMPLITUDE, rig.periods, orbit.time, orbit.state)
        assert radius(values) == pytest.approx(radius(orbit.multipliers), rel=1e-5)
        angles = [float(np.abs(np.angle(each[np.abs(each.imag) > 1e-6])).max()) for each in (values, orbit.multipliers)]
        assert angles[0] == pytest.approx(angles[1], rel=1e-4)
        seen.append((omega, values))
    assert crossing(*seen) == pytest.approx(at.value, rel=2e-5)
    assert np.sort(np.abs(np.abs(at.multipliers) - 1))[1] < 1e-10


def test_one_impact() -> None:
    """The quadratic's own boundary; where the frequency of the torus starts, the multipliers' angle, agrees too."""
    system = ImpactSystem.from_modes([1.0, 4.3], [0.02, 0.01], [1.0, 0.5], [1.0, 0.4], gap=3e-4, restitution=0.8)
    found = boundaries(system, 5e-4, (1.5, 6.5), points=121, kinds=(Kind.NEIMARK_SACKER,))
    at = next(each for each in found if each.clear)
    assert at.kind.name == "NEIMARK_SACKER"
    seen = []
    for share in (-ASIDE, ASIDE):
        omega = at.omega * (1 + share)
        near = min(orbits(system, Drive(omega, 5e-4)), key=lambda each: abs(each.velocity - at.velocity))
        values = own_multipliers(system, omega, 5e-4, 1, near.time, near.state)
        assert radius(values) == pytest.approx(radius(near.multipliers), rel=1e-5)
        seen.append((omega, values))
    assert crossing(*seen) == pytest.approx(at.omega, rel=2e-5)
