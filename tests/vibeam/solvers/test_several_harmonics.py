"""Several harmonics: the equation itself integrated with events, closed forms, and the kernels' own drive."""

from __future__ import annotations

import numpy as np
import pytest
from bounded import Bound
from scipy.integrate import solve_ivp
from stand_in import two_modes as rig

import vibeam
from vibeam.system.several_harmonics import Harmonic, SeveralHarmonics
from vibeam_models.laws.compliant import LinearStop

OMEGA, SIZE = 2 * np.pi * 15.3, 8e-5
FIRST = OMEGA**2 * SIZE
FURTHER = (Harmonic(2, 0.4 * FIRST, 0.7), Harmonic(3, 0.3 * FIRST, -1.1))
PERIOD = 2 * np.pi / OMEGA


def true_motion(system, harmonics, y, end):
    """(η, η') at ``end``, and how many impacts, by DOP853 from one to the next."""

    def slope(t, y):
        force = FIRST * np.sin(OMEGA * t)
        force += sum(each.acceleration * np.sin(each.order * OMEGA * t + each.phase) for each in harmonics)
        pull = system.load * force - system.omega**2 * y[:2] - 2 * system.zeta * system.omega * y[2:]
        return np.concatenate([y[2:], pull])

    def distance(t, y):
        return system.gap - system.contact @ y[:2]

    distance.terminal, distance.direction = True, -1
    t, impacts = 0.0, 0
    within = Bound()
    while within(t < end):
        path = solve_ivp(
            slope, (t, end), y, "DOP853", events=distance, rtol=1e-11, atol=1e-15, first_step=1e-7, max_step=2e-3
        )  # fmt: skip
        t, y = path.t[-1], path.y[:, -1].copy()
        if path.status == 1:
            impulse = (1 + system.restitution) * (system.contact @ y[2:]) / (system.contact @ system.contact)
            y[2:] -= impulse * system.contact
            impacts += 1
    return y, impacts


@pytest.mark.parametrize("gap", [1e-4, 0.0, -1e-4])
def test_the_motion_is_that_of_the_equation(gap):
    own, end = rig(gap), 20 * PERIOD
    start = vibeam.State([-1e-4 + min(gap, 0) / 2.14, 0.0], [0.0, 0.0])
    several = SeveralHarmonics(own, vibeam.Drive(OMEGA, SIZE), FURTHER)
    path = vibeam.simulate(several.system, several.drive, end, several.enter(start))
    last = several.leave(path.state, end)
    true, impacts = true_motion(own, FURTHER, np.concatenate([start.displacement, start.velocity]), end)
    assert len(path.impact_times) == impacts > 15
    np.testing.assert_allclose(last.displacement, true[:2], rtol=0, atol=1e-10 * np.abs(true[:2]).max())
    np.testing.assert_allclose(last.velocity, true[2:], rtol=0, atol=1e-9 * np.abs(true[2:]).max())


@pytest.mark.parametrize(("gap", "restitution"), [(-3e-4, 0.3), (-1e-4, 0.0), (-3e-4, 0.6)])
def test_an_oscillator_is_as_good_as_a_drive_through_chatter_and_rest(gap, restitution):
    """The first harmonic of 15.3 Hz, and as second one of 7.65 Hz beside no first."""
    own, end = rig(gap, restitution), 20.25 * PERIOD
    start = vibeam.State([gap / 2.14 - 2e-4, 0.0], [0.0, 0.0])
    plain = vibeam.simulate(own, vibeam.Drive(OMEGA, SIZE), end, start)
    several = SeveralHarmonics(own, vibeam.Drive(OMEGA / 2, 0.0), (Harmonic(2, FIRST),))
    path = vibeam.simulate(several.system, several.drive, end, several.enter(start))
    last = several.leave(path.state, end)
    assert len(path.rests) == len(plain.rests) > 5
    assert last.resting == plain.state.resting
    np.testing.assert_allclose(last.displacement, plain.state.displacement, rtol=0, atol=1e-15)
    np.testing.assert_allclose(path.at(0.9 * end, "sensor"), plain.at(0.9 * end, "sensor"), rtol=1e-9)


@pytest.mark.parametrize("more", [{}, {"coupling": [[1.6, 0.5], [0.5, 21.0]]}, {"second_gap": 2.0}])
def test_outputs_have_their_own_phases(more):
    """Without impacts the sensor is Σ s·H over the harmonics, H from the matrices; a sweep reads its extremes."""
    own = rig(gap=1.0, **more)
    several = SeveralHarmonics(own, vibeam.Drive(OMEGA, SIZE), FURTHER)
    damper = np.diag(2 * own.zeta * own.omega) if own.coupling is None else own.coupling
    times, steady = np.linspace(0, PERIOD, 2000), 0.0
    for each in (Harmonic(2, 0.0), *FURTHER):
        order, size = (each.order, each.acceleration) if each.acceleration else (1, FIRST)
        rate = order * OMEGA
        force = own.load * size * np.exp(1j * each.phase)
        modes = np.linalg.solve(np.diag(own.omega**2) - rate**2 * np.eye(2) + 1j * rate * damper, force)
        steady = steady + (own.outputs["sensor"] @ modes * np.exp(1j * rate * times)).imag
    rest = several.enter(vibeam.State(np.zeros(2), np.zeros(2)))
    found = vibeam.sweep(several.system, omega=OMEGA, amplitude=SIZE, settle=800, output="sensor", state=rest)
    assert found.amplitude[0] == pytest.approx(np.ptp(steady) / 2, rel=1e-5)
    assert found.period[0] == -1
    assert found.maximum[0] == pytest.approx(steady.max(), rel=1e-5)


