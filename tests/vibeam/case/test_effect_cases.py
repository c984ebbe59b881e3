"""The tables of effects: what a case with them holds, refuses and computes."""

# ruff: noqa: E501  (a message stays on its line)

import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest

import vibeam
from tests.vibeam.casefile.test_case_faults import RIG as TEXT
from vibeam.case.fidelity import Fidelity, system
from vibeam.case.input_plan import InputPlan
from vibeam.casefile.read import parse
from vibeam.casefile.template import template
from vibeam.exchange.faults import CaseError
from vibeam.runs.run import run
from vibeam.runs.sweep import march
from vibeam.studies.derive import derive
from vibeam.studies.modes import mode_table, write_shapes
from vibeam_models.base import Base
from vibeam_models.base_motion import drive_amplitude
from vibeam_models.beam import assemble
from vibeam_models.effects.gravity import Gravity
from vibeam_models.effects.masses import MasslessBeam
from vibeam_models.effects.platform import Platform, PlatformFilter, Shaker
from vibeam_models.effects.supports import Clamp
from vibeam_models.effects.torsion import Torsion
from vibeam_models.keys import keys_of
from vibeam_reductions.static_shapes import static_mode

ROOT = Path(__file__).parents[3]
CLAMP = '[clamp]\nstiffness = "500 N m/rad"\n'
GRAVITY = '[gravity]\ndirection = "hanging"\n'
TORSION = '[torsion]\neccentricity = "1 mm"\npolar_inertia = "2.8e-5 kg m^2"\npoissons_ratio = 0.25\n'
PLATFORM = '[platform]\nmass = "5 kg"\nfrequency = "3.25 Hz"\ndamping_ratio = 0\ncoupling = "one-way"\ncalibrated_at = "15.5 Hz"\n'
SHAKER = '[shaker]\nresistance = "4 ohm"\nforce_factor = "20 N/A"\n'
SHAKEN = TEXT.replace("gain = 5e-4\n", "") + PLATFORM.replace('calibrated_at = "15.5 Hz"\n', "") + SHAKER
FORCED = TEXT.replace('voltage = "0.6 V"\ngain = 5e-4', 'force = "5 N"')
ONE_WAY = parse(TEXT + PLATFORM)
TWO_WAY = parse(TEXT + PLATFORM, set={"platform.coupling": "two-way"})
UNDAMPED = {"beam.damping_ratio": 0.0, "platform.coupling": "two-way"}


def faults_of(text, set=None):
    with pytest.raises(CaseError) as caught:
        parse(text, "mine.toml", set)
    return [str(fault) for fault in caught.value.faults]


def test_the_tables_are_the_scene():
    case = parse(TEXT + CLAMP + GRAVITY + TORSION + PLATFORM, set={"beam.massless": True})
    scene = case.scene
    platform = Platform(mass=5.0, frequency=3.25, damping_ratio=0.0, coupling="one-way", calibrated_at=15.5)
    torsion = Torsion(1e-3, 2.8e-5, 0.25)
    assert set(scene.effects) == {MasslessBeam(), Clamp(500.0), Gravity("hanging", 9.80665), torsion, platform}
    assert torsion.modulus(scene.beam) == 84e9
    assert scene.carrier.mass_per_length == 0
    assert (platform.spring, platform.calibration) == (5.0 * (2 * np.pi * 3.25) ** 2, 2 * np.pi * 15.5)
    assert parse(case.text).scene == scene
    assert parse(SHAKEN).scene.shaker == Shaker(4.0, 20.0, 0.0)
    other = parse(TEXT + TORSION.replace("poissons_ratio = 0.25", 'shear_modulus = "80 GPa"')).scene
    assert other.effects == (Torsion(1e-3, 2.8e-5, shear_modulus=80e9),)
    assert other.effects[0].modulus(other.beam) == 80e9
    by_beam = TORSION.replace("poissons_ratio = 0.25\n", "")
    shared = parse(TEXT + by_beam, set={"beam.poissons_ratio": 0.25}).scene
    assert shared.effects[0].modulus(shared.beam) == 84e9
    with pytest.raises(CaseError, match=r"torsion.poissons_ratio: beam.poissons_ratio says 0.3: leave it out here"):
        parse(TEXT + TORSION, set={"beam.poissons_ratio": 0.3})


