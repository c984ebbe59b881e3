"""Conclusions of vibeam fit: points outside its family, other minima, and models that do not describe the points."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import vibeam
from vibeam.casefile.read import parse
from vibeam.exchange.curves.record import ReferenceCurve
from vibeam.studies.fit.estimate import best, settled
from vibeam.studies.fit.problem import NO_CONTACT, Problem
from vibeam.studies.fit.surface import Forward

CASES = Path(__file__).parents[3] / "cases"

MODES = """
[modes]
frequency = ["11.3 Hz", "61 Hz", "170 Hz"]
damping_ratio = 0.01928113421014574
modal_mass = "1 kg"
contact = [1.1, 0.7, -0.4]
sensor = [0.8, -0.5, 0.3]
base = [0.9, 0.4, 0.2]
[stop]
gap = "0 m"
restitution = 0.7
[drive]
amplitude = "0.15 mm"
[sweep]
frequency = { from = "20 Hz", to = "25 Hz", points = 41 }
direction = "up"
settle = 300
hold = 20
[fidelity.beam]
reduction = "full"
[fit.keys]
"stop.restitution" = [0.3, 0.95]
"stop.gap" = ["-0.3 mm", "0.3 mm"]
"drive.amplitude" = ["0.05 mm", "0.4 mm"]
"""

#: of another integrator, 1 % of noise: the first point has two impacts a period
TWO_IMPACTS = (
    np.array([20.5, *np.arange(21.5, 24.6, 0.2)]),
    2e-4 * np.array([
        1.773845, 1.201713, 1.249683, 1.376977, 1.468284, 1.540527, 1.604819, 1.661580, 1.682297, 1.650974, 1.617802,
        1.559890, 1.462902, 1.365395, 1.260738, 1.209909, 1.237275,
    ]),
    {"stop.restitution": 0.67013, "stop.gap": 7.8e-5, "drive.amplitude": 1.455e-4},
)  # fmt: skip

GAIN = '"drive.gain" = ["3e-4 1/V", "9e-4 1/V"]'

BEAM = {
    "fidelity.beam.modes": 3, "fit.references": '["laser"]',
    "fit.keys": f'{{{GAIN}, "stop.restitution" = [0.4, 0.95], "beam.damping_ratio" = [0.005, 0.04]}}',
}  # fmt: skip

TRUTH = {"drive.gain": 5.2e-4, "stop.restitution": 0.7, "beam.damping_ratio": 0.017}

SET = TRUTH | {"drive.gain": "5.2e-4 1/V"}

FREQUENCY = np.linspace(14.2, 16.8, 17)

NOISE = 1 + 0.01 * np.random.default_rng(1).standard_normal(len(FREQUENCY))


def beam(**changes):
    """The rig of the synthetic curve with three modes and three keys."""
    return vibeam.load(CASES / "synthetic/fit.toml", set=BEAM | changes)


def with_points(case, frequency, value, fidelity="beam"):
    curve = ReferenceCurve.of(frequency, value, uncertainty=0.01 * value)
    given = case.with_reference("laser", curve, fidelity).references["laser"]
    assert case.fit is not None
    return replace(case, references={"laser": given}, fit=replace(case.fit, references=("laser",)))


def amplitudes(case, law=None):
    """Stable motions with one impact a period; ``law``: restitution by the velocity of the motion itself."""
    system, found = case.system("beam"), []
    for frequency in FREQUENCY:
        omega = 2 * np.pi * frequency
        drive = vibeam.Drive(omega, float(np.ravel(case.amplitude_of("beam", np.array([omega])))[0]))
        own = system
        for _ in range(1 if law is None else 25):
            motion = next(each for each in vibeam.orbits(own, drive) if each.admissible and each.stable)
            own = system if law is None else replace(system, restitution=law(motion.velocity))
        found.append(motion.amplitude("sensor"))
    return NOISE * np.array(found)


@pytest.fixture(scope="module")
def right():
    """Points of the model itself, at its true keys."""
    return amplitudes(beam(**SET))


def held(study, truth):
    return {row.key: row.low <= truth[row.key] <= row.high for row in study.rows}


@pytest.mark.parametrize("start", ["its own", "the truth"])
def test_a_point_with_two_impacts_a_period_is_followed_and_named(start):
    frequency, value, truth = TWO_IMPACTS
    own = {key: f"{each} m" if each < 0.01 else each for key, each in truth.items()}
    study = vibeam.fit(with_points(parse(MODES, set=own if start == "the truth" else None), frequency, value))
    assert all(held(study, truth).values())
    restitution = study.rows[0]
    assert restitution.value == pytest.approx(0.670, abs=0.015)
    assert restitution.high - restitution.low < 0.03
    assert study.misfit < 20
    assert [point.motion for point in study.points] == ["2 impacts a period", *16 * ["harder impact"]]
    assert abs(study.points[0].residual) < 3
    told = " ".join(study.sentences)
    assert "17 points: 16 with harder impact, 1 with 2 impacts a period." in told


def test_no_contact_is_no_answer_where_contact_is_within_reach():
    """From a start in the basin of another minimum, where 19 of 21 points lose contact at χ² = 4395."""
    text = (CASES / "synthetic/fit.toml").read_text(encoding="utf-8")
    text = text[: text.index("[stop]")] + SWEEP
    value = 1e-6 * np.array([
        156.2153, 145.5889, 127.3633, 43.5337, 42.8837, 42.4190, 42.1618, 41.5365, 41.3490, 41.5039, 41.3533, 41.1365,
        40.6287, 40.1473, 40.0576, 40.3832, 40.3236, 39.4329, 39.2020, 39.7065, 39.3319,
    ])  # fmt: skip
    case = with_points(parse(text, set={"beam.damping_ratio": 0.0057}), np.linspace(14, 16.4, 21), value)
    study = vibeam.fit(case)
    assert study.misfit < 30
    damping = next(row for row in study.rows if row.key == "beam.damping_ratio")
    assert damping.low < 0.0121 < damping.high
    assert [point.motion for point in study.points][:4] == [*3 * ["harder impact"], "no contact"]


SWEEP = """
[stop]
gap = "0.05 mm"
restitution = 0.7
[sensor]
position = "100 mm"
[drive]
amplitude = "0.0491881976874320 mm"
[sweep]
frequency = { from = "14 Hz", to = "16.4 Hz", points = 41 }
direction = "up"
settle = 300
hold = 20
[fidelity.beam]
reduction = "modal"
modes = 4
[fit.keys]
"stop.restitution" = [0.4, 0.95]
"beam.damping_ratio" = [0.005, 0.04]
"stop.gap" = ["0.01 mm", "0.15 mm"]
"""


def test_a_minimum_without_contact_loses_against_one_with_unless_it_meets_the_points(right):
    problem = Problem.of(with_points(beam(**SET), FREQUENCY, right))
    touching = settled(problem, problem.start)
    lost = replace(touching, chosen=np.full(problem.count, NO_CONTACT), loss=touching.loss / 2, touches=False)
    assert best([replace(lost, misfit=1e4), touching]) is touching
    assert not best([replace(lost, misfit=1.0), touching]).touches


def test_the_model_itself_is_said_to_meet_the_points(right):
    study = vibeam.fit(with_points(beam(), FREQUENCY, right))
    assert all(held(study, TRUTH).values())
    assert study.sentences[0].startswith("Misfit: χ² = ")
    assert study.judgement.described
    assert not study.judgement.outliers


def test_a_restitution_that_falls_with_velocity_is_told_by_the_residuals():
    """R = 0.7 (v/50 mm/s)^−¼ fitted with a constant: a factor of two in v is a change of −0.11 in R."""
    value = amplitudes(beam(**SET), lambda velocity: 0.7 * (velocity / 0.05) ** -0.25)
    study = vibeam.fit(with_points(beam(), FREQUENCY, value / NOISE**0.8))
    (first, *_) = study.judgement.patterns
    assert first.name == "velocity"
    assert first.probability < 0.01
    assert np.log(2) * first.size == pytest.approx(-0.11, abs=0.04)
    assert "R changed by -0.1" in " ".join(study.sentences)


def test_one_mode_in_place_of_eight_is_said_not_to_describe_them():
    value = amplitudes(beam(**SET | {"fidelity.beam.modes": 8}))
    one = {"fidelity.one.reduction": "static_mode", "reference.laser.fidelity": "one"}
    study = vibeam.fit(with_points(beam(**one), FREQUENCY, value, "one"))
    assert study.sentences[0].startswith("This model does not describe these points: χ² = ")
    assert study.sentences[1].startswith("It would describe them with 8 modes in fidelity.one (χ² = ")
    assert all(np.isnan([row.low, row.high]).all() for row in study.rows)


def test_the_other_convention_of_the_gap_is_named():
    """The case's gap is held at the sensor, the points were made with it at the contact."""
    gap = {"stop.gap": "0.06 mm"}
    value = amplitudes(beam(**SET | gap | {"stop.gap_at": "contact"}))
    study = vibeam.fit(with_points(beam(**gap), FREQUENCY, value))
    assert study.sentences[0].startswith("This model does not describe these points: χ² = ")
    assert study.sentences[1].startswith('It would describe them with stop.gap_at = "contact" (χ² = ')
    assert "Intervals are withheld" in study.sentences[2]


