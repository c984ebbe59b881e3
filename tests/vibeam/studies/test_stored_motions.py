"""Motions at stored points: of solvers that step, and of several harmonics, against exact flight and closed form."""

import numpy as np
import pytest

import vibeam
from vibeam.studies.stored import stored
from vibeam.studies.stored_motions import FLOWN, StoredMotions

CASE = """
[beam]
length = "180 mm"
width = "20 mm"
thickness = "3 mm"
youngs_modulus = "210 GPa"
density = "7850 kg/m^3"
damping_ratio = 0.02
elements = 8
[mass]
mass = "0.2 kg"
position = "132 mm"
[stop]
gap = "GAP"
restitution = 0.7
[sensor]
position = "100 mm"
[drive]
amplitude = "0.02 mm"
[sweep]
frequency = ["45 Hz"]
direction = "up"
settle = 40
hold = 4
"""

STEPPED = """
[fidelity.flown]
reduction = "modal"
modes = 2
[fidelity.moreau]
reduction = "modal"
modes = 2
solver = "moreau"
"""

DIRECT = """
[fidelity.stepped]
reduction = "modal"
modes = 2
solver = "direct"
options = { rtol = 1e-6, atol = 1e-11 }
"""

HARMONIC = """
[fidelity.two]
reduction = "modal"
modes = 2
set = { "drive.harmonic" = [2], "drive.harmonic_share" = ["50 %"], "drive.harmonic_phase" = ["30 deg"] }
[fidelity.stepped]
reduction = "modal"
modes = 2
solver = "moreau"
set = { "drive.harmonic" = [2], "drive.harmonic_share" = ["50 %"], "drive.harmonic_phase" = ["30 deg"] }
"""


def _motions(folder, text, frequency):
    file = folder / "case.toml"
    file.write_text(text, encoding="utf-8")
    vibeam.run(vibeam.load(file), out=folder / "case.h5")
    found = stored(folder / "case.h5")
    return found, {each.fidelity: each for each in StoredMotions(found, np.array([frequency]))}


@pytest.fixture(scope="module")
def struck(tmp_path_factory):
    """A motion with one impact a period."""
    return _motions(tmp_path_factory.mktemp("stepped"), CASE.replace("GAP", "0.02 mm") + STEPPED, 45.0)[1]


@pytest.fixture(scope="module")
def direct(tmp_path_factory, struck):
    """The same by a solver of differential equations."""
    folder = tmp_path_factory.mktemp("direct")
    return struck | _motions(folder, CASE.replace("GAP", "0.02 mm") + DIRECT, 45.0)[1]


@pytest.fixture(scope="module")
def free(tmp_path_factory):
    """A motion without contact under two harmonics."""
    return _motions(
        tmp_path_factory.mktemp("harmonic"), CASE.replace("GAP", "10 mm").replace("0.02\n", "0.06\n") + HARMONIC, 45.0
    )


@pytest.mark.slow
def test_a_motion_of_differential_equations_is_the_exact_one_at_its_samples(direct):
    _compare(direct["flown"], direct["stepped"], 1e-3)


def test_a_motion_of_time_steps_is_the_exact_one_at_its_samples(struck):
    _compare(struck["flown"], struck["moreau"], 2e-2)


def _compare(exact, found, within):
    assert (exact.fault, found.fault) == ("", "")
    assert found.window == exact.window
    size, speed = np.ptp(exact.displacement), np.ptp(exact.velocity)
    assert np.interp(exact.time, found.time, found.displacement) == pytest.approx(
        exact.displacement, abs=size * max(within, 3e-3)
    )  # between its points, linear
    assert len(found.impacts) == len(exact.impacts) >= 1
    assert found.impacts[:, 1] == pytest.approx(exact.impacts[:, 1], rel=within)
    assert found.impacts[:, 0] == pytest.approx(exact.impacts[:, 0], abs=within)
    assert found.section.shape == exact.section.shape == (FLOWN, 2)
    assert found.section[:, 0] == pytest.approx(exact.section[:, 0], abs=size * within)
    assert found.section[:, 1] == pytest.approx(exact.section[:, 1], abs=speed * within)
    assert found.lines[:: FLOWN][:4] == pytest.approx(exact.lines[:: FLOWN][:4], abs=size * within)  # fmt: skip
    assert found.shares == pytest.approx(exact.shares, abs=max(within, 1e-3))
    assert found.deflection == pytest.approx(exact.deflection, abs=np.ptp(exact.deflection) * within)


@pytest.mark.slow
def test_an_impact_between_steps_has_both_its_sides(direct):
    found = direct["stepped"]
    jumps = np.flatnonzero(np.diff(found.time) == 0)
    assert found.time[jumps] == pytest.approx(found.impacts[:, 0])
    assert (found.velocity[jumps + 1] < found.velocity[jumps]).all()


@pytest.mark.parametrize(("name", "within"), [("two", 1e-4), ("stepped", 1e-2)])
def test_lines_of_a_drive_of_two_harmonics_are_those_of_the_linear_response(free, name, within):
    """Without contact: |Σ o f a/(ω² − ν² + 2iζων)| at each harmonic, and nothing between them."""
    results, motions = free
    found, case = motions[name], results.result.case
    assert found.fault == ""
    system, omega = case.system(name), 2 * np.pi * 45.0
    acceleration = omega**2 * float(np.ravel(case.amplitude_of(name, np.array([omega])))[0])
    for order, share in ((1, 1.0), (2, 0.5)):
        nu = order * omega
        modes = system.load * share * acceleration / (system.omega**2 - nu**2 + 2j * system.zeta * system.omega * nu)
        height = abs(system.output("sensor") @ modes)
        assert found.lines[order * FLOWN] == pytest.approx(height, rel=within)
    assert found.lines[3 * FLOWN] < within * found.lines[FLOWN]
    assert found.shares.shape == (2,)
    assert found.shares.sum() == pytest.approx(1)
    response = results.result[name].up
    assert np.ptp(found.displacement) / 2 == pytest.approx(response.amplitude[0], rel=1e-3)
