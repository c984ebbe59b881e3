"""Error estimated against the full model: against flights of that model, and other programs' orbits."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from support.random_beams import RandomBeam, random_beam
from vibeam.case.fidelity import Fidelity, system
from vibeam.flight.solver import FlightSolver
from vibeam.periodic.bifurcation_functions import motions
from vibeam.periodic.motions import OrbitKind, predicted
from vibeam.periodic.nearby_orbits import nearby_orbits
from vibeam.periodic.orbit_search import orbits
from vibeam.periodic.trains import Trains
from vibeam.report.run_answer import run_answer
from vibeam.runs.estimate.error import estimate_error
from vibeam.runs.estimate.of_case import estimates
from vibeam.runs.estimate.records import QUANTITIES, Basis, ErrorEstimate, FidelityEstimate, estimate_texts
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Branches, FrequencyResponse
from vibeam.system.rows import TimeDerivative
from vibeam.system.state import StatesAfter

ROOT = Path(__file__).parents[3]

THREE = ImpactSystem.from_modes(
    [1.0, 5.3, 13.0], 0.02, [1.0, 1.5 / 5.3, -1.1 / 13], [1.0, 1 / 5.3, 1 / 13], gap=0.1, restitution=0.7,
    outputs={"sensor": [0.8, 0.3, 0.2]},
)  # fmt: skip


def cut(full: ImpactSystem, n: int) -> ImpactSystem:
    """Its first n modes."""
    rows = {name: getattr(full, name)[:n] for name in ("omega", "zeta", "contact", "load", "static")}
    return replace(full, outputs={"sensor": full.outputs["sensor"][:n]}, **rows)


def settled(system: ImpactSystem, omega: float, amplitude: float) -> tuple[FrequencyResponse, StatesAfter]:
    found, state = FlightSolver(system, omega).steady([omega], amplitude, None, 800, 32, "sensor")
    return found, StatesAfter(state.displacement[None], state.velocity[None])


def estimated(beam: RandomBeam) -> tuple[ErrorEstimate, FrequencyResponse, FrequencyResponse]:
    response, after = settled(beam.reduced, beam.omega, beam.amplitude)
    found = estimate_error(response, beam.reduced, beam.full, beam.amplitude, "sensor", after)
    return found, response, settled(beam.full, beam.omega, beam.amplitude)[0]


def test_the_estimate_is_no_less_than_the_error_of_random_beams_and_not_many_times_as_large() -> None:
    pairs, refused = [], []
    for seed in range(2000, 2030):
        found, response, full = estimated(random_beam(seed))
        same = full.period[0] == response.period[0] and full.impacts_per_period[0] == response.impacts_per_period[0]
        if found.known[0] and same:
            pairs.append((found.amplitude_bound[0], abs(response.amplitude[0] / full.amplitude[0] - 1)))
        elif not found.known[0]:
            refused.append(same)
    estimate, true = np.array(pairs).T
    large = true > 1e-5  # below, the flights themselves are not settled and read to more
    assert len(pairs) >= 15
    assert np.mean(estimate >= true) >= 0.95
    assert np.median(estimate[large] / true[large]) <= 1.5
    assert np.quantile(estimate[large] / true[large], 0.9) <= 10
    assert true.max() > 0.05  # some are far off, so that the estimate is not of small corrections alone
    assert np.mean(refused) < 0.5 if refused else True


def test_signed_estimates_are_the_differences_of_amplitude_reach_and_velocity() -> None:
    found, response, full = estimated(random_beam(2000))
    for name in ("amplitude", "reach", "impact_velocity"):
        true = getattr(response, name)[0] / getattr(full, name)[0] - 1
        unsure = getattr(found, f"{name}_bound")[0] - abs(getattr(found, name)[0])
        assert abs(true) > 1e-3
        assert getattr(found, name)[0] == pytest.approx(true, abs=unsure + 1e-5)


def closed(system: ImpactSystem, omega: np.ndarray[Any, Any], amplitude: float, branch: int) -> Trains:
    base = np.full(len(omega), amplitude)
    roots = motions(system, 1, omega, base, np.full(len(omega), system.gap)).roots
    return Trains(roots.phase[:, branch, None], roots.impulse[:, branch, None], omega, base, 1)


def test_the_corrected_orbit_is_the_other_models_own() -> None:
    """Against the quadratic of ``orbits``, which knows nothing of the first model."""
    omega = np.array([1.4, 1.8, 2.2])
    near = nearby_orbits(THREE, closed(cut(THREE, 1), omega, 0.2, 0))
    own = [orbits(THREE, Drive(each, 0.2))[0] for each in omega]
    assert near.found.all()
    assert near.trains.phases[:, 0] == pytest.approx([each.phase for each in own], rel=1e-12)
    assert near.trains.impulses[:, 0] == pytest.approx([each.impulse for each in own], rel=1e-12)
    assert np.all(near.first > 1e-3)


def test_extremes_are_those_of_the_flight_and_the_bound_holds_for_damping_of_every_kind() -> None:
    for zeta, unsure in (([0.02, 0.02, 0.02], 1e-5), ([0.3, 0.9, 3.0], 1e-4), ([0.02, 1.0, 1.00001], 1e-2)):
        full = replace(THREE, zeta=np.array(zeta))
        drive = Drive(1.8, 0.2)
        own = next(each for each in orbits(full, drive) if each.admissible)
        train = Trains(*(np.array([[each]]) for each in (own.phase, own.impulse)), np.array([1.8]), np.array([0.2]), 1)
        there, watched = predicted(full, train, "sensor"), own.watched("sensor")
        bounds = {"maximum": there.uncertainty, "minimum": there.uncertainty, "reach": there.reach_uncertainty}
        for name, bound in bounds.items():
            assert abs(getattr(there, name)[0] - getattr(watched, name)[0]) <= bound[0] + 1e-9
        assert there.uncertainty[0] < unsure * there.amplitude[0]
        assert there.impact_velocity[0] == pytest.approx(own.velocity, rel=1e-12)


def test_velocities_and_accelerations_are_read_off_too() -> None:
    """Against the flight settled on the same orbit: a velocity jumps at the impact, an acceleration has the base's."""
    row = np.array([0.8, 0.3, 0.2])
    for order, base in ((1, 0.0), (2, 1.0)):
        full = replace(THREE, outputs={}, derivatives={"probe": TimeDerivative(row, order, base)})
        own = next(each for each in orbits(full, Drive(1.8, 0.2)) if each.admissible)
        train = Trains(*(np.array([[each]]) for each in (own.phase, own.impulse)), np.array([1.8]), np.array([0.2]), 1)
        there = predicted(full, train, "probe")
        watched, _ = FlightSolver(full, 1.8).steady([1.8], 0.2, None, 1500, 8, "probe")
        assert watched.impact_velocity[0] == pytest.approx(own.velocity, rel=1e-6)
        assert there.maximum[0] == pytest.approx(watched.maximum[0], rel=1e-4)
        assert there.minimum[0] == pytest.approx(watched.minimum[0], rel=1e-4)