def test_a_case_without_tables_names_no_effect():
    scene = parse(TEXT).scene
    assert scene.effects == ()
    assert scene.carrier == scene.beam


def test_the_template_with_all_its_comments_opened_is_told_what_excludes_what():
    """Every optional key at once: two ways to say one thing are told, few modes of a massless beam, and what a mesh does not take."""
    opened = re.sub(r"(?m)^# (\[+[a-z_.]+\]+$|[a-z_]+ = )", r"\1", template()).split("[reference")[0]
    opened = re.sub(r"(?m)^\[(record|start)\]\n(?:(?!\[).*\n)*", "", opened)
    said = "\n".join(faults_of(opened))
    assert "unknown" not in said
    of_other_shapes = {line.split(": ")[1] for line in said.splitlines() if 'does not go with shape = "tube"' in line}
    assert {key.split(".")[0] for key in of_other_shapes} == {"beam", "opposite", "section"}
    of_records = {f"drive.{name}" for name in keys_of(InputPlan)}
    assert {line.split(": ")[1] for line in said.splitlines()} - of_other_shapes == of_records | {
        'chosen_by."platform.mass"',
        "drive.harmonic",
        "further_stop.0.exponent",
        "further_stop.0.velocity",
        "further_stop.0.damping",
        "further_stop.0.hertz_stiffness",
        "plate.0",
        "plate.0.mass",
        "opposite",
        "torsion",
        "output.gauge.absolute",
        "stop.damping",
        "stop.shape",
        "stop.stiffness",
        "stop.exponent",
        "stop.hertz_stiffness",
        "stop.restitution_of",
        "stop.restitutions",
        "stop.speeds",
        "stop.velocity",
        "torsion.poissons_ratio",
        "measurement.ripple",
        "measurement.attenuation",
        "platform.frequency",
        "platform.calibrated_at",
        "drive.gain",
        "drive.amplitude",
        "drive.velocity",
        "drive.acceleration",
        "drive.force",
        "drive.moment",
        "drive.at",
        "drive.frequency",
        *(f"solid.{name}" for name in ("along", "across", "through", "whole", "mass_size", "mass_youngs_modulus")),
        *(f"solid.{name}" for name in ("contact", "force", "damping", "damping_ratio")),
        "fidelity.sdof",
        "fidelity.beam.modes",
        "fidelity.sdof.modes",
        *(f"fidelity.sdof.{name}" for name in ("boundary", "frequency", "periods", "inner_product")),
    }


