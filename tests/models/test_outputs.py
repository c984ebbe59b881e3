"""Outputs along a beam against the textbook: strain and slope under static loads, what reductions leave of a strain."""

from dataclasses import replace

import numpy as np
import pytest

from tests.models.bench import POINT_MASS, STEEL
from vibeam.case.fidelity import Fidelity, system
from vibeam_models.beam import assemble, assemble_with_space
from vibeam_models.beams.shapes import General, Round
from vibeam_models.effects.sections import BondedPlate, Section
from vibeam_models.outputs import Output, surface_distance
from vibeam_models.stop import Stop

BARE = replace(POINT_MASS, mass=None, stop=Stop(0.18, 0.0))
LENGTH, HALF, STIFFNESS = STEEL.length, STEEL.shape.thickness / 2, STEEL.bending_stiffness


def strain(x: float, distance: float | None = None) -> Output:
    return Output("gauge", x, "strain", distance)


@pytest.mark.parametrize(
    ("output", "expected"),
    [
        (strain(0.0), LENGTH * HALF / STIFFNESS),  # ε = F (L − x) c / EI
        (strain(0.005), (LENGTH - 0.005) * HALF / STIFFNESS),
        (strain(0.1, -2e-3), -(LENGTH - 0.1) * 2e-3 / STIFFNESS),
        (strain(LENGTH), 0.0),
        (Output("turn", LENGTH, "slope"), LENGTH**2 / (2 * STIFFNESS)),
        (Output("turn", 0.09, "slope"), (LENGTH * 0.09 - 0.09**2 / 2) / STIFFNESS),
        (Output("speed", LENGTH, "velocity"), LENGTH**3 / (3 * STIFFNESS)),  # its row is the displacement's
    ],
)
def test_a_force_at_the_tip(output, expected):
    structure, space = assemble_with_space(replace(BARE, outputs=(output,)))
    deflection = structure.deflection(space.row(LENGTH))
    found = structure.outputs[output.name] @ deflection
    assert found == pytest.approx(expected, rel=1e-8, abs=1e-8 * LENGTH * HALF / STIFFNESS)
    assert structure.units[output.name] == output.kind.unit


def test_strain_at_the_clamp_under_the_inertia_of_a_base_that_accelerates():
    """q = ρA per m/s²: M(0) = qL²/2; cubic elements of length h miss the curvature by qh²/12EI."""
    structure = assemble(replace(BARE, outputs=(strain(0.0),)))
    found = structure.outputs["gauge"] @ structure.deflection(-structure.load)
    line = STEEL.mass_per_length * LENGTH**2 / 2
    missed = STEEL.mass_per_length * (LENGTH / STEEL.elements) ** 2 / 12
    assert found == pytest.approx((line - missed) * HALF / STIFFNESS, rel=1e-8)


def slow_strain(reduction: str, modes: int | None = None) -> float:
    """Strain at the clamp per acceleration of a base far below all resonances, rigid mass and beam."""
    scene = replace(POINT_MASS, outputs=(strain(0.0),))
    made = system(scene, Fidelity("any", reduction, modes=modes))
    return float(made.outputs["gauge"] @ (made.load / made.omega**2))


def test_strain_converges_with_the_modes_and_one_mode_misses_it():
    whole = slow_strain("full")
    errors = [abs(slow_strain("modal", n) / whole - 1) for n in (1, 2, 8, 32)]
    assert abs(slow_strain("static_mode") / slow_strain("modal", 8) - 1) > 0.005
    assert errors[0] > 0.005
    assert errors[1] < errors[0] / 2
    assert errors[2] < errors[0] / 40
    assert errors[3] < errors[2] / 10
    line = STEEL.mass_per_length * LENGTH**2 / 2 + 0.2 * 0.132  # moment at the clamp, N m per m/s²
    assert whole == pytest.approx(line * HALF / STIFFNESS, rel=1e-4)


def test_the_surface_is_half_the_height_of_the_section_there():
    stretch = Section(start=0.05, end=0.1, shape="round", diameter=4e-3).carrier(STEEL)
    assert surface_distance(stretch, 0.02) == HALF
    assert surface_distance(stretch, 0.07) == 2e-3
    tapered = Section(start=0.0, end=0.1, end_thickness=2 * STEEL.shape.thickness).carrier(STEEL)
    assert surface_distance(tapered, 0.05) == pytest.approx(1.5 * HALF)
    assert surface_distance(replace(STEEL, shape=Round(3e-3)), 0.0) == 1.5e-3


def test_no_distance_is_known_of_a_general_section_or_under_a_plate():
    general = replace(STEEL, shape=General(2e-5, 2e-12))
    plated = BondedPlate(start=0.0, end=0.05, width=0.02, thickness=1e-3, density=7850.0).carrier(STEEL)
    assert surface_distance(general, 0.0) is None
    assert surface_distance(plated, 0.02) is None
    assert surface_distance(plated, 0.1) == HALF
    with pytest.raises(ValueError, match="output gauge: no distance"):
        assemble(replace(BARE, beam=general, outputs=(strain(0.0),)))
    assert "gauge" in assemble(replace(BARE, beam=general, outputs=(strain(0.0, 1e-3),))).outputs


def test_an_output_off_the_beam_is_named():
    with pytest.raises(ValueError, match=r"output.gauge.position: 0.2 m is outside \[0, 0.18\] m"):
        assemble(replace(BARE, outputs=(strain(0.2),)))


def test_outputs_change_nothing_else_to_the_bit():
    plain, read = assemble(BARE), assemble(replace(BARE, outputs=(strain(0.0),)))
    assert read.outputs.keys() - plain.outputs.keys() == {"gauge"}
    for name in ("M", "C", "K", "load", "contact"):
        assert np.array_equal(getattr(plain, name), getattr(read, name))
