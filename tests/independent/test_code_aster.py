"""SDND101 and SDND102 of code_aster: a mass thrown onto a stop that yields; a shaken one against a wall, or another.

The printed numbers are in ``code_aster.json``; the cases are in ``cases/code_aster``.
"""

from __future__ import annotations

import json
from math import pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vibeam

HERE = Path(__file__).parent
CASES = HERE.parents[1] / "cases" / "code_aster"
PRINTED = json.loads((HERE / "code_aster.json").read_text(encoding="utf-8"))


def path_of(name):
    """The motion of a case, as its one fidelity moves."""
    case = vibeam.load(CASES / f"{name}.toml")
    (fidelity,) = case.fidelities
    own = case.system(fidelity)
    return vibeam.simulate(own, case.input(fidelity), case.record.duration, case.start(fidelity), certify=True)


@pytest.fixture(scope="module")
def thrown():
    return path_of("sdnd101")


def test_a_mass_thrown_against_its_stop_in_closed_form(thrown):
    """Half turns at √((k+K)/m) in contact and at √(k/m) in flight; each contact is as the first."""
    own = PRINTED["sdnd101"]
    pushed = sqrt((own["stiffness"] + own["stop"]) / own["mass"])
    free = pi / sqrt(own["stiffness"] / own["mass"])
    begins, durations, forces = thrown.contacts.T
    assert begins == pytest.approx([0.0, pi / pushed + free], abs=1e-14)
    assert durations == pytest.approx(pi / pushed, rel=1e-13)
    assert forces == pytest.approx(own["stop"] * own["speed"] / pushed, rel=1e-13)
    assert thrown.certificate.complete


def test_sdnd101_as_printed(thrown):
    """Within what the test of code_aster allows; of the impulse, 198.0198 N s in closed form, 198.05 is printed."""
    own = PRINTED["sdnd101"]
    begins, durations, forces = thrown.contacts.T
    found = {"force": forces[0], "contact": durations[0], "impulse": 2 * forces[0] * durations[0] / pi}
    found |= {"first_peak": begins[0] + durations[0] / 2, "second_peak": begins[1] + durations[1] / 2}
    assert {name: value for name, value in found.items() if abs(value / own[name] - 1) > own[f"{name}_precision"]} == {}
    assert f"{found['first_peak']:.5f} {found['contact']:.5f} {found['second_peak']:.3f}" == "0.01563 0.03126 0.361"
    assert round(found["force"], -1) == own["force"]


@pytest.fixture(scope="module")
def shaken():
    return path_of("sdnd102_wall"), path_of("sdnd102_pair")


def test_sdnd102_two_masses_move_as_one_against_a_wall(shaken):
    """Printed: below 3e-5 m apart in time steps. In exact motion it is round-off."""
    times = np.linspace(0.0, 1.0, 501)
    wall, pair = (path.at(times, "sensor") for path in shaken)
    assert np.abs(wall - pair).max() < 1e-15
    assert len(shaken[0].impact_times) == len(shaken[1].impact_times) == 10
    assert shaken[0].contacts == pytest.approx(shaken[1].contacts, rel=1e-9)
    assert all(path.certificate.complete for path in shaken)


def test_sdnd102_as_printed_is_central_differences_of_a_quarter_millisecond(shaken):
    """The printed digits are those of the scheme, to 1e-8 m; the exact motion is as far off as its step leaves."""
    own = PRINTED["sdnd102"]
    times, printed = np.array([(float(t), value) for t, value in own["displacement"].items()]).T
    coarse, fine = (central_differences(own, step)[np.rint(times / step).astype(int)] for step in (own["step"], 5e-6))
    exact = shaken[0].at(times, "sensor")
    assert np.abs(coarse - printed).max() < 1e-8
    assert 1e-6 < np.abs(exact - printed).max() < own["difference"] / 10
    assert np.abs(exact - fine).max() < 3e-8


def central_differences(own, step):
    """Absolute displacement of the mass at all steps: velocities between them, damping by the last of these."""
    mass, stiffness, omega = own["mass"], own["stiffness"], 2 * pi * own["frequency"]
    damping = 2 * own["damping_ratio"] * sqrt(stiffness * mass)
    x, v, found = 0.0, 0.0, [0.0]
    for k in range(round(1 / step)):
        t = k * step
        support = -own["acceleration"] * sin(omega * t) / omega**2
        deep = max(x + support - own["gap"], 0.0)
        pull = -(stiffness * x + damping * v + own["wall"] * deep) / mass - own["acceleration"] * sin(omega * t)
        v += step * pull * (0.5 if k == 0 else 1.0)
        x += step * v
        found.append(x - own["acceleration"] * sin(omega * (t + step)) / omega**2)
    return np.array(found)


def test_sdnd102_by_dop853(shaken):
    """First contact and its force, in the support's frame, by scipy at 1e-12."""
    own = PRINTED["sdnd102"]
    mass, stiffness, omega, wall = own["mass"], own["stiffness"], 2 * pi * own["frequency"], own["wall"]
    damping = 2 * own["damping_ratio"] * sqrt(stiffness * mass)

    def deep(t, y):
        return y[0] - own["acceleration"] * sin(omega * t) / omega**2 - own["gap"]

    def motion(pushes):
        def rate(t, y):
            force = wall * deep(t, y) if pushes else 0.0
            return [y[1], -(stiffness * y[0] + damping * y[1] + force) / mass - own["acceleration"] * sin(omega * t)]

        return rate

    def turned(t, y):
        return y[1] - own["acceleration"] * np.cos(omega * t) / omega

    deep.terminal, deep.direction, turned.terminal, turned.direction = True, 1, True, -1
    accuracy = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-16}
    met = solve_ivp(motion(False), (0.0, 1.0), [0.0, 0.0], events=deep, max_step=1e-3, **accuracy)
    top = solve_ivp(motion(True), (met.t[-1], 1.0), met.y[:, -1], events=turned, max_step=1e-4, **accuracy)
    first = shaken[0].contacts[0]
    assert first[0] == pytest.approx(met.t[-1], rel=1e-8)
    assert first[2] == pytest.approx(wall * deep(top.t[-1], top.y[:, -1]), rel=1e-7)