WRONG = [
    (TEXT + CLAMP.replace("N m/rad", "N/m"), "28: clamp.stiffness: '500 N/m' is a stiffness, not a rotational stiffness"),
    (TEXT + GRAVITY + "acceleration = -9.81\n", "29: gravity.acceleration: is negative: for the other way up write direction = \"standing\""),
    (TEXT + TORSION + 'shear_modulus = "80 GPa"\n', "30: torsion.poissons_ratio: shear_modulus says it already: keep one of the two"),
    (TEXT + TORSION.replace("poissons_ratio = 0.25\n", ""), "27: torsion.poissons_ratio: missing (or shear_modulus): write poissons_ratio = 0.3"),
    (TEXT + TORSION.replace("0.25", "0.6"), "30: torsion.poissons_ratio: 0.6 is above 0.5, where the volume grows under pressure"),
    (TEXT + TORSION.replace('"1 mm"', '"11 mm"'), "28: torsion.eccentricity: 0.011 m is beside the beam: beam.width is 0.02 m"),
    (TEXT.replace("elements = 36", 'massless = "yes"'), "9: beam.massless: must be true | false, not 'yes'"),
    (TEXT.replace("[stop]", "rigid_half_width = 1e-5\n[stop]"), "13: mass.rigid_half_width: 1e-05 m is below a thousandth of beam.length and changes nothing: leave it out"),
    (TEXT + PLATFORM.replace('frequency = "3.25 Hz"\n', ""), "27: platform.frequency: missing (or stiffness): write frequency = \"3.25 Hz\""),
    (TEXT + PLATFORM + "stiffness = 2000\n", "29: platform.frequency: platform.stiffness says it already: keep one of the two"),
    (TEXT + PLATFORM.replace('calibrated_at = "15.5 Hz"\n', ""), "27: platform.calibrated_at: missing (where the drive's motion holds): write calibrated_at = \"… Hz\""),
    (TEXT + SHAKER, "27: shaker: drives a platform: add [platform], or take [shaker] away"),
    (TEXT + 'coupling = "one-way"\n', "27: fidelity.sdof.coupling: unknown key; known here: "),
    (TEXT.replace("settle", 'output = "platform"\nsettle') + PLATFORM, "23: sweep.output: the platform has no motion of its own: add [platform] with coupling = \"two-way\""),
    (TEXT.replace("static_mode\"", "modal\"\nmodes = 3").replace("elements = 36", "massless = true"), "27: fidelity.sdof.modes: 3 are more than the model has: a massless beam's inertias give 1 at most"),
    (TEXT.replace("static_mode\"", "modal\"\nmodes = 145") + TORSION, "27: fidelity.sdof.modes: 145 are more than the model has: beam.elements gives 144 at most"),
    (FORCED, "19: drive.force: acts on the beam, or on a platform: write at = \"120 mm\", or add [platform]"),
    (FORCED + PLATFORM, "31: platform.calibrated_at: goes with a base motion alone: a force or a shaker says the drive already"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), WRONG, ids=[message[:40] for _, message in WRONG])
def test_what_effects_refuse(text, message):
    said = faults_of(text)
    assert len(said) == 1
    assert said[0].startswith(f"mine.toml:{message}"), said


def test_a_coil_with_inductance_is_one_way_only():
    text = SHAKEN + 'inductance = "1 mH"\n'
    assert parse(text).scene.shaker.inductance == 1e-3
    said = faults_of(text, {"platform.coupling": "two-way"})
    assert len(said) == 1
    assert "shaker.inductance: with two-way coupling the coil's current would be a state of its own" in said[0]


def test_a_shaker_needs_its_voltage_and_nothing_else():
    both = SHAKEN.replace('voltage = "0.6 V"', 'voltage = "0.6 V"\ngain = 5e-4')
    assert "drive.gain: the shaker's voltage says the drive already" in faults_of(both)[0]
    none = SHAKEN.replace('voltage = "0.6 V"\n', "")
    assert 'drive: the shaker needs its voltage: write voltage = "… V"' in faults_of(none)[0]


def test_a_buckled_column_is_a_fault_of_the_case_and_no_traceback():
    case = parse(TEXT + GRAVITY.replace("hanging", "standing"), set={"gravity.acceleration": 400})
    with pytest.raises(CaseError, match=r"fidelity\.sdof: gravity: the standing beam buckles"):
        run(case)


# the drive


def test_a_one_way_platform_filters_the_drive():
    omega = 2 * np.pi * np.array([7.6, 15.5])
    amplitude = ONE_WAY.amplitude(omega)
    assert amplitude[1] == pytest.approx(drive_amplitude(parse(TEXT).scene, omega), rel=1e-12)
    assert amplitude[1] / amplitude[0] == pytest.approx(0.2055, abs=5e-5)
    with pytest.raises(ValueError, match="depends on the frequency"):
        _ = ONE_WAY.base_amplitude


@pytest.mark.parametrize("key", ["sweep.frequency", "platform.calibrated_at"])
def test_a_platform_driven_at_its_own_frequency_needs_damping(key):
    value = [3.25] if key == "sweep.frequency" else 3.25
    with pytest.raises(CaseError, match="give it a damping_ratio"):
        run(parse(TEXT + PLATFORM, set={key: value}))
    run(parse(TEXT + PLATFORM, set={key: value, "platform.damping_ratio": 0.01}))


