"""The study of solvers: errors beside exact motions, time that is kept, the front; what the budget leaves out."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stand_in import HELD_AT_CONTACT, RIG, SDOF
from typer.testing import CliRunner

import vibeam
from vibeam.case.case import Case
from vibeam.case.study_plans import VerdictPlan
from vibeam.casefile.read import parse
from vibeam.cli.main import app
from vibeam.report import verdict
from vibeam.report.cost import answer, decision, details, sheet, uncertain
from vibeam.runs.sweep import sweep
from vibeam.solvers import SOLVERS, solver
from vibeam.studies.cost import measure as measured_module
from vibeam.studies.cost.measure import FLIGHT, Plan, Setting, measured, settings_of
from vibeam.studies.cost.planning import LeftOut, SettingSeries, finest_model, frequencies, models, plan_of, run_in_turn
from vibeam.studies.cost.row import front
from vibeam.studies.cost.study import CostStudy, cost

pytestmark = pytest.mark.usefixtures("undrawn")

TINY = SDOF + '\n[cost]\nsettle = 5\nhold = 2\nfrequency = ["1.9 rad/s", "2 rad/s", "2.1 rad/s"]\n'
BEAM = {
    "cost.settle": 40, "cost.hold": 2, "cost.frequency": ["15 Hz", "15.5 Hz"],
    "cost.solvers": ["flight", "orbit", "averaging"], "beam.elements": 12, "sweep.settle": 200, "cost.budget": "60 s",
}  # fmt: skip


class Clock:
    """Each look at it, a second has passed."""

    def __init__(self) -> None:
        self.count = itertools.count()

    def __call__(self) -> float:
        return float(next(self.count))


def plan(case: Case) -> Plan:
    return plan_of(case, finest_model(case, models(case)[0]), frequencies(case))


def test_every_solver_takes_its_settings() -> None:
    case, settings = parse(SDOF), [setting for name in SOLVERS for setting in settings_of(name, 1e-3)]
    for setting in settings:
        solver(setting.solver, case.system("sdof"), 1.5, **setting.options)
    assert len({setting.label for setting in settings}) == len(settings)


class Work:
    """Stands in for a measurement of four points, each of which takes so many seconds of the schedule's clock."""

    def __init__(self, schedule: Schedule, setting: Setting, each: float) -> None:
        self.schedule, self.setting, self.each, self.used, self.points = schedule, setting, each, 0.0, 0

    def __len__(self) -> int:
        return self.points

    @property
    def done(self) -> bool:
        return self.points == 4

    def step(self, allowed: float) -> bool:
        took = min(self.each, allowed)
        self.used, self.schedule.now = self.used + took, self.schedule.now + took
        self.points += took == self.each
        return took == self.each

    def timed_again(self) -> None:
        pass


class Schedule:
    """Runs in turn whose points take known times: by solver, of each setting by method."""

    def __init__(self) -> None:
        self.now = 0.0

    def series(self, name: str, times: dict[str, float]) -> SettingSeries:
        schedule = self

        class Series(SettingSeries):
            def begun(self, setting: Setting, clock: object) -> Any:
                return Work(schedule, setting, times[f"{setting.method}{setting.setting}"])

        model: Any = models(parse(SDOF))[0][0]
        return Series(model, plan(parse(TINY)), tuple(Setting(name, each[0], each[1:]) for each in times))

    def run(self, budget: float, **times: dict[str, float]) -> tuple[dict[str, int], list[str]]:
        """Points of each run, and the runs left out."""
        found = list(run_in_turn([self.series(*each) for each in times.items()], budget, lambda: self.now))
        runs = {each[1].setting.label: len(each[1]) for each in found if not isinstance(each, LeftOut)}
        return runs, [each.run for each in found if isinstance(each, LeftOut)]


def test_the_run_that_has_used_least_goes_on_and_a_point_that_takes_more_than_its_share_ends_it() -> None:
    """A first setting that is given up takes the others of its solver with it, a later one those of its method."""
    quick, endless = {"a1": 0.1, "a2": 0.2, "a3": 0.4}, {"a1": 100.0, "b1": 1.0}
    runs, left = Schedule().run(30.0, quick=quick, slow={"a1": 1.0, "b1": 90.0, "a2": 2.0, "b2": 1.0}, endless=endless)
    assert runs == {
        "quick a 1": 4, "quick a 2": 4, "quick a 3": 4, "slow a 1": 4, "slow b 1": 0, "slow a 2": 3, "endless a 1": 0,
    }  # fmt: skip
    assert left == ["endless b 1", "slow b 2"]


