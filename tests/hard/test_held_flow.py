"""The motion held on the stop against arbitrary precision, and what a rest makes of a change of its begin."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from agreement import follow, true_motion
from motions import NONE, state
from mpmath import mpf
from random_systems import Case, random_case
from sensitivity import held_flow

import vibeam


@pytest.mark.parametrize("omega", [[1.0, 3.3, 7.1], [0.0, 3.3, 70.0]])
def test_two_rests_that_begin_a_little_apart(omega: list[float]) -> None:
    contact = np.array([1.0, -0.6, 0.3])
    system = vibeam.ImpactSystem.from_modes(
        omega, [0.05, 1.0, 4.7], contact, [1.0, 0.4, -0.2], gap=0.0, restitution=0.5, static=[50.0, 0.0, 0.0]
    )
    along = np.eye(3) - np.outer(contact, contact) / (contact @ contact)
    moved = along @ np.array([[1.0, 2.0, -0.5], [0.3, -1.0, 0.7]]).T * 1e-3
    ends = []
    for change in (np.zeros((3, 2)), moved):
        motion = true_motion(Case(system, vibeam.Drive(1.9, 0.05), state(*change.T, True)), 0.0)
        motion.run(t_end=0.7)
        assert motion.resting
        after = motion.state()
        ends.append(np.array([*after.displacement, *after.velocity], dtype=float))
    expected = held_flow(system, 0.7) @ moved.T.ravel()
    np.testing.assert_allclose(ends[1] - ends[0], expected, rtol=1e-9, atol=1e-12 * np.abs(expected).max())


def test_a_long_rest_among_fast_and_overdamped_modes_is_within_the_estimate() -> None:
    """Without the rest's share the first impact after it was 51 times as late as one last digit explains."""
    readout = follow(random_case(7, 79, size=8), 100, 8)
    assert readout.releases >= 3
    assert not readout.faults
    assert readout.worst_blur < 32


HELD = {
    "rates over five decades": ([1.0, 3.0, 1e5], [0.02, 4.7, 0.02], [1.0, 0.7, 0.5]),
    "overdamped among fast ones": ([1.0, 40.0, 600.0, 1e4], [0.3, 4.7, 0.01, 1.0], [1.0, -0.6, 0.8, 0.5]),
    "two critical ones side by side": ([1.0, 2.76, 2.94, 77.0], [5e-4, 1.0, 1.0, 0.04], [-0.5, 4.1, 2.3, 2.3]),
    "critical twins": ([1.0, 1.0 + 2.0**-24, 70.0], [1.0, 1.0, 0.3], [1.0, 0.8, -0.8]),
    "twins": ([1.0, 1.0, 70.0], [0.0, 0.0, 0.3], [1.0, 0.8, -0.8]),
    "twins that differ by a last digit": ([1.0, 1.0 + 2.0**-52, 70.0], [0.02, 0.02, 0.3], [1.0, 0.8, -0.8]),
    "twins that differ by many": ([1.0, 1.0 + 2.0**-46, 70.0], [0.0, 0.0, 0.3], [1.0, 0.8, -0.8]),
    "twins that differ by half the digits": ([1.0, 1.0 + 2.0**-26, 70.0], [0.02, 0.02, 0.3], [1.0, 0.8, -0.8]),
    "overdamped twins": ([1.0, 1.0 + 2.0**-40, 70.0], [3.0, 3.0, 0.3], [1.0, 0.8, -0.8]),
    "two pairs of twins": ([1.0, 1.0, 9.0, 9.0], [0.02, 0.02, 0.0, 0.0], [1.0, 0.8, -0.8, 0.5]),
    "triplets": ([1.0, 1.0, 1.0, 9.0], [1.0, 1.0, 1.0, 0.1], [1.0, 0.8, -0.8, 0.5]),
    "rigid twins": ([0.0, 0.0, 70.0], [0.0, 0.0, 0.3], [1.0, 0.8, -0.8]),
    "critical, hardly felt": ([1.0, 3.0, 70.0], [0.02, 1.0, 0.3], [1.0, 2.0**-23, -0.8]),
    "damped in proportion": ([1.0, 30.0, 1e3, 1e5], [1e-6, 3e-5, 1e-3, 0.1], [1.0, 0.7, -0.5, 0.4]),
    "one that the stop does not feel": ([1.0, 5.0, 1e4], [0.02, 3.0, 0.1], [1.0, 0.0, 0.4]),
    "one without stiffness": ([0.0, 3.0, 1e4], [0.0, 0.5, 0.03], [1.0, -0.7, 0.5]),
    "an eight-mode case of the exhaustive search": random_case(7, 79, size=8).system,
}


def held(name: str) -> vibeam.ImpactSystem:
    """Held at 0 by a force along the contact row, which moves nothing; of few bits, lest rounding does."""
    found = HELD[name]
    omega, zeta, contact = found if isinstance(found, tuple) else (found.omega, found.zeta, found.contact)
    row = np.where(np.abs(contact) > 0.01, np.round(np.array(contact) * 64) / 64, contact)
    press = 2.0 ** np.ceil(np.log2(1e3 * np.max(omega) * np.min(omega, initial=np.inf, where=np.array(omega) > 0)))
    return vibeam.ImpactSystem.from_modes(omega, zeta, row, 0.0, gap=0.0, restitution=0.5, static=press * row)


