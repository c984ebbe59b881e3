"""A swept-sine test in pieces of one period: its bounds by hand, and the chirp itself integrated with events."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vibeam
from vibeam.solvers.chirp import Chirp, linear_chirp, swept
from vibeam.system.response import Ended

Array = np.ndarray

FIRST, LAST = 2 * np.pi * 14.8, 2 * np.pi * 15.8
SIZE = 8e-5


def constant(omega: Array) -> float:
    """A held displacement."""
    return SIZE


def acceleration(omega: Array) -> Array:
    """A held acceleration, that of the displacement at 15 Hz."""
    return SIZE * (2 * np.pi * 15) ** 2 / omega**2


def rig(gap: float = 0.0, restitution: float = 0.72) -> vibeam.ImpactSystem:
    """Two modes of about the DTU rig's size."""
    return vibeam.ImpactSystem.from_modes(
        [47.9, 636.0], [0.017, 0.017], [2.14, 1.3], [0.47, 0.38], gap=gap, restitution=restitution,
        outputs={"sensor": [1.36, 2.2]},
    )  # fmt: skip


def true_motion(system: vibeam.ImpactSystem, chirp: Chirp, rate: float, law: Callable, start: vibeam.State) -> Array:
    """Displacements (n + 1, modes) at ``chirp.times`` under the chirp itself: DOP853 from impact to impact."""
    n, first = system.size, chirp.edges[0]

    def force(t: float) -> float:
        omega = first + rate * t
        return float(omega**2 * np.asarray(law(np.array([omega]))).ravel()[0] * np.sin(first * t + rate * t * t / 2))

    def slope(t: float, y: Array) -> Array:
        pull = system.load * force(t) - system.omega**2 * y[:n] - 2 * system.zeta * system.omega * y[n:]
        return np.concatenate([y[n:], pull])

    def distance(t: float, y: Array) -> float:
        return system.gap - float(system.contact @ y[:n])

    distance.terminal, distance.direction = True, -1
    t, y, found = 0.0, np.concatenate([start.displacement, start.velocity]), np.zeros((len(chirp.times), n))
    found[0] = start.displacement
    while t < chirp.times[-1]:
        path = solve_ivp(
            slope, (t, chirp.times[-1]), y, "DOP853", events=distance, dense_output=True, rtol=1e-10, atol=1e-14,
            first_step=1e-7, max_step=2e-3,
        )  # fmt: skip
        within = (chirp.times > t) & (chirp.times <= path.t[-1])
        found[within] = np.array([path.sol(time)[:n] for time in chirp.times[within]]).reshape(-1, n)
        t, y = path.t[-1], path.y[:, -1].copy()
        y[n:] -= (
            system.contact * (1 + system.restitution) * (system.contact @ y[n:]) / (system.contact @ system.contact)
        )
    return found


def begun(system: vibeam.ImpactSystem, law: Callable) -> vibeam.State:
    """Settled at the chirp's first frequency."""
    drive = vibeam.Drive(FIRST, float(np.ravel(law(np.array([FIRST])))[0]))
    state = vibeam.simulate(system, drive, 300 * 2 * np.pi / FIRST).state
    return vibeam.State(state.displacement, state.velocity)


def flown(system: vibeam.ImpactSystem, chirp: Chirp, law: Callable, start: vibeam.State) -> Array:
    """As ``true_motion``, in pieces."""
    rows, state = [start.displacement], start
    for k in range(len(chirp.omega)):
        piece = Chirp(chirp.omega[k : k + 1], chirp.edges[k : k + 2], chirp.times[k : k + 2])
        _, state = swept(system, piece, law, state=state)
        rows.append(state.displacement)
    return np.array(rows)


@pytest.mark.parametrize(("law", "most"), [(constant, 3.0), (acceleration, 1.0)])
def test_the_pieces_follow_the_chirp_and_twice_as_close_at_half_the_rate(law, most):
    """At the drive's zeros, through the peak, with an impact in each of some 13 and 26 periods."""
    system, off = rig(), []
    start, seen = begun(system, law), system.outputs["sensor"]
    for hertz in (1.2, 0.6):
        rate = 2 * np.pi * hertz
        chirp = linear_chirp(FIRST, LAST, rate)
        pieces, true = flown(system, chirp, law, start), true_motion(system, chirp, rate, law, start)
        off.append(np.abs((pieces - true) @ seen).max() / np.ptp(true @ seen))
        assert off[-1] < most * hertz / 15.3**2
    assert 1.7 < off[0] / off[1] < 2.3


