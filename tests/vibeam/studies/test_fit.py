"""vibeam fit: truth of synthetic data, of another program's data, what is not determined, and refusals."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bounded import Bound
from scipy.integrate import solve_ivp

import vibeam
from vibeam.exchange.curves.record import ReferenceCurve
from vibeam.report.fit import fit_answer
from vibeam.studies.fit.estimate import minimise, settled
from vibeam.studies.fit.judgement import Judgement, patterns
from vibeam.studies.fit.problem import MOTIONS, Problem
from vibeam.studies.fit.profile import LEVEL, profile
from vibeam.studies.fit.words import on_misfit

CASES = Path(__file__).parents[3] / "cases"

TWO = {"fit.keys": '{"drive.gain" = ["3e-4 1/V", "9e-4 1/V"], "stop.restitution" = [0.5, 0.9]}'}

LASER = {"drive.gain": 5.16e-4, "stop.restitution": 0.70}  # make_laser.py


def _neutral(**changes):
    """The neutral rig's single degree of freedom, to be fitted to a curve of its own."""
    return vibeam.load(CASES / "dtu_neutral.toml", set=TWO | {"fit.references": '["exact"]'} | changes)


def _with(case, frequency, value, **more):
    curve = ReferenceCurve.of(frequency, value, **more)
    given = case.with_reference("exact", curve, "sdof").references["exact"]
    return replace(case, references={"exact": given})


def test_the_truth_of_the_synthetic_curve_lies_in_the_intervals():
    """The flight solver made the curve, eight modes and noise; the closed forms find its keys."""
    known = {"beam.thickness": "1.02883 mm", "beam.damping_ratio": 0.017}
    problem = Problem.of(vibeam.load(CASES / "synthetic/fit.toml", set=TWO | known))
    found = settled(problem, problem.start)
    assert found.actual.all()
    assert np.abs(found.residual).max() < 4
    for k, key in enumerate(problem.keys):
        interval = profile(problem, found, k)
        low, high = (key.low + share * (key.high - key.low) for share in (interval.low, interval.high))
        assert low < LASER[key.key] < high
        assert high - low < 0.03 * LASER[key.key]
        assert interval.open == (-1, -1)  # the data end it


def test_an_independent_integration_is_met_without_residual():
    """Reference of 30 digits by Taylor series: gain and restitution that it was made with, to 1e-6."""
    case = vibeam.load(CASES / "dtu_neutral.toml")
    file = next(each.file for each in case.references.values() if each.fidelity == "sdof")
    points = vibeam.read_curve(file, "amplitude").along(("up",))
    kept = [each for each in points if each.period == 1 and each.value][::8]
    frequency, value = np.array([each.frequency for each in kept]), np.array([each.value for each in kept])
    problem = Problem.of(_with(_neutral(), frequency, value, uncertainty=1e-5 * value))
    found = settled(problem, problem.start)
    assert problem.values(found.x) == pytest.approx([5.16e-4, 0.72], rel=1e-6)
    assert found.actual.all()
    assert not any(each.significant for each in patterns(problem, found))  # of what is far within the uncertainty
    told = list(on_misfit(problem, replace(found, x=np.array([1.0, 0.5])), Judgement(False, [])))
    assert "drive.gain is at a bound of [fit.keys]: widen it." in told
    assert not any("stop.restitution is at a bound" in each for each in told)


def test_a_peak_alone_fixes_the_ridge_and_no_point_on_it():
    """One point near the resonance: gain and restitution are not determined, and the sentence says what is."""
    study = vibeam.fit(_with(_neutral(), [15.2], [3.9e-4], uncertainty=[2e-6]))
    assert not any(row.determined for row in study.rows)
    told = " ".join(study.sentences)
    assert "drive.gain and stop.restitution are not separated" in told
    shared = re.search(r"drive\.gain/\(ζ₁ − ln R₁/π\) = ([0-9.]+)", told)
    assert shared is not None
    assert float(shared[1]) == pytest.approx(42.4e-4, rel=0.05)  # of the paper's refits
    one, other = study.rows
    assert "drive.gain alone is free between 0.0003 1/V by its bound and " in told
    rows = (
        replace(one, value=6e-4, low=5e-4, low_bound="", high_bound="drive.gain = 0.0009 1/V"),
        replace(other, value=0.7, low=0.69, high=0.71, low_bound="", high_bound=""),
    )
    told = fit_answer(replace(study, rows=rows))
    assert told.startswith(
        "drive.gain 0.0006 1/V (0.0005 1/V to 0.0009 1/V by its bound) and stop.restitution 0.7 (± 0.01)"
    )
    lone = fit_answer(replace(study, rows=(one, rows[1]), shared=()))
    assert lone.startswith("The 1 point does not determine drive.gain within the bounds; --next")


