"""Periodic motions in closed form as the page finds them, against vibeam.orbits; eigenvalues against LAPACK."""

from dataclasses import replace

import numpy as np
import pytest

import vibeam
from vibeam.periodic.modal_sums import resonant
from vibeam.periodic.multipliers import monodromy
from vibeam.periodic.orbit_search import orbits
from vibeam.solvers.orbit import OrbitSolver

RATES = 47.7 * np.array([1, 6.27, 17.55, 34.4, 56.8, 84.9, 118.6, 157.9])
MODULE = "const { orbitsAt, freeMotion } = await load('extensions/explore/engine/periodic.js');"


def beam(modes, **given):
    contact, load = 2 * (-0.5) ** np.arange(modes), 0.5 / (1 + np.arange(modes))
    return vibeam.ImpactSystem.from_modes(RATES[:modes], contact=contact, load=load, **given)


SYSTEMS = {
    "one mode": beam(1, zeta=0.01, gap=1e-3, restitution=0.72),
    "two modes, wide gap": beam(2, zeta=0.02, gap=3e-3, restitution=0.5),
    "pressed on the stop": beam(2, zeta=0.03, gap=-2e-4, restitution=0.72),
    "eight modes, loaded": beam(8, zeta=0.02, gap=2e-3, restitution=0.6, static=[1.0] * 8),
    "overdamped": vibeam.ImpactSystem.from_modes(
        [40.0, 200.0, 300.0], [0.05, 1.2, 3.0], [1.0, 0.5, 0.3], [1.0, 0.2, 0.1], gap=1e-3, restitution=0.6
    ),
    "plastic, no gap": beam(2, zeta=0.02, gap=0.0, restitution=0.0),
    "undamped mode": beam(2, zeta=[0.0, 0.01], gap=1e-3, restitution=0.8),
    "falling ball": vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 1.0, static=9.81, restitution=0.6),
    "ball on a beam": vibeam.ImpactSystem.from_modes(
        [0.0, 60.0], [0.0, 0.02], [1.0, 0.4], [1.0, 0.3], static=[9.81, 0.0], restitution=0.6
    ),
}
AMPLITUDE = 1e-3
OMEGA = np.linspace(30.0, 140.0, 23)


def as_json(system):
    rows = {name: getattr(system, name) for name in ("omega", "zeta", "contact", "load", "static")}
    return rows | {"gap": system.gap, "restitution": system.restitution}


@pytest.fixture(scope="module")
def found(node):
    """By system: [periods][frequency] of orbits, [frequency] of motions without contact."""
    script = f"""{MODULE}
    return given.systems.map((system) => {{
      const drives = given.omega.map((omega) => ({{ omega, amplitude: given.amplitude }}));
      return {{
        orbits: [1, 2, 3].map((periods) => drives.map((drive) => orbitsAt(system, drive, periods))),
        free: drives.map((drive) => freeMotion(system, drive, system.contact)),
      }};
    }});"""
    given = {"systems": list(map(as_json, SYSTEMS.values())), "omega": OMEGA, "amplitude": AMPLITUDE}
    return dict(zip(SYSTEMS, node(script, given), strict=True))


@pytest.mark.parametrize("name", SYSTEMS)
def test_motions_with_one_impact(found, name):
    """The same formulas, so round-off apart: 1e-11 of an impact velocity, 1e-12 rad, 1e-10 of a state."""
    system, counts = SYSTEMS[name], np.zeros(3, dtype=int)
    for periods in (1, 2, 3):
        for omega, there in zip(OMEGA, found[name]["orbits"][periods - 1], strict=True):
            drive, period = vibeam.Drive(omega, AMPLITUDE), 2 * np.pi / omega
            wanted = () if resonant(system, omega, periods) else orbits(system, drive, periods)
            assert len(there) == len(wanted)
            for one, other in zip(there, wanted, strict=True):
                assert one["impactVelocity"] == pytest.approx(other.velocity, rel=1e-11)
                assert abs(np.angle(np.exp(1j * (one["phase"] - other.phase)))) < 1e-12
                assert one["stable"] == (other.stable and one["state"] is not None)
                assert one["state"] is not None or not other.admissible
                if other.admissible:
                    zero = period * np.ceil(other.time / period)
                    path = vibeam.simulate(system, drive, zero, other.state, t_start=other.time)
                    state = path.modes_at(zero).ravel()
                    assert one["state"] == pytest.approx(state, abs=1e-10 * np.abs(state).max())
                counts += one["stable"], not one["stable"] and other.admissible, other.admissible
    assert counts.min() > 0, "this system decides nothing"


@pytest.mark.parametrize("name", SYSTEMS)
def test_motion_without_contact(found, name):
    system = SYSTEMS[name]
    solver = OrbitSolver(system, OMEGA[0])
    for omega, there in zip(OMEGA, found[name]["free"], strict=True):
        state = solver._linear(vibeam.Drive(omega, AMPLITUDE))
        assert len(there) == (state is not None)
        if state is not None:
            wide = replace(system, gap=1e6)
            flight = OrbitSolver(wide, OMEGA[0]).flight
            response, _ = flight.steady([omega], AMPLITUDE, state, 0, 1, "contact")
            for key in ("amplitude", "maximum", "minimum"):
                assert there[0][key] == pytest.approx(getattr(response, key)[0], rel=1e-10)


def test_faults(node):
    loose = vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 1.0)
    script = "return given.systems.map((await load('extensions/explore/engine/modal_sums.js')).fault);"
    none, said = node(script, {"systems": [as_json(SYSTEMS["falling ball"]), as_json(loose)]})
    assert none == ""
    assert "static force toward the stop" in said


def test_powers_say_whether_a_matrix_contracts(node):
    """Against the eigenvalues of LAPACK: random ones, near and on the unit circle, far from normal."""
    rng = np.random.default_rng(5)
    matrices = [scale * rng.standard_normal((n, n)) for n in (1, 2, 3, 4, 7, 16, 16) for scale in (0.2, 1.0)]
    turn = np.linalg.qr(rng.standard_normal((6, 6)))[0]
    matrices += [0.999999 * turn, 1.000001 * turn, np.zeros((4, 4)), np.diag(10.0 ** -np.arange(1, 16))]
    matrices += [np.array([[0.99, 1e6], [0.0, 0.98]]), np.array([[1.01, 1e6], [0.0, 0.98]])]
    span, relative = np.full(30, 0.07), rng.normal(scale=100, size=30)
    matrices += list(monodromy(SYSTEMS["eight modes, loaded"], span, relative))
    script = """const { isContracting } = await load("extensions/explore/engine/multipliers.js");
    return given.matrices.map((rows) => isContracting(Float64Array.from(rows.flat()), rows.length));"""
    found = node(script, {"matrices": [each.tolist() for each in matrices]})
    radii = [np.abs(np.linalg.eigvals(each)).max() for each in matrices]
    assert found == [radius < 1 for radius in radii]
    assert set(found) == {True, False}
    still = [np.eye(5).tolist(), np.roll(np.eye(4), 1, axis=0).tolist()]
    assert node(script, {"matrices": still}) == [False, False]