@pytest.mark.parametrize(("first", "last"), [(FIRST, LAST), (LAST, FIRST)])
def test_pieces_are_the_chirp_between_its_zeros(first, last):
    rate = 2 * np.pi * 0.1 * np.sign(last - first)
    chirp = linear_chirp(first, last, abs(rate))
    assert abs(last - chirp.edges[-1]) < 2 * np.pi * abs(rate) / last
    np.testing.assert_allclose(chirp.edges, first + rate * chirp.times, rtol=1e-13)
    turns = first * chirp.times + rate * chirp.times**2 / 2
    np.testing.assert_allclose(turns, 2 * np.pi * np.arange(len(turns)), rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(chirp.omega * np.diff(chirp.times), 2 * np.pi, rtol=1e-11)


@pytest.mark.parametrize(("law", "power"), [(constant, 2), (acceleration, 0)])
def test_the_errors_are_bounds_that_are_reached(law, power):
    """Phase and size of chirp and pieces at many times within every piece."""
    rate = 2 * np.pi * 0.5
    chirp = linear_chirp(FIRST, LAST, rate)
    share = np.linspace(0, 1, 101)
    time = chirp.times[:-1, None] + share * np.diff(chirp.times)[:, None]
    phase = FIRST * time + rate * time**2 / 2 - 2 * np.pi * (np.arange(len(chirp.omega))[:, None] + share)
    np.testing.assert_allclose(np.abs(phase).max(axis=1), chirp.phase_error, rtol=1e-6)
    omega = FIRST + rate * time
    size = [np.asarray(law(each)) * each**2 for each in (omega, chirp.omega[:, None])]
    np.testing.assert_allclose(np.abs(size[0] / size[1] - 1).max(axis=1), chirp.size_error(law), rtol=1e-9, atol=1e-14)
    epsilon = rate * np.diff(chirp.times) / chirp.omega
    np.testing.assert_allclose(chirp.size_error(law), power * epsilon / 2, rtol=2e-3, atol=1e-14)
    np.testing.assert_allclose(chirp.phase_error, np.pi / 4 * epsilon, rtol=1e-9)


def test_a_slow_chirp_is_the_settled_curve():
    """Swept ten times slower, the largest distance from settled points is some ten times less; up and down differ."""
    system, off = rig(), []
    for hertz in (0.1, 0.01):
        found, _ = swept(system, linear_chirp(FIRST, LAST, 2 * np.pi * hertz), constant, settle=300, output="sensor")
        settled = vibeam.sweep(system, omega=found.omega, amplitude=SIZE, settle=100, output="sensor")
        assert np.all(found.ended == Ended.COMPLETE.code)
        off.append(np.abs(found.amplitude - settled.amplitude).max() / settled.amplitude.max())
    assert 1e-3 < off[0] < 0.2
    assert off[1] < 0.2 * off[0]


@pytest.mark.parametrize(
    ("solver", "options", "within"),
    [
        pytest.param("direct", {"rtol": 1e-10, "atol": 1e-14}, 1e-6, marks=pytest.mark.slow),
        ("moreau", {"steps": 4000}, 2e-3),
    ],
)
def test_other_solvers_fly_it_too(solver, options, within):
    chirp = linear_chirp(FIRST, FIRST + 2.0, 2 * np.pi * 2.0)
    exact, last = swept(rig(), chirp, acceleration, settle=3)
    other, after = swept(rig(), chirp, acceleration, settle=3, solver_name=solver, options=options)
    np.testing.assert_allclose(other.amplitude, exact.amplitude, rtol=within)
    np.testing.assert_allclose(after.displacement[0], last.displacement[0], rtol=within)


def test_what_no_chirp_is():
    with pytest.raises(ValueError, match="must be positive"):
        linear_chirp(FIRST, LAST, 0.0)
    with pytest.raises(ValueError, match="lower the rate"):
        linear_chirp(FIRST, LAST, 1e3)
    with pytest.raises(ValueError, match="raise the rate"):
        linear_chirp(FIRST, LAST, 1e-6)
    with pytest.raises(ValueError, match="knows settled motions alone"):
        swept(rig(), linear_chirp(FIRST, LAST, 1.0), constant, solver_name="orbit")