def test_an_outlier_is_named_and_the_others_give_the_keys(right):
    value = right.copy()
    value[6] *= 1.1
    study = vibeam.fit(with_points(beam(), FREQUENCY, value))
    assert [each.index for each in study.judgement.outliers] == [6]
    assert all(held(study, TRUTH).values())
    told = "The point at 15.175 Hz contradicts all others and is left out: it is "
    assert any(line.startswith(told) and "above what they say" in line for line in study.sentences)
    assert study.points[6].left_out == "contradicts the other points"


@pytest.mark.parametrize(("factor", "how"), [(1e3, "1000 times too large"), (1e-3, "1000 times too small")])
def test_a_wrong_unit_is_named(right, factor, how):
    study = vibeam.fit(with_points(beam(), FREQUENCY, factor * right))
    assert study.sentences[0].startswith("This model does not describe these points: χ² = ")
    assert study.sentences[1].startswith(f"The values of laser look {how}")


def test_surfaces_are_the_model_and_its_slopes():
    """Two keys of the structure, one of the stop: modal data at a point that no surface was fitted to."""
    keys = '{"beam.thickness" = ["1.02 mm", "1.05 mm"], "mass.position" = ["130 mm", "133 mm"], '
    keys += '"stop.gap" = ["0 mm", "0.1 mm"]}'
    problem = Problem.of(with_points(beam(**{"fit.keys": keys}), FREQUENCY, np.full(len(FREQUENCY), 3e-4)))
    problem = problem.within(np.full(3, 0.3), np.full(3, 0.7), 1e-9)
    x, step = np.array([0.41, 0.63, 0.37]), 1e-3
    surface, forward = problem.surfaces["beam"], problem.forward["beam"]
    data, tangents = surface.with_tangents(x)
    exact = forward.data(problem.values(x), problem.omega_of("beam"))
    assert data.omega == pytest.approx(exact.omega, rel=1e-9)
    assert abs(data.gap) == pytest.approx(abs(exact.gap), rel=1e-9)
    for k in range(3):
        ends = [forward.data(problem.values(x + way * step * np.eye(3)[k]), data.drive) for way in (1, -1)]
        slope = (ends[0].omega - ends[1].omega) / (2 * step)
        assert tangents.omega[k] == pytest.approx(slope, rel=1e-4, abs=1e-6 * data.omega.max())


def test_a_key_of_finite_elements_makes_few_structures(right, monkeypatch):
    """The structure is made for a surface and to confirm it, not for each step of each minimisation."""
    made, data = [0], Forward.data

    def counted(self, values, omega):
        made[0] += 1
        return data(self, values, omega)

    monkeypatch.setattr(Forward, "data", counted)
    keys = f'{{{GAIN}, "stop.restitution" = [0.4, 0.95], "beam.thickness" = ["1 mm", "1.06 mm"]}}'
    study = vibeam.fit(with_points(beam(**{"fit.keys": keys}), FREQUENCY, right))
    assert study.judgement.described
    assert made[0] < 300
