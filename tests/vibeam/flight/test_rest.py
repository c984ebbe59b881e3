"""Rest on the stop: the constrained motion against an integration of its own equations, its force, its release."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from apart import run_apart
from exact_motion import exact_motion
from scipy.integrate import solve_ivp

import vibeam
from vibeam.flight.linear.block_regime import held_regime
from vibeam.flight.linear.eigenpairs import LinearSystem

Array = np.ndarray


@dataclass(frozen=True)
class Held:
    """A system that starts at rest on the stop with its other modes under way."""

    system: vibeam.ImpactSystem
    drive: vibeam.Drive
    start: vibeam.State

    @property
    def path(self) -> vibeam.Trajectory:
        return vibeam.simulate(self.system, self.drive, 40.0, self.start)


def held(omega: list[float], zeta: list[float], drive: vibeam.Drive, seed: int = 0, **rest: object) -> Held:
    """Contact, load and start at random (the start held on the stop), pressed by a load on the first mode."""
    rng = np.random.default_rng(seed)
    n = len(omega)
    contact = rest.pop("contact", np.r_[1.0, rng.uniform(-0.8, 0.8, n - 1)])
    static = np.r_[0.5, rng.uniform(-0.1, 0.1, n - 1)]
    given = {"gap": -0.3, "restitution": 0.6, "static": static, **rest}
    system = vibeam.ImpactSystem.from_modes(omega, zeta, contact, np.r_[1.0, rng.normal(size=n - 1) / 3], **given)
    c, soft = system.contact, 1 / np.maximum(omega, 1.0) ** 2
    x, v = 0.05 * rng.normal(size=n) * soft, 0.05 * rng.normal(size=n) * np.sqrt(soft)
    x -= c * soft * (c @ x - system.gap) / (c**2 @ soft)
    return Held(system, drive, vibeam.State(x, v - c * soft * (c @ v) / (c**2 @ soft), resting=True))


PULL = vibeam.Drive(0.8, 2.5)
CASES = {
    "2 modes": held([1.0, 2.7], [0.05, 0.01], PULL),
    "2 modes, one overdamped": held([1.0, 2.7], [0.05, 3.0], PULL),
    "2 modes, critical": held([1.0, 2.7], [1.0, 1.0], PULL),
    "2 modes, alike": held([1.0, 1.0], [0.05, 0.05], PULL),
    "3 modes": held([1.0, 2.7, 5.3], [0.05, 0.2, 0.01], PULL, 1),
    "3 modes, overdamped": held([1.0, 2.7, 5.3], [2.0, 0.2, 4.0], PULL, 1),
    "3 modes, stiffness damping": held([1.0, 2.7, 5.3], [0.02, 0.054, 0.106], PULL, 2),
    "3 modes, mass damping": held([1.0, 2.7, 5.3], [0.1, 0.1 / 2.7, 0.1 / 5.3], PULL, 2),
    "3 modes, undamped": held([1.0, 2.7, 5.3], [0.0, 0.0, 0.0], PULL, 3),
    "3 modes, two alike": held([1.0, 2.7, 2.7], [0.02, 0.3, 0.3], PULL, 3),
    "3 modes, one free": held([0.0, 2.7, 5.3], [0.0, 0.03, 0.1], PULL, 4),
    "6 modes": held([1.0, 2.7, 5.3, 7.7, 11.0, 16.0], [0.05, 0.2, 0.01, 0.4, 0.03, 0.07], PULL, 5),
    "6 modes, all regimes": held([1.0, 2.7, 5.3, 7.7, 11.0, 16.0], [0.05, 1.0, 2.5, 0.4, 1.0, 0.07], PULL, 6),
    "6 modes, critical": held([1.0, 2.7, 5.3, 7.7, 11.0, 16.0], [1.0] * 6, PULL, 7),
}
CASES["no drive"] = held([1.0, 2.7, 5.3], [0.05, 0.2, 0.01], vibeam.Drive(0.0, 0.0), 1)
# two rigid-body modes: once held, what is left of them turns without any stiffness
CASES["a free rod"] = held([0.0, 0.0, 5.3], [0.0, 0.0, 0.1], PULL, 4)
# a critical mode that the stop does not feel, its double rate between those of the overdamped ones
CASES["a double rate among others"] = held([1.0, 1.2, 4.2], [0.0, 1.0, 2.0], PULL, 8, contact=[1.0, 0.0, 0.1])
CASES["a double rate among four"] = held(
    [1.0, 1.778, 3.162, 5.623, 10.0], [0.0, 0.0, 1.0, 2.0, 1.75], PULL, 8, contact=[1.0, 1.0, 0.0, 1.0, 0.1]
)
CASES["a silent free mode"] = Held(
    vibeam.ImpactSystem.from_modes([1.0, 0.0], [0.05, 0.0], [1.0, 0.0], [1.0, 0.3], gap=-0.3, static=[0.5, 0.1]),
    PULL,
    vibeam.State(np.array([-0.3, 0.02]), np.array([0.0, 0.03]), resting=True),
)


def drift(case: Held, t: float, x: Array, v: Array) -> Array:
    """Modal accelerations without the contact force."""
    own = case.system
    push = own.load * case.drive.omega**2 * case.drive.amplitude * np.sin(case.drive.omega * t)
    return push + own.static - 2 * own.zeta * own.omega * v - own.omega**2 * x


def force(case: Held, t: float, x: Array, v: Array) -> float:
    """The contact force that keeps the contact's acceleration zero: contact·drift / Σ contact²."""
    c = case.system.contact
    return float(c @ drift(case, t, x, v) / (c @ c))