def test_what_the_time_is_over_for_is_left_out_by_name() -> None:
    schedule = Schedule()
    runs, left = schedule.run(4.0, fast={"a1": 0.5, "a2": 0.5, "a3": 0.5}, other={"a1": 0.5})
    assert runs == {"fast a 1": 4, "other a 1": 4}
    assert left == ["fast a 2", "fast a 3"]
    assert schedule.now == 4.0


@pytest.fixture(scope="module")
def whole() -> CostStudy:
    names = ["flight", "orbit", "mapping", "averaging", "moreau"]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(measured_module, "STEPS", (100, 3000))
        return cost(parse(TINY, set={"cost.solvers": names, "cost.settle": 130}), budget=60.0)


def test_a_study_of_one_degree_of_freedom(whole: CostStudy) -> None:
    rows = {row.label: row for row in whole.rows}
    assert not whole.left_out
    assert abs(rows["moreau 100 steps"].total.worst) > 10 * abs(rows["moreau 3000 steps"].total.worst)
    for exact in ("mapping", "orbit"):
        assert abs(rows[exact].total.worst) < 1e-8
    assert 0.001 < abs(rows["averaging log"].total.worst) < abs(rows["averaging paper"].total.worst) < 0.1
    assert all(0 < row.seconds <= row.used for row in whole.rows)
    assert {row.computed for row in whole.rows} == {3}