def test_motions_with_several_impacts_are_corrected_too() -> None:
    """Two impacts a period, and two in two periods, against the full model's own flights."""
    reduced = cut(THREE, 2)
    for omega, repeats in ((0.7, (1, 2.0)), (1.2, (2, 1.0))):
        response, after = settled(reduced, omega, 0.2)
        assert (response.period[0], response.impacts_per_period[0]) == repeats
        found = estimate_error(response, reduced, THREE, 0.2, "sensor", after)
        full, _ = settled(THREE, omega, 0.2)
        true = response.amplitude[0] / full.amplitude[0] - 1
        assert found.known.all()
        assert abs(true) > 1e-3
        assert found.amplitude[0] == pytest.approx(true, abs=2e-5)
        assert found.amplitude_bound[0] >= abs(true)
        without = estimate_error(response, reduced, THREE, 0.2, "sensor")
        assert Basis.of_code(int(without.basis[0])) is Basis.UNSETTLED


def test_an_orbit_of_another_kind_is_refused() -> None:
    """A second touch and a multiplier beyond the circle, as ``orbits`` proves them."""
    reduced, seen = cut(THREE, 1), set()
    for omega in np.linspace(0.7, 3.2, 101):
        train = closed(reduced, np.array([omega]), 0.2, 0)
        if not train.impulses[0, 0] < 0:
            continue
        there = predicted(THREE, train, "sensor")
        own = orbits(THREE, Drive(omega, 0.2))[:1]
        kind = list(OrbitKind)[there.found[0]]
        if own and kind is not OrbitKind.NO_ORBIT:
            truth = (
                OrbitKind.STRIKES if not own[0].admissible else OrbitKind.ORBIT if own[0].stable else OrbitKind.UNSTABLE
            )
            assert kind is truth, omega
            seen.add(kind)
    assert seen == {OrbitKind.ORBIT, OrbitKind.STRIKES, OrbitKind.UNSTABLE}


