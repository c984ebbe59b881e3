"""Keys of the beam's sections, plates, ends and supports: what they make, and what a wrong one is told."""

from __future__ import annotations

from math import inf
from pathlib import Path

import numpy as np
import pytest

import vibeam
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam_models.beam import assemble
from vibeam_models.beams.beam import Support
from vibeam_models.beams.shapes import SHAPES, Rectangle, Round, Tube
from vibeam_models.laws import LAWS
from vibeam_models.space import bare_beam

DTU = Path(__file__).parents[3] / "cases" / "dtu_neutral.toml"

PLAIN = """units = "SI"
[beam]
length = "1 m"
width = "20 mm"
thickness = "5 mm"
youngs_modulus = "210 GPa"
density = "7850 kg/m^3"
damping_ratio = 0.01

[stop]
gap = "1 mm"
position = "800 mm"
restitution = 0.7

[sensor]
position = "900 mm"

[drive]
amplitude = "0.1 mm"

[sweep]
frequency = [5]
settle = 20
hold = 5

[fidelity.beam]
reduction = "modal"
modes = 3
"""

TUBE = PLAIN.replace('width = "20 mm"\nthickness = "5 mm"', 'shape = "tube"\nouter_diameter = "16 mm"\nwall = "1 mm"')
FIRST = '[[section]]\nstart = "0 mm"\nend = "400 mm"\n'


def faults_of(text: str) -> list[str]:
    with pytest.raises(CaseError) as caught:
        parse(text, "mine.toml")
    return [line.split(":", 2)[2].strip() for line in str(caught.value).splitlines()]


def test_a_shape_says_its_own_dimensions():
    assert parse(TUBE).scene.beam.shape == Tube(0.016, 0.001)
    assert parse(PLAIN).scene.beam.shape == Rectangle(0.02, 0.005)


def test_a_section_takes_from_the_beam_what_it_does_not_say():
    carrier = parse(PLAIN + FIRST + 'thickness = "8 mm"\nend_thickness = "5 mm"\ndensity = 2700\n').scene.carrier
    taper, rest = carrier.stretches[0], carrier.stretches[-1]
    assert (taper.shape, taper.far) == (Rectangle(0.02, 0.008), Rectangle(0.02, 0.005))
    assert (taper.material.density, taper.material.youngs_modulus) == (2700.0, 210e9)
    assert (rest.start, rest.end, rest.shape, rest.material.density) == (0.4, 1.0, Rectangle(0.02, 0.005), 7850.0)


def test_a_section_may_have_another_shape():
    carrier = parse(PLAIN + FIRST + 'shape = "round"\ndiameter = "9 mm"\n').scene.carrier
    assert carrier.stretches[0].shape == Round(0.009)


def test_sections_of_the_beams_own_kind_change_nothing():
    """Two stretches that say what the beam says are the beam, but for the order in which round-off adds up."""
    whole = parse(PLAIN + FIRST + '[[section]]\nstart = "400 mm"\nend = "1 m"\n').scene
    own = assemble(parse(PLAIN, set={"beam.elements": 35}).scene).modes(4).omega
    assert assemble(parse(PLAIN).scene).modes(4).omega == pytest.approx(own, rel=1e-5)
    assert assemble(whole).modes(4).omega == pytest.approx(own, rel=1e-5)


@pytest.mark.parametrize(
    "words",
    [
        {"beam.shape": "rectangle"},
        {"beam.ends": "clamped-free"},
        {"section": [{"start": 0, "end": "180 mm"}]},
        {"section": [{"start": 0, "end": "180 mm", "shape": "rectangle", "width": "20 mm", "thickness": "1.034 mm"}]},
    ],
    ids=["shape", "ends", "section", "whole section"],
)
def test_the_rig_in_other_words_has_the_same_numbers_to_the_bit(words):
    """One stretch over the whole beam has no break within: the same mesh, the same sums."""
    own, other = (vibeam.load(DTU, set=given).system("beam") for given in ({}, words))
    assert other.moves_as(own)
    changed = vibeam.load(DTU, set={"section": [{"start": 0, "end": "180 mm", "width": "20.001 mm"}]}).system("beam")
    assert not changed.moves_as(own)


