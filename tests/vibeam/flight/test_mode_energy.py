"""Modal energies read off a period: against quadrature in 30 digits of the modes' own closed forms, and of the path."""

from __future__ import annotations

from itertools import pairwise

import mpmath
import numpy as np
import pytest
from mpmath import mpf

import vibeam
from vibeam.flight.equilibrium import equilibrium
from vibeam.flight.solver import FlightSolver, exact_solver
from vibeam_models.laws.compliant import LinearStop

DIGITS = 1e-11


def energies(system: vibeam.ImpactSystem, drive: vibeam.Drive, start: vibeam.State) -> np.ndarray:
    """∫ ½(η'² + ω²η²) dt of each mode (n,) over one drive period."""
    found, _ = FlightSolver(system, drive.omega).steady([drive.omega], drive.amplitude, start, 0, 1, "contact")
    return found.mode_energy[0] * 2 * np.pi / drive.omega


def true_energy(
    omega: float, zeta: float, load: float, static: float, drive: vibeam.Drive, x: float, v: float
) -> float:
    """The same of one mode in free flight: its roots, its amplitude under e^{iΩt}, and Gauss–Legendre in 30 digits."""
    with mpmath.workdps(30):
        w, z, W = mpf(omega), mpf(zeta), mpf(drive.omega)
        response = mpf(load) * W**2 * mpf(drive.amplitude) / (w**2 - W**2 + 2j * z * w * W)
        offset, root = mpf(static) / w**2, mpmath.sqrt(mpmath.mpc(z**2 - 1)) * w
        first, second = -z * w + root, -z * w - root
        u, du = mpf(x) - offset - response.imag, mpf(v) - (1j * W * response).imag

        def free(t: mpf) -> tuple[mpf, mpf]:
            if root == 0:
                rise = du + z * w * u
                return mpmath.exp(first * t).real * (u + rise * t), mpmath.exp(first * t).real * (du - z * w * rise * t)
            a, b = (du - second * u) / (first - second), (first * u - du) / (first - second)
            one, two = a * mpmath.exp(first * t), b * mpmath.exp(second * t)
            return (one + two).real, (first * one + second * two).real

        def density(t: mpf) -> mpf:
            turned, (value, slope) = response * mpmath.expj(W * t), free(t)
            return ((slope + (1j * W * turned).imag) ** 2 + w**2 * (value + offset + turned.imag) ** 2) / 2

        span = 2 * mpmath.pi / mpf(drive.omega)
        rate = max(w * (z + mpmath.sqrt(z**2 + 1)), W)
        pieces = [span * k / 2**10 for k in (0, 1, 4, 16, 64)]
        pieces += mpmath.linspace(span / 8, span, 2 + int(min(60, span * rate / 10)))
        return float(mpmath.quad(density, sorted(set(pieces)), method="gauss-legendre"))


ZETAS, RATIOS = [0.0, 0.02, 0.9985, 1.0, 1 + 1e-9, 1.01, 4.7, 300.0], [1e-4, 0.03, 0.9, 1.001, 1 + 1e-8, 3.0, 47.0]
FEW = [(zeta, ratio) for zeta in ZETAS for ratio in RATIOS if zeta in (0.0, 300.0) or ratio in (1e-4, 1 + 1e-8)]


@pytest.mark.parametrize(
    ("zeta", "ratio"),
    [
        each if each in FEW else pytest.param(*each, marks=pytest.mark.slow)
        for each in ((zeta, ratio) for zeta in ZETAS for ratio in RATIOS)
    ],
)
def test_a_flight_of_one_period(zeta: float, ratio: float) -> None:
    """Slow and fast modes, any damping, beside and at resonance, with a static offset."""
    drive = vibeam.Drive(2.3, 0.04)
    omega, rng = ratio * drive.omega, np.random.default_rng(int(1e4 * ratio))
    x, v, static = 0.1 * rng.normal(), 0.1 * rng.normal() * max(omega, 1.0), 0.05 * omega**2
    system = vibeam.ImpactSystem.from_modes(omega, zeta, 1.0, 0.7, gap=1e6, static=static)
    found = energies(system, drive, vibeam.State(np.array([x]), np.array([v])))[0]
    assert found == pytest.approx(true_energy(omega, zeta, 0.7, static, drive, x, v), rel=DIGITS, abs=0)