def test_a_force_and_a_voltage_on_the_platform():
    omega = 2 * np.pi * np.array([3.0, 15.5])
    stiffness = 5.0 * (2 * np.pi * 3.25) ** 2
    forced = parse(FORCED + PLATFORM.replace('calibrated_at = "15.5 Hz"\n', "")).amplitude(omega)
    np.testing.assert_allclose(forced, 5.0 / np.abs(stiffness - 5.0 * omega**2), rtol=1e-12)
    shaken = parse(SHAKEN)
    gain = PlatformFilter(5.0, 0.0, stiffness, 20.0, 4.0).base_per_input(omega)
    np.testing.assert_allclose(shaken.amplitude(omega), 0.6 * np.abs(gain), rtol=1e-12)
    two_way = parse(SHAKEN, set={"platform.coupling": "two-way"})
    np.testing.assert_allclose(two_way.amplitude(omega), 0.6 * 20 / 4 / (5.0 * omega**2), rtol=1e-12)


def test_one_amplitude_for_each_frequency():
    """The same numbers, bit by bit, as point after point by hand with the state carried; scalars are what they were."""
    made = ONE_WAY.system("sdof")
    omega = 2 * np.pi * np.array([14.5, 15.0, 15.5])
    amplitude = ONE_WAY.amplitude(omega)
    short = {"settle": 5, "hold": 5, "output": "sensor"}
    both = vibeam.sweep(made, omega=omega[[2, 0, 1]], amplitude=amplitude[[2, 0, 1]], direction="both", **short)
    state, found = None, []
    for w, a in zip([*omega, *omega[::-1]], [*amplitude, *amplitude[::-1]], strict=True):
        [(point, state)] = march(made, [w], a, state=state, slowest=omega[0], **short)
        found.append(point.amplitude[0])
    assert [*both.up.amplitude, *both.down.amplitude] == found
    each = vibeam.sweep(made, omega=omega, amplitude=np.full(3, 1e-4), **short)
    assert np.array_equal(each.amplitude, vibeam.sweep(made, omega=omega, amplitude=1e-4, **short).amplitude)
    assert not np.array_equal(each.amplitude, both.up.amplitude)


@pytest.mark.parametrize("amplitude", [[1e-4, 1e-4], [[1e-4]], [1e-4, np.nan, 1e-4]])
def test_amplitudes_that_fit_no_grid(amplitude):
    with pytest.raises(ValueError, match="amplitude"):
        vibeam.sweep(ONE_WAY.system("sdof"), omega=[90.0, 95.0, 100.0], amplitude=amplitude)


def test_a_platform_runs_and_resumes_to_the_same_bits(tmp_path):
    whole = run(ONE_WAY)["sdof"].up.amplitude
    assert np.all(np.isfinite(whole))
    out = tmp_path / "a.h5"

    def stop(done, total):
        if done >= 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(ONE_WAY, out, stop)
    assert np.array_equal(run(ONE_WAY, out)["sdof"].up.amplitude, whole)


# the two-way platform


def test_the_platform_is_one_more_mode_of_every_fidelity():
    case = parse(TEXT + PLATFORM, set=UNDAMPED)
    small = case.system("sdof")
    assert small.size == 2
    assert set(small.outputs) == {"sensor", "tip", "platform"}
    assert small.gap == 0.0
    natural = small.omega / (2 * np.pi)
    assert natural[0] == pytest.approx(3.25 * np.sqrt(5 / 5.2), rel=0.02)
    assert natural[1] > parse(TEXT).system("sdof").omega[0] / (2 * np.pi)


def test_the_platforms_own_motion_can_be_swept():
    """With C = D K of the platform too the damping is proportional: each mode's ζ/ω is the same."""
    natural = 2 * np.pi * 3.25
    first = assemble(parse(TEXT).scene).modes(1).omega[0]
    settings = {
        "beam.damping": "stiffness",
        "beam.damping_ratio": 0.02,
        "platform.damping_ratio": 0.02 * natural / first,
    }
    case = parse(TEXT + PLATFORM, set={"sweep.output": "platform", "platform.coupling": "two-way"} | settings)
    made = case.system("sdof")
    assert np.all(np.isfinite(run(case)["sdof"].up.amplitude))
    ratio = made.zeta / made.omega
    assert ratio[0] == pytest.approx(ratio[1], rel=1e-3)


