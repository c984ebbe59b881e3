"""Cases under an input over time: their numbers with a source, by formulas and programs of their own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import vibeam
from vibeam.case.case import Case

INPUTS = Path(__file__).parents[3] / "cases" / "inputs"
GRAVITY, LENGTH = 9.80665, 0.011


def expected(case: Case, name: str) -> float:
    assert case.expectations[name].source
    return case.expectations[name].value


def first_mode(case: Case) -> tuple[float, float, float, float, float]:
    """Frequency, damping ratio, load, contact row and gap of the one mode of ``sdof``."""
    system = case.system("sdof")
    return (*(float(each[0]) for each in (system.omega, system.zeta, system.load, system.contact)), system.gap)


@pytest.mark.parametrize(("name", "number", "peak"), [
    ("half_sine", "sdof_first", -5 * GRAVITY), ("relay_shock", "sdof_first", -30 * GRAVITY),
])  # fmt: skip
def test_first_impact_under_a_half_sine_is_the_closed_form(name: str, number: str, peak: float) -> None:
    """By hand, η = Im[lG(e^{ipt} − e^{−ζωt}(cos ω_d t + (ζω + ip)/ω_d sin ω_d t))], G⁻¹ = ω² − p² + 2iζωp."""
    case = vibeam.load(INPUTS / f"{name}.toml")
    omega, zeta, load, contact, gap = first_mode(case)
    p, damped = np.pi / LENGTH, omega * np.sqrt(1 - zeta**2)
    gain = -load * peak / (omega**2 - p**2 + 2j * zeta * omega * p)

    def beyond(t: float) -> float:
        free = np.exp(-zeta * omega * t) * (np.cos(damped * t) + (zeta * omega + 1j * p) / damped * np.sin(damped * t))
        return contact * float((gain * np.exp(1j * p * t)).imag - (gain * free).imag) - gap

    grid = np.linspace(0.0, LENGTH, 100)
    after = int(np.argmax([beyond(t) >= 0 for t in grid]))
    assert expected(case, number) == pytest.approx(brentq(beyond, grid[after - 1], grid[after], xtol=1e-16), rel=2e-9)


def test_first_impact_of_the_plucked_beam_is_the_closed_form() -> None:
    """By hand: x = x₀ e^{−ζωt} (cos ω_d t + ζω/ω_d sin ω_d t)."""
    case = vibeam.load(INPUTS / "plucked.toml")
    omega, zeta, _, contact, gap = first_mode(case)
    start = -3e-3 / float(case.system("sdof").output("sensor")[0]) * contact
    damped = omega * np.sqrt(1 - zeta**2)

    def beyond(t: float) -> float:
        turned = np.cos(damped * t) + zeta * omega / damped * np.sin(damped * t)
        return start * float(np.exp(-zeta * omega * t) * turned) - gap

    assert expected(case, "sdof_first") == pytest.approx(brentq(beyond, 0.0, np.pi / damped, xtol=1e-16), rel=2e-9)


def test_equipment_on_the_base_is_that_of_a_second_program() -> None:
    case = vibeam.load(INPUTS / "half_sine.toml")
    omega = 2 * np.pi * 72.7

    def flow(t: float, x: np.ndarray) -> list[float]:
        return [x[1], -0.1 * omega * x[1] - omega**2 * x[0] - 5 * GRAVITY * np.sin(np.pi * t / LENGTH)]

    made = solve_ivp(flow, (0.0, LENGTH), [0.0, 0.0], "DOP853", np.linspace(0, LENGTH, 200_001), rtol=1e-12, atol=1e-16)
    assert expected(case, "on_base") == pytest.approx(
        np.abs(0.1 * omega * made.y[1] + omega**2 * made.y[0]).max(), rel=1e-8
    )


def test_force_on_the_open_contact_closes_it_at_the_level_that_the_spectrum_says() -> None:
    """The free device's displacement is proportional to the level: below gap/displacement nothing is struck."""
    case = vibeam.load(INPUTS / "relay_shock.toml")
    system, record = case.system("spring"), case.input("spring")
    lowest = [float(np.min(system.omega)) / (2 * np.pi)]
    level = 0.3e-3 / case.expectations["free"].value
    for share, struck in ((0.999, False), (1.001, True)):
        found = vibeam.shock_spectrum(record.scaled(level * share), lowest, device=system, output="contact")
        assert bool(found.impacts[0]) is struck
