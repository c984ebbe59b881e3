"""The table [drive]: what a case with each kind of drive holds, refuses and computes."""

# ruff: noqa: E501  (a message stays on its line)

import numpy as np
import pytest

from tests.vibeam.casefile.test_case_faults import RIG as TEXT
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam.figures.kinds import modal
from vibeam.runs.run import run
from vibeam.studies.derive import derive
from vibeam.studies.modes import mode_table
from vibeam_models.base import Base

VOLTAGE = 'voltage = "0.6 V"\ngain = 5e-4\n'
PLATFORM = '[platform]\nmass = "5 kg"\nfrequency = "3.25 Hz"\ndamping_ratio = 0.05\ncoupling = "one-way"\n'
AT = 'at = "120 mm"\n'


def driven(drive, more=""):
    return TEXT.replace(VOLTAGE, drive) + more


def faults_of(text, set=None):
    with pytest.raises(CaseError) as caught:
        parse(text, "mine.toml", set)
    return str(caught.value).splitlines()


@pytest.mark.parametrize(
    ("drive", "base"),
    [
        ('velocity = "10 mm/s"\n', Base(velocity=0.01)),
        ('acceleration = "0.02 m/s^2"\n', Base(acceleration=0.02)),
        ('acceleration = "0.1 g"\n', Base(acceleration=0.980665)),
        (f'force = "1 N"\n{AT}', Base(force=1.0, at=0.12)),
        (f'moment = "0.1 N m"\n{AT}', Base(moment=0.1, at=0.12)),
        (
            'acceleration = ["0.1 g", 0.5]\nfrequency = ["14 Hz", "17 Hz"]\n',
            Base(acceleration=(0.980665, 0.5), frequency=(14.0, 17.0)),
        ),
    ],
)
def test_the_drive_is_the_scene(drive, base):
    case = parse(driven(drive))
    assert case.scene.base == base
    assert parse(case.text).scene == case.scene


WRONG = [
    ('force = "1 N"\n', "", '19: drive.force: acts on the beam, or on a platform: write at = "120 mm", or add [platform]'),
    ('moment = "1 N m"\n', "", '19: drive.moment: acts on the beam: write at = "120 mm"'),
    (AT + VOLTAGE, "", '19: drive.at: is where a force or a moment acts on the beam: write force = "1 N", or take at away'),
    (f'force = "1 N"\nmoment = "1 N m"\n{AT}', "", "19: drive.force: the drive is said twice: keep force, or moment"),
    (f'velocity = "1 mm/s"\nforce = "1 N"\n{AT}', "", "19: drive.velocity: the drive is said twice: keep velocity, or force"),
    ('velocity = "1 mm/s"\nacceleration = "1 g"\n', "", "19: drive.velocity: the base motion is said twice: keep velocity, or acceleration"),
    (f'acceleration = "1 g"\n{VOLTAGE}', "", "19: drive.acceleration: the base motion is said twice: keep acceleration, or voltage and gain"),
    ('force = "1 N"\nat = "181 mm"\n', "", "20: drive.at: 0.181 m is beyond the tip: beam.length is 0.18 m"),
    (f'force = "1 N"\n{AT}', PLATFORM, "20: drive.at: is of a drive on the beam, and [platform] moves its base: take at, or it, away"),
    ('acceleration = "1 mm/s"\n', "", "19: drive.acceleration: '1 mm/s' is a speed, not an acceleration"),
    ('moment = "1 N"\nat = 0.1\n', "", "19: drive.moment: '1 N' is a force, not a moment"),
    ('amplitude = "0.1 g"\n', "", "19: drive.amplitude: '0.1 g' is a mass, not a length"),
    ("velocity = [0.1, 0.2]\n", "", '19: drive.velocity: a list needs its frequencies: write frequency = ["… Hz", …], one for each velocity'),
    ("velocity = 0.1\nfrequency = [1, 2]\n", "", "20: drive.frequency: is of a list of as many amplitudes, and there is none: take it away"),
    ("velocity = [0.1, 0.2, 0.3]\nfrequency = [14, 17]\n", "", "19: drive.velocity: 3 numbers for 2 frequencies"),
    ("velocity = [0.1, 0.2]\nfrequency = [14.5, 17]\n", "", "20: drive.frequency: the table is of 14.5 … 17 Hz, and the sweep has 14 Hz: lengthen the table"),
    ("velocity = [0.1, 0.2]\nfrequency = [14, 16]\n", "", "20: drive.frequency: the table is of 14 … 16 Hz, and the sweep has 17 Hz: lengthen the table"),
    ("velocity = [0.1, -0.2]\nfrequency = [14, 17]\n", "", "19: drive.velocity: number 2 of the list: -0.2 must be ≥ 0"),
    ("velocity = [0.1, 0.2]\nfrequency = [14, 17]\n", PLATFORM + "calibrated_at = 15\n", "19: drive.velocity: a base motion over frequency has the platform in it: take [platform] out, or give its force"),
]  # fmt: skip