def test_derivatives_of_the_residuals_are_those_of_the_model():
    """By every key, one of the structure among them, against differences of the whole model."""
    keys = '{"drive.gain" = ["3e-4 1/V", "9e-4 1/V"], "stop.restitution" = [0.5, 0.9], '
    keys += '"stop.gap" = ["-0.1 mm", "0.1 mm"], "mass.mass" = ["0.18 kg", "0.22 kg"]}'
    case = _neutral(**{"fit.keys": keys})
    frequency = np.linspace(14.5, 16.5, 9)
    problem = Problem.of(_with(case, frequency, np.full(9, 3e-4), uncertainty=3e-6))
    x, chosen = np.array([0.4, 0.5, 0.45, 0.5]), np.zeros(9, dtype=int)
    _, jacobian = problem.residuals(x, chosen)
    for k, step in enumerate(1e-4 * np.eye(4)):
        ahead, back, further, behind = (
            problem.residuals(x + share * step, chosen)[0] for share in (1, -1, 2, -2)
        )  # fmt: skip
        slope = (8 * (ahead - back) - (further - behind)) / 12e-4
        assert jacobian[:, k] == pytest.approx(slope, rel=1e-6, abs=1e-6 * np.abs(slope).max())


def test_a_controlled_reference_finds_the_unstable_branch():
    """Points of the softer impact of a tight stop: taken where they were controlled, else told to be no motion."""
    case = vibeam.load(CASES / "dtu_tight.toml", set=TWO | {"fit.references": '["exact"]'})
    system, grid = case.system("sdof"), np.linspace(15.7, 17.5, 37)
    amplitude = float(np.ravel(case.amplitude(2 * np.pi * grid))[0])
    both = [(f, vibeam.orbits(system, vibeam.Drive(2 * np.pi * f, amplitude))) for f in grid]
    kept = [(f, each[1]) for f, each in both if len(each) == 2 and each[1].admissible and not each[1].stable]
    assert len(kept) > 3
    frequency, value = np.array([f for f, _ in kept]), np.array([each.amplitude("sensor") for _, each in kept])
    given = _with(case, frequency, value, uncertainty=0.01 * value)
    assert given.fit is not None
    controlled = replace(given, fit=replace(given.fit, unstable=("exact",)))
    problem = Problem.of(controlled)
    found = settled(problem, problem.start)
    assert (found.chosen == 1).all()
    assert found.misfit < 1e-6
    assert not settled(Problem.of(given), problem.start).actual.all()


@pytest.mark.parametrize("start", [(0.2, 0.5), (0.25, 0.55), (0.3, 0.3)])
def test_points_of_both_branches_are_told_apart_from_starts_whose_fold_lies_beyond_them(start):
    """Where neither branch exists at the start a point of the lower one is not left with the upper one."""
    case = vibeam.load(CASES / "dtu_tight.toml", set=TWO | {"fit.references": '["exact"]'})
    system, grid = case.system("sdof"), np.linspace(16.3, 17.3, 6)
    amplitude = float(np.ravel(case.amplitude(2 * np.pi * grid))[0])
    found = [(f, each) for f in grid for each in vibeam.orbits(system, vibeam.Drive(2 * np.pi * f, amplitude))]
    frequency, value = np.array([(f, each.amplitude("sensor")) for f, each in found]).T
    given = _with(case, frequency, value, uncertainty=0.01 * value)
    problem = Problem.of(replace(given, fit=replace(given.fit, unstable=("exact",))))
    at_start = problem.motions(np.array(start))[1]
    assert (at_start[:2, :2] > 0).all()  # beyond the fold
    minimum = settled(problem, np.array(start))
    assert minimum.chosen.tolist() == 6 * [0, 1]
    assert minimum.misfit < 1e-6