def test_the_correction_grows_toward_a_fold_and_is_refused_beyond_it() -> None:
    """The fold is where the discriminant of the quadratic vanishes; the correction goes like one over its root."""
    full = replace(THREE, gap=0.4)
    omega = np.linspace(1.6, 1.8, 2001)
    real = motions(full, 1, omega, np.full(2001, 0.2), np.full(2001, 0.4)).roots.discriminant > 0
    fold = int(np.flatnonzero(~real)[0])
    assert 0 < fold < 2000
    off = replace(full, contact=full.contact * np.array([1.0, 1.0, 0.999]))  # a model beside it
    near = nearby_orbits(full, closed(off, omega[fold - np.array([64, 16, 4])], 0.2, 0))
    assert near.found.all()
    assert near.first[1:] / near.first[:-1] == pytest.approx([2, 2], rel=0.25)
    beyond = nearby_orbits(replace(full, gap=0.41), closed(full, omega[[fold - 2]], 0.2, 0))
    assert not beyond.found.any()


def test_points_without_impacts_and_without_a_period_are_told_apart() -> None:
    free = replace(THREE, gap=10.0)
    response, _ = settled(cut(free, 1), 1.5, 0.2)
    found = estimate_error(response, cut(free, 1), free, 0.2, "sensor")
    full, _ = settled(free, 1.5, 0.2)
    assert found.amplitude[0] == pytest.approx(response.amplitude[0] / full.amplitude[0] - 1, abs=1e-5)
    assert np.isnan(found.impact_velocity[0])
    loose = replace(response, period=np.array([0]))
    assert estimate_error(loose, cut(free, 1), free, 0.2, "sensor").reasons == {Basis.APERIODIC: 1}
    touching = replace(free, gap=0.5 * float(full.maximum[0]))
    assert estimate_error(response, cut(free, 1), touching, 0.2, "sensor").reasons == {Basis.TOUCHES: 1}


def test_no_point_has_an_estimate_at_which_the_full_model_makes_another_motion() -> None:
    """Against the full model's own sweep, which is computed for the estimate."""
    case = vibeam.load(ROOT / "cases" / "matrices" / "frame.toml")
    result = vibeam.run(case, show=False)
    reduced = {name: result[name] for name in ("static", "one")}
    systems = {name: case.system(name) for name in case.fidelities}
    made, others = estimates(case, systems, reduced, {}), 0
    for name, responses in reduced.items():
        for way, own in responses.items():
            found, full = made[name].branches[way], dict(result["whole"].items())[way]
            numbers = np.isfinite(found.amplitude_bound)
            assert np.array_equal(numbers, found.known)
            true = (own.amplitude / full.amplitude - 1)[numbers]  # settled to 1e-3 beside a doubling
            assert found.amplitude[numbers] == pytest.approx(true, abs=1e-3)
            others += found.reasons.get(Basis.ANOTHER, 0)
    assert others > 10


LINEAR = {"stop.law": "linear", "stop.stiffness": "2e4 N/m", "stop.restitution": 0.6}
HARMONIC = {"drive.harmonic": [2], "drive.harmonic_share": ["5 %"]}


@pytest.mark.parametrize("changes", [{}, LINEAR, HARMONIC, {"stop.second_gap": "2 mm"}, {"fidelity.whole.modes": 2}])
def test_beside_the_full_model_in_the_run_errors_are_the_differences_from_it(changes: dict[str, object]) -> None:
    """Whatever the stop and the drive, and where all modes are that model."""
    quick = {"sweep.frequency.points": 21, "sweep.settle": 100, "sweep.hold": 20, "fidelity.stiff": None}
    modal = {"fidelity.whole.reduction": "modal"} if "fidelity.whole.modes" in changes else {}
    case = vibeam.load(ROOT / "cases" / "matrices" / "frame.toml", set=quick | modal | changes)
    result = vibeam.run(case, show=False, compare=True)
    assert result.estimates["whole"].whole
    for name in ("static", "one"):
        for way, own in result[name].items():
            found, full = result.estimates[name].branches[way], dict(result["whole"].items())[way]
            both = (own.period != 0) & (full.period != 0)
            assert np.array_equal(found.known, both)
            assert np.array_equal(found.amplitude[both], (own.amplitude / full.amplitude - 1)[both])
            assert found.reasons == ({Basis.IRREGULAR: int((~both).sum())} if not both.all() else {})
    cells = estimate_texts(result.estimates).cells
    assert cells["whole"] == "full"
    answer = run_answer(result)
    assert answer.startswith("whole suffices for 5 % (computed exactly)")
    assert "not known" not in answer.partition(" held")[0]


def test_an_orbit_that_repeats_sooner_in_the_full_model_is_another_motion() -> None:
    """Period 2 of the reduced model where the full one's period has not doubled yet: twice its period 1."""
    drive = Drive(1.8, 0.2)
    own = next(each for each in orbits(THREE, drive) if each.admissible and each.stable)
    apart = np.array([[own.phase, own.phase + 2 * np.pi]]), own.impulse * np.array([[1.001, 0.999]])
    there = predicted(THREE, Trains(*apart, np.array([1.8]), np.array([0.2]), 2), "sensor")
    assert list(OrbitKind)[there.found[0]] is OrbitKind.ANOTHER
    assert np.isnan(there.amplitude[0])