def on_the_stop(
    system: vibeam.ImpactSystem, x: np.ndarray, v: np.ndarray, t: float, drive: vibeam.Drive = NONE
) -> np.ndarray:
    """Displacements and velocities (2n,) after t of x″ = P(f − 2ζωx′ − ω²x) on a stop at 0: exponential in 40 digits.

    The contact point's own motion, rounding, is taken off first: of velocities along its row, of displacements where it
    is softest. The force is carried along as a constant and a rotating pair.
    """
    with mpmath.workdps(40):
        n, c, w = system.size, mpmath.matrix(system.contact), [mpf(a) for a in system.omega]
        damping = [2 * mpf(z) * a for z, a in zip(system.zeta, w, strict=True)]
        soft = [c[i] / w[i] ** 2 if w[i] > 0 else c[i] * mpf(10) ** 30 for i in range(n)]
        beyond = sum(c[i] * mpf(x[i]) for i in range(n)) / sum(c[i] * soft[i] for i in range(n))
        speed = sum(c[i] * mpf(v[i]) for i in range(n)) / (c.T * c)[0]
        start = [mpf(x[i]) - soft[i] * beyond for i in range(n)] + [mpf(v[i]) - c[i] * speed for i in range(n)]
        along, rates = mpmath.eye(n) - c * c.T / (c.T * c)[0], mpmath.zeros(2 * n + 3)
        static, load = along * mpmath.matrix(system.static), along * mpmath.matrix(system.load)
        turn, strength = mpf(drive.omega), mpf(drive.omega) ** 2 * mpf(drive.amplitude)
        for i in range(n):
            rates[i, n + i] = 1
            rates[n + i, 2 * n], rates[n + i, 2 * n + 1] = static[i], load[i] * strength
            for k in range(n):
                rates[n + i, k], rates[n + i, n + k] = -along[i, k] * w[k] ** 2, -along[i, k] * damping[k]
        rates[2 * n + 1, 2 * n + 2], rates[2 * n + 2, 2 * n + 1] = turn, -turn
        after = mpmath.expm(rates * mpf(t)) * mpmath.matrix([*start, 1, 0, 1])
        return np.array([float(y) for y in after[: 2 * n]])


@pytest.mark.parametrize("name", HELD)
def test_a_rest_costs_tens_of_last_digits_however_far_apart_the_rates_are(name: str) -> None:
    system = held(name)
    n, c, w = system.size, system.contact, system.omega
    slowest, fastest = np.min(w[w > 0]), np.max(w)
    rng = np.random.default_rng(3)
    x, v = rng.normal(size=n) * slowest / np.maximum(w, slowest), slowest * rng.normal(size=n)
    soft = np.where(w > 0, c / np.maximum(w, slowest) ** 2, 0.0) if w.min() > 0 else np.where(w == 0, c, 0.0)
    x, v = x - soft * (c @ x) / (c @ soft), v - c * (c @ v) / (c @ c)
    for t in (1 / fastest, 30 / fastest, min(1e3 / fastest, 1 / slowest)):
        path = vibeam.simulate(system, vibeam.Drive(0.0, 0.0), t, vibeam.State(x, v, True))
        assert path.state.resting
        off = np.concatenate([path.state.displacement, path.state.velocity]) - on_the_stop(system, x, v, t)
        size = np.concatenate([np.where(w > 0, w, 1 / t), np.ones(n)])  # a motion's own, velocities
        start = np.max(size * np.abs(np.concatenate([x, v])))
        digits = np.max(size * np.abs(off)) / start / np.finfo(float).eps
        assert digits < 32


FAR_AWAY = {  # static on a mode, drive, times
    "pushed": ([1e3, 0.0, 0.0], NONE, (1e-3, 0.01, 0.1, 1.0)),
    "pushed hard": ([1e7, 0.0, 0.0], NONE, (1e-7, 1e-6)),
    "driven": ([1e3, 0.0, 0.0], vibeam.Drive(2.0, 1e9), (1e-7, 1e-6)),
}


@pytest.mark.parametrize("coupled", [False, True])
@pytest.mark.parametrize("name", FAR_AWAY)
def test_a_held_equilibrium_far_away_costs_no_digits(name: str, coupled: bool) -> None:
    """Taken out of the state and put back, the steady response cost as many last digits as it is times the motion."""
    static, drive, times = FAR_AWAY[name]
    omega, zeta = np.array([1.0, 3.0, 100.0]), np.array([0.02, 4.7, 0.02])
    system = vibeam.ImpactSystem.from_modes(
        omega, zeta, [1.0, 0.7, 0.5], [1.0, 0.5, 0.25], gap=0.0, restitution=0.5, static=static,
        coupling=np.diag(2 * zeta * omega) if coupled else None,
    )  # fmt: skip
    x, v = np.array([0.07, -0.1, 0.0]), np.zeros(3)
    for t in times:
        path = vibeam.simulate(system, drive, t, vibeam.State(x, v, True))
        assert path.state.resting
        true, found = on_the_stop(system, x, v, t, drive).reshape(2, -1), path.state
        off = np.abs(np.stack([found.displacement, found.velocity]) - true).max(axis=1)
        place = np.abs(true[0]).max()
        speed = max(np.abs(true[1]).max(), np.max(omega * np.maximum(np.abs(x), np.abs(true[0]))))
        assert max(off[0] / place, off[1] / speed) < 32 * np.finfo(float).eps
