"""The solver "orbit" of systems without closed forms: what flights settle on, and the motions that none settles on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import vibeam
from vibeam.solvers import solver
from vibeam.system.response import Ended
from vibeam_models.laws.compliant import LinearStop

OMEGAS = np.linspace(1.5, 2.6, 12)
THREE = vibeam.ImpactSystem.from_modes([1.0, 4.0, 9.0], 0.05, [1, -0.9, 0.8], [1, 0.6, 0.4], gap=0.05, restitution=0.6)
SOFT = replace(THREE, law=LinearStop.matched(1e4, 0.6, 1 / THREE.mobility))


def test_points_are_what_flights_settle_on_where_these_repeat() -> None:
    """To 1e-9 where both have period 1; a point without a stable motion of that period says so."""
    shot = vibeam.sweep(SOFT, omega=OMEGAS, amplitude=0.1, solver="orbit")
    flown = vibeam.sweep(SOFT, omega=OMEGAS, amplitude=0.1, settle=400, hold=4)
    both = (shot.period == 1) & (flown.period == 1)
    assert both.sum() >= 6
    np.testing.assert_allclose(shot.amplitude[both], flown.amplitude[both], rtol=1e-9)
    np.testing.assert_allclose(shot.mode_energy[both], flown.mode_energy[both], rtol=1e-7)
    assert set(shot.ended[shot.period == 0].tolist()) == {Ended.NO_ORBIT.code}
    assert np.all(flown.period[shot.period == 0] != 1)


def test_a_motion_without_contact_is_one() -> None:
    far = replace(SOFT, gap=5.0)
    shot = vibeam.sweep(far, omega=OMEGAS, amplitude=0.1, solver="orbit", options={"periods": 2})
    assert shot.period.tolist() == [-1] * 12
    drive = vibeam.Drive(OMEGAS[0], 0.1)
    free = abs(
        np.sum(
            far.contact
            * far.load
            * drive.omega**2
            * 0.1
            / (far.omega**2 - drive.omega**2 + 0.1j * far.omega * drive.omega)
        )
    )
    np.testing.assert_allclose(shot.amplitude[0], free, rtol=1e-12)


def test_curves_go_through_where_the_motion_is_unstable() -> None:
    curves = solver("orbit", SOFT, OMEGAS[0]).curves(OMEGAS, 0.1, "contact")
    assert np.isfinite(curves.velocity[:, 0]).all()
    assert curves.stable[0, 0]
    assert not curves.stable[-3, 0]
    drive = vibeam.Drive(OMEGAS[0], 0.1)
    assert abs(curves.velocity[0, 0] - max(each.velocity for each in vibeam.orbits(SOFT, drive))) < 1e-12