@pytest.mark.parametrize(("drive", "more", "message"), WRONG, ids=[message[:40] for *_, message in WRONG])
def test_what_a_drive_refuses(drive, more, message):
    said = faults_of(driven(drive, more))
    assert f"mine.toml:{message}" in said
    assert len(said) == 1


@pytest.mark.parametrize(
    ("set", "message"),
    [
        ({"drive.force": 1.0}, "drive.at: a massless beam has no inertia there: take the place of a mass, or massless out"),
        ({"drive.moment": 1.0}, "drive.moment: turns a beam without mass: take beam.massless out, or write force"),
    ],
)  # fmt: skip
def test_a_massless_beam_refuses_what_it_cannot_carry(set, message):
    said = faults_of(driven(AT), set | {"beam.massless": True})
    assert len(said) == 1
    assert message in said[0]
    assert parse(driven('force = "1 N"\nat = "132 mm"\n'), set={"beam.massless": True}).system("sdof").size == 1


def test_a_velocity_and_an_acceleration_are_displacements_at_one_frequency():
    """The same base amplitude, B = V/Ω = A/Ω²: the same motion to the bit, through the whole run."""
    one = {"sweep.frequency": [15.0]}
    omega = 2 * np.pi * 15.0
    by = {
        name: run(parse(driven(f"{name} = {size!r}\n"), set=one))["sdof"].up.amplitude
        for name, size in {"velocity": 0.01, "acceleration": 0.5}.items()
    }
    for name, base in {"velocity": 0.01 / omega, "acceleration": 0.5 / omega**2}.items():
        assert by[name] == run(parse(driven(f"amplitude = {base!r}\n"), set=one))["sdof"].up.amplitude > 0


def test_a_table_of_two_equal_ends_is_a_constant():
    table = parse(driven("velocity = [0.01, 0.01]\nfrequency = [14, 17]\n"))
    constant = parse(driven("velocity = 0.01\n"))
    up, same = (run(case)["sdof"].up for case in (table, constant))
    np.testing.assert_allclose(up.amplitude, same.amplitude, rtol=1e-13)
    assert not np.allclose(up.amplitude, run(parse(TEXT))["sdof"].up.amplitude, rtol=1e-2)


def test_a_table_left_by_a_figure_says_so():
    case = parse(driven("velocity = [0.01, 0.01]\nfrequency = [14, 17]\n"))
    with pytest.raises(ValueError, match=r"drive: 13 Hz is outside its table"):
        case.amplitude(2 * np.pi * np.array([13.0]))


def test_a_force_without_impacts_is_the_sum_over_the_modes():
    """Σ φ(sensor) φ(at) F / (ω² − Ω² + 2iζωΩ), by mode shapes that the table of modes prints, not by the system's load."""
    case = parse(
        driven(f'force = "1 N"\n{AT}'), set={"stop.gap": 1.0, "sweep.settle": 2000, "fidelity.sdof.reduction": "full"}
    )
    found = run(case)["sdof"].up
    at = mode_table(parse(driven(f'force = "1 N"\n{AT}'), set={"sensor.position": 0.12}).scene, 72)
    table = mode_table(case.scene, 72)
    omega = np.array([row.frequency for row in table.rows])[:, None] * 2 * np.pi
    shapes = np.array([[row.sensor, other.sensor] for row, other in zip(table.rows, at.rows, strict=True)])
    drive = 2 * np.pi * found.frequency
    swing = (shapes[:, :1] * shapes[:, 1:] / (omega**2 - drive**2 + 2j * 0.017 * omega * drive)).sum(0)
    np.testing.assert_allclose(found.amplitude, np.abs(swing), rtol=1e-8)


def test_a_force_keeps_the_beam_pressed_by_gravity_at_its_place():
    """Weight across the beam does not hang on how it is driven."""
    gravity = '[gravity]\ndirection = "transverse"\n'
    moved, pushed = (parse(text + gravity).system("sdof") for text in (TEXT, driven(f'force = "1 N"\n{AT}')))
    np.testing.assert_array_equal(moved.static, pushed.static)
    assert moved.static[0] > 0


