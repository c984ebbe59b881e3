"""The lift of periodic motions: between models of the same modes it is the motion itself, to others a start."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import vibeam
from vibeam.periodic.lift import contact_load, lifted
from vibeam.periodic.shooting import NoOrbit
from vibeam.periodic.stroboscopic import StroboscopicMap
from vibeam_models.laws.compliant import Hertz, LinearStop

DRIVE = vibeam.Drive(2.2, 0.1)
THREE = vibeam.ImpactSystem.from_modes([1.0, 4.0, 9.0], 0.05, [1, -0.9, 0.8], [1, 0.6, 0.4], gap=0.05, restitution=0.3)
COUPLED = np.diag(2 * THREE.zeta * THREE.omega) + 0.02
PRESSED = vibeam.ImpactSystem.from_modes(
    [1.0, 2.6, 5.1], [0.02, 0.05, 0.05], [1.0, 0.6, -0.4], [1.0, 0.3, 0.1], gap=0.0, restitution=0.3,
    static=[1.5, 0.0, 0.0],
)  # fmt: skip
LINEAR = LinearStop(1e3, 5.0)
SYSTEMS = {  # and what quadrature leaves of it: nothing of what is smooth in a contact, d^p at its ends, late impulses
    "linear, two stops": (replace(THREE, law=LINEAR, second_gap=0.1), DRIVE, 1e-13),
    "linear, coupled": (replace(THREE, law=LINEAR, coupling=COUPLED), DRIVE, 1e-13),
    "hard, coupled": (replace(THREE, coupling=COUPLED), DRIVE, 1e-13),
    "several": (replace(THREE, further=(vibeam.Contact([0.3, 1.0, -0.5], 0.05, 0.5),)), DRIVE, 1e-13),
    "Hertz": (replace(THREE, law=Hertz(1e4)), DRIVE, 1e-6),
    "rests": (
        replace(PRESSED, coupling=np.diag(2 * PRESSED.zeta * PRESSED.omega) + 0.02), vibeam.Drive(1.3, 2.0), 1e-6
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SYSTEMS)
def test_lifted_to_its_own_model_a_motion_is_itself(name: str) -> None:
    system, drive, share = SYSTEMS[name]
    section, found = StroboscopicMap(system, drive), vibeam.orbits(system, drive)
    assert any(len(orbit.times) or orbit.rests for orbit in found)
    assert (name == "rests") == any(orbit.rests for orbit in found)
    for orbit in found:
        time, state = lifted(orbit, system)
        assert time == orbit.time
        apart = section.vector(state) - section.vector(orbit.state)
        assert np.linalg.norm(apart) < share * np.linalg.norm(section.vector(orbit.state))


def test_the_load_has_the_impulse_of_the_mean() -> None:
    """Without stiffness, ω = 0: over a span the contact gives back what the static force takes, exactly."""
    ball = vibeam.ImpactSystem.from_modes(
        [0.0, 3.0], [0.0, 0.1], [1.0, 0.3], [1.0, 0.5], static=[2.0, 0.0], restitution=0.6
    )
    orbit = next(each for each in vibeam.orbits(ball, vibeam.Drive(5.0, 0.1)) if each.admissible)
    load = contact_load(orbit)
    assert load.impulses.sum() == pytest.approx(-2.0 * orbit.span, rel=1e-12)
    time, state = lifted(orbit, ball)
    flown = vibeam.simulate(ball, orbit.drive, time, orbit.state, t_start=orbit.time).state
    np.testing.assert_allclose(state.displacement, flown.displacement, atol=1e-13)
    np.testing.assert_allclose(state.velocity, flown.velocity, atol=1e-12)


def test_a_model_of_more_modes_starts_from_one_of_few() -> None:
    """The closed-form orbit of mode 1 leads to that of three modes; one correction is what the others add."""
    one = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, gap=0.05, restitution=0.5)
    many = vibeam.ImpactSystem.from_modes(
        [1.0, 6.0, 15.0], 0.05, [1.0, 0.2, 0.1], [1.0, 0.1, 0.05], gap=0.05, restitution=0.5
    )
    few = next(each for each in vibeam.orbits(one, DRIVE) if each.stable and each.admissible)
    want = next(each for each in vibeam.orbits(many, DRIVE) if each.stable and each.admissible)
    [found] = vibeam.orbits(many, DRIVE, start=few)
    assert found.velocity == pytest.approx(want.velocity, rel=1e-12)
    assert 1e-3 < found.corrections[0] < 0.2


def test_a_model_without_the_contact_is_refused() -> None:
    two = replace(THREE, second_gap=0.05)
    orbit = next(each for each in vibeam.orbits(two, DRIVE) if 1 in each.contacts)
    with pytest.raises(ValueError, match="strikes contact 2, and the other model has 1") as refused:
        vibeam.orbits(THREE, DRIVE, start=orbit)
    assert not isinstance(refused.value, NoOrbit)
