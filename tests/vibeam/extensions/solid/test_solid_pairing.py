"""Pairing of modes by shape: an order, signs and further modes that are known beforehand are found again."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.extensions.solid.verdict.model import SteppedModel
from vibeam.extensions.solid.verdict.pairing import bending, inertias_along, likeness, partners
from vibeam.extensions.solid.verdict.steps import ladder, solid_of

X = np.linspace(0, 1, 41)
ROOTS = np.array([1.875104068711961, 4.694091132974175, 7.854757438237613, 10.995540734875467])


def cantilever(number: int) -> np.ndarray:
    """Mass-normalised mode of a uniform cantilever of mass 1, by its roots of 1 + cos λ cosh λ."""
    root = ROOTS[number]
    sigma = (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root))
    return np.asarray(np.cosh(root * X) - np.cos(root * X) - sigma * (np.sinh(root * X) - np.sin(root * X)))


BEAM = np.column_stack([cantilever(number) for number in range(4)])


def test_modes_are_found_in_another_order_with_other_signs() -> None:
    still, order, signs = np.zeros(41), [2, 0, 3, 1], [-1.0, 1.0, -1.0, -1.0]
    theirs = np.column_stack([still, *(sign * BEAM[:, at] for at, sign in zip(order, signs, strict=True)), still])
    found, alike = partners(BEAM, theirs)
    assert found.tolist() == [2, 4, 1, 3]
    np.testing.assert_allclose(alike, 1.0, rtol=1e-12)


def test_of_modes_with_one_mean_line_the_one_that_moves_it_is_taken() -> None:
    """A wide strip has modes that wave across its width: along the mean line they are like mode 1, but small."""
    theirs = np.column_stack([0.3 * BEAM[:, 0], 0.95 * BEAM[:, 0], BEAM[:, 1]])
    assert likeness(BEAM, theirs)[0] == pytest.approx([0.09, 0.95**2, 0.0], abs=3e-3)  # of sums: φ_tip²/80, squared
    assert partners(BEAM[:, :2], theirs)[0].tolist() == [1, 2]


def test_a_shape_that_the_other_has_not_finds_no_partner() -> None:
    found, alike = partners(BEAM, np.column_stack([BEAM[:, 0], BEAM[:, 1], 1e-9 * BEAM[:, 2]]))
    assert found.tolist() == [0, 1, -1, -1]
    assert np.isnan(alike[2:]).all()


def test_modes_that_leave_the_mean_line_at_rest_do_not_bend_it() -> None:
    shapes = np.column_stack([BEAM[:, 0], np.full(41, 1e-3)])
    assert bending(shapes).tolist() == [True, False]


def test_each_place_is_weighed_by_what_moves_there() -> None:
    """Modes of one beam with a heavy mass and its inertia are alike to themselves alone: they are M-orthogonal."""
    case = vibeam.load("cases/dtu_neutral.toml")
    masses, turned = inertias_along(case.scene, "beam", 25)
    assert masses.sum() == pytest.approx(case.scene.moving_mass, rel=1e-12)
    assert (turned.sum(), masses.argmax(), turned.argmax()) == (2.988e-5, 18, 18)  # 132 mm of 180 mm
    beam = SteppedModel(ladder(solid_of(case.scene))[0], 6)
    assert likeness(beam.shapes, beam.shapes) == pytest.approx(
        np.eye(6), abs=0.05
    )  # of 25 places: the mass is 3 mm aside


def test_a_model_has_the_modes_that_its_reference_chose_and_none_where_that_has_none() -> None:
    step: Any = None
    solid = SteppedModel(step, 2, SteppedModel(step, 2))
    rough = SteppedModel(step, 2, solid)
    solid.__dict__["partners"] = np.array([2, -1, 0]), np.array([0.9, np.nan, 0.8])
    solid.__dict__["shapes"] = np.eye(3)
    rough.__dict__["shapes"] = np.eye(3)[:, [1, 0, 2]]
    places, alike = rough.partners
    assert places.tolist() == [2, -1, 1]
    assert np.array_equal(alike, [1.0, np.nan, 1.0], equal_nan=True)