def test_studies_under_a_force():
    case = parse(driven(f'force = "1 N"\n{AT}'))
    names = [row.name for row in derive(case)]
    assert "drive" not in names
    assert derive(case)["base factor"] == derive(parse(TEXT))["base factor"]
    assert mode_table(case.scene, 1).load_unit == "kg^-½"
    assert modal._load(case.scene)[0] == "kg(-1/2)"
    assert [row.name for row in derive(parse(driven("velocity = 0.01\n")))] == names


def test_a_force_is_felt_where_it_acts():
    """A fidelity may move it; at the clamp's side it moves the beam less."""
    text = driven(
        f'force = "1 N"\n{AT}', '[fidelity.near]\nreduction = "static_mode"\nset = { "drive.at" = "60 mm" }\n'
    )
    result = run(parse(text))
    assert (result["near"].up.amplitude < result["sdof"].up.amplitude).all()


SDOF = """[sdof]
damping_ratio = 0.015
[stop]
gap = {gap}
restitution = 0.8
[drive]
{drive}
[sweep]
frequency = ["1.9 rad/s", "2 rad/s", "2.1 rad/s"]
settle = 400
hold = 10
[fidelity.flight]
"""
OTHERS = """[fidelity.orbit]
solver = "orbit"
[fidelity.mapping]
solver = "mapping"
[fidelity.direct]
solver = "direct"
options = { method = "DOP853", rtol = 1e-8, atol = 1e-11 }
"""


def test_a_single_degree_of_freedom_is_driven_by_one_acceleration():
    """Without impacts A/|1 − Ω² + 2iβΩ|, and with a table of velocity what the table says over Ω."""
    omega = np.array([1.9, 2.0, 2.1])
    resistance = np.abs(1 - omega**2 + 0.03j * omega)
    own = 'frequency = ["1 rad/s", "3 rad/s"]'
    for drive, force in (
        ("acceleration = 1e-3", 1e-3),
        (f"acceleration = [1e-3, 3e-3]\n{own}", 1e-3 * omega),
        (f"velocity = [1e-3, 3e-3]\n{own}", 1e-3 * omega**2),
        ("velocity = 1e-3", 1e-3 * omega),
    ):
        found = run(parse(SDOF.format(gap=1.0, drive=drive)))["flight"].up
        np.testing.assert_allclose(found.amplitude, force / resistance, rtol=1e-8)


def test_all_solvers_take_a_drive_that_depends_on_the_frequency():
    text = SDOF.format(gap=0.0, drive="acceleration = 2e-3") + OTHERS
    result = run(parse(text, set={"sweep.frequency": ["2 rad/s", "2.1 rad/s"], "sweep.direction": "up"}))
    for name, within in (("orbit", 1e-9), ("mapping", 1e-9), ("direct", 1e-5)):
        np.testing.assert_allclose(result[name].up.amplitude, result["flight"].up.amplitude, rtol=within)


@pytest.mark.parametrize(
    ("drive", "message"),
    [
        ("", "drive.amplitude: missing (of the base B, in the unit of the motion): write amplitude = 0.0005"),
        ("amplitude = 1\nvelocity = 1", "drive.amplitude: the base motion is said twice: keep amplitude, or velocity"),
        ("velocity = [1, 2]", "drive.velocity: a list needs its frequencies"),
        ("velocity = 1\nfrequency = ['1 rad/s', '3 rad/s']", "drive.frequency: is of a list of as many amplitudes"),
        ('velocity = "1 mm/s"', "drive.velocity: '1 mm/s' is a speed, not a plain number"),
    ],
)
def test_what_the_drive_of_a_single_degree_of_freedom_refuses(drive, message):
    assert message in "\n".join(faults_of(SDOF.format(gap=0.0, drive=drive)))


def test_all_solvers_take_a_force_on_the_beam():
    """Flight, closed-form orbits and one mode's mapping: the same curve under a force."""
    more = "".join(
        f'[fidelity.{name}]\nreduction = "static_mode"\nsolver = "{name}"\n' for name in ("orbit", "mapping")
    )
    result = run(parse(driven(f'force = "0.2 N"\n{AT}', more), set={"sweep.settle": 400}))
    for name in ("orbit", "mapping"):
        np.testing.assert_allclose(result[name].up.amplitude, result["sdof"].up.amplitude, rtol=1e-9)
    assert result["sdof"].up.impacts.sum() > 100
