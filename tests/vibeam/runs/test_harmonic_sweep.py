"""Sweeps under several harmonics: closed forms without impacts, the equation integrated from impact to impact."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from bounded import Bound
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from stand_in import two_modes as rig

import vibeam
from vibeam.runs.sweep import march
from vibeam.solvers.harmonic_point import steady_point
from vibeam.system.response import FrequencyResponse
from vibeam.system.several_harmonics import Harmonic, SeveralHarmonics
from vibeam_models.laws.compliant import LinearStop

OMEGA, SIZE = 2 * np.pi * 15.3, 8e-5
PERIOD = 2 * np.pi / OMEGA
FURTHER = ((2, 0.4, 0.7), (3, 0.3, -1.1))


def point(system: vibeam.ImpactSystem, **more: Any) -> FrequencyResponse:
    keys: dict[str, Any] = {"omega": [OMEGA], "amplitude": SIZE, "output": "sensor", "harmonics": FURTHER}
    found = vibeam.sweep(system, **(keys | more))
    assert isinstance(found, FrequencyResponse)
    return found


class Integrated:
    """The equation by DOP853 from one impact to the next, its modes' energies integrated along."""

    def __init__(self, system: vibeam.ImpactSystem, state: vibeam.State, periods: int) -> None:
        self.system, t, end = system, 0.0, periods * PERIOD
        y = np.concatenate([state.displacement, state.velocity, np.zeros(2)])
        self.velocities: list[float] = []
        sensor: list[NDArray[np.float64]] = []
        within = Bound()
        while within(t < end):
            path = solve_ivp(
                self.slope, (t, end), y, "DOP853", events=self.distance(), rtol=1e-11, atol=1e-15, first_step=1e-7,
                max_step=1e-3, dense_output=True,
            )  # fmt: skip
            times = np.linspace(t, path.t[-1], 3000)
            sensor.append(system.outputs["sensor"] @ path.sol(times)[:2])
            t, y = path.t[-1], path.y[:, -1].copy()
            if path.status == 1:
                speed = float(system.contact @ y[2:4])
                self.velocities.append(speed)
                y[2:4] -= (1 + system.restitution) * speed / (system.contact @ system.contact) * system.contact
        self.last, self.energy, self.sensor = y, y[4:] / end, np.concatenate(sensor)

    def slope(self, t: float, y: NDArray[np.float64]) -> NDArray[np.float64]:
        system = self.system
        wave = np.sin(OMEGA * t) + sum(share * np.sin(order * OMEGA * t + phase) for order, share, phase in FURTHER)
        pull = system.load * OMEGA**2 * SIZE * wave - system.omega**2 * y[:2] - 2 * system.zeta * system.omega * y[2:4]
        return np.concatenate([y[2:4], pull, (y[2:4] ** 2 + system.omega**2 * y[:2] ** 2) / 2])

    def distance(self) -> Any:
        def gap(t: float, y: NDArray[np.float64]) -> float:
            return float(self.system.gap - self.system.contact @ y[:2])

        gap.terminal, gap.direction = True, -1  # type: ignore[attr-defined]
        return gap


@pytest.mark.parametrize("gap", [1e-4, 0.0])
def test_a_point_is_that_of_the_equation_integrated(gap: float) -> None:
    system, start = rig(gap), vibeam.State([-1e-4, 0.0], [0.0, 0.0])
    found, after = next(march(system, OMEGA, SIZE, settle=0, hold=12, output="sensor", state=start, harmonics=FURTHER))
    true = Integrated(system, start, 12)
    assert found.impacts_per_period[0] * 12 == len(true.velocities) > 8
    np.testing.assert_allclose(after.displacement, true.last[:2], rtol=0, atol=1e-10 * np.abs(true.last[:2]).max())
    np.testing.assert_allclose(after.velocity, true.last[2:4], rtol=0, atol=1e-9 * np.abs(true.last[2:4]).max())
    assert found.impact_velocity[0] == pytest.approx(np.mean(true.velocities), rel=1e-9)
    kept = found.impact_velocities[0]
    np.testing.assert_allclose(kept[np.isfinite(kept)], true.velocities[-16:], rtol=1e-7)
    assert found.amplitude[0] == pytest.approx(np.ptp(true.sensor) / 2, rel=1e-5)
    np.testing.assert_allclose(found.mode_energy[0], true.energy, rtol=1e-8)