def test_plates_by_mass_and_by_density_are_one():
    plate = '[[plate]]\nstart = "100 mm"\nend = "200 mm"\nwidth = "20 mm"\nthickness = "2 mm"\nsides = "both"\n'
    by_mass = parse(PLAIN + plate + f"mass = {2 * 7850 * 0.02 * 0.002 * 0.1}\n").scene.carrier
    by_density = parse(PLAIN + plate + "density = 7850\n").scene.carrier
    assert by_mass.plates[0].mass_per_length == pytest.approx(by_density.plates[0].mass_per_length, rel=1e-15)
    assert by_mass.mass == pytest.approx(7850 * (0.02 * 0.005 + 2 * 0.02 * 0.002 * 0.1), rel=1e-14)


def test_ends_and_supports():
    text = PLAIN.replace("damping_ratio", 'ends = "clamped-pinned"\ndamping_ratio')
    scene = parse(text + '[[support]]\nposition = "500 mm"\nstiffness = "2 kN/m"\n').scene
    assert scene.carrier.held == (Support(0.0, inf, inf), Support(1.0, inf, 0.0), Support(0.5, 2000.0, 0.0))
    free, sprung = (bare_beam(beam)[0].modes(1).omega for beam in (parse(text).scene.carrier, scene.carrier))
    assert sprung > 1.01 * free


def test_timoshenkos_beam_is_softer():
    text = TUBE.replace("damping_ratio", 'theory = "timoshenko"\npoissons_ratio = 0.3\ndamping_ratio')
    soft, stiff = (assemble(parse(each).scene).modes(3).omega for each in (text, TUBE))
    assert np.all(soft < stiff)
    assert soft == pytest.approx(stiff, rel=1e-2)


NAMES = " | ".join(f'"{name}"' for name in SHAPES)
LAW_NAMES = " | ".join(f'"{name}"' for name in LAWS)
OFF_LEAF = (
    "leaf.length: opposite.arm says where on the leaf the contact is: "
    'write arm = "0.057 m" for its tip, or less, above 0'
)
MASSIVE = '[leaf]\nlength = "57 mm"\nwidth = "40 mm"\nthickness = "1 mm"\nmass = "18 g"\n'