def test_a_mode_without_stiffness() -> None:
    """η' = v + F (1 − cos Ωt)/Ω + s t: it carries its force along."""
    drive, v, s = vibeam.Drive(2.3, 0.04), 0.1, -0.03
    system = vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 0.7, gap=1e6, static=s)
    force = 0.7 * drive.omega**2 * drive.amplitude

    def density(t: mpf) -> mpf:
        return (v + force * (1 - mpmath.cos(drive.omega * t)) / drive.omega + s * t) ** 2 / 2

    found = energies(system, drive, vibeam.State(np.zeros(1), np.array([v])))[0]
    assert found == pytest.approx(float(mpmath.quad(density, [0, 2 * mpmath.pi / drive.omega])), rel=DIGITS, abs=0)


def quadrature(path: vibeam.Trajectory, per_piece: int) -> np.ndarray:
    """∫ ½(η'² + ω²η²) dt (n,) along a path, by 40 Gauss nodes on ``per_piece`` equal pieces of every segment."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    events = np.unique(np.r_[path.t_start, path.segments.trace[1:, 0], path.t_end])
    total = np.zeros(path.system.size)
    for begin, end in pairwise(events):
        edges = np.linspace(begin, end, per_piece + 1)
        times = (edges[:-1, None] + np.diff(edges)[:, None] * (nodes + 1) / 2).ravel()
        poses = path.modes_at(np.clip(times, begin, np.nextafter(end, begin)))
        density = (poses[:, 1] ** 2 + (path.system.omega * poses[:, 0]) ** 2) / 2
        total += np.tile(weights, per_piece) @ density * (end - begin) / per_piece / 2
    return total


def test_the_rig_with_eight_modes_that_ring_between_impacts() -> None:
    """Simpson's rule with 128 steps a flight had the eighth mode to 6e-3."""
    case = vibeam.load("cases/dtu_neutral.toml")
    system, drive = case.system("beam"), vibeam.Drive(2 * np.pi * 15.3, case.base_amplitude)
    settled = vibeam.simulate(system, drive, 200 * 2 * np.pi / drive.omega).state
    path = vibeam.simulate(system, drive, 2 * np.pi / drive.omega, settled)
    assert len(path.impact_times) >= 1
    np.testing.assert_allclose(energies(system, drive, settled), quadrature(path, 100), rtol=1e-9)


@pytest.mark.parametrize("coupled", [False, True])
def test_a_period_with_chatter_rest_and_release(coupled: bool) -> None:
    omega, zeta = np.array([1.0, 4.7, 9.1]), 0.03
    system = vibeam.ImpactSystem.from_modes(
        omega, zeta, [1.0, 0.4, -0.3], [1.0, 0.3, -0.2], gap=-0.3, restitution=0.5, static=[1.0, 0.0, 0.0],
        coupling=np.diag(2 * zeta * omega) if coupled else None,
    )  # fmt: skip
    drive, start = vibeam.Drive(0.6, 4.2), vibeam.State(np.array([-0.32, 0.0, 0.0]), np.zeros(3))
    path = vibeam.simulate(system, drive, 2 * np.pi / drive.omega, start)
    assert len(path.chatters) >= 1
    assert len(path.rests) >= 1
    if coupled:
        response = vibeam.sweep(system, omega=[0.6], amplitude=4.2, settle=3, hold=1)
        settled = vibeam.simulate(system, drive, 3 * 2 * np.pi / drive.omega).state
        path = vibeam.simulate(system, drive, 2 * np.pi / drive.omega, settled)
        found = response.mode_energy[0] * 2 * np.pi / drive.omega
    else:
        found = energies(system, drive, start)
    np.testing.assert_allclose(found, quadrature(path, 12), rtol=1e-9)


