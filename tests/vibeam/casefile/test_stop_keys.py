"""What [stop] can say beyond one coefficient: the system that comes of it, and the faults."""

from __future__ import annotations

from dataclasses import replace

import free_mass
import numpy as np
import pytest

import vibeam
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam_models.laws.compliant import HuntCrossley, LinearStop
from vibeam_models.laws.restitution import PlasticRestitution, TableRestitution, ViscousRestitution

RIG = """units = "SI"
[beam]
length = "180 mm"
width = "20 mm"
thickness = "1.034 mm"
youngs_modulus = "210 GPa"
density = "7850 kg/m^3"
damping_ratio = 0.017
[mass]
mass = "0.2 kg"
position = "132 mm"
[stop]
gap = "0.1 mm"
STOP
[sensor]
position = "100 mm"
[drive]
amplitude = "0.1 mm"
[sweep]
frequency = ["14 Hz", "15 Hz", "16 Hz"]
settle = 30
hold = 10
direction = "up"
[fidelity.two]
reduction = "modal"
modes = 2
"""


def made(stop: str) -> vibeam.ImpactSystem:
    return parse(RIG.replace("STOP", stop)).system("two")


def faults(stop: str) -> str:
    with pytest.raises(CaseError) as caught:
        parse(RIG.replace("STOP", stop), "mine.toml")
    return str(caught.value)


def test_without_a_law_nothing_of_it_is_there() -> None:
    plain = parse(RIG.replace("STOP", "restitution = 0.72"))
    assert plain.system("two").beyond_plain == ()
    named = parse(RIG.replace("STOP", 'restitution = 0.72\nlaw = "restitution"')).system("two")
    assert (named.restitution, named.beyond_plain) == (0.72, ())
    for key in ("law", "stiffness", "drift", "second_gap", "velocity"):
        assert f"\n{key} =" not in plain.numbers


def test_every_law_is_built() -> None:
    linear = made('law = "linear"\nstiffness = "1e6 N/m"\ndamping = "12 N s/m"').law
    assert linear == LinearStop(1e6, 12.0)
    system = made('law = "linear"\nstiffness = "1 kN/mm"\nrestitution = 0.72')
    assert isinstance(system.law, LinearStop)
    mass = 1 / float(np.sum(system.contact**2))
    assert free_mass.restitution(system.law, mass) == pytest.approx(0.72, rel=1e-12)
    assert made('law = "hertz"\nhertz_stiffness = 1e9').law == HuntCrossley(1e9, 0.0, 1.5)
    hunt = made(
        'law = "hunt-crossley"\nhertz_stiffness = 1e9\nrestitution = 0.7\nvelocity = "50 mm/s"\nexponent = 2'
    ).law
    assert isinstance(hunt, HuntCrossley)
    assert (hunt.exponent, free_mass.given_back(hunt, 0.05)) == (2.0, pytest.approx(0.7, rel=1e-12))
    plastic = made('law = "velocity restitution"\nrestitution = 0.6\nvelocity = "0.1 m/s"').law
    assert plastic == PlasticRestitution(0.6, 0.1)
    table = made('law = "velocity restitution"\nspeeds = ["10 mm/s", "0.1 m/s"]\nrestitutions = [0.8, 0.6]').law
    assert table == TableRestitution((0.01, 0.1), (0.8, 0.6))
    viscous = 'law = "viscous restitution"\nrestitution = 0.8\nvelocity = "0.1 m/s"'
    assert made(viscous).law == ViscousRestitution.matched(0.8, 0.1, 0.2)
    assert made(viscous + "\nexponent = 0.5").law == ViscousRestitution.matched(0.8, 0.1, 0.5)
    assert made('restitution = 0.72\nsecond_gap = "1 mm"').second_gap == pytest.approx(1e-3)


