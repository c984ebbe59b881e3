"""vibeam fit where motions have no closed form: stops that yield, on both sides, several impacts a period."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import vibeam
from vibeam.casefile.read import parse
from vibeam.exchange.curves.record import ReferenceCurve
from vibeam.studies.fit.estimate import Minimum, minimise, settled
from vibeam.studies.fit.explanation import explained
from vibeam.studies.fit.flights import FlyingModel, OrbitModel
from vibeam.studies.fit.judgement import Judgement
from vibeam.studies.fit.orbits import OtherMotion, Shooting, differentiate
from vibeam.studies.fit.problem import FOLLOWED, Problem
from vibeam.studies.fit.profile import LEVEL
from vibeam.studies.fit.trails import LONG, settled_points
from vibeam.studies.fit.words import on_misfit

CASES = Path(__file__).parents[3] / "cases"

RIG = """
[modes]
frequency = ["11.3 Hz", "61 Hz", "170 Hz"]
damping_ratio = 0.02
modal_mass = "1 kg"
contact = [1.1, 0.7, -0.4]
sensor = [0.8, -0.5, 0.3]
base = [0.9, 0.4, 0.2]
[stop]
gap = "0.1 mm"
{stop}
[drive]
amplitude = "0.15 mm"
[sweep]
frequency = {{ from = "{first} Hz", to = "{last} Hz", points = {points} }}
direction = "up"
settle = 300
hold = 32
[fidelity.beam]
reduction = "full"
[fit.keys]
{keys}
"""

LINEAR = 'law = "linear"\nstiffness = "2e4 N/m"\ndamping = "20 N s/m"'

LINEAR_KEYS = """
"stop.stiffness" = ["5e3 N/m", "8e4 N/m"]
"stop.gap" = ["-0.1 mm", "0.3 mm"]
"drive.amplitude" = ["0.05 mm", "0.4 mm"]
"""

BOTH_SIDES = LINEAR + '\nsecond_gap = "0.3 mm"'

HUNT = 'law = "hunt-crossley"\nhertz_stiffness = 2e6\nrestitution = 0.8\nvelocity = "0.02 m/s"'


def rig(stop=LINEAR, keys=LINEAR_KEYS, first=10.0, last=16.0, points=13, **changes):
    """A rig of three modes."""
    return parse(RIG.format(stop=stop, keys=keys, first=first, last=last, points=points), set=changes)


def measured(case, truth, noise=0.01, seed=1, direction="up"):
    """The case with points of a sweep at the keys ``truth``, by the flight solver, and noise."""
    own = case.with_keys(truth)
    omega = 2 * np.pi * case.sweep.frequency
    amplitude = np.broadcast_to(own.amplitude_of("beam", omega), omega.shape)
    flown = vibeam.sweep(
        own.system("beam"), omega=omega, amplitude=amplitude, settle=400, hold=32, direction=direction, output="sensor"
    )
    value = flown.amplitude * (1 + noise * np.random.default_rng(seed).standard_normal(len(omega)))
    curve = ReferenceCurve.of(flown.frequency, value, uncertainty=(noise or 0.01) * flown.amplitude)
    given = case.with_reference("lab", curve, "beam")
    return replace(given, fit=replace(case.fit, references=("lab",))), flown


TRUTH = {"stop.stiffness": "1.5e4 N/m", "stop.gap": "0.08 mm", "drive.amplitude": "0.17 mm"}

VALUES = np.array([1.5e4, 8e-5, 1.7e-4])


def test_a_linear_stop_is_fitted_and_its_keys_lie_in_the_intervals():
    """The committed curve of twelve modes, by eight: keys that make_linear_stop.py made it with."""
    study = vibeam.fit(CASES / "synthetic/linear_stop.toml")
    assert study.judgement.described
    assert {point.motion for point in study.points} == {"1 impact a period"}
    assert not any(point.left_out for point in study.points)
    for row, value in zip(study.rows, (2e4, 5e-5, 6e-4), strict=True):
        assert row.low < value < row.high
        assert row.high - row.low < 0.05 * value


@pytest.mark.parametrize(
    ("stop", "first", "last", "kinds"),
    [
        (BOTH_SIDES, 10.0, 16.0, {"1 impact a period", "2 impacts a period"}),
        (HUNT, 10.0, 16.0, {"1 impact a period"}),
        (
            'restitution = 0.5\nsecond_gap = "0.3 mm"',
            6.0,
            8.3,
            {"no contact", "1 impact a period", "2 impacts a period"},
        ),
    ],
    ids=["linear, both sides", "Hunt-Crossley", "rigid, both sides"],
)
def test_exact_points_give_the_keys_that_made_them(stop, first, last, kinds):
    """Without noise: to 1e-4, what the flown points have settled to within 400 periods."""
    keys, truth = LINEAR_KEYS.split("\n", 2)[2], {key: TRUTH[key] for key in ("stop.gap", "drive.amplitude")}
    case, flown = measured(rig(stop, keys, first, last, points=7), truth, noise=0.0)
    problem = Problem.of(case)
    true = (VALUES[1:] - problem.low) / problem.width
    found = settled(problem, true + np.array([0.002, -0.002]), nearby=True)
    assert (found.chosen >= FOLLOWED).all()
    assert kinds <= {problem.called(each) for each in found.chosen.tolist()}
    assert (flown.period != 0).all()
    assert problem.values(found.x) == pytest.approx(VALUES[1:], rel=1e-4)


@pytest.mark.parametrize("stop", [LINEAR, BOTH_SIDES], ids=["one side", "both sides"])
def test_derivatives_are_those_of_converged_orbits(stop):
    """Against central differences of motions that are shot anew, in steps whose error falls with their square."""
    case, _ = measured(rig(stop, points=5), TRUTH)
    problem = Problem.of(case)
    x = problem.start
    found = settled(problem, x, nearby=True)
    x, chosen = found.x, found.chosen
    assert (chosen >= FOLLOWED).all()
    _, by = problem.predicted(x, chosen)
    off = []
    for step in (2e-3, 1e-3):
        slopes = np.array(
            [
                (problem.predicted(x + row, chosen)[0][0] - problem.predicted(x - row, chosen)[0][0]) / (2 * step)
                for row in step * np.eye(3)
            ]
        )
        off.append(np.abs(slopes - by[:, 0]).max() / np.abs(by[:, 0]).max())
    assert off[1] < 1e-4
    assert off[0] / off[1] == pytest.approx(4, rel=0.2)


WIDE = {"stop.gap": "1 mm", "drive.amplitude": "0.17 mm"}

WIDE_KEYS = '"stop.gap" = ["0.5 mm", "1.5 mm"]\n"drive.amplitude" = ["0.05 mm", "0.4 mm"]'


def test_a_motion_that_is_followed_beyond_its_fold_is_lost_and_told():
    """Contact beside none: a smaller drive ends the former in a fold, and the latter is not taken for it."""
    case, _ = measured(rig(keys=WIDE_KEYS, first=12.0, last=13.5, points=4, **WIDE), WIDE)
    problem = Problem.of(case)
    found = settled(problem, problem.start, nearby=True)
    assert [problem.called(each) for each in found.chosen.tolist()] == 4 * ["1 impact a period"]
    trail, near = problem.trails.every[int(found.chosen[-1]) - FOLLOWED], found.x
    small = near - [0.0, 0.25]
    with pytest.raises(vibeam.NoOrbit, match="lost"):
        trail.at(small)
    value, _ = problem.predicted(small, found.chosen)
    assert np.isfinite(value).all()  # as the tangent goes on
    lost = Minimum.at(problem, small, found.chosen, explained(problem, small))
    assert not lost.actual[-1]
    assert "it has ended" in " ".join(on_misfit(problem, lost, Judgement(False, [])))


@pytest.mark.parametrize("direction", ["up", "down"])
def test_points_of_either_of_two_motions_are_told_apart(direction):
    """Contact and none side by side at 12.5 … 14 Hz: a sweep up measures one, a sweep down the other."""
    case, flown = measured(rig(keys=WIDE_KEYS, first=12.0, last=14.0, points=5, **WIDE), WIDE, direction=direction)
    problem = Problem.of(case)
    found = settled(problem, problem.start, nearby=True)
    told = [problem.called(each) for each in found.chosen.tolist()]
    assert told == ["no contact" if each == 0 else "1 impact a period" for each in flown.impacts_per_period]
    assert ("no contact" in told) == (direction == "down")
    assert found.actual.all()


@pytest.mark.slow
def test_intervals_of_a_linear_stop_hold_the_truth():
    """Twenty sets of noise, three keys: the likelihood ratio at the truth is below the 95 % level in most (≥ 16)."""
    inside = np.zeros(3)
    for seed in range(20):
        case, _ = measured(rig(), TRUTH, seed=seed)
        problem = Problem.of(case)
        truth = (VALUES - problem.low) / problem.width
        found = settled(problem, truth, nearby=True)
        least = [minimise(problem, found.x, found.chosen, {k: float(truth[k])})[1] for k in range(3)]
        inside += [each - found.misfit < LEVEL for each in least]
    assert (inside >= 16).all()


def test_a_side_that_cannot_be_flown_leaves_the_derivatives_of_all_points(monkeypatch):
    """Flights with a larger gap fail at one point: one side serves it, both do the other; neither side: told."""
    case, _ = measured(rig(points=3), TRUTH)
    problem = Problem.of(case)
    found = settled(problem, problem.start, nearby=True)
    orbits = [problem.trails.every[int(each) - FOLLOWED].at(found.x) for each in found.chosen[:2]]
    differentiate(orbits)
    usual, failing, fly = [each.by for each in orbits], [1], FlyingModel.over
    gap = [each.key for each in problem.keys].index("stop.gap")

    def over(self, omega, *given):
        read, after = fly(self, omega, *given)
        here = orbits[0].made.system.gap
        if self.system.gap * failing[0] > here * failing[0] or (not failing[0] and self.system.gap != here):
            fails = omega == orbits[1].shooting.omega
            after[fails] = np.nan
            read.amplitude[fails] = np.nan
        return read, after

    monkeypatch.setattr(FlyingModel, "over", over)
    for failing[0] in (1, -1, 0):
        again = [replace(each, by=None, state_by=None) for each in orbits]
        differentiate(again)
        assert again[0].by == pytest.approx(usual[0], rel=1e-12)
        if failing[0]:
            assert again[1].by == pytest.approx(usual[1], rel=1e-3)  # one-sided: to first order in 3e-5
            assert again[1].differentiable
        else:
            assert np.isnan(again[1].by[gap])
            assert not again[1].differentiable


def test_signs_of_modes_are_no_matter():
    """A model whose modes are turned over beside the others: the same motion, rows and derivatives."""
    case, _ = measured(rig(points=3), TRUTH)
    problem = Problem.of(case)
    found = settled(problem, problem.start, nearby=True)
    orbit = problem.trails.every[int(found.chosen[1]) - FOLLOWED].at(found.x)
    turned = np.array([-1.0, 1.0, -1.0])
    model = OrbitModel(problem.forward["beam"], orbit.shooting.model.slowest)
    own = case.system("beam")
    outputs = {name: turned * row for name, row in own.outputs.items()}
    model.like = replace(own, contact=turned * own.contact, load=turned * own.load, outputs=outputs)
    again = replace(orbit.shooting, model=model).orbit(found.x, np.tile(turned, 2) * orbit.state, orbit)
    differentiate([orbit, again])
    assert again.state * np.tile(turned, 2) == pytest.approx(orbit.state, rel=1e-9, abs=1e-12)
    assert again.by == pytest.approx(orbit.by, rel=1e-5)


FILTER = {
    "measurement.low_pass": "bessel", "measurement.order": 4, "measurement.cut_off": "60 Hz",
    "measurement.sampling": "5 kHz",
}  # fmt: skip


@pytest.mark.parametrize("changes", [{}, FILTER], ids=["unfiltered", "behind a filter"])
def test_shot_motions_have_the_values_and_derivatives_of_the_closed_form(changes):
    """A rigid stop, one impact a period: values as a flight's extremes are read, derivatives as differences are."""
    case, _ = measured(rig("restitution = 0.7", LINEAR_KEYS.split("\n", 2)[2], 21.4, 24.0, points=3), {})
    problem = Problem.of(replace(case, chain=rig(**changes).chain) if changes else case)
    value, by = problem.predicted(problem.start, np.zeros(3, dtype=int), problem.exact(problem.start))
    (group,), model = problem.groups, problem.trails.model(problem.forward["beam"], problem.omega_of("beam"))
    assert (group.gain is not None) == bool(changes)
    made, like = model.at(problem.start), OtherMotion(1, 1, 0.0, False, 0.0, 0.0)
    for each in settled_points(group, made, np.array([1]), LONG):
        orbit = Shooting(model, group, float(group.omega[each.place]), each.place).settled(
            problem.start, each.state, like
        )
        differentiate([orbit])
        assert orbit.value == pytest.approx(value[0, 1], rel=1e-6 if changes else 1e-8)
        scale = np.abs(by[:, 0, 1]).max()
        assert orbit.by == pytest.approx(by[:, 0, 1], rel=0.0, abs=(1e-4 if changes else 1e-6) * scale)