@pytest.mark.parametrize("law", [None, LinearStop(40.0, 0.05)], ids=["rest", "push"])
@pytest.mark.parametrize("coupled", [False, True], ids=["modal", "coupled"])
def test_a_mode_that_turns_thousands_of_times_in_contact(coupled: bool, law: LinearStop | None) -> None:
    """In closed form, where 128 panels of quadrature do not resolve a turn: at rest, pushed, with coupled damping."""
    omega, zeta, drive = np.array([1.0, 9.0, 2400.0]), 1e-5, vibeam.Drive(0.6, 0.3)
    damping = np.diag(2 * zeta * omega) + 0.004 * np.outer([1.0, 2.0, -1.0], [1.0, 2.0, -1.0])
    system = vibeam.ImpactSystem.from_modes(
        omega, zeta, [1.0, 0.4, -0.3], [1.0, 0.3, -0.2], gap=-0.3, restitution=0.3, static=[1.0, 0.0, 0.0],
        coupling=damping if coupled else None, law=law,
    )  # fmt: skip
    pressed = equilibrium(system)
    start = vibeam.State(pressed.displacement, np.array([1e-5, 5e-5, 1e-4]), pressed.resting)  # contact at rest
    path = vibeam.simulate(system, drive, 2 * np.pi / drive.omega, start)
    solver = exact_solver(system, drive.omega)
    response, _ = solver.steady([drive.omega], drive.amplitude, start, 0, 1, "contact")
    assert response.rest[0] == 1.0
    found = response.mode_energy[0] * 2 * np.pi / drive.omega
    np.testing.assert_allclose(found, quadrature(path, 2000), rtol=1e-9)


UNRESOLVED = {  # ω, ζ, drive: what is no sum of exponentials, and turns oftener than 128 panels hold
    "two modes at an undamped resonance, a fast third": ([1.0, 1.0, 500.0], [0.0, 0.0, 0.0], 1.0),
    "overdamped twins that differ by a last digit": (
        [300.0, 300.0 * (1 + 1e-12), 250.0, 0.5],
        [2.0, 2.0, 2.0, 0.0],
        2.0,
    ),
    "a critical mode beside an undamped one": ([1.0, 3.0, 700.0], [0.0, 1.0, 0.0], 0.8),
}


@pytest.mark.parametrize("law", [None, LinearStop(400.0)], ids=["rest", "push"])
@pytest.mark.parametrize("name", UNRESOLVED)
def test_what_is_no_sum_of_exponentials_is_resolved(name: str, law: LinearStop | None) -> None:
    """Quadrature on 128 panels had these energies wrong by up to 2 %."""
    omega, zeta, rate = UNRESOLVED[name]
    row = np.array([1.0, -0.6, 0.3, 0.5])[: len(omega)]
    system = vibeam.ImpactSystem.from_modes(
        omega, zeta, row, [1.0, 0.3, 0.2, 0.1][: len(omega)], gap=0.0, restitution=0.0, static=5e3 * row, law=law
    )
    drive, speed = vibeam.Drive(rate, 0.1), np.array([0.1, -0.2, 0.4, 0.3])[: len(omega)]
    pressed = equilibrium(system)
    start = vibeam.State(pressed.displacement, speed - row * (row @ speed) / (row @ row), pressed.resting)
    path = vibeam.simulate(system, drive, 2 * np.pi / rate, start)
    assert len(path.segments.trace) == 1
    response, _ = exact_solver(system, rate).steady([rate], drive.amplitude, start, 0, 1, "contact")
    moving = path.modes_at(np.linspace(0.0, path.t_end, 7))[:, 0].std(axis=0)
    assert np.all(moving > 0)
    found = response.mode_energy[0] * 2 * np.pi / rate
    np.testing.assert_allclose(found, quadrature(path, 2000), rtol=1e-9)