def test_intervals_cover_the_truth():
    """Twelve sets of noise: the likelihood ratio at the truth is below the 95 % level in most (binomial: ≥ 9)."""
    case = _neutral()
    system, frequency = case.system("sdof"), np.linspace(14.3, 16.8, 16)
    amplitude = float(np.ravel(case.amplitude(2 * np.pi * frequency))[0])
    exact = np.array(
        [vibeam.orbits(system, vibeam.Drive(2 * np.pi * f, amplitude))[0].amplitude("sensor") for f in frequency]
    )
    rng, inside = np.random.default_rng(3), np.zeros(2)
    for _ in range(12):
        noisy = exact * (1 + 0.01 * rng.standard_normal(len(exact)))
        problem = Problem.of(_with(case, frequency, noisy, uncertainty=0.01 * exact))
        found = settled(problem, problem.start)
        least = [minimise(problem, found.x, found.chosen, {k: problem.start[k]})[1] for k in (0, 1)]
        inside += [each - found.misfit < LEVEL for each in least]
    assert (inside >= 9).all()


def test_points_with_several_impacts_are_known_as_such(tmp_path):
    """Impacts a drive period times period: 2 in 1 and 3 in 2 are on no motion with one, 1 in 2 is."""
    rows = ["15,4e-4,1,1", "15.5,3e-4,1,2", "15.7,3e-4,2,0.5", "16,3e-4,2,1.5"]
    head = "frequency_hz,amplitude,period,impacts_per_period"
    (tmp_path / "own.csv").write_text("\n".join([head, *rows]) + "\n")
    changes = {"fidelity.sdof.reduction": "static_mode", "fit.references": None, "reference.laser.fidelity": "sdof"}
    changes |= {"reference.laser.file": str(tmp_path / "own.csv"), "reference.laser.columns": None}
    case = vibeam.load(CASES / "synthetic/fit.toml", set=TWO | changes | {"reference.laser.uncertainty": "1 %"})
    problem = Problem.of(case)
    found = [(each.periods, each.several, each.frequency.tolist()) for each in problem.groups]
    assert found == [(1, False, [15.0]), (1, True, [15.5]), (2, False, [15.7]), (2, True, [16.0])]
    assert not np.isfinite(problem.motions(problem.start)[0][:, [1, 3]]).any()


def test_one_rig_at_three_gaps_is_fitted_jointly():
    """Fidelities that set the gap, each with a reference of its own: the joint estimates are the truth."""
    gaps = {"closed": "-0.08 mm", "open": "0.08 mm"}
    changes = {f"fidelity.{name}.reduction": "static_mode" for name in gaps}
    changes |= {f"fidelity.{name}.set": f'{{ "stop.gap" = "{gap}" }}' for name, gap in gaps.items()}
    keys = TWO["fit.keys"].replace("}", ', "beam.thickness" = ["1.0 mm", "1.07 mm"]}')
    case = _neutral(**changes | {"fit.keys": keys})
    ranges = {"sdof": (14.2, 17.0), "closed": (16.0, 17.4), "open": (13.9, 14.6)}
    given = replace(case, references={})
    for name, (low, high) in ranges.items():
        grid = np.linspace(low, high, 5)
        value = [_hardest(case, name, each) for each in grid]
        curve = ReferenceCurve.of(grid, value, uncertainty=0.01 * np.array(value))
        given = given.with_reference(name, curve, name)
    assert case.fit is not None
    problem = Problem.of(replace(given, fit=replace(case.fit, references=tuple(ranges))))
    assert len({float(each.data(problem.low, np.ones(1)).gap) for each in problem.forward.values()}) == 3
    found = settled(problem, np.array([0.45, 0.45, 0.55]))
    assert problem.values(found.x) == pytest.approx([5.16e-4, 0.72, 1.034e-3], rel=1e-5)
    assert found.misfit < 1e-6
    assert found.actual.all()