@pytest.mark.parametrize("more", [{}, {"coupling": [[1.6, 0.5], [0.5, 21.0]]}])
def test_without_impacts_it_is_the_sum_of_its_parts(more: dict[str, Any]) -> None:
    """η = Σ Im(H e^{ijΩt}) with H from the matrices, and the mean energies are Σ |H|²(ω² + (jΩ)²)/4."""
    own = rig(gap=1.0, **more)
    damper = np.diag(2 * own.zeta * own.omega) if own.coupling is None else own.coupling
    times, steady, energy = np.linspace(0, PERIOD, 20_000), np.zeros(20_000), np.zeros(2)
    for order, share, phase in ((1, 1.0, 0.0), *FURTHER):
        rate = order * OMEGA
        force = own.load * OMEGA**2 * SIZE * share * np.exp(1j * phase)
        modes = np.linalg.solve(np.diag(own.omega**2) - rate**2 * np.eye(2) + 1j * rate * damper, force)
        steady += (own.outputs["sensor"] @ modes * np.exp(1j * rate * times)).imag
        energy += np.abs(modes) ** 2 * (own.omega**2 + rate**2) / 4
    found = point(own, settle=800, hold=10)
    assert found.period[0] == -1
    assert found.amplitude[0] == pytest.approx(np.ptp(steady) / 2, rel=1e-6)
    assert found.minimum[0] == pytest.approx(steady.min(), rel=1e-6)
    np.testing.assert_allclose(found.mode_energy[0], energy, rtol=1e-9)


def test_a_velocity_and_an_absolute_acceleration_have_them_too() -> None:
    """Σ Im(ijΩ r·H e^{ijΩt}), and of the sensor with the base Σ Im(−(jΩ)² r·H e^{ijΩt}) − Ω²B Σ s sin(jΩt + phase)."""
    row = np.array([1.36, 2.2])
    speed, pull = vibeam.TimeDerivative(row, 1), vibeam.TimeDerivative(row, 2, base=1.0)
    own = rig(gap=1.0, derivatives={"speed": speed, "pull": pull})
    times, rates, accelerations = np.linspace(0, PERIOD, 20_000), np.zeros(20_000), np.zeros(20_000)
    for order, share, phase in ((1, 1.0, 0.0), *FURTHER):
        rate, turn = order * OMEGA, np.exp(1j * order * OMEGA * times)
        force = OMEGA**2 * SIZE * share * np.exp(1j * phase)
        place = row @ (own.load * force / (own.omega**2 - rate**2 + 2j * own.zeta * own.omega * rate))
        rates += (1j * rate * place * turn).imag
        accelerations += (-(rate**2) * place * turn - force * turn).imag
    for name, expected in (("speed", rates), ("pull", accelerations)):
        found = point(own, settle=800, hold=4, output=name)
        assert found.amplitude[0] == pytest.approx(np.ptp(expected) / 2, rel=1e-6)
        assert found.maximum[0] == pytest.approx(expected.max(), rel=1e-6)


def test_a_period_is_that_of_the_motion_and_not_of_its_oscillators() -> None:
    """What the drive repeats every period is large in the solver's state; the motion itself may have period 1 or 3."""
    assert point(rig(), settle=300, hold=20).period[0] == 1
    system, periods = rig(-1e-4, 0.3), {"settle": 300, "hold": 20}
    found, state = next(march(system, OMEGA, SIZE, harmonics=FURTHER, **periods))  # type: ignore[arg-type]
    assert found.period[0] == 3
    later = [state]
    for _ in range(3):
        _, state = next(march(system, OMEGA, SIZE, settle=0, hold=1, harmonics=FURTHER, state=state))
        later.append(state)
    rates = [each.velocity for each in later]
    np.testing.assert_allclose(rates[3], rates[0], atol=1e-6 * np.abs(rates[0]).max())
    assert np.abs(rates[1] - rates[0]).max() > 0.01 * np.abs(rates[0]).max()


