"""Drives of a beam: a force or a moment at a place against the dynamic stiffness, amplitudes over frequency by hand."""

from __future__ import annotations

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from bench import POINT_MASS, RIG, STEEL, with_effects
from refusals import answers

from vibeam_models.base import Base
from vibeam_models.base_motion import base_amplitude, drive_amplitude
from vibeam_models.beam import assemble
from vibeam_models.beams.beam import Damping
from vibeam_models.effects.gravity import Gravity
from vibeam_models.effects.masses import MasslessBeam
from vibeam_models.scene import Mass, Sensor
from vibeam_models.stop import Stop
from vibeam_models.structure import Structure

BARE = replace(
    RIG,
    beam=replace(STEEL, damping=Damping("stiffness", (0.017,)), elements=60),
    mass=None,
    stop=Stop(0.15, 0.0, 0.72),
    sensor=Sensor(0.1),
    effects=(),
)
OMEGA = 2 * np.pi * np.array([14.0, 15.5, 17.0])


def exact(omega: float, at: float, seen: float, moment: bool, damping_time: float) -> complex:
    """Deflection at ``seen`` (m) over a force, or a moment, at ``at``: EI(1 + iΩD) w⁗ = ρAΩ² w in two pieces.

    Each piece is a sum of the four Krylov functions of β x: clamped at 0, free at L; at ``at`` deflection and slope are
    continuous, shear jumps by the force, bending by the moment.
    """
    with mp.workdps(40):
        stiff = mp.mpf(STEEL.bending_stiffness) * (1 + 1j * mp.mpf(omega) * damping_time)
        beta = mp.root(mp.mpf(STEEL.mass_per_length) * mp.mpf(omega) ** 2 / stiff, 4)
        waves = [beta, -beta, 1j * beta, -1j * beta]

        def row(x: float, order: int) -> list:
            return [wave**order * mp.exp(wave * x) for wave in waves]

        none, a, end = [mp.mpf(0)] * 4, mp.mpf(at), mp.mpf(STEEL.length)
        rows = [row(0, 0) + none, row(0, 1) + none, none + row(end, 2), none + row(end, 3)]
        rows += [row(a, order) + [-each for each in row(a, order)] for order in range(4)]
        jumps = [0, 0, 0, 0, 0, 0, 1 / stiff if moment else 0, 0 if moment else -1 / stiff]
        found = mp.lu_solve(mp.matrix(rows), mp.matrix(jumps))
        side = 0 if seen <= at else 4
        return complex(sum(found[side + k] * each for k, each in enumerate(row(mp.mpf(seen), 0))))


def response(structure: Structure, omega: float, row: np.ndarray) -> complex:
    """Steady response of a row to F sin Ωt = Ω²B sin Ωt with F = 1: b̈ = −Ω²B drives the load."""
    matrix = structure.K - omega**2 * structure.M + 1j * omega * structure.C
    return complex(row @ np.linalg.solve(matrix, -structure.load))


@pytest.mark.parametrize("moment", [False, True])
@pytest.mark.parametrize("at", [0.18, 0.0777, 0.1003])
def test_a_force_and_a_moment_are_those_of_the_dynamic_stiffness(at, moment):
    base = Base(at=at, moment=1.0) if moment else Base(at=at, force=1.0)
    structure = assemble(replace(BARE, base=base))
    damping_time = 2 * 0.017 / float(structure.modes(1).omega[0])
    for frequency in (3.0, 50.0, 180.0):
        omega = 2 * np.pi * frequency
        for seen, row in ((0.1, structure.outputs["sensor"]), (0.15, structure.contact)):
            true = exact(omega, at, seen, moment, damping_time)
            assert response(structure, omega, row) == pytest.approx(true, rel=2e-6 if frequency > 100 else 1e-7)


