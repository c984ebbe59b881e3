"""Reduction bases: what each must keep is kept, and with all of its vectors each gives the full model's flight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import answers, other_answers
from scipy.linalg import eigh

import vibeam
from tests.models.bench import RIG, STEEL, with_effects
from vibeam.flight.trajectory import modal_snapshots
from vibeam_models.beam import assemble
from vibeam_models.beams.beam import Support
from vibeam_models.effects.masses import AddedMass
from vibeam_models.effects.opposite import Opposite
from vibeam_models.effects.torsion import Torsion
from vibeam_models.laws.compliant import Hertz, LinearStop
from vibeam_models.structure import Structure
from vibeam_reductions.modes import massless_boundary, modal, residual_flexibility
from vibeam_reductions.pod import Snapshots, pod
from vibeam_reductions.projection import Reduction
from vibeam_reductions.static_shapes import boundary_rows, craig_bampton

COARSE = replace(RIG, beam=replace(STEEL, elements=4))
SCENES = {
    "mass": COARSE,
    "torsion": with_effects(COARSE, Torsion(1e-3, 2.988e-5, poissons_ratio=0.3)),
    "opposite": with_effects(COARSE, Opposite(0.05, length=0.06, width=0.03), AddedMass(0.02, 0.05, on="opposite")),
    "supports": replace(
        COARSE, beam=replace(STEEL, elements=4, ends="pinned-pinned", supports=(Support(0.06, 2e4, 0.0),))
    ),
}
BASES = [residual_flexibility, massless_boundary, craig_bampton]


@pytest.fixture(scope="module")
def rig() -> Structure:
    return assemble(RIG)


def flown(structure: Structure, law: LinearStop | None) -> np.ndarray:
    """Contact, sensor and tip over eight periods with impacts, at 400 instants, (3, 400)."""
    system = vibeam.ImpactSystem.from_structure(structure, gap=1e-5, restitution=0.4, law=law)
    drive = vibeam.Drive(1.2 * system.omega[0], 2e-5)
    t_end = 8 * 2 * np.pi / drive.omega
    path = vibeam.simulate(system, drive, t_end)
    assert path.stats["impacts"] >= 5 or len(path.contacts) >= 5
    times = np.linspace(0, t_end, 400)
    return np.array([path.at(times, name) for name in ("contact", "sensor", "tip")])


def reduced(structure: Structure, name: str) -> Reduction:
    """The reduction of a name, with all vectors that it can have."""
    if name == "pod":
        system = vibeam.ImpactSystem.from_structure(structure, gap=0.0, restitution=0.9)
        states = modal_snapshots(system, vibeam.Drive(1.3 * system.omega[0], 1e-3), 20)
        return pod(structure, structure.size, Snapshots(*states))
    return next(basis for basis in BASES if basis.__name__ == name)(structure, structure.size)


ALL = [*(basis.__name__ for basis in BASES), "pod"]


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("scene", SCENES)
def test_with_all_vectors_the_flight_is_the_full_models(scene: str, name: str) -> None:
    structure = assemble(SCENES[scene])
    law = LinearStop(1e5) if name == "massless_boundary" else None
    found, expected = flown(reduced(structure, name).structure, law), flown(structure, law)
    assert np.max(np.abs(found - expected)) <= 1e-9 * np.max(np.abs(expected))


def test_one_vector_less_is_another_flight() -> None:
    structure = assemble(COARSE)
    found, expected = flown(craig_bampton(structure, structure.size - 1).structure, None), flown(structure, None)
    assert np.max(np.abs(found - expected)) > 1e-7 * np.max(np.abs(expected))


@pytest.mark.parametrize("n", [1, 2, 5])
def test_residual_flexibility_keeps_modes_and_the_static_deflection(rig: Structure, n: int) -> None:
    made = residual_flexibility(rig, n)
    omega = made.structure.modes().omega
    np.testing.assert_allclose(omega[: n - 1], rig.modes(n - 1).omega, rtol=1e-11)
    assert made.flexibility_kept == pytest.approx(1, abs=1e-8)
    assert modal(rig, n).mobility_kept < made.mobility_kept < 1
    force = rig.deflection(rig.contact)
    in_basis = made.expand(made.structure.deflection(made.structure.contact))
    np.testing.assert_allclose(in_basis, force, atol=1e-8 * np.abs(force).max())


def test_the_residual_has_the_flexibility_of_the_modes_left_out(rig: Structure) -> None:
    """g = Σ c²/ω² over the modes that are not kept, mass Σ c²/ω⁴ / g² (Rubin's eq. 20, in modal coordinates)."""
    modes = rig.modes()
    c, squared = rig.contact @ modes.shapes[:, 3:], modes.omega[3:] ** 2
    last = residual_flexibility(rig, 4).structure.modes().omega[-1]
    assert last**2 == pytest.approx(np.sum(c**2 / squared) / np.sum(c**2 / squared**2), rel=1e-8)
    assert massless_boundary(rig, 3).structure.contact_flexibility == pytest.approx(np.sum(c**2 / squared), rel=1e-8)


def test_residual_modes_do_not_couple_by_modal_damping(rig: Structure) -> None:
    made = residual_flexibility(rig, 4).structure
    assert vibeam.ImpactSystem.from_structure(made, gap=0.0).coupling is None


def test_craig_bampton_is_the_textbooks_partition(rig: Structure) -> None:
    """The same subspace as from [I; −K_ii⁻¹K_ib] and K_ii φ = ω² M_ii φ in coordinates that have the boundary."""
    boundary, n = ("contact", "sensor", "tip"), 7
    rows = np.array([*boundary_rows(rig, boundary).values()])
    others = np.linalg.svd(rows)[2][3:]
    to_x = np.linalg.inv(np.vstack([rows, others]))  # x = to_x @ (u_b, u_i)
    M, K = to_x.T @ rig.M @ to_x, to_x.T @ rig.K @ to_x
    constraint = np.vstack([np.eye(3), -np.linalg.solve(K[3:, 3:], K[3:, :3])])
    fixed = eigh(K[3:, 3:], M[3:, 3:])[1][:, : n - 3]
    expected = to_x @ np.hstack([constraint, np.vstack([np.zeros((3, n - 3)), fixed])])
    made = craig_bampton(rig, n, boundary)
    weights = np.linalg.cholesky(rig.M).T
    one, other = (np.linalg.qr(weights @ basis)[0] for basis in (expected, made.basis))
    np.testing.assert_allclose(np.linalg.svd(one.T @ other)[1], 1, atol=1e-6)


def test_a_boundary_named_twice_counts_once(rig: Structure) -> None:
    twice = rig.with_(outputs=rig.outputs | {"again": 2 * rig.contact})
    assert craig_bampton(twice, 2, ("contact", "again")).structure.size == 2
    with pytest.raises(ValueError, match="its boundary has 3 rows, contact, inertia 2, sensor"):
        craig_bampton(rig, 2)
    with pytest.raises(ValueError, match="boundary: sensr: it is made of contact, masses, sensor, tip"):
        craig_bampton(rig, 4, ("contact", "sensr"))


@pytest.mark.parametrize("inner_product", ["mass", "energy"])
def test_pod_of_one_mode_is_that_mode(rig: Structure, inner_product: str) -> None:
    """Snapshots in two modes, the first larger: the directions are these, exactly, in either inner product."""
    phase = np.linspace(0, 2 * np.pi, 41)[:-1]
    eta = np.zeros((rig.size, 40))
    eta[0], eta[4] = np.sin(phase), 1e-9 * np.cos(phase)
    made = pod(rig, 2, Snapshots(eta, eta), inner_product)
    np.testing.assert_allclose(made.structure.modes().omega, rig.modes().omega[[0, 4]], rtol=1e-9)
    with pytest.raises(ValueError, match="modes: 3, the flight spans 1 to 2 directions"):
        pod(rig, 3, Snapshots(eta, eta), inner_product)


def test_pod_weighs_velocities_as_displacements(rig: Structure) -> None:
    """A mode that only velocities show is as good as one that only displacements show, whatever the units."""
    slow, fast = np.zeros((rig.size, 8)), np.zeros((rig.size, 8))
    slow[1], fast[6] = 1e-6, 1e3
    found = pod(rig, 2, Snapshots(slow, fast)).structure.modes().omega
    np.testing.assert_allclose(found, rig.modes().omega[[1, 6]], rtol=1e-9)
    with pytest.raises(ValueError, match="stands still"):
        pod(rig, 1, Snapshots(slow, 0 * fast))


def test_a_massless_contact_is_a_spring_before_the_stop(rig: Structure) -> None:
    """1/k = 1/k_s + g: two springs in series; the static penetration under a load is that of the full model."""
    small = massless_boundary(rig, 2).structure
    made = vibeam.ImpactSystem.from_structure(small, gap=0.0, law=LinearStop(1e6))
    assert 1 / made.law.stiffness == pytest.approx(1e-6 + small.contact_flexibility, rel=1e-12)
    assert small.contact_flexibility > 1e-8


def test_a_massless_contact_refuses_what_needs_its_mass(rig: Structure) -> None:
    small = massless_boundary(rig, 2).structure
    wrong = {
        "mobility is infinite, so that an impulse and a coefficient of restitution have no meaning": None,
        'the law "hertz" in series with a spring has no closed form': Hertz(1e8),
        "a damper behind a contact without mass makes a state of the first order": LinearStop(1e6, 10.0),
    }
    wrong = {f'{said}: write reduction = "residual_flexibility"': law for said, law in wrong.items()}
    assert other_answers(lambda law: vibeam.ImpactSystem.from_structure(small, gap=0.0, law=law), wrong) == []


def test_more_than_there_is_and_a_free_body_are_refused(rig: Structure) -> None:
    assert answers(lambda basis: basis(rig, 65), BASES, "modes: 65") == []
    free = Structure(np.eye(2), np.zeros((2, 2)), [[1.0, -1.0], [-1.0, 1.0]], [-1.0, -1.0], [0.0, 0.0], [0.0, 1.0])
    static = [residual_flexibility, massless_boundary]
    assert answers(lambda basis: basis(free, 1), static, "the body is free") == []