def test_points_follow_one_another_in_the_systems_own_modes() -> None:
    """A sweep is its points one by one, each from the state after the one before; from scratch and with a drift."""
    grid, system = OMEGA * np.array([0.97, 1.0, 1.03]), rig()
    keys: dict[str, Any] = {"amplitude": SIZE, "settle": 20, "hold": 5, "harmonics": FURTHER}
    found = vibeam.sweep(system, omega=grid, drift=lambda omega: 1e-6 * np.ones(len(omega)), **keys)
    assert isinstance(found, FrequencyResponse)
    state, moved = None, rig(1e-6)
    for index, omega in enumerate(grid):
        alone, state = next(march(moved, omega, state=state, slowest=float(grid[0]), **keys))
        assert found.amplitude[index] == alone.amplitude[0]
        assert state.displacement.shape == (2,)


@pytest.mark.parametrize(("solver", "options", "within"), [
    ("direct", {"method": "DOP853", "rtol": 1e-10, "atol": 1e-14}, 1e-6), ("moreau", {"steps": 4000}, 1e-2),
])  # fmt: skip
def test_solvers_by_steps_take_them(solver: str, options: dict[str, Any], within: float) -> None:
    keys: dict[str, Any] = {"settle": 4, "hold": 4, "state": vibeam.State([-1e-4, 0.0], [0.0, 0.0])}
    exact, other = point(rig(), **keys), point(rig(), solver=solver, options=options, **keys)
    assert other.amplitude[0] == pytest.approx(exact.amplitude[0], rel=within)
    np.testing.assert_allclose(other.mode_energy[0], exact.mode_energy[0], rtol=10 * within)


def test_a_point_that_fails_says_why_and_the_next_one_begins_anew() -> None:
    keys: dict[str, Any] = {"omega": [OMEGA, 1.1 * OMEGA], "settle": 5, "hold": 5, "options": {"limit": 1}}
    found = point(rig(-1e-4, 0.3), **keys)
    assert found.ended.tolist() == [vibeam.Ended.EVENT_LIMIT.code] * 2
    assert np.isnan(found.amplitude).all()
    assert np.isnan(found.mode_energy).all()


def test_what_a_sweep_refuses() -> None:
    with pytest.raises(ValueError, match="'orbit' knows a drive of one harmonic: flight, direct, moreau take several"):
        point(rig(), solver="orbit")
    with pytest.raises(ValueError, match="an order comes twice in 2, 2"):
        point(rig(), harmonics=((2, 0.1, 0.0), (2, 0.2, 0.0)))
    with pytest.raises(ValueError, match="the first is 2"):
        point(rig(), harmonics=((1, 0.1, 0.0),))
    with pytest.raises(ValueError, match="carried to one contact, and the system has several"):
        point(rig(further=[vibeam.Contact([1.0, 2.0], 1e-3, 0.5)]))


def test_a_sweep_without_them_does_not_load_them() -> None:
    program = (
        "import sys, vibeam\n"
        "system = vibeam.ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, restitution=0.9)\n"
        "vibeam.sweep(system, omega=[2.0], amplitude=1e-3, settle=1, hold=1)\n"
        "assert not [name for name in sys.modules if 'harmonic' in name], sys.modules.keys()\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


@pytest.mark.parametrize(("more", "start", "periods"), [
    ({"gap": -3e-4, "restitution": 0.3}, -3e-4 / 2.14 - 2e-4, 12), ({"gap": -1e-4, "restitution": 0.0}, -3e-4, 12),
    ({"law": LinearStop(1e5, 5.0)}, -1e-4, 12), ({"gap": 1e-4, "second_gap": 1e-4}, 0.0, 4),
])  # fmt: skip
def test_energies_are_those_of_the_same_drive_as_a_first_harmonic(
    more: dict[str, Any], start: float, periods: int
) -> None:
    """Through chatter, rest, contact that lasts and two stops: 15.3 Hz, and as second harmonic of 7.65 Hz."""
    own, state = rig(**more), vibeam.State([start, 0.0], [0.0, 0.0])
    plain = point(own, settle=0, hold=periods, state=state, harmonics=())
    several = SeveralHarmonics(own, vibeam.Drive(OMEGA / 2, 0.0), (Harmonic(2, OMEGA**2 * SIZE),))
    found, _ = steady_point(
        several, state, 0, periods // 2, solver_name="flight", output="sensor", slowest=OMEGA / 2, options={}
    )  # fmt: skip
    assert found.rest[0] == pytest.approx(plain.rest[0], rel=1e-8)
    assert found.amplitude[0] == pytest.approx(plain.amplitude[0], rel=1e-8)
    np.testing.assert_allclose(found.mode_energy[0], plain.mode_energy[0], rtol=1e-6)