def integrated(case: Held, times: Array, begin: float = 0.0) -> Array:
    """Poses (m, 2, n) of the motion projected on contact·η' = 0, from its start at time ``begin``."""
    n, c = case.system.size, case.system.contact

    def slope(t: float, y: Array) -> Array:
        free = drift(case, t, y[:n], y[n:])
        return np.concatenate([y[n:], free - c * (c @ free) / (c @ c)])

    start = np.concatenate([case.start.displacement, case.start.velocity])
    found = solve_ivp(
        slope, (begin, times[-1]), start, method="DOP853", t_eval=times, rtol=1e-12, atol=1e-14, max_step=0.05
    )
    return found.y.T.reshape(-1, 2, n)


@pytest.mark.parametrize("name", CASES)
def test_the_path_is_that_of_the_constrained_equations(name: str) -> None:
    case = CASES[name]
    path = case.path
    begin, end = path.rests[0]
    assert begin == 0.0
    assert end > 1.0
    times = np.linspace(0.0, min(end, 12.0), 60)[:-1]
    expected = integrated(case, times)
    found = path.modes_at(times)
    for k in range(2):
        np.testing.assert_allclose(found[:, k], expected[:, k], atol=1e-9 * np.abs(expected[:, k]).max())


def test_the_comparison_sees_damping_taken_off() -> None:
    case = CASES["3 modes"]
    other = Held(
        vibeam.ImpactSystem.from_modes(
            case.system.omega, case.system.zeta * (1 + 1e-6), case.system.contact, case.system.load,
            gap=case.system.gap, static=case.system.static,
        ),
        case.drive, case.start,
    )  # fmt: skip
    times = np.linspace(0.0, case.path.rests[0, 1], 60)[:-1]
    expected = integrated(other, times)
    with pytest.raises(AssertionError):
        np.testing.assert_allclose(case.path.modes_at(times), expected, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("name", CASES)
def test_the_contact_stays_where_the_stop_is(name: str) -> None:
    case = CASES[name]
    path = case.path
    times = np.linspace(0.0, path.rests[0, 1], 200)[:-1]
    np.testing.assert_allclose(path.at(times), case.system.gap, rtol=1e-12)
    speeds = np.abs(path.modes_at(times)[:, 1] * case.system.contact).sum(axis=1).max()
    np.testing.assert_allclose(path.velocity_at(times), 0.0, atol=1e-12 * max(speeds, 1e-3))


@pytest.mark.parametrize("name", CASES)
def test_the_force_presses_until_it_vanishes_at_the_release(name: str) -> None:
    case = CASES[name]
    path = case.path
    begin, end = path.rests[0]
    times = np.linspace(begin, end, 400)[:-1]
    poses = path.modes_at(times)
    forces = np.array([force(case, t, x, v) for t, (x, v) in zip(times, poses, strict=True)])
    assert forces.min() > 0
    if case.drive.amplitude == 0:
        assert end == 40.0
        return
    assert end < 40.0
    assert force(case, end, *path.modes_at(end)) == pytest.approx(0.0, abs=1e-11 * forces.max())
    # it really leaves: from g''' alone, as the force vanishes
    after = end + 1e-3
    left = case.system.gap - path.at(after)
    x, v = path.modes_at(end)
    rate = (force(case, end + 1e-6, x + 1e-6 * v, v + 1e-6 * drift(case, end, x, v)) - force(case, end, x, v)) / 1e-6
    mobility = case.system.contact @ case.system.contact
    assert left == pytest.approx(-rate * mobility * 1e-9 / 6, rel=0.05)


@pytest.mark.parametrize("name", [name for name in CASES if CASES[name].drive.amplitude > 0])
def test_release_and_the_next_impacts_are_exact(name: str) -> None:
    case = CASES[name]
    path = case.path
    motion = exact_motion(case.system, case.drive, case.start)
    motion.run(count=1, until="release", t_end=40.0)
    motion.run(count=2, t_end=40.0)
    released = [float(event.time) for event in motion.events if event.kind == "release"]
    hits = np.array([(float(e.time), float(e.speed)) for e in motion.events if e.kind == "impact"])
    assert path.rests[0, 1] == pytest.approx(released[0], rel=1e-10)
    assert len(hits) >= 1
    np.testing.assert_allclose(path.impact_times[: len(hits)], hits[:, 0], rtol=1e-10)
    np.testing.assert_allclose(path.impact_velocities[: len(hits)], hits[:, 1], atol=1e-9 * hits[:, 1].max())


@pytest.mark.parametrize("off", [0.0, 1e-12, 1e-9, 1e-6, 1e-3])
def test_resonance_of_what_is_left_free_at_rest(off: float) -> None:
    """Contact (1, 1), ω = (1, 3), undamped: held, the other motion has ν² = 5, and is driven there."""
    drive = vibeam.Drive(np.sqrt(5.0) * (1 + off), 0.01)
    system = vibeam.ImpactSystem.from_modes([1.0, 3.0], 0.0, [1.0, 1.0], [0.5, -0.5], gap=-0.3, restitution=0.5)
    equilibrium = vibeam.simulate(system, vibeam.Drive(0.0, 0.0), 1.0).state
    case = Held(system, drive, equilibrium)
    path = case.path
    end = path.rests[0, 1]
    assert end > 5.0
    times = np.linspace(0.0, end, 60)[:-1]
    expected = integrated(case, times)[:, 0]
    np.testing.assert_allclose(path.modes_at(times)[:, 0], expected, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("mode", [2, 3, 6])
def test_rest_after_chatter_is_the_same_rest(mode: int) -> None:
    """A motion that comes to rest by itself: the state handed on mid-rest obeys the constrained equations."""
    omega = [1.0, 2.7, 5.3, 7.7, 11.0, 16.0][:mode]
    case = held(omega, [0.05, 0.2, 0.01, 0.4, 0.03, 0.07][:mode], PULL, 8)
    path = vibeam.simulate(
        case.system,
        case.drive,
        40.0,
        vibeam.State(case.start.displacement - 0.05 * case.system.contact, case.start.velocity),
    )
    assert len(path.chatters) >= 1
    longest = np.argmax(np.diff(path.rests)[:, 0])
    begin, end = path.rests[longest]
    assert end - begin > 0.5
    middle = (begin + end) / 2
    # the equations' time runs on from the middle of the rest
    shifted = Held(case.system, case.drive, vibeam.State(*path.modes_at(middle), resting=True))
    times = np.linspace(middle, end, 30)[:-1]
    expected = integrated(shifted, times, middle)
    np.testing.assert_allclose(path.modes_at(times), expected, atol=1e-9 * np.abs(expected).max())


NO_FORCE = """
import numpy as np
import vibeam

system = vibeam.ImpactSystem.from_modes({modes}, gap=0.0, restitution={restitution})
start = vibeam.State(np.array({x}), np.array({v}))
path = vibeam.simulate(system, vibeam.Drive(1.0, 0.0), {end}, start, max_impacts=20_000)
assert path.ended is vibeam.Ended.COMPLETE, path.ended
assert len(path.impact_times) < 100, len(path.impact_times)
times = np.linspace(0, {end}, 2001)
assert path.at(times).max() < 1e-14
assert all(begin <= end for begin, end in path.rests)
"""


def test_a_contact_without_any_force_of_its_own_after_a_plastic_impact() -> None:
    """Two modes alike, gap 0, R = 0: struck once, the contact point stands while the modes swing against each other."""
    modes = "[1.0, 1.0], 0.0, [-0.38853799, -0.82927784], [1.0, 1.0]"
    x, v = [0.11253899, 0.51518469], [0.0, 0.095222408]
    run_apart(NO_FORCE.format(modes=modes, restitution=0.0, x=x, v=v, end=18.84955592))


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_contact_force_that_decays_while_a_mode_that_the_stop_does_not_feel_swings_on(restitution: float) -> None:
    modes = "[1.0, 1.7, 1.9], [6.0, 1.0, 0.005], [-0.8, 0.3, 0.0], [1.0, 1.0, 1.0]"
    run_apart(NO_FORCE.format(modes=modes, restitution=restitution, x=[0.1, 0.0, 0.4], v=[-0.5, 0.3, 0.2], end=400.0))


def test_held_rates_on_the_brink_of_critical_damping_are_taken_together() -> None:
    """A conjugate pair with imaginary parts of 9.6e-5 of its size is one plane, on whichever side of the limit."""
    omega = np.array([1.0, 1.36581907, 2.94256797, 5.81136443, 12.10398161, 18.97134649])
    zeta = np.array([6.12514078, 0.0, 1.0, 0.0, 6.12514078, 0.17483231])
    contact = np.array([-7.14799860e-01, -8.14675450e-01, 6.10350000e-05, 0.0, 0.0, -1.02078294])
    for share in (1.0, 0.5, 0.1, 1e-3):
        row = contact * np.array([1, 1, share, 1, 1, 1])
        linear = LinearSystem(omega**2, np.diag(2 * zeta * omega), row, np.inf)
        found, _ = held_regime(linear, contact, contact, 0.0, 0)
        assert np.abs(found.into).max() < 1e6
        assert np.abs(found.into @ found.outof - np.eye(10)).max() < 1e-8
