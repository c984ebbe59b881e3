"""Beams in pieces, with any ends and supports: frequencies against closed forms."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest

from tests.models import closed_forms
from tests.models.bench import STEEL
from vibeam_models.beams.beam import PAIRS, Beam, Support
from vibeam_models.beams.shapes import General, HollowRectangle, ISection, Rectangle, Round, Tube
from vibeam_models.beams.stretch import Material, Plate, Stretch
from vibeam_models.space import bare_beam

STIFF = STEEL.material
ROOT = np.sqrt(STEEL.bending_stiffness / STEEL.mass_per_length)


def frequencies(beam: Beam, count: int, elements: int) -> np.ndarray:
    return bare_beam(replace(beam, elements=elements))[0].modes(count).omega


def rigid_modes(ends: str) -> int:
    """Number of motions that bend nothing."""
    kinds = ends.split("-")
    return {"free-free": 2}.get(ends, int({*kinds} <= {"free", "guided"} or {*kinds} == {"pinned", "free"}))


@pytest.mark.parametrize("ends", PAIRS)
def test_every_pair_of_ends_has_the_textbook_frequencies(ends):
    """Fourth order; the frequency of a rigid-body mode is 0 exactly."""
    rigid = rigid_modes(ends)
    exact = closed_forms.uniform_eigenvalues(ends, 5) ** 2 * ROOT / STEEL.length**2
    coarse, fine = (frequencies(replace(STEEL, ends=ends), rigid + 5, n)[rigid:] for n in (60, 120))
    assert fine == pytest.approx(exact, rel=1e-6)
    assert (16 * fine - coarse) / 15 == pytest.approx(exact, rel=1e-8)  # Richardson's extrapolation
    assert np.count_nonzero(frequencies(replace(STEEL, ends=ends), 5, 20) == 0) == rigid


def test_springs_lead_from_one_end_to_the_other():
    free = replace(STEEL, ends="clamped-free", supports=(Support(STEEL.length, 1e-9, 1e-9),))
    held = replace(STEEL, ends="clamped-free", supports=(Support(STEEL.length, 1e9, 1e7),))
    for beam, ends in ((free, "clamped-free"), (held, "clamped-clamped")):
        exact = closed_forms.uniform_eigenvalues(ends, 3) ** 2 * ROOT / STEEL.length**2
        assert frequencies(beam, 3, 60) == pytest.approx(exact, rel=5e-5)


def test_a_support_between_divides_a_pinned_beam():
    halves = replace(STEEL, ends="pinned-pinned", supports=(Support(STEEL.length / 2, inf, 0.0),))
    half = STEEL.length / 2
    pinned = closed_forms.uniform_eigenvalues("pinned-pinned", 1) ** 2 * ROOT / half**2
    held = closed_forms.uniform_eigenvalues("clamped-pinned", 1) ** 2 * ROOT / half**2
    assert frequencies(halves, 2, 120) == pytest.approx([pinned[0], held[0]], rel=1e-7)


def test_a_stepped_beam_has_the_frequencies_of_its_pieces():
    thick = Stretch(0.0, 0.07, Rectangle(0.02, 2e-3), STIFF)
    light = Stretch(0.07, 0.1, Rectangle(0.03, 1.5e-3), Material(70e9, 2700.0), added=0.05)
    beam = replace(STEEL, sections=(thick, light))
    pieces = [
        (0.07, 210e9 * 0.02 * 2e-3**3 / 12, 7850 * 0.02 * 2e-3),
        (0.03, 70e9 * 0.03 * 1.5e-3**3 / 12, 2700 * 0.03 * 1.5e-3 + 0.05),
        (0.08, STEEL.bending_stiffness, STEEL.mass_per_length),
    ]
    exact = closed_forms.stepped_omega(pieces, "clamped-free", 5, 40.0)
    coarse, fine = (frequencies(beam, 5, n) for n in (90, 180))
    assert fine == pytest.approx(exact, rel=1e-6)
    assert 12 < np.max(np.abs(coarse - exact)) / np.max(np.abs(fine - exact)) < 20  # fourth order


@pytest.mark.parametrize(("order", "shapes"), [
    (1, (Rectangle(0.02, 4e-3), Rectangle(0.02, 1e-3))),
    (2, (Round(4e-3), Round(1e-3))),
    (2, (Rectangle(0.02, 4e-3), Rectangle(0.005, 1e-3))),
])  # fmt: skip
def test_a_taper_has_the_frequencies_of_the_wedge_and_the_cone(order, shapes):
    near, far = shapes
    beam = replace(STEEL, sections=(Stretch(0.0, STEEL.length, near, STIFF, far),))
    root = np.sqrt(210e9 * near.second_moment_times(1.0) / (7850 * near.area_times(1.0)))
    exact = closed_forms.wedge_omega(order, STEEL.length, 0.25, root, 3, 120.0)
    coarse, fine = (frequencies(beam, 3, n) for n in (30, 60))
    assert fine == pytest.approx(exact, rel=1e-6)
    assert 12 < np.max(np.abs(coarse / exact - 1)) / np.max(np.abs(fine / exact - 1)) < 20


@pytest.mark.parametrize("n", [1, 2, 5])
def test_shear_and_rotary_inertia_are_timoshenkos(n):
    beam = Beam(0.5, Rectangle(0.03, 0.06), 210e9, 7850.0, STEEL.damping, ends="pinned-pinned", poissons_ratio=0.3)
    shear = 210e9 / 2.6 * 0.03 * 0.06 * 10 * 1.3 / (12 + 11 * 0.3)
    inertia = 7850 * 0.03 * 0.06**3 / 12
    exact = closed_forms.timoshenko_omega(beam.bending_stiffness, shear, beam.mass_per_length, inertia, beam.length, n)
    plain, coarse, fine = (
        frequencies(replace(beam, shear=with_shear), n, elements)[n - 1]
        for with_shear, elements in ((False, 80), (True, 40), (True, 80))
    )
    assert fine == pytest.approx(exact, rel=1e-6)
    assert 12 < (coarse - exact) / (fine - exact) < 20
    assert plain > (1 + 0.02 * n**2) * exact or n > 2


def test_thin_beams_need_no_shear():
    thin = replace(STEEL, poissons_ratio=0.3, shear=True)
    assert frequencies(thin, 3, 36) == pytest.approx(frequencies(STEEL, 3, 36), rel=1e-3)
    assert np.all(frequencies(thin, 3, 36) < frequencies(STEEL, 3, 36))


# area and second moment by hand (mm), shear coefficient where a limit is known
SECTIONS = [
    (Rectangle(20.0, 3.0), 60.0, 45.0),
    (Round(4.0), 4 * np.pi, 4 * np.pi),
    (Tube(10.0, 1.0), np.pi * (25 - 16), np.pi / 4 * (5**4 - 4**4)),
    (HollowRectangle(20.0, 10.0, 1.0), 200 - 18 * 8, (20 * 10**3 - 18 * 8**3) / 12),
    (ISection(20.0, 30.0, 2.0, 3.0), 2 * 60 + 24 * 2, 2 * (20 * 3**3 / 12 + 60 * 13.5**2) + 2 * 24**3 / 12),
    (General(7.0, 9.0), 7.0, 9.0),
]


@pytest.mark.parametrize(("shape", "area", "second_moment"), SECTIONS)
def test_sections(shape, area, second_moment):
    assert shape.area_times(1.0) == pytest.approx(area, rel=1e-14)
    assert shape.second_moment_times(1.0) == pytest.approx(second_moment, rel=1e-14)


def test_shear_coefficients_meet_in_their_limits():
    """Cowper: a tube without bore is round; a thin one has 2(1 + ν)/(4 + 3ν); a rectangle 5/6 at ν = 0."""
    assert Tube(10.0, 5.0).sheared_area(0.3) == pytest.approx(Round(10.0).sheared_area(0.3), rel=1e-14)
    thin = Tube(10.0, 1e-6)
    assert thin.sheared_area(0.3) / thin.area_times(1.0) == pytest.approx(2 * 1.3 / (4 + 0.9), rel=1e-6)
    assert Rectangle(2.0, 3.0).sheared_area(0.0) == pytest.approx(5.0, rel=1e-14)
    thin_box = HollowRectangle(1e-3, 10.0, 1e-4)  # as good as two webs: a rectangle's
    assert 0.7 < thin_box.sheared_area(0.3) / thin_box.area_times(1.0) < 0.9


def test_a_plate_of_the_beams_own_section_doubles_its_thickness():
    beam = replace(STEEL, plates=(Plate(0.0, STEEL.length, 0.02, 1.034e-3, 210e9, 7850.0),))
    double = replace(STEEL, shape=Rectangle(0.02, 2 * 1.034e-3))
    assert frequencies(beam, 3, 36) == pytest.approx(frequencies(double, 3, 36), rel=1e-9)


def test_plates_on_both_sides_make_a_sandwich():
    beam = replace(STEEL, plates=(Plate(0.0, STEEL.length, 0.02, 1.034e-3, 210e9, 7850.0, sides=2),))
    triple = replace(STEEL, shape=Rectangle(0.02, 3 * 1.034e-3))
    assert frequencies(beam, 3, 36) == pytest.approx(frequencies(triple, 3, 36), rel=1e-9)


def test_a_plate_that_does_not_stiffen_only_weighs():
    plate = Plate(0.05, 0.1, 0.02, 1e-3, 210e9, 7850.0, stiffens=False)
    weighed = Stretch(0.05, 0.1, STEEL.shape, STIFF, added=7850 * 0.02 * 1e-3)
    exact = frequencies(replace(STEEL, sections=(weighed,)), 3, 36)
    assert frequencies(replace(STEEL, plates=(plate,)), 3, 36) == pytest.approx(exact, rel=1e-9)


def test_mass_beyond_a_place_is_the_integral():
    beam = replace(
        STEEL,
        sections=(Stretch(0.0, 0.1, Rectangle(0.02, 4e-3), STIFF, Rectangle(0.01, 1e-3)),),
        plates=(Plate(0.05, 0.12, 0.02, 1e-3, 210e9, 2000.0),),
    )
    taper = 7850 * 0.1 * (0.02 * 4e-3 / 3 + (0.02 * 1e-3 + 0.01 * 4e-3) / 6 + 0.01 * 1e-3 / 3)
    whole = taper + STEEL.mass_per_length * 0.08 + 2000 * 0.02 * 1e-3 * 0.07
    assert beam.mass == pytest.approx(whole, rel=1e-13)
    assert beam.mass_beyond(np.array([0.1, 0.15])) == pytest.approx(
        [STEEL.mass_per_length * 0.08 + 2000 * 0.02 * 1e-3 * 0.02, STEEL.mass_per_length * 0.03], rel=1e-13
    )
