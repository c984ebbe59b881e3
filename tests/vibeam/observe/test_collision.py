"""One collision: closed forms of a single mass and of Newton's law, and the modal equations by scipy's DOP853."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import beta

import vibeam
from vibeam.figures.kinds.impact import struck
from vibeam_models.laws.compliant import Hertz, HuntCrossley

STIFFNESS, SPEED = 2.04e10, 0.05
OMEGA, CONTACT = np.array([47.7, 635.0, 2555.0, 9000.0]), np.array([2.12, 0.31, 0.30, 0.45])


def system(modes: int = 4, zeta: float = 0.0, **law: object) -> vibeam.ImpactSystem:
    rows = OMEGA[:modes], zeta, CONTACT[:modes], np.zeros(modes)
    return vibeam.ImpactSystem.from_modes(*rows, **({"law": Hertz(STIFFNESS)} | law))


@pytest.mark.parametrize("speed", [0.005, 0.05, 0.5])
def test_a_mass_on_hertz_contact_stays_as_long_as_his_formula_says(speed: float) -> None:
    """t = 2δ/v ∫₀¹ dx/√(1 − x^{5/2}), δ = (5mv²/4k)^{2/5}.

    That is 2.87 (m²/RE*²V)^{1/5}: Johnson, Contact Mechanics, eq. 11.24.
    """
    mass = 0.2
    one = vibeam.ImpactSystem.from_modes([1.0], 0.0, [mass**-0.5], [0.0], law=Hertz(STIFFNESS))
    found = struck(one, speed)
    deep = (5 * mass * speed**2 / (4 * STIFFNESS)) ** 0.4
    assert found.duration == pytest.approx(0.8 * beta(0.4, 0.5) * deep / speed, rel=1e-6)
    radius, modulus = 17.5e-3, 0.75 * STIFFNESS / np.sqrt(17.5e-3)
    assert found.duration == pytest.approx(2.868 * (mass**2 / (radius * modulus**2 * speed)) ** 0.2, rel=2e-4)
    assert found.force == pytest.approx(STIFFNESS * deep**1.5, rel=1e-6)
    assert (found.restitution, found.mode_restitution) == pytest.approx((1.0, 1.0), rel=1e-9)


def integrated(made: vibeam.ImpactSystem, speed: float) -> tuple[float, np.ndarray]:
    """Duration and pose (2, n) at the end of the touch, by DOP853."""
    n, law = made.size, made.law

    def force(y: np.ndarray) -> float:
        deep, rate = made.contact @ y[:n], made.contact @ y[n:]
        return float(max(law.stiffness * max(deep, 0.0) ** law.exponent * (1 + law.damping * rate), 0.0))

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        pull = -(made.omega**2) * y[:n] - 2 * made.zeta * made.omega * y[n:] - made.contact * force(y)
        return np.concatenate([y[n:], pull])

    def parted(t: float, y: np.ndarray) -> float:
        return float(made.contact @ y[:n])

    parted.terminal, parted.direction = True, -1.0
    start = np.zeros(2 * n)
    start[n] = speed / made.contact[0]
    scale = np.concatenate([np.full(n, 1e-6), np.full(n, speed)])
    found = solve_ivp(rate, (0, 0.01), start, method="DOP853", rtol=1e-12, atol=1e-14 * scale, events=parted)
    return float(found.t_events[0][0]), found.y_events[0][0].reshape(2, n)


def free_rate(made: vibeam.ImpactSystem, pose: np.ndarray, elapsed: float) -> float:
    """Rate of the first mode alone, ``elapsed`` s (of either sign) later, by DOP853."""
    omega, zeta = float(made.omega[0]), float(made.zeta[0])
    found = solve_ivp(
        lambda t, y: [y[1], -2 * zeta * omega * y[1] - omega**2 * y[0]], (0, elapsed), pose[:, 0], method="DOP853",
        rtol=1e-12, atol=1e-16,
    )  # fmt: skip
    return float(found.y[1, -1])


@pytest.mark.parametrize("modes", [2, 4])
@pytest.mark.parametrize("law", [Hertz(STIFFNESS), HuntCrossley(STIFFNESS, 2.0)])
def test_a_collision_is_that_of_the_modal_equations(modes: int, law: HuntCrossley) -> None:
    made = system(modes, 0.017, law=law)
    found, (time, pose) = struck(made, SPEED), integrated(made, SPEED)
    assert found.duration == pytest.approx(time, rel=1e-8)
    assert found.restitution == pytest.approx(-(made.contact @ pose[1]) / SPEED, rel=1e-8)
    start = np.zeros((2, modes))
    start[1, 0] = SPEED / made.contact[0]
    kept = -free_rate(made, pose, -time / 2) / free_rate(made, start, time / 2)
    assert found.mode_restitution == pytest.approx(kept, rel=1e-8)
    left = np.sum(pose[1] ** 2 + (made.omega * pose[0]) ** 2)
    assert found.energy_restitution == pytest.approx(np.sqrt(left) / start[1, 0], rel=1e-8)
    assert found.touches == 1


def test_an_elastic_contact_loses_no_energy_and_mode_1_does() -> None:
    found = struck(system(4), SPEED)
    assert found.energy_restitution == pytest.approx(1.0, rel=1e-10)
    assert found.mode_restitution < 0.95
    assert found.mode_share == pytest.approx(found.mode_restitution**2, rel=1e-3)


@pytest.mark.parametrize("restitution", [0.5, 0.72, 1.0])
def test_an_impact_is_newtons(restitution: float) -> None:
    """R₁ = (1+R) c₁²/S − 1 and the energy lost is (1 − R²) v²/2S."""
    made = system(3, law=None, restitution=restitution)
    found, mobility = struck(made, SPEED), float(np.sum(made.contact**2))
    assert (found.duration, found.restitution) == pytest.approx((0.0, restitution), abs=1e-12)
    first = made.contact[0] ** 2
    assert found.mode_restitution == pytest.approx((1 + restitution) * first / mobility - 1, rel=1e-9)
    lost = (1 - restitution**2) * first / mobility
    assert found.energy_restitution == pytest.approx(np.sqrt(1 - lost), rel=1e-9)
    assert found.touches == 1


def test_later_touches_belong_to_the_collision() -> None:
    """Modes 2 and 3 swing the contact back before mode 1 has taken it away."""
    rows = [10.0, 400.0, 1700.0], 0.0, [1.0, 1.5, 1.5], np.zeros(3)
    found = struck(vibeam.ImpactSystem.from_modes(*rows, law=Hertz(1e9)), SPEED)
    assert found.touches > 1
    assert found.energy_restitution == pytest.approx(1.0, rel=1e-8)


def test_what_is_no_collision_is_refused() -> None:
    made = system(2, 0.01)
    path = vibeam.simulate(made, vibeam.Drive(1.0, 0.0), 0.01)
    with pytest.raises(ValueError, match="no touch that ends"):
        vibeam.observe.collision_of(path, path.contacts)
    with pytest.raises(ValueError, match="no period"):
        struck(vibeam.ImpactSystem.from_modes([0.0], 0.0, [1.0], [0.0]), SPEED)
    coupled = system(2, coupling=np.array([[1.0, 0.5], [0.5, 2.0]]))
    with pytest.raises(ValueError, match="couples the modes"):
        struck(coupled, SPEED)