def test_short_runs_are_timed_again_long_ones_are_not(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each solver is made once a run: once for a run that took long, by a clock of its own."""
    made: list[str] = []
    real = measured_module.solver

    def counted(name: str, *words: object, **options: object) -> object:
        made.append(name)
        return real(name, *words, **options)

    monkeypatch.setattr(measured_module, "solver", counted)
    case = parse(TINY, set={"cost.solvers": ["mapping"]})
    for clock, runs in ((lambda: 0.0, 1 + measured_module.REPEATS), (Clock(), 1)):
        made.clear()
        assert cost(case, clock=clock, budget=1000.0).rows[0].computed == 3
        assert made.count("mapping") == runs


class Broken:
    """A solver whose motion overflows."""

    def __init__(self, inner: object) -> None:
        self.inner = inner

    def steady(self, *words: object) -> object:
        response, state = self.inner.steady(*words)  # type: ignore[attr-defined]
        response.ended[:], response.amplitude[:] = vibeam.Ended.NOT_FINITE.code, np.nan
        return response, state


def test_a_run_that_fails_is_no_number_with_its_reason(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    real = measured_module.solver

    def made(name: str, *words: object, **options: object) -> object:
        inner = real(name, *words, **options)
        return Broken(inner) if name == "mapping" else inner

    monkeypatch.setattr(measured_module, "solver", made)
    case = parse(TINY, set={"cost.solvers": ["flight", "mapping"], "cost.settle": 150})
    study = cost(case)
    failed = next(row for row in study.rows if row.solver == "mapping")
    assert np.isnan(failed.total.worst)
    assert failed.why.startswith("3 of 3 points: a number overflowed")
    assert [study.rows[i].solver for i in study.front] == ["flight"]
    assert any(note.startswith("1 of 2 runs gave no error (sdof by mapping: 3 of 3") for note in uncertain(study, case))
    shown = decision(study, case, 0.05)
    assert shown.left_out == ("mapping",)  # named, never a mark
    assert {each.solver for each in shown.errors} == {"flight"}
    sheet(study, case).write(tmp_path / "a_cost.csv", case.figure)
    assert "a number overflowed" in (tmp_path / "a_cost.csv").read_text(encoding="utf-8")


@pytest.mark.parametrize(("name", "looks", "after"), [("flight", 2, 1), ("direct", 8, 0), ("ivanov", 8, 0)])
def test_time_up_within_a_run_keeps_what_is_done(name: str, looks: float, after: int) -> None:
    """Between the points, and within one that is integrated: it takes some thousand evaluations, 64 a look."""
    case = parse(TINY)
    found = measured(case.system("sdof"), Setting(name), plan(case), Clock(), looks)
    assert (len(found), found.done) == (after, False)
    assert found.used >= looks
    assert list(found.response.ended) == [0] * after + [vibeam.Ended.NOT_RUN.code] * (3 - after)


def test_a_rival_that_is_given_up_keeps_its_time_and_is_named() -> None:
    case = parse(TINY, set={"cost.solvers": ["flight", "direct"]})
    studies = (cost(case, clock=Clock(), budget=80.0 + 10 * k) for k in range(8))
    found = ((study, row) for study in studies for row in study.rows if row.computed < 3 and row.solver == "direct")
    study, late = next(each for each in found if each[1].used > 1)
    assert [row.computed for row in study.rows if row.solver == "flight"] == [3]
    assert late.why == f"given up after {late.used:.2g} s, with {late.computed} of 3 frequencies"
    assert all(each.run.startswith("direct") for each in study.left_out)
    note = next(note for note in uncertain(study, case) if "did not fit" in note)
    assert f"by direct ({late.used:.2g} s used): vibeam verdict " in note
    assert note.endswith(f" --only solvers --budget '{10 * study.budget:g} s' runs more of them.")
    shown = sheet(study, case).tables[0]
    times = list(shown.columns[4].cells)
    direct = [str(times[i]) for i, cell in enumerate(shown.columns[1].cells) if str(cell).startswith("direct")]
    timed_runs = [row for row in study.rows if row.solver == "direct" and row.computed]
    assert timed_runs or any(each.startswith("> ") for each in direct)  # a bound where no run of the solver has a time


@pytest.fixture(scope="module")
def beam() -> CostStudy:
    return cost(parse(HELD_AT_CONTACT.split("[reference")[0], set=BEAM))


def test_errors_are_those_of_sweeps_made_by_hand(beam: CostStudy) -> None:
    case = parse(HELD_AT_CONTACT.split("[reference")[0], set=BEAM)
    one, all_ = (
        sweep(case.system(name), omega=2 * np.pi * np.array([15, 15.5]), amplitude=case.base_amplitude, settle=200,
              output="sensor").amplitude
        for name in ("sdof", "beam")
    )  # fmt: skip
    row = next(row for row in beam.rows if (row.fidelity, row.solver) == ("sdof", "flight"))
    found = one / all_ - 1
    assert row.total.worst == pytest.approx(found[np.argmax(np.abs(found))], rel=1e-4)
    assert row.total.rms == pytest.approx(np.sqrt(np.mean(found**2)), rel=1e-4)
    own = next(row for row in beam.rows if (row.fidelity, row.solver) == ("beam", "flight"))
    assert abs(own.total.worst) < 1e-4


def test_other_solvers_are_for_the_smallest_and_the_finest(beam: CostStudy) -> None:
    ran = {(row.fidelity, row.solver) for row in beam.rows}
    assert {fidelity for fidelity, name in ran if name == "flight"} == {"sdof", "two_modes", "beam"}
    assert {fidelity for fidelity, name in ran if name == "orbit"} == {"sdof", "beam"}
    assert {(each.fidelity, each.run) for each in beam.refused} == {("beam", "averaging")}


def test_models_of_one_system_are_one() -> None:
    found, same = models(parse(SDOF + "[fidelity.again]\nsolver = 'mapping'\n"))
    assert [model.name for model in found] == ["sdof"]
    assert same == {"again": "sdof"}


def test_too_little_time_leaves_frequencies_and_runs_out_and_says_so() -> None:
    case = parse(SDOF, set={"cost.budget": 1e-9, "cost.solvers": ["flight", "orbit"]})
    study = cost(case)
    assert (study.rows, len(study.frequency), study.asked) == ((), 1, 5)
    assert {each.run for each in study.left_out} == {"flight", "orbit"}
    notes = list(uncertain(study, case))
    assert notes[0].startswith("2 of 2 runs did not fit into 1e-09 s, by flight and orbit: vibeam verdict ")
    assert notes[1] == "1 frequencies in place of 5, for the budget: --budget allows more."
    assert answer(study, case) == "No run of sdof by flight fits into 1e-09 s of CPU time."
    assert sheet(study, case).draw is None


def test_what_finds_no_motion_somewhere_is_not_on_the_front(beam: CostStudy) -> None:
    without = replace(beam, rows=tuple(replace(row, found=1) for row in beam.rows if row.solver == "orbit"))
    assert beam.front
    assert without.rows
    assert without.front == []


def timed(study: CostStudy) -> CostStudy:
    """By times of our own, a millisecond a mode by flight and ten by all else."""
    times = [1e-3 * row.modes * (1 if row.solver == "flight" else 10) for row in study.rows]
    return replace(study, rows=tuple(
        replace(row, seconds=each) for row, each in zip(study.rows, times, strict=True)
    ))  # fmt: skip


def test_the_sheet_answers_first(beam: CostStudy) -> None:
    case, study = parse(HELD_AT_CONTACT.split("[reference")[0], set=BEAM), timed(beam)
    found = sheet(study, case, within=0.5)
    assert found.answer == (
        f"Exact flight of beam takes 8 ms a frequency; the cheapest within 50 % is sdof by flight, 8 times faster and "
        f"{share_of(study, 'sdof')} off. "
        "R = 0.72 at the contact is prescribed."
    )
    assert "nothing cheaper is within 0 %: the nearest is " in answer(study, case, 0.0)
    few = tuple(replace(row, total=replace(row.total, points=0)) for row in study.rows)
    assert "; of cheaper runs the error is known at less than half of the 2 frequencies" in answer(
        replace(study, rows=few), case
    )
    asked = vibeam.Verdict(case, VerdictPlan(accuracy=0.5), (vibeam.studies.Stage("solvers", study, 0.0),))
    assert verdict.sheet(asked).answer == found.answer != answer(study, case)
    table = found.tables[0].brief()
    assert [str(cell) for cell in table.columns[-1].cells] == ["*"] * len(study.front)
    assert [each.row_count for each in found.more] == [len(beam.rows)]


def share_of(study: CostStudy, fidelity: str) -> str:
    row = next(row for row in study.rows if (row.fidelity, row.solver) == (fidelity, "flight"))
    return f"{100 * abs(row.total.worst):.3g} %"


def test_frequencies_of_the_case_that_take_longer_are_refused() -> None:
    case, done = parse(TINY, set={"cost.solvers": ["flight", "moreau"]}), []
    study = cost(case, progress=lambda *counts: done.append(counts), clock=Clock(), budget=1000.0)
    assert study.budget == 1000
    assert (done[0], done[-1]) == ((0, 6), (6, 6))
    with pytest.raises(ValueError, match=r"the exact motions of sdof at 3 frequencies take more than 1 s of CPU"):
        cost(case, clock=Clock(), budget=1.0)


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tiny.toml").write_text(TINY, encoding="utf-8")
    words = ["verdict", "tiny.toml", "--only", "solvers", "--set", 'cost.solvers=["flight", "averaging"]']
    words += ["--set", "cost.settle=150"]  # motions repeat: there are errors to draw
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    assert {path.name for path in tmp_path.iterdir()} == {
        "tiny.toml", "tiny_cost.png", "tiny_cost.svg", "tiny_cost.csv",
    }  # fmt: skip
    assert "Error against CPU time" in result.stdout
    assert max(map(len, result.stdout.splitlines()[1:])) <= 160
    found = json.loads(CliRunner().invoke(app, [*words, "--json", "--out", "new/folder"]).stdout)
    assert [row["solver"] for row in found["study"]["rows"]] == ["flight", "averaging", "averaging"]
    assert len((tmp_path / "tiny_cost.csv").read_text(encoding="utf-8").splitlines()) == 4
    wrong = CliRunner().invoke(app, ["verdict", "tiny.toml", "--only", "solvers", "--set", 'cost.solvers=["flite"]'])
    assert wrong.exit_code == 2
    assert "did you mean 'flight'" in wrong.stderr
    assert (tmp_path / "new" / "folder" / "tiny_cost.csv").exists()
    assert CliRunner().invoke(app, [*words, "--out", "tiny.toml"]).exit_code == 2


def test_what_is_asked_of_cost_does_not_change_what_a_run_computes() -> None:
    assert parse(TINY).key == parse(SDOF).key
    assert parse(parse(TINY).text).cost == parse(TINY).cost
    assert parse(TINY).cost.settle == 5


def test_a_gap_that_changes_along_the_sweep_is_refused() -> None:
    case = vibeam.load(RIG, set={"stop.wear": "1 nm"})
    with pytest.raises(ValueError, match="no point stands alone"):
        cost(case)


def test_a_stop_that_yields_is_studied_with_the_solvers_that_take_it() -> None:
    """The others are named with the law as the case has it."""
    settings = {"stop.restitution": None, "stop.law": "hertz", "stop.hertz_stiffness": 1e3, "cost.budget": 60.0}
    study = cost(parse(TINY, set=settings | {"cost.solvers": ["flight", "orbit", "averaging"]}))
    assert [row.solver for row in study.rows] == ["flight", "orbit"]
    assert {each.run for each in study.refused} == {"averaging"}
    told = "\n".join(details(study))
    assert 'averaging cannot take sdof: the contact law "hertz"' in told
    assert "HuntCrossley" not in told


def test_flight_is_cheapest_where_it_is_timed_alone() -> None:
    """The exact runs of a study settle as long as the sweep; their times are in no row."""
    case = parse(TINY, set={"sweep.settle": 300})
    model = models(case)[0][0]
    assert plan_of(case, model, frequencies(case), exact=True).settle == 300
    assert plan_of(case, model, frequencies(case)).settle == 5
    assert measured(model.system, FLIGHT, plan(case)).done


def test_the_pareto_front() -> None:
    points = [(1.0, 3.0), (2.0, 1.0), (1.5, 2.0), (1.6, 2.5), (np.nan, 0.1), (3.0, 1.0), (0.5, np.nan), (1.0, 4.0)]
    assert front(points) == [0, 2, 1]
    assert front([]) == []


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), max_size=30))
def test_the_front_is_what_nothing_beats(points: list[tuple[float, float]]) -> None:
    kept = {points[i] for i in front(points)}
    beaten = {p for p in points if any(q != p and q[0] <= p[0] and q[1] <= p[1] for q in points)}
    assert kept == set(points) - beaten