SHORT = {"sweep.frequency": ["14.5 Hz", "15 Hz", "15.5 Hz"], "sweep.settle": 150, "sweep.hold": 10, "beam.elements": 12}


def test_a_run_has_the_estimates_and_its_file_keeps_them(tmp_path: Path) -> None:
    case = vibeam.load(ROOT / "cases" / "dtu_neutral.toml", set=SHORT)
    made = vibeam.run(case, tmp_path / "it.h5", show=False, compare=True).estimates
    kept = vibeam.run(case, tmp_path / "it.h5", show=False, compare=True).estimates
    full = system(case.scene, Fidelity("full", "full"))
    flown = vibeam.sweep(
        full, omega=2 * np.pi * case.sweep.frequency, amplitude=case.base_amplitude, direction="up", settle=300,
        hold=10, output="sensor",
    )  # fmt: skip
    result = vibeam.run(case, show=False)
    for name in case.fidelities:
        up = made[name].branches["up"]
        true = result[name].up.amplitude / flown.amplitude - 1
        assert made[name].modes == full.size
        assert up.known.all()
        assert np.all(up.amplitude_bound >= np.abs(true))
        assert up.amplitude == pytest.approx(true, abs=1e-4)
        for direction, branch in kept[name].branches.items():
            assert np.array_equal(branch.amplitude_bound, made[name].branches[direction].amplitude_bound)
            assert np.array_equal(branch.basis, made[name].branches[direction].basis)
    assert np.all(np.abs(made["sdof"].branches["up"].amplitude) > 0.01)


def test_what_has_no_periodic_motion_says_why(tmp_path: Path) -> None:
    lines = (ROOT / "cases" / "dtu_neutral.toml").read_text("utf-8").split("[reference.exact]")[0]
    (tmp_path / "it.toml").write_text(lines.replace("[sensor]", 'wear = "1e-9 mm"\n\n[sensor]', 1), "utf-8")
    case = vibeam.load(tmp_path / "it.toml", set=SHORT)
    made = estimates(case, {name: case.system(name) for name in ("beam",)}, {"beam": Branches(empty())}, {})
    assert "each impact widens the gap" in made["beam"].why
    texts = estimate_texts(made)
    assert (texts.rows[0].points, texts.rows[0].total, texts.cells) == (0, 0, {})
    assert texts.sentences[0].startswith("beam: not estimated against the full model (")


def estimate_of(bounds: list[float], basis: list[Basis]) -> FidelityEstimate:
    """Estimate of one branch by its bounds alone."""
    row = np.array(bounds)
    names = (*QUANTITIES, *(f"{name}_bound" for name in QUANTITIES), "correction")
    codes = np.array([each.code for each in basis])
    branch = ErrorEstimate(frequency=np.arange(len(row)) + 1.0, basis=codes, **dict.fromkeys(names, row))
    return FidelityEstimate(64, {"up": branch})


NAN, SEEN, CLEAR, GONE = float("nan"), Basis.ORBIT, Basis.FREE, Basis.NO_ORBIT


@pytest.mark.parametrize(
    ("bounds", "basis", "cell", "said"),
    [
        ([0.2, 0.01, 0.03], [CLEAR, SEEN, SEEN], "3 %", ""),  # points clear of the stop count for nothing
        ([0.2, 0.01, NAN], [CLEAR, SEEN, GONE], "1 % (1/2)", "known at 1 of 2 points with impacts (the full model has"),
        ([0.2, 0.01, NAN, NAN], [CLEAR, SEEN, GONE, GONE], "– (1/3)", "1 of 3 points with impacts, too few to say"),
        ([0.2, NAN], [CLEAR, Basis.TOUCHES], "– (0/1)", "the full model touches the stop, this one does not: 1"),
        ([0.2, NAN], [CLEAR, Basis.FAILED], "", ""),  # no point with impacts at all: no column
    ],
)  # fmt: skip
def test_an_estimate_says_over_which_points_with_impacts_it_holds(
    bounds: list[float], basis: list[Basis], cell: str, said: str
) -> None:
    texts = estimate_texts({"sdof": estimate_of(bounds, basis)})
    assert texts.cells == ({"sdof": cell} if cell else {})
    assert said in " ".join(texts.sentences)
    assert bool(said) == bool(texts.sentences)
    assert np.isfinite(texts.rows[0].worst) == ("%" in cell) == np.isfinite(texts.rows[0].rms)


def empty() -> FrequencyResponse:
    return FrequencyResponse.empty(np.array([14.5, 15.0, 15.5]), 8)