def test_restitution_of_the_first_mode_stays_that_of_the_beam():
    settings = UNDAMPED | {"stop.restitution_of": "first mode"}
    still = parse(TEXT, set={"beam.damping_ratio": 0.0, "stop.restitution_of": "first mode"})
    for fidelity in (Fidelity("sdof", "static_mode"), Fidelity("three", "modal", 3)):
        moved = system(parse(TEXT + PLATFORM, set=settings).scene, fidelity)
        assert moved.restitution == system(still.scene, fidelity).restitution


def heavy_platform(mass):
    """Undamped, so that b = B sin Ωt for ever if it begins so; and the beam on that base, prescribed."""
    settings = {"stop.gap": "0.05 mm", "platform.mass": mass, "beam.damping_ratio": 0.0, "platform.coupling": "two-way"}
    scene = parse(TEXT + PLATFORM, set=settings).scene
    return scene, replace(scene.without("platform"), base=Base(amplitude=1e-4))


def test_a_heavy_platform_is_the_prescribed_base_through_impacts():
    """The first impacts from rest; b begins on its own steady motion, which differs by O(m/m_p) alone."""
    omega, mass = 95.0, 1e13
    scene, prescribed = heavy_platform(mass)
    three = Fidelity("three", "modal", 3)
    moved, still = system(scene, three), system(prescribed, three)
    stiffness = (2 * np.pi * 3.25) ** 2
    amplitude = 1e-4 * (stiffness - omega**2) / omega**2  # b₀ Ω² = (k/m_p − Ω²) B
    # The modal velocities in which the platform alone moves with BΩ, the beam at rest relative to it.
    rows = np.vstack([moved.contact, *(moved.outputs[name] for name in ("sensor", "tip", "platform"))])
    start = np.linalg.solve(rows, np.array([0.0, 0.0, 0.0, 1e-4 * omega]))
    path = vibeam.simulate(moved, vibeam.Drive(omega, amplitude), 0.6, vibeam.State(np.zeros(moved.size), start))
    other = vibeam.simulate(still, vibeam.Drive(omega, 1e-4), 0.6)
    assert len(path.impact_times) == len(other.impact_times) > 5
    np.testing.assert_allclose(path.impact_times, other.impact_times, rtol=1e-9)
    np.testing.assert_allclose(path.impact_velocities, other.impact_velocities, rtol=1e-8)


def test_two_way_without_loss_keeps_energy_over_a_thousand_impacts():
    settings = UNDAMPED | {"stop.restitution": 1.0}
    made = parse(TEXT + PLATFORM, set=settings).system("sdof")
    start = vibeam.State(np.zeros(2), np.array([0.01, 0.05]))
    path = vibeam.simulate(made, vibeam.Drive(0.0, 0.0), 1e4, start, max_impacts=1200)
    assert len(path.impact_times) >= 1000
    state = path.state
    energy = [np.sum(s.velocity**2 + (made.omega * s.displacement) ** 2) for s in (start, state)]
    assert energy[1] == pytest.approx(energy[0], rel=1e-9)
    before, after = path.velocity_at(path.impact_times[100] + np.array([-1e-7, 1e-7]), "platform")
    scene = parse(TEXT).scene
    shape = static_mode(assemble(scene)).structure
    riding = -float(shape.load[0] / shape.contact[0])  # ∫φ dm over φ at the contact: what changes its velocity by 2v
    jolt = 2 * path.impact_velocities[100] * riding / (5.0 + scene.moving_mass)
    assert after - before == pytest.approx(jolt, rel=1e-3)


