"""Modes of equal frequency and damping, all at the contact: what the stop does not feel of them moves as if alone.

Two such modes with contact values a, b are one with √(a² + b²) and one that has none. The first, with all others, is a
system of one mode less; the second is a free oscillator through every impact, rest and push: a formula.
"""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from mpmath import mpf

import vibeam
from vibeam.flight.equilibrium import equilibrium
from vibeam_models.laws.compliant import LinearStop

Array = np.ndarray

EPSILON = float(np.finfo(float).eps)

PAIRS = {"undamped": (1.3, 0.0), "light": (1.3, 0.02), "critical": (1.3, 1.0), "heavy": (1.3, 3.0), "rigid": (0.0, 0.0)}

STOPS: dict[str, dict[str, Any]] = {
    "hard": {"restitution": 0.3},
    "plastic": {"restitution": 0.0},
    "linear": {"law": LinearStop(60.0)},
    "linear, damped": {"law": LinearStop(60.0, 3.0)},
}

ROW, LOAD = np.array([0.8, -0.6, 0.5]), np.array([1.0, 0.4, -0.3])  # the equal ones' share: exactly 1

TURN = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])

DRIVE = vibeam.Drive(0.7, 0.5)


def rig(own: float, zeta: float, stop: dict[str, Any], coupled: float = 0.0) -> vibeam.ImpactSystem:
    """Two equal modes and a third, pressed against the stop now and then; ``coupled``: damping of all with all."""
    omega, ratio = np.array([own, own, 3.7]), np.array([zeta, zeta, 0.03])
    every = np.array([1.0, 0.5, -0.4])
    coupling = np.diag(2 * ratio * omega) + coupled * np.outer(every, every) if coupled else None
    return vibeam.ImpactSystem.from_modes(
        omega, ratio, ROW, LOAD, gap=0.0, static=0.25 * ROW, coupling=coupling, **stop
    )


def turned(system: vibeam.ImpactSystem) -> vibeam.ImpactSystem:
    """The mode that carries the contact, and the third: without the one that has none."""
    keep = [0, 2]
    return vibeam.ImpactSystem.from_modes(
        system.omega[keep], system.zeta[keep], (TURN @ system.contact)[keep], (TURN @ system.load)[keep],
        gap=system.gap, static=(TURN @ system.static)[keep], law=system.law, restitution=system.restitution,
    )  # fmt: skip


def alone(own: float, zeta: float, load: float, x: float, v: float, t: Array) -> Array:
    """η'' + 2ζωη' + ω²η = l Ω²B sin Ωt from x, v at 0, in 30 digits."""
    with mpmath.workdps(30):
        w, strength = mpf(DRIVE.omega), mpf(load) * mpf(DRIVE.omega) ** 2 * mpf(DRIVE.amplitude)
        a = mpmath.matrix(
            [[0, 1, 0, 0], [-(mpf(own) ** 2), -2 * mpf(zeta) * own, strength, 0], [0, 0, 0, w], [0, 0, -w, 0]]
        )
        start = mpmath.matrix([x, v, 0, 1])
        return np.array([[float(y) for y in (mpmath.expm(a * mpf(float(at))) * start)[:2]] for at in t])


@pytest.mark.parametrize("stop", STOPS)
@pytest.mark.parametrize("pair", PAIRS)
def test_one_carries_the_contact_and_the_other_never_feels_it(pair: str, stop: str) -> None:
    own, zeta = PAIRS[pair]
    system = rig(own, zeta, STOPS[stop])
    less, place, velocity = turned(system), np.array([-0.05, 0.03, 0.0]), np.array([0.0, -0.2, 0.0])
    start = vibeam.State(TURN.T @ place, TURN.T @ velocity)  # of what carries the contact, of the other, of the third
    short = vibeam.State(place[[0, 2]], velocity[[0, 2]])
    path, other = (vibeam.simulate(s, DRIVE, 12.0, x) for s, x in ((system, start), (less, short)))
    assert path.ended is other.ended is vibeam.Ended.COMPLETE
    assert np.any(path.segments.trace[:, 3] != 0)  # rests, or is pushed
    t = np.linspace(0.0, 12.0, 25)[1:]
    found = np.einsum("ij,tkj->tki", TURN, path.modes_at(t))
    np.testing.assert_allclose(found[:, :, [0, 2]], other.modes_at(t), rtol=0, atol=1e-9)
    true = alone(own, zeta, float((TURN @ LOAD)[1]), place[1], velocity[1], t)
    np.testing.assert_allclose(found[:, :, 1], true, rtol=0, atol=1e-12 * np.abs(true).max())