def test_states_come_out_as_they_went_in():
    several = SeveralHarmonics(rig(), vibeam.Drive(OMEGA, SIZE), FURTHER)
    state = vibeam.State([-1e-4, 2e-6], [0.01, -0.02], resting=True)
    inside = several.enter(state, 0.123)
    back = several.leave(inside, 0.123)
    np.testing.assert_allclose(back.displacement, state.displacement, rtol=1e-13)
    np.testing.assert_allclose(back.velocity, state.velocity, rtol=1e-13)
    assert back.resting
    for name in ("contact", "sensor"):
        row = several.system.output(name)
        assert row @ inside.displacement == pytest.approx(rig().output(name) @ state.displacement, rel=1e-10)
        assert row @ inside.velocity == pytest.approx(rig().output(name) @ state.velocity, rel=1e-10)


def test_a_stop_that_yields_takes_it_too():
    own, end = rig(law=LinearStop(1e5, 5.0)), 8.25 * PERIOD
    start = vibeam.State([-1e-4, 0.0], [0.0, 0.0])
    plain = vibeam.simulate(own, vibeam.Drive(OMEGA, SIZE), end, start)
    several = SeveralHarmonics(own, vibeam.Drive(OMEGA / 2, 0.0), (Harmonic(2, FIRST),))
    last = several.leave(vibeam.simulate(several.system, several.drive, end, several.enter(start)).state, end)
    np.testing.assert_allclose(last.displacement, plain.state.displacement, rtol=0, atol=1e-12)


def test_what_no_harmonic_is():
    for wrong in (1, 0, 2.5):
        with pytest.raises(ValueError, match="the first is 2"):
            Harmonic(wrong, 1.0)
    with pytest.raises(ValueError, match="must be finite"):
        Harmonic(2, np.inf)
    undamped = vibeam.ImpactSystem.from_modes([2 * OMEGA], [0.0], [1.0], [1.0])
    with pytest.raises(ValueError, match="an undamped mode is at order 2"):
        SeveralHarmonics(undamped, vibeam.Drive(OMEGA, SIZE), (Harmonic(2, 1.0),))


@pytest.mark.parametrize(("solver", "options", "within"), [
    ("direct", {"method": "DOP853", "rtol": 1e-10, "atol": 1e-14}, 1e-7), ("moreau", {"steps": 4000}, 5e-3),
])  # fmt: skip
def test_solvers_by_steps_take_it_too(solver, options, within):
    several = SeveralHarmonics(rig(), vibeam.Drive(OMEGA, SIZE), FURTHER)
    start = several.enter(vibeam.State([-1e-4, 0.0], [0.0, 0.0]))
    keys = {"omega": OMEGA, "amplitude": SIZE, "settle": 4, "hold": 2, "output": "sensor", "state": start}
    exact = vibeam.sweep(several.system, **keys)
    other = vibeam.sweep(several.system, solver=solver, options=options, **keys)
    assert exact.impacts_per_period[0] >= 1
    assert other.amplitude[0] == pytest.approx(exact.amplitude[0], rel=within)


def test_velocities_and_absolute_accelerations_have_every_harmonic():
    """The right-hand side of the equation at a state, plus b̈ = −Ω²B sin Ωt − Σ Aⱼ sin(jΩt + ψⱼ) of the base."""
    row = np.array([1.36, 2.2])
    derivatives = {"v": vibeam.TimeDerivative(row, 1), "a": vibeam.TimeDerivative(row, 2, 1.0)}
    plain = rig(gap=1e-4, derivatives=derivatives)
    driven = SeveralHarmonics(plain, vibeam.Drive(OMEGA, SIZE), FURTHER)
    start = vibeam.State(np.zeros(2), np.zeros(2))
    end = 2.3 * PERIOD
    y, impacts = true_motion(plain, FURTHER, np.zeros(4), end)
    path = vibeam.simulate(driven.system, driven.drive, end, driven.enter(start))
    base = FIRST * np.sin(OMEGA * end)
    base += sum(each.acceleration * np.sin(each.order * OMEGA * end + each.phase) for each in FURTHER)
    pull = plain.load * base - plain.omega**2 * y[:2] - 2 * plain.zeta * plain.omega * y[2:]
    assert impacts > 0
    assert float(path.at(end, "v")) == pytest.approx(row @ y[2:], rel=1e-7)
    assert float(path.at(end, "a")) == pytest.approx(row @ pull - base, rel=1e-7)