def test_gravity_is_the_same_under_every_drive():
    moved = assemble(with_effects(POINT_MASS, Gravity("transverse")))
    pushed = assemble(replace(with_effects(POINT_MASS, Gravity("transverse")), base=Base(at=0.132, force=1.0)))
    np.testing.assert_array_equal(pushed.static, moved.static)
    assert float(np.abs(moved.static).max()) > 0
    assert not np.array_equal(pushed.load, moved.load)


def test_a_force_leaves_all_but_the_load_as_it_is():
    at = RIG.mass.position
    moved, pushed = assemble(RIG), assemble(replace(RIG, base=Base(at=at, force=1.0)))
    for name in ("M", "C", "K", "static", "contact"):
        np.testing.assert_array_equal(getattr(pushed, name), getattr(moved, name))


def test_amplitudes_over_frequency():
    of = {
        "amplitude": 2e-5 * OMEGA**0, "velocity": 2e-5 / OMEGA, "acceleration": 2e-5 / OMEGA**2,
    }  # fmt: skip
    for name, wanted in of.items():
        found = drive_amplitude(replace(RIG, base=Base(**{name: 2e-5})), OMEGA)
        np.testing.assert_array_equal(np.broadcast_to(found, OMEGA.shape), wanted)
    for load in ("force", "moment"):
        found = drive_amplitude(replace(RIG, base=Base(**{load: 0.5}, at=0.1)), OMEGA)
        np.testing.assert_array_equal(found, 0.5 / OMEGA**2)


def test_a_table_is_linear_between_its_frequencies():
    table = (14.0, 15.0, 17.0)
    base = Base(acceleration=(1.0, 3.0, 2.0), frequency=table)
    np.testing.assert_allclose(drive_amplitude(replace(RIG, base=base), OMEGA) * OMEGA**2, [1, 2.75, 2], rtol=1e-15)
    volts = Base(voltage=(0.6, 0.6, 1.2), gain=5.16e-4, frequency=table)
    np.testing.assert_allclose(
        drive_amplitude(replace(RIG, base=volts), OMEGA), base_amplitude(RIG) * np.array([1, 1.25, 2]), rtol=1e-14
    )
    with pytest.raises(ValueError, match=r"17\.5 Hz is outside its table of 14 … 17 Hz"):
        drive_amplitude(replace(RIG, base=base), 2 * np.pi * np.array([17.5]))
    with pytest.raises(ValueError, match="2 values of velocity for 3 frequencies"):
        drive_amplitude(replace(RIG, base=Base(velocity=(1.0, 2.0), frequency=table)), OMEGA)


def test_a_drive_that_says_too_little_or_too_much():
    wrong = [
        Base(force=1.0), Base(at=0.1), Base(at=0.1, amplitude=1e-4), Base(at=0.1, force=1.0, moment=1.0),
        Base(velocity=1.0, acceleration=1.0), Base(velocity=1.0, voltage=1.0, gain=1.0),
    ]  # fmt: skip
    said = "give either an amplitude"
    assert answers(lambda base: drive_amplitude(replace(RIG, base=base), OMEGA), wrong, said) == []


def test_no_one_amplitude_where_it_depends_on_the_frequency():
    with pytest.raises(ValueError, match="one amplitude at all frequencies is needed"):
        base_amplitude(replace(RIG, base=Base(velocity=1.0)))


def test_a_massless_beam_is_driven_at_a_mass_alone():
    light = with_effects(replace(POINT_MASS, mass=Mass(0.2, 0.132)), MasslessBeam())
    driven = assemble(replace(light, base=Base(at=0.132, force=1.0)))
    assert response(driven, 60.0, driven.contact) == pytest.approx(
        1 / (driven.K[0, 0] - 60.0**2 * driven.M[0, 0] + 60.0j * driven.C[0, 0]) * driven.contact[0] ** 2, rel=1e-12
    )
    for base in (Base(at=0.1, force=1.0), Base(at=0.132, moment=1.0)):
        with pytest.raises(ValueError, match="a force on one of its masses"):
            assemble(replace(light, base=base))