FAULTS = [
    (PLAIN.replace('width = "20 mm"\n', ""), 'beam.width: missing (width of the section): write width = "… mm"'),
    (TUBE.replace('wall = "1 mm"', 'wall = "9 mm"'),
     'beam.wall: 0.009 m leaves no hollow: outer_diameter is 0.016 m; write shape = "round"'),
    (TUBE.replace("wall =", 'thickness = "2 mm"\nwall ='),
     'beam.thickness: does not go with shape = "tube": write shape = "rectangle" or shape = "hollow rectangle" or '
     'shape = "I", or take it out'),
    (PLAIN.replace("width =", 'shape = "tub"\nwidth ='),
     f"beam.shape: 'tub' is not one of {NAMES}; did you mean 'tube'?"),
    (TUBE.replace('"tube"', '"tub"') + FIRST + 'outer_diameter = "20 mm"\n',
     f"beam.shape: 'tub' is not one of {NAMES}; did you mean 'tube'?"),
    (PLAIN.replace("restitution = 0.7", 'law = "liner"\nstiffness = "1 N/mm"\nrestitution = 0.7'),
     f"stop.law: 'liner' is not one of {LAW_NAMES}; did you mean 'linear'?"),
    (PLAIN.replace("restitution = 0.7", 'law = "linear"\nstiffness = "1 N/mm"\nrestitution = 0'),
     'stop.restitution: 0 is more than law = "linear" can lose: write a number above 0'),
    (PLAIN.replace('amplitude = "0.1 mm"', 'force = ["1 N", "2 N"]\nfrequency = [6, 4]\nat = "0.5 m"'),
     "drive.frequency: the list must ascend, each number once; the direction is said elsewhere"),
    (PLAIN.replace('amplitude = "0.1 mm"', 'moment = "1 N m"\nat = "0 mm"'), "drive.at: '0 mm' must be > 0"),
    (PLAIN + FIRST.replace("400 mm", "2 m"), "section.0.end: 2 m is beyond the tip: beam.length is 1 m"),
    (PLAIN + FIRST.replace("400 mm", "0 m").replace('"0 mm"', '"1 mm"'), "section.0.end: '0 m' must be > 0"),
    (PLAIN + FIRST + FIRST, "section.1.start: the stretch overlaps that from 0 m to 0.4 m: let them meet"),
    (PLAIN + FIRST + 'shape = "tube"\nwall = "1 mm"\n',
     'section.0.outer_diameter: missing (of a tube): write outer_diameter = "15.875 mm"'),
    (PLAIN + FIRST + 'diameter = "1 mm"\n',
     'section.0.diameter: does not go with shape = "rectangle": write shape = "round", or take it out'),
    (PLAIN + '[[plate]]\nstart = "0 m"\nend = "0.1 m"\nwidth = "20 mm"\nthickness = "1 mm"\n',
     'plate.0.mass: missing (or density): write mass = "40 g"'),
    (PLAIN + '[[support]]\nposition = "2 m"\n', "support.0.position: 2 m is beyond the tip: beam.length is 1 m"),
    (PLAIN + '[[support]]\nposition = "0.5 m"\nstiffness = 0\n',
     "support.0.stiffness: 0 holds nothing: leave it out for a rigid support, or take the support out"),
    (PLAIN.replace("damping_ratio", 'ends = "pinned-free"\ndamping_ratio') + '[gravity]\ndirection = "standing"\n',
     'gravity.direction: nothing holds a beam against its weight, it falls and has no static gap: take '
     "[gravity] out, hold an end, or add [[support]]"),
    (PLAIN.replace("damping_ratio", 'ends = "free-free"\ndamping_ratio') + '[gravity]\ndirection = "hanging"\n',
     'gravity.direction: nothing holds a beam against its weight, it falls and has no static gap: take '
     "[gravity] out, hold an end, or add [[support]]"),
    (PLAIN.replace("damping_ratio", 'theory = "timoshenko"\ndamping_ratio'),
     'beam.poissons_ratio: missing (theory = "timoshenko" needs it): write poissons_ratio = 0.3'),
    (PLAIN.replace("damping_ratio", 'ends = "pinned-pinned"\ndamping_ratio') + '[clamp]\nstiffness = 5\n',
     'clamp: goes with a beam clamped at its start, not with ends = "pinned-pinned": write [[support]]'),
    (PLAIN + '[[plate]]\non = "opposite"\nstart = 0\nend = 0.1\nwidth = 0.02\nthickness = 1e-3\nmass = 0.01\n',
     'plate.0.on: there is no opposite beam: add [opposite], or write on = "beam"'),
    (PLAIN + MASSIVE,
     "leaf: stands on an opposite beam: add [opposite]; a leaf on the base is an [opposite] beam itself"),
    (PLAIN + MASSIVE + '[opposite]\nposition = "700 mm"\n', OFF_LEAF),
    (PLAIN + MASSIVE + '[opposite]\nposition = "700 mm"\narm = "60 mm"\n', OFF_LEAF),
    (PLAIN + '[opposite]\nposition = "1.2 m"\n', "opposite.position: 1.2 m is beyond its tip: it is 1 m long"),
    (PLAIN + '[opposite]\nposition = 1\ndiameter = 0.01\n',
     'opposite.diameter: does not go with shape = "rectangle": write shape = "round", or take it out'),
    (PLAIN + '[opposite]\nposition = 1\nshape = "tube"\nwall = 1e-3\n',
     'opposite.outer_diameter: missing (of a tube): write outer_diameter = "15.875 mm"'),
    (PLAIN + '[opposite]\nposition = 1\nshape = "I"\nthickness = 0.03\nwidth = 0.02\nflange = 3e-3\n',
     'opposite.web: missing (thickness of the web of an I): write web = "5 mm"'),
    (PLAIN + '[opposite]\nposition = 1\n[gravity]\ndirection = "hanging"\n',
     "opposite: does not go with a massless beam, torsion, or weight along the beam: take one of them out"),
    (PLAIN + '[opposite]\nposition = 1\nlength = 2\n[[support]]\non = "opposite"\nposition = 3\n',
     "support.0.position: 3 m is beyond the tip: opposite.length is 2 m"),
    (PLAIN + '[[added_mass]]\nmass = "1 g"\nposition = "0.99 m"\nrigid_half_width = "20 mm"\n',
     "added_mass.0.rigid_half_width: 0.02 m reaches an end of the beam"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), FAULTS)