def test_five_kilograms_under_the_rig():
    """They move the neutral peak from 15.3 to 15.5 Hz, and an impact jolts them by 4.8 mm/s."""
    rig = ROOT / "cases" / "dtu_neutral.toml"
    first = assemble(vibeam.load(rig).scene).modes(1).omega[0]
    short = {
        "units": "SI",
        "sweep.frequency": [15.1, 15.2, 15.3, 15.4, 15.5, 15.6, 15.7],
        "sweep.settle": 150,
        "sweep.direction": "down",
    }
    alone = {"beam.damping": "stiffness", "fidelity.two_modes": None, "fidelity.beam": None, "reference": {}}
    table = {"mass": 5, "frequency": 3.25, "coupling": "two-way", "calibrated_at": 15.5}
    table["damping_ratio"] = 0.017 * 2 * np.pi * 3.25 / first  # proportional as a whole
    still = run(vibeam.load(rig, set=short | alone))["sdof"].down
    moved_case = vibeam.load(rig, set=short | alone | {"platform": table})
    moved = run(moved_case)["sdof"].down
    peaks = [response.frequency[np.argmax(response.amplitude)] for response in (still, moved)]
    assert peaks == pytest.approx([15.3, 15.5], abs=0.01)
    system_there = moved_case.system("sdof")
    mobility = np.sum(system_there.contact**2)
    impulse = 1.72 * moved.impact_velocity[np.argmax(moved.amplitude)] / mobility
    assert impulse * abs(system_there.outputs["platform"] @ system_there.contact) == pytest.approx(4.8e-3, abs=0.05e-3)


# derive and modes


def test_derive_and_modes_take_every_effect():
    text = TEXT + CLAMP + TORSION + PLATFORM
    case = parse(text, set={"platform.coupling": "two-way"})
    names = {row.name for row in derive(case)}
    assert "gap" in names
    assert not names & {"drive", "gain"}
    still = parse(TEXT + CLAMP)
    assert derive(case)["stiffness"].reference == pytest.approx(derive(still)["stiffness"].reference, rel=1e-9)
    frequencies = [row.frequency for row in mode_table(case.scene, 3).rows]
    assert frequencies[0] == pytest.approx(mode_table(still.scene, 1).rows[0].frequency, rel=1e-9)
    massless = parse(TEXT, set={"beam.massless": True})
    assert abs(derive(massless)["frequency, massless beam"].error) < 1e-9
    assert len(mode_table(massless.scene).rows) == 1


def test_a_beam_that_twists_first_is_derived_from_its_bending():
    slow = parse(TEXT + TORSION, set={"torsion.polar_inertia": 1.0})
    assert mode_table(slow.scene, 1).rows[0].sensor == 0
    assert derive(slow)["stiffness"].reference == pytest.approx(derive(parse(TEXT))["stiffness"].reference, rel=1e-9)


def test_a_mode_of_torsion_has_a_shape_file_too(tmp_path):
    table = mode_table(parse(TEXT + TORSION).scene, 3)
    write_shapes(table, tmp_path / "a.vtu")
    shapes = list(meshio.read(tmp_path / "a.vtu").point_data.values())
    assert len(shapes) == 6
    assert np.isfinite(shapes).all()


ABSENT = """
import sys, numpy as np, vibeam
case = vibeam.load(sys.argv[1])
[case.system(name) for name in case.fidelities], case.amplitude(np.array([95.0]))
loaded = [name for name in sys.modules if name.startswith("vibeam_models.effects.")]
print(*sorted(name.split(".")[-1] for name in loaded))
"""


def loaded(path, text):
    path.write_text(text)
    places = os.pathsep.join(str(ROOT / part) for part in ("", "models", "reductions"))
    command = [sys.executable, "-c", ABSENT, str(path)]
    done = subprocess.run(command, env=os.environ | {"PYTHONPATH": places}, capture_output=True, text=True, check=True)
    return done.stdout.split()


def test_effects_that_a_case_does_not_name_are_not_imported(tmp_path):
    assert loaded(tmp_path / "a.toml", TEXT) == []
    assert loaded(tmp_path / "a.toml", TEXT + GRAVITY) == ["gravity"]
