"""Beams that can move as rigid bodies: frequencies in closed form, rigid-body modes at 0, their shapes and damping."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import vibeam
from tests.models.bench import RIG, STEEL
from vibeam_models.beam import assemble
from vibeam_models.beams.beam import Damping, Support
from vibeam_models.beams.shapes import Rectangle, Tube
from vibeam_models.beams.stretch import Stretch
from vibeam_models.damping import damped
from vibeam_models.effects.opposite import Opposite
from vibeam_models.effects.supports import BeamEnds
from vibeam_models.space import bare_beam
from vibeam_models.structure import natural_modes, rank
from vibeam_reductions.declaration import REDUCTIONS

FREE = replace(STEEL, ends="free-free")
ROOTS = np.array([4.730040744862704, 7.853204624095838, 10.995607838001671])  # of cos βL cosh βL = 1
SHAFT = replace(FREE, length=0.3, shape=Tube(30.08e-3, 11.54e-3), poissons_ratio=0.3, shear=True)


@pytest.mark.parametrize("elements", [12, 36, 150])
def test_a_free_beam_has_the_textbook_frequencies_above_two_modes_at_zero(elements: int) -> None:
    exact = ROOTS**2 * np.sqrt(FREE.bending_stiffness / FREE.mass_per_length) / FREE.length**2
    omega = bare_beam(replace(FREE, elements=elements))[0].modes(5).omega
    assert omega[:2].tolist() == [0.0, 0.0]
    assert omega[2:] == pytest.approx(exact, rel=max(2.0 * (8 / elements) ** 4 * 0.1, 1e-7))


def test_a_stubby_hollow_shaft_has_timoshenkos_frequencies() -> None:
    """By transfer matrices with Cowper's κ = 0.78391."""
    frequency = bare_beam(replace(SHAFT, elements=100))[0].modes(5).frequency
    assert frequency[:2].tolist() == [0.0, 0.0]
    assert frequency[2:] == pytest.approx([1535.34042344, 4028.63445833, 7416.55468793], rel=1e-6)


@pytest.mark.parametrize("stiffness", [1.0, 100.0])
def test_one_soft_spring_leaves_one_rigid_body_mode_and_slows_nothing_else(stiffness: float) -> None:
    """The other swings on the spring at √(k (1/m + 12 s²/mL²)), s the spring's distance from the middle."""
    place = 0.3 * FREE.length
    beam = replace(FREE, supports=(Support(place, stiffness),))
    omega = bare_beam(beam)[0].modes(4).omega
    mobility = (1 + 12 * (place / FREE.length - 0.5) ** 2) / FREE.mass
    assert omega[0] == 0.0
    assert omega[1] == pytest.approx(np.sqrt(stiffness * mobility), rel=2e-3)
    assert omega[2] == pytest.approx(bare_beam(FREE)[0].modes(3).omega[2], rel=5e-2)


def test_a_tapered_beam_moves_as_a_rigid_body_without_bending() -> None:
    wedge = Stretch(0.02, 0.1, Rectangle(0.02, 4e-3), STEEL.material, far=Rectangle(0.01, 1e-3))
    structure, space = bare_beam(replace(FREE, sections=(wedge,)))
    shapes = structure.modes(2).shapes
    motion = np.column_stack([np.ones(len(space.nodes)), space.nodes])
    for shape in shapes.T:
        read = space.rows(space.nodes, 0) @ shape
        straight = motion @ np.linalg.lstsq(motion, read, rcond=None)[0]
        assert read == pytest.approx(straight, abs=1e-8 * np.abs(read).max())
    assert shapes.T @ structure.M @ shapes == pytest.approx(np.eye(2), abs=1e-9)


def test_the_first_rigid_body_mode_alone_moves_the_contact() -> None:
    """So that a model of one mode has the contact's mobility of the rigid beam, 4/m at its end."""
    structure, _ = bare_beam(FREE)
    at_contact = structure.contact @ structure.modes(2).shapes
    assert at_contact[0] ** 2 == pytest.approx(4 / FREE.mass, rel=1e-9)
    assert at_contact[1] == pytest.approx(0.0, abs=1e-9 * at_contact[0])
    system = vibeam.ImpactSystem.from_structure(vibeam.modal(structure, 4).structure, gap=0.0)
    assert (system.omega[:2].tolist(), system.zeta[:2].tolist(), system.contact[1]) == ([0.0, 0.0], [0.0, 0.0], 0.0)


@pytest.mark.parametrize(("damping", "ratios"), [
    (Damping("constant", (0.01,)), [0.01, 0.01, 0.01]),
    (Damping("list", (0.01, 0.03)), [0.01, 0.03, 0.03]),
    (Damping("stiffness", (0.01,)), [0.01, 0.01 * (ROOTS[1] / ROOTS[0]) ** 2, 0.01 * (ROOTS[2] / ROOTS[0]) ** 2]),
    (Damping("rayleigh", (0.02, 0.02)), [0.02, 0.02, None]),
])  # fmt: skip
def test_damping_ratios_count_the_elastic_modes(damping: Damping, ratios: list[float | None]) -> None:
    structure = damped(bare_beam(FREE)[0], damping)
    for modes in (1, 2, 5, structure.size):
        system = vibeam.ImpactSystem.from_structure(vibeam.modal(structure, modes).structure, gap=0.0)
        assert system.coupling is None
        assert system.zeta[:2].tolist() == [0.0, 0.0][:modes]
        for found, ratio in zip(system.zeta[2:5], ratios, strict=False):
            assert ratio is None or found == pytest.approx(ratio, rel=1e-5)


def test_matrices_of_a_free_body_have_modes_at_zero_whatever_their_units() -> None:
    spring = np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    for scale in (1e-9, 1.0, 3e11):
        squared, shapes = natural_modes(scale * spring, np.eye(3))
        assert squared == pytest.approx(scale * np.array([0.0, 1.0, 3.0]), rel=1e-9, abs=0.0)
        assert np.ptp(shapes[:, 0]) == pytest.approx(0.0, abs=1e-9)
    assert natural_modes(np.zeros((2, 2)), np.eye(2))[0].tolist() == [0.0, 0.0]
    assert natural_modes(np.array([[0.0, 1.0], [1.0, 0.0]]), np.eye(2))[0] == pytest.approx([-1.0, 1.0])
    assert rank(bare_beam(replace(FREE, elements=300))[0].K) == 2 * 301 - 2


@pytest.mark.parametrize(("reduction", "modes"), [
    ("static_mode", None), ("residual_flexibility", 4), ("craig_bampton", 6), ("massless_boundary", 4),
])  # fmt: skip
@pytest.mark.parametrize("elements", [10, 36, 120])
def test_what_needs_a_static_deflection_is_refused_on_every_mesh(reduction: str, modes: int, elements: int) -> None:
    structure, _ = bare_beam(replace(FREE, elements=elements))
    with pytest.raises(ValueError, match=r"the body is free: .* hold it, or write reduction = .modal."):
        REDUCTIONS[reduction].make(structure, modes)


def test_two_free_beams_have_four_rigid_body_modes() -> None:
    scene = replace(RIG, effects=(BeamEnds("free-free"), Opposite(0.1, ends="free-free")))
    omega = assemble(scene).modes(6).omega
    assert np.count_nonzero(omega == 0) == 4