def contact_flow(system: vibeam.ImpactSystem, x: Array, v: Array, t: float) -> Array:
    """State (2n,) after t of x'' + Dx' + Λx + w(k w·x + c w·x') = static on a linear stop at 0, in 40 digits."""
    with mpmath.workdps(40):
        n, law, w = system.size, system.law, mpmath.matrix(system.contact)
        damper = np.diag(2 * system.zeta * system.omega) if system.coupling is None else system.coupling
        rates = mpmath.zeros(2 * n + 1)
        for i in range(n):
            rates[i, n + i], rates[n + i, 2 * n] = 1, mpf(system.static[i])
            for j in range(n):
                own = mpf(system.omega[i]) ** 2 if i == j else 0
                rates[n + i, j] = -own - law.stiffness * w[i] * w[j]
                rates[n + i, n + j] = -mpf(damper[i, j]) - law.damping * w[i] * w[j]
        after = mpmath.expm(rates * mpf(t)) * mpmath.matrix([*map(mpf, x), *map(mpf, v), 1])
        return np.array([float(y) for y in after[: 2 * n]])


NEAR = [0.0, *(2.0**-k for k in (52, 51, 49, 46, 40, 33, 26, 20))]


@pytest.mark.parametrize("coupled", [0.0, 0.3], ids=["", "coupled"])
@pytest.mark.parametrize("zeta", [0.0, 0.02, 3.0])
@pytest.mark.parametrize(
    "apart",
    [each if each in (0.0, 2.0**-52, 2.0**-33) else pytest.param(each, marks=pytest.mark.slow) for each in NEAR],
)
def test_a_push_among_nearly_equal_modes(apart: float, zeta: float, coupled: float) -> None:
    """Equal, one last digit apart, up to 1e-6: the same digits."""
    whole = rig(1.0, zeta, {"law": LinearStop(40.0, 0.5)}, coupled)
    omega = np.array([1.0, 1.0 + apart, 3.7])
    coupling = None if whole.coupling is None else np.diag(2 * whole.zeta * omega) + 0.3 * np.outer(
        [1.0, 0.5, -0.4], [1.0, 0.5, -0.4])  # fmt: skip
    system = vibeam.ImpactSystem.from_modes(
        omega, whole.zeta, ROW, 0.0, gap=0.0, static=300.0 * ROW, law=whole.law, coupling=coupling
    )
    x, v = equilibrium(system).displacement, np.array([0.3, -0.5, 0.1])
    for t in (0.3, 4.0, 20.0):
        path = vibeam.simulate(system, vibeam.Drive(0.0, 0.0), t, vibeam.State(x, v))
        assert len(path.segments.trace) == 1
        found = np.concatenate([path.state.displacement, path.state.velocity])
        off = np.abs(found - contact_flow(system, x, v, t)).max()
        assert off <= 64 * EPSILON * np.abs(x).max() * max(1.0, t)


def critical(apart: float, stop: dict[str, Any]) -> vibeam.Trajectory:
    """Three modes of nearly one frequency, critically damped but for ``apart`` from one to the next, let go."""
    omega, zeta = 1.3 * (1 + 1e-9 * np.arange(3)), 1 + apart * np.arange(3)
    system = vibeam.ImpactSystem.from_modes(omega, zeta, ROW, LOAD, gap=0.0, static=0.25 * ROW, **stop)
    return vibeam.simulate(system, DRIVE, 30.0, vibeam.State(-ROW, np.zeros(3)))


@pytest.mark.parametrize("stop", ["linear", "linear, damped"])
def test_three_nearly_equal_critical_modes_are_refused_with_the_cure(stop: str) -> None:
    with pytest.raises(ValueError, match=r"damping ratios differ by 0\.1 % or more"):
        critical(0.0, STOPS[stop])
    cured, further = critical(1e-3, STOPS[stop]), critical(2e-3, STOPS[stop])
    assert len(cured.impact_times) == len(further.impact_times) >= 1
    np.testing.assert_allclose(cured.impact_times, further.impact_times, rtol=3e-3)