@pytest.mark.parametrize(
    ("stop", "said"),
    [
        ("", "stop.restitution: missing (speed after over speed before an impact): write restitution = …"),
        ('law = "linear"\nrestitution = 0.7', "stop.stiffness: missing"),
        ('law = "linear"\nstiffness = 1e6', "stop.damping: the loss of the linear stop is not said"),
        ('law = "linear"\nstiffness = 1e6\nrestitution = 0.7\ndamping = 1', "is said twice"),
        ('law = "linear"\nstiffness = 1e6\nrestitution = 0', "stop.restitution: 0 is more than"),
        ('law = "hertz"\nhertz_stiffness = 1e9\nrestitution = 0.7', 'stop.restitution: does not go with law = "hertz"'),
        ('law = "hertz"\nhertz_stiffness = 1e9\nexponent = 0.5', "stop.exponent: 0.5 is below 1"),
        ('law = "hunt-crossley"\nhertz_stiffness = 1e9\nrestitution = 0.7', "stop.velocity: missing"),
        ('law = "velocity restitution"\nspeeds = [0.1, 0.2]\nrestitutions = [0.5]', "1 numbers for 2 speeds"),
        ('restitution = 0.7\nstiffness = "1 N/m"', 'stop.stiffness: does not go with law = "restitution"'),
        ('law = "linear"\nstiffness = "1 N"', "not a stiffness"),
        ('law = "linaer"', "linear"),
        ('restitution = 0.7\nsecond_gap = "-0.1 mm"', "stop.second_gap: must be above −gap"),
        (
            'restitution = 0.7\nsecond_gap = "1 mm"\ndrift = ["0 mm", "-10 mm"]\ndrift_frequency = [10, 30]',
            "stop.second_gap: must be above −gap less the drift, -0.003 m, = 0.0029 m",
        ),
        ('restitution = 0.7\ndrift = ["0 mm"]', "stop.drift_frequency: missing"),
        ("restitution = 0.7\ndrift = [0.0]\ndrift_frequency = [14, 16]", "stop.drift: 1 numbers for 2 frequencies"),
        (
            'law = "hertz"\nhertz_stiffness = 1e9\nrestitution_of = "first mode"',
            'stop.restitution_of: "first mode" does not go',
        ),
    ],
)
def test_what_does_not_go_together_is_said_at_its_key(stop: str, said: str) -> None:
    assert said in faults(stop)


def test_a_case_flies_viscous_restitution_as_direct_integration_finds_it() -> None:
    case = parse(RIG.replace("STOP", 'law = "viscous restitution"\nrestitution = 0.8\nvelocity = "0.1 m/s"'))
    assert np.all(vibeam.run(case)["two"].up.impacts > 0)
    asked = {"omega": [2 * np.pi * 15], "amplitude": 1e-4, "settle": 5, "hold": 2}
    fine = {"solver": "direct", "options": {"method": "DOP853", "rtol": 1e-10}}
    flown, direct = (vibeam.sweep(case.system("two"), **asked, **how) for how in ({}, fine))
    np.testing.assert_allclose(flown.amplitude, direct.amplitude, rtol=1e-4)


def test_a_gap_that_drifts_is_another_gap_at_each_frequency() -> None:
    stop = 'restitution = 0.72\ndrift_frequency = ["14 Hz", "16 Hz"]\ndrift = ["0 mm", "0.04 mm"]'
    case = parse(RIG.replace("STOP", stop))
    found = vibeam.run(case)["two"].up
    system, state = case.system("two"), None
    assert system.beyond_plain == ()
    for i, (frequency, more) in enumerate([(14.0, 0.0), (15.0, 2e-5), (16.0, 4e-5)]):
        moved = replace(system, gap=system.gap + more)
        omega = [2 * np.pi * frequency]
        one = vibeam.sweep(moved, omega=omega, amplitude=1e-4, settle=30, hold=10, state=state, output="sensor")
        assert found.reach[i] == pytest.approx(one.reach[0], rel=1e-6)
        state = vibeam.simulate(moved, vibeam.Drive(omega[0], 1e-4), 40 / frequency, state).state
    still = vibeam.run(parse(RIG.replace("STOP", "restitution = 0.72")))["two"].up
    assert abs(still.amplitude[2] - found.amplitude[2]) > 1e-7


