"""Places that supports hold, places too near each other, and rigid zones that meet something."""

from __future__ import annotations

import pytest

from tests.vibeam.casefile.test_beam_keys import PLAIN
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam.studies.derive import derive
from vibeam.studies.effect_sets import subsets
from vibeam_models.beam import assemble

PINNED = PLAIN.replace("damping_ratio", 'ends = "pinned-pinned"\ndamping_ratio')
SUPPORT = '[[support]]\nposition = "{}"\n'
ZONE = '[[added_mass]]\nmass = "1 g"\nposition = "{}"\nrigid_half_width = "20 mm"\n'
OPPOSITE = '[opposite]\nposition = "800 mm"\n'
SECTION = '[[section]]\nstart = "{}"\nend = "{}"\nthickness = "8 mm"\n'
MASS = '[mass]\nmass = "1 kg"\nposition = "1 m"\n'
FORCE = ('amplitude = "0.1 mm"', 'force = "1 N"\nat = "1 m"')

FAULTS = [
    (PINNED.replace("800 mm", "1 m"),
     "stop.position: the beam is held at 1 m: it never meets a stop there; move the stop"),
    (PLAIN + SUPPORT.format("800.0001 mm"),
     "stop.position: the beam is held at 0.8 m: it never meets a stop there; move the stop"),
    (PINNED + '[[further_stop]]\nposition = "1 m"\ngap = "1 mm"\nrestitution = 0.7\n',
     "further_stop.0.position: the beam is held at 1 m: it never meets a stop there; move the stop"),
    (PINNED.replace("900 mm", "1 m"), "sensor.position: the beam is held at 1 m: a sensor reads 0 there; move it"),
    (PINNED.replace(*FORCE), "drive.at: the beam is held at 1 m: a force moves nothing there; move it"),
    (PINNED.replace("pinned-pinned", "clamped-clamped").replace(*FORCE).replace('force = "1 N"', 'moment = "1 N m"'),
     "drive.at: the beam is held at 1 m: a moment moves nothing there; move it"),
    (PINNED + MASS, "mass.position: the beam is held at 1 m: a mass does not move there; take [mass] out, or write "
     "[[added_mass]] for what turns there"),
    (PINNED.replace("settle", 'output = "tip"\nsettle'),
     'sweep.output: the beam is held at 1 m: the tip does not move; write output = "sensor"'),
    (PINNED + '[show.tip]\nkind = "history"\nfrequency = 5\noutput = "tip"\n',
     'show.tip.output: the beam is held at 1 m: the tip does not move; write output = "sensor"'),
    (PLAIN + OPPOSITE + SUPPORT.format("800 mm") + 'on = "opposite"\n',
     "opposite.position: the opposite beam is held at 0.8 m and does not give way: meet it elsewhere, or take "
     "[opposite] out"),
    (PLAIN + OPPOSITE + 'ends = "pinned-free"\n[gravity]\ndirection = "transverse"\n',
     'gravity.direction: nothing holds a beam against its weight, it falls and has no static gap: '
     "take [gravity] out, hold an end, or add [[support]]"),
    (PLAIN + ZONE.format("0.5 m") + SUPPORT.format("0.51 m"),
     "added_mass.0.rigid_half_width: 0.02 m reaches the support at 0.51 m, which does not yield: "
     "give that a stiffness"),
    (PLAIN + ZONE.format("0.5 m") + ZONE.format("0.53 m"),
     "added_mass.1.rigid_half_width: 0.02 m meets the rigid zone at 0.5 m: make it less than 0.01 m"),
    (PLAIN + ZONE.format("0.5 m") + ZONE.format("0.51 m"),
     "added_mass.1.rigid_half_width: 0.02 m meets the rigid zone at 0.5 m: make both one mass"),
    (PLAIN + SECTION.format("0.3 m", "0.30001 m"),
     "section.0.end: 1e-05 m from 0.3 m, a stretch below 0.0001 of the length is all round-off: make them one"),
    (PLAIN + SECTION.format("0.3 m", "0.99995 m"),
     "section.0.end: 5e-05 m from the end of the beam, a stretch below 0.0001 of the length is all round-off: make "
     "them one"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), FAULTS)
def test_one_fault_is_one_line(text, message):
    with pytest.raises(CaseError) as caught:
        parse(text)
    assert [line.split(": ", 1)[1] for line in str(caught.value).splitlines()] == [message]


@pytest.mark.parametrize(
    "text",
    [
        PINNED.replace(*FORCE).replace('force = "1 N"', 'moment = "1 N m"'),
        PLAIN + ZONE.format("0.5 m") + SUPPORT.format("0.51 m") + 'stiffness = "1 kN/m"\n',
        PLAIN + ZONE.format("0.5 m") + ZONE.format("0.55 m"),
        PLAIN + OPPOSITE + SUPPORT.format("800 mm"),  # the opposite beam meets a place that is held
        PINNED.replace("pinned-pinned", "guided-clamped"),
    ],
    ids=["moment at a pin", "spring in a zone", "zones apart", "opposite moves", "guided"],
)
def test_what_moves_is_accepted(text):
    assert assemble(parse(text.replace("900 mm", "700 mm")).scene).modes(1).omega[0] > 0


def test_a_stop_beside_a_break_leaves_the_modes_as_they_are():
    """1 µm of a beam of 1 m is (10⁶)³ as stiff as the beam: with a node at the stop nothing of that would be left."""
    at, beside = (PLAIN.replace("800 mm", place) + SECTION.format("0 m", "0.8 m") for place in ("800 mm", "800.001 mm"))
    own, other = (assemble(parse(text).scene).modes(4).omega for text in (at, beside))
    assert other == pytest.approx(own, rel=1e-8)


def test_a_sensor_beside_the_stop_leaves_the_derived_stiffness_as_it_is():
    one, other = (derive(parse(PINNED.replace("900 mm", place)))["stiffness"] for place in ("800 mm", "800.001 mm"))
    assert other.value == pytest.approx(one.value, rel=1e-4)


CARRIED = (
    OPPOSITE + '[[added_mass]]\non = "opposite"\nmass = "20 g"\nposition = "1 m"\n' + SECTION.format("0 m", "0.1 m")
)
CARRIED += 'on = "opposite"\n' + SECTION.format("0 m", "0.2 m")


def test_a_beam_that_is_left_out_takes_along_what_is_on_it():
    case = parse(PLAIN + CARRIED, set={"fidelity.alone.without": ["opposite"], "fidelity.alone.modes": 4,
                                       "fidelity.alone.reduction": "modal"})  # fmt: skip
    own = parse(PLAIN + SECTION.format("0 m", "0.2 m"))
    assert case.scene_of("alone") == own.scene


def test_influence_takes_the_opposite_beam_away_with_what_is_on_it():
    sets = subsets(parse(PLAIN + CARRIED))
    assert sets.effects == ("added_mass", "opposite", "section.0", "section.1")
    left = sets.case(["section.1"])
    assert left.scene == parse(PLAIN + SECTION.format("0 m", "0.2 m")).scene
    assert sets.case(["opposite", "section.1"]).scene.named("opposite")