def _hardest(case, name, frequency):
    """Amplitude of the stable motion with one impact a period, by exact flight from rest."""
    omega = 2 * np.pi * np.array([frequency])
    amplitude = float(np.ravel(case.amplitude_of(name, omega))[0])
    flown = vibeam.sweep(
        case.system(name), omega=omega, amplitude=amplitude, direction="up", settle=400, hold=5, output="sensor"
    )
    assert flown.period[0] == 1
    assert flown.impacts_per_period[0] == 1
    return float(flown.amplitude[0])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"fit.keys": '{"drive.gian" = [1, 2]}'}, "did you mean 'gain'"),
        ({"fit.keys": '{"stop.restitution" = [0.5, 1.9]}'}, "outside"),
        ({"fit.keys": '{"stop.restitution" = [0.9, 0.5]}'}, "goes from 0.9 to 0.5"),
        ({"fit.keys": '{"stop.restitution" = 0.5}'}, "lowest, highest"),
        ({"fit.keys": '{"beam.elements" = [2, 5]}'}, "no single number"),
        ({"fit.references": '["lazer"]'}, "did you mean 'laser'"),
    ],
)
def test_faults_of_the_table_are_told_at_their_key(changes, message):
    with pytest.raises(vibeam.CaseError, match=re.escape(message)):
        vibeam.load(CASES / "synthetic/fit.toml", set=changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"measurement.sampling": "5 kHz", "measurement.noise": "0.1 µm", "measurement.seed": 1}, "noise"),
        ({"reference.laser.columns": '{ frequency = "Frequenz", amplitude = "Weg" }'}, "uncertainty"),
    ],
)  # fmt: skip
def test_what_cannot_be_fitted_is_refused_in_words(changes, message):
    with pytest.raises(ValueError, match=message):
        vibeam.fit(vibeam.load(CASES / "synthetic/fit.toml", set=changes))


BENCHMARKS = Path(__file__).parents[2] / "benchmarks"

RESULTS = json.loads((BENCHMARKS / "results" / "fit_families.json").read_text(encoding="utf-8"))

EXAMPLES = [each for each in RESULTS["sets"] if each["set"]]


@pytest.fixture
def families(monkeypatch):
    """The benchmark that draws the rigs."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import fit_families

    yield fit_families
    sys.modules.pop("fit_families")


def test_nine_of_ten_intervals_hold_the_truth_in_the_trial():
    held, total = (sum(len(each[part]) for each in RESULTS["sets"]) for part in ("held", "errors"))
    assert (held, total) == (RESULTS["summary"]["held"], RESULTS["summary"]["intervals"])
    assert total == 120
    assert held >= 0.9 * total
    assert all(each["of_other_families"] >= 2 for each in RESULTS["sets"])


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda each: f"{each['rig']} {each['seed']}")
def test_points_of_other_families_do_not_pull_the_keys(families, example):
    """Every interval holds the truth; points on other motions than one impact a period are about as many as are."""
    given = example["set"]
    arrays = {name: np.array(given[name]) for name in ("frequency", "noisy")}
    exact = families.Record(np.array(given["exact"]), np.zeros(0), np.zeros(0))
    case = families.Measured(**given | arrays | {"exact": exact}).case()
    study = vibeam.fit(case)
    assert study.judgement.described
    assert all(row.low <= given["truth"][row.key] <= row.high for row in study.rows)
    other = sum(bool(point.left_out) or point.motion not in MOTIONS for point in study.points)
    assert 0 < other <= example["of_other_families"] + 1


def test_the_integrator_of_the_trial_is_another_one_s(families):
    """Two modes from rest, 32 periods, against an adaptive Runge–Kutta method with events."""
    system = vibeam.ImpactSystem.from_modes(
        [70.0, 400.0], 0.02, [1.0, 0.6], [0.9, 0.4], gap=5e-5, restitution=0.7, outputs={"sensor": [0.8, -0.5]}
    )
    omega, amplitude = 90.0, 1e-4
    record = families.records(system, np.array([omega]), amplitude, settle=0)

    def slope(time, y):
        pull = system.load * omega**2 * amplitude * np.sin(omega * time)
        return np.concatenate([y[2:], pull - 2 * system.zeta * system.omega * y[2:] - system.omega**2 * y[:2]])

    def gap(_, y):
        return system.gap - system.contact @ y[:2]

    gap.terminal, gap.direction = True, -1.0
    time, y, end, impacts, seen = 0.0, np.zeros(4), 32 * 2 * np.pi / omega, 0, []
    within = Bound()
    while within(time < end):
        found = solve_ivp(slope, (time, end), y, events=gap, rtol=1e-9, atol=1e-14, max_step=2 * np.pi / omega / 100)
        seen += (system.outputs["sensor"] @ found.y[:2]).tolist()
        time, y = found.t[-1], found.y[:, -1].copy()
        if found.status != 1:
            break
        speed = system.contact @ y[2:]
        y[2:] -= (1 + system.restitution) * speed / (system.contact @ system.contact) * system.contact
        impacts += 1
    assert record.impacts.tolist() == [impacts]
    assert record.amplitude[0] == pytest.approx((max(seen) - min(seen)) / 2, rel=2e-3)