def test_a_gap_that_closes_takes_what_rests_on_the_stop_along() -> None:
    system = vibeam.ImpactSystem.from_modes([10.0], 0.1, 1.0, 1.0, gap=-1e-3, restitution=0.3)
    falling = vibeam.sweep(
        system, omega=[20.0, 21.0], amplitude=1e-7, settle=5, hold=5, drift=lambda w: -1e-4 * (w - 20)
    )
    assert falling.rest == pytest.approx([1.0, 1.0], rel=1e-14)
    assert falling.maximum == pytest.approx([-1e-3, -1.1e-3], rel=1e-9)


BODIES = 'radius = "5 mm"\nyoungs_modulus = "210 GPa"\npoissons_ratio = 0.3\n'
BOTH = f"{BODIES}counterbody_poissons_ratio = 0.3\n"


def test_a_stop_says_radius_and_materials_in_place_of_its_stiffness() -> None:
    """E* of two equal bodies is E/2(1 − ν²): 4/3 E* √R of the sphere, 2 E* a of the punch."""
    modulus = 210e9 / (2 * 0.91)
    sphere = made(f'{BOTH}law = "hertz"').law
    assert sphere == HuntCrossley(sphere.stiffness)
    assert sphere.stiffness == pytest.approx(4 / 3 * modulus * 0.005**0.5, rel=1e-14)
    found = made(f'{BOTH}law = "hunt-crossley"\nrestitution = 0.7\nvelocity = "0.1 m/s"').law
    assert found == HuntCrossley.matched(found.stiffness, 0.7, 0.1)
    punch = made(f'{BOTH}law = "linear"\nshape = "flat punch"\ndamping = "3 N s/m"').law
    assert punch == LinearStop(punch.stiffness, 3.0)
    assert punch.stiffness == pytest.approx(2 * modulus * 0.005, rel=1e-14)


def test_what_meets_the_stop_is_the_beam_unless_the_stop_says_otherwise() -> None:
    own = RIG.replace("STOP", f'{BODIES}law = "hertz"').replace("damping_ratio", "poissons_ratio = 0.3\ndamping_ratio")
    assert parse(own).system("two").law == made(f'{BOTH}law = "hertz"').law
    softer = parse(own, set={"beam.youngs_modulus": "70 GPa"}).system("two").law
    said = parse(own, set={"stop.counterbody_youngs_modulus": "70 GPa"}).system("two").law
    assert softer == said != made(f'{BOTH}law = "hertz"').law


@pytest.mark.parametrize(
    ("stop", "told"),
    [
        (f'{BODIES}law = "hertz"', "write counterbody_poissons_ratio = …; or poissons_ratio in [beam]"),
        ('law = "hertz"\nradius = "5 mm"\nhertz_stiffness = 1e9', "stop.hertz_stiffness: does not go with law"),
        ('law = "hertz"\nradius = "5 mm"', 'write youngs_modulus = "… GPa"'),
        ('law = "hertz"', "or radius, youngs_modulus and poissons_ratio of the stop"),
        (f'{BOTH}law = "hertz"\nshape = "flat punch"', 'grows as d^1: write law = "linear"'),
        (f'{BOTH}law = "linear"\nrestitution = 1\nshape = "sphere"', 'grows as d^1.5: write law = "hertz", or'),
        (f'{BOTH}law = "linear"\nrestitution = 1', 'stop.shape: missing: write shape = "flat punch"'),
        (f'{BOTH}law = "hertz"\nshape = "cylinder"', 'stop.length: missing (of the cylinder): write length = "10 mm"'),
        (f'{BOTH}law = "hertz"\nshape = "cylinder"', "stop.radius: does not go with a cylinder"),
        (f"{BOTH}restitution = 0.7", 'stop.radius: does not go with law = "restitution"'),
        (f'{BOTH}law = "linear"\nshape = "flat punch"', "stop.damping: the loss of the linear stop is not said"),
    ],
)
def test_faults_of_a_stop_by_its_materials(stop: str, told: str) -> None:
    assert told in faults(stop)