def test_faults(text, message):
    assert faults_of(text) == [message]


def test_two_beams_by_keys():
    case = parse(PLAIN + '[opposite]\nposition = "700 mm"\narm = "50 mm"\nthickness = "6 mm"\n')
    opposite = case.scene.named("opposite")[0]
    assert opposite.beam(case.scene).shape == Rectangle(0.02, 0.006)
    assert case.system("beam").output("opposite").any()
    assert parse(case.text).scene == case.scene


@pytest.mark.parametrize("held", ['ends = "free-free"', 'ends = "pinned-free"', 'ends = "guided-free"'])
def test_weight_across_a_beam_on_springs_has_a_static_gap(held: str) -> None:
    text = PLAIN.replace("damping_ratio", f"{held}\ndamping_ratio") + '[gravity]\ndirection = "transverse"\n'
    with pytest.raises(CaseError, match="nothing holds a beam against its weight"):
        parse(text)
    springs = "".join(f'[[support]]\nposition = "{x} m"\nstiffness = "1 kN/m"\n' for x in (0.3, 0.9))
    assert parse(text + springs).system("beam").omega[0] > 0


def test_a_pinned_beam_that_hangs_is_a_pendulum() -> None:
    """√(3g/2L)/2π of a rigid bar; the bar bends a little under it."""
    text = PLAIN.replace("damping_ratio", 'ends = "pinned-free"\ndamping_ratio')
    assert parse(text).system("beam").omega[0] == 0
    hanging = parse(text + '[gravity]\ndirection = "hanging"\n').system("beam")
    assert hanging.omega[0] == pytest.approx(np.sqrt(3 * 9.80665 / 2), rel=1e-3)


def test_two_rigid_zones_are_rigid():
    zone = '[[added_mass]]\nmass = "1 g"\nposition = "{}"\nrotary_inertia = "1e-7 kg m^2"\nrigid_half_width = "20 mm"\n'
    structure = assemble(parse(PLAIN + zone.format("0.3 m") + zone.format("0.6 m")).scene)
    plain = assemble(parse(PLAIN).scene)
    assert structure.modes(1).omega > plain.modes(1).omega
    assert structure.size < plain.size + 8


def test_lists_of_tables_that_a_case_does_not_name_are_no_part_of_it():
    case = parse(PLAIN)
    assert "[]" not in case.text
    assert parse(case.text).key == case.key
    assert parse(PLAIN + '[[support]]\nposition = "0.5 m"\n').key != case.key


def test_a_leaf_goes_with_the_opposite_beam_that_carries_it():
    stand = '[opposite]\nposition = "700 mm"\narm = "50 mm"\n'
    case = parse(PLAIN + MASSIVE + stand, set={"fidelity.alone": {
        "reduction": "modal", "modes": 4, "without": ["opposite"]}, "fidelity.stiff": {
        "reduction": "modal", "modes": 4, "without": ["leaf"]}})  # fmt: skip
    assert case.scene_of("alone") == parse(PLAIN).scene
    assert case.scene_of("stiff") == parse(PLAIN + stand).scene
    parse(PLAIN + MASSIVE + stand, set={"sweep.output": "opposite_tip"})
    with pytest.raises(CaseError, match=r"sweep\.output: 'opposite_tip' is not one of"):
        parse(PLAIN, set={"sweep.output": "opposite_tip"})
