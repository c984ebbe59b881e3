"""The study: the cheapest runs first, within the time; failures with their reason; parts that add up."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from stand_in import HELD_AT_CONTACT, RIG, SDOF, curve
from typer.testing import CliRunner

import vibeam
from vibeam.case.fidelity import with_first_mode_restitution
from vibeam.case.study_plans import VerdictPlan
from vibeam.casefile.read import parse
from vibeam.cli.main import app
from vibeam.flight.engine.threads import OutOfTime
from vibeam.report import verdict
from vibeam.report.cost import MOST_ROWS, answer, details, parts, runs, sheet, uncertain
from vibeam.report.work_precision import work_precision
from vibeam.runs.sweep import sweep
from vibeam.solvers import SOLVERS, solver
from vibeam.studies.cost import measure as measured_module
from vibeam.studies.cost import study as study_module
from vibeam.studies.cost.measure import Setting, measure, series_of
from vibeam.studies.cost.planning import (
    Planning,
    RunSchedule,
    finest_model,
    first_mode_restitution_of,
    models,
    run_schedule,
)
from vibeam.studies.cost.reference import bound
from vibeam.studies.cost.row import LinkShare, part, shares, timed
from vibeam.studies.cost.study import CostStudy, cost

pytestmark = pytest.mark.usefixtures("undrawn")

TINY = SDOF + '\n[cost]\nsettle = 5\nhold = 2\nfrequency = ["1.9 rad/s", "2 rad/s", "2.1 rad/s"]\nrepeats = 2\n'
BEAM = {
    "cost.settle": 40,
    "cost.hold": 2,
    "cost.frequency": ["15 Hz", "15.5 Hz"],
    "cost.solvers": ["flight", "orbit", "averaging"],
    "cost.modes": [4],
    "beam.elements": 12,
    "sweep.settle": 200,
}


class Clock:
    """Each look at it, a second has passed."""

    def __init__(self) -> None:
        self.count = itertools.count()

    def __call__(self) -> float:
        return float(next(self.count))


def test_every_solver_takes_its_settings() -> None:
    case, rungs = parse(SDOF), [rung for name in SOLVERS for ladder in series_of(name, 1e-3) for rung in ladder]
    for rung in rungs:
        solver(rung.solver, case.system("sdof"), 1.5, **rung.options)
    assert len({rung.label for rung in rungs}) == len(rungs)


def test_the_cheapest_next_and_the_rest_is_named() -> None:
    ladder = tuple(Setting("direct", "RK23", f"rtol {i}", growth=3.0) for i in range(4))
    single = (Setting("flight"),)
    taken: list[str] = []
    seconds = {"budget": 20.0}

    def run(fidelity: str, rung: Setting) -> float | None:
        taken.append(f"{fidelity} {rung.label}")
        took = 1.0 if rung.solver == "flight" else 2.0 * 3.0 ** int(rung.setting[-1])
        seconds["budget"] -= took
        return took

    tracks = [RunSchedule("a", ladder, 2.0), RunSchedule("b", single, 1.0), RunSchedule("c", single, 50.0)]
    left = run_schedule(tracks, lambda: seconds["budget"], run)
    assert taken == ["b flight", "a direct RK23 rtol 0", "a direct RK23 rtol 1"]
    assert [(each.fidelity, each.run) for each in left] == [
        ("a", "direct RK23 rtol 2"), ("a", "direct RK23 rtol 3"), ("c", "flight"),
    ]  # fmt: skip
    assert "about 18 s" in left[0].why
    assert "about 54 s" in left[1].why
    assert "11 s of the budget" in left[0].why
    stopped = run_schedule([RunSchedule("a", ladder, 2.0)], lambda: 100.0, lambda fidelity, rung: None)
    assert len(stopped) == 3
    assert "rtol 0 broke down" in stopped[0].why


@pytest.fixture(scope="module")
def tiny() -> CostStudy:
    return cost(parse(TINY, set={"cost.budget": 20}), clock=Clock())


def test_a_study_with_a_clock_of_its_own_leaves_out_what_does_not_fit(tiny: CostStudy) -> None:
    """Every look at the clock costs a second of the 20: most runs find no room, and each of them is named."""
    everything = {rung.label for name in SOLVERS for ladder in series_of(name, 1.0) for rung in ladder}
    assert {row.label for row in tiny.rows} | {each.run for each in tiny.left_out} == everything
    assert not {row.label for row in tiny.rows} & {each.run for each in tiny.left_out}
    assert tiny.left_out


@pytest.fixture(scope="module")
def whole() -> CostStudy:
    names = ["flight", "orbit", "mapping", "averaging", "moreau", "zhuravlev"]
    with pytest.MonkeyPatch.context() as patch:
        coarse, strict = series_of("moreau", 1e-2)[0], series_of("zhuravlev", 1e-2)[1]
        fewer = {"moreau": [(coarse[0], coarse[3])], "zhuravlev": [strict[4:]]}
        patch.setattr(study_module, "series_of", lambda name, size: fewer.get(name) or series_of(name, size))
        return cost(parse(TINY, set={"cost.solvers": names, "cost.settle": 130, "cost.repeats": 1}))


def test_a_study_of_one_degree_of_freedom(whole: CostStudy) -> None:
    rows = {row.label: row for row in whole.rows}
    assert whole.bound.points == 3
    assert whole.bound.value < 1e-8
    assert whole.bound.impacts < 1e-8
    assert abs(rows["moreau 100 steps"].total.amplitude.worst) > 10 * abs(
        rows["moreau 3000 steps"].total.amplitude.worst
    )
    assert abs(rows["mapping"].total.amplitude.worst) < 1e-8
    assert (
        0.001
        < abs(rows["averaging log"].total.amplitude.worst)
        < abs(rows["averaging paper"].total.amplitude.worst)
        < 0.1
    )
    assert rows["flight"].numerical.path == 0
    assert rows["zhuravlev DOP853 rtol 1e-10"].numerical.impact_velocities < 1e-8
    assert rows["zhuravlev DOP853 rtol 1e-10"].work.evaluations > rows["flight"].work.impacts > 100
    assert all(row.work.cpu_min <= row.work.cpu_median for row in whole.rows)


def test_the_work_counts_all_that_is_timed() -> None:
    """Sweep, clouds and path: on the pressed stop of the tight rig, where the motion at 14 Hz does not repeat."""
    case = parse(HELD_AT_CONTACT.split("[reference")[0], set=BEAM | {"stop.gap": "-0.1 mm"})
    plan = replace(_plan(case), omega=2 * np.pi * np.array([14.0, 15.5]))  # type: ignore[type-var]
    found, work = timed(lambda: measure(case.system("sdof"), Setting("flight"), plan), Clock(), 3, 1.0)
    assert 0 in found.clouds
    assert len(found.clouds[0].amplitude) == 200
    assert found.path is not None
    swept, clouded = int(np.sum(found.response.impacts)), sum(each.impacts for each in found.clouds.values())
    assert work.impacts == swept + clouded + len(found.path.impact_times) > swept + 200
    assert work.periods == 2 * (plan.settle + plan.hold) + 200 * len(found.clouds) + 10
    assert (work.cpu_min, work.cpu_median, work.repeats) == (1.0, 1.0, 1)


def test_the_timed_call_is_the_call_whose_error_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each solver is made once a repeat and nowhere else but for its estimate and what is exact."""
    made: list[str] = []
    real = measured_module.solver

    def counted(name: str, *words: object, **options: object) -> object:
        made.append(name)
        return real(name, *words, **options)

    monkeypatch.setattr(measured_module, "solver", counted)
    study = cost(parse(TINY, set={"cost.solvers": ["mapping"], "cost.repeats": 3}))
    assert [row.work.repeats for row in study.rows] == [3]
    assert made.count("mapping") == 1 + 3


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
    assert np.isnan(failed.total.amplitude.worst)
    assert failed.why.startswith("3 of 3 points: a number overflowed")
    assert [study.rows[i].solver for i in study.front] == ["flight"]
    axes = work_precision(study, case).axes[0]
    edge = [x for each in axes.lines if each.get_marker() == "X" for x in each.get_xdata()]
    assert edge
    assert min(edge) > 10  # beyond an error of 1000 %, at the edge
    sheet(study, case).write(tmp_path / "a_cost.csv", case.figure)
    assert "a number overflowed" in (tmp_path / "a_cost.csv").read_text(encoding="utf-8")


@pytest.mark.parametrize(("solver", "looks"), [("flight", 1.5), ("direct", 8), ("ivanov", 8)])
def test_time_up_within_a_run_is_told(solver: str, looks: float) -> None:
    """Between the points, and within one that is integrated: it takes some thousand evaluations, 64 a look."""
    case, after = parse(TINY), 1 if solver == "flight" else 0
    with pytest.raises(OutOfTime, match=f"stopped after {after} of 3 points: the time was up"):
        measure(case.system("sdof"), Setting(solver), _plan(case), Clock(), looks)


def test_a_first_setting_that_takes_the_budget_is_left_out_and_said() -> None:
    case = parse(TINY, set={"cost.budget": 5, "cost.solvers": ["flight", "ivanov"]})
    study = cost(case, clock=Clock())
    assert {each.why for each in study.left_out if each.run.startswith("ivanov")} == {"over the whole budget"}
    assert study.bound.note == "integration at 1e-12 takes more than 5 s"


def _plan(case: object) -> object:
    return Planning(case, finest_model(case, models(case)[0])).plan  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def beam() -> CostStudy:
    return cost(parse(HELD_AT_CONTACT.split("[reference")[0], set=BEAM))


def test_the_parts_add_up_exactly(beam: CostStudy) -> None:
    for each in beam.splits:
        assert sum(part.mean for part in each.parts) == pytest.approx(each.total.mean, rel=1e-12, abs=1e-15)
        assert each.points == 2
    sdof = next(each for each in beam.splits if each.fidelity == "sdof")
    names = {part.name: part for part in sdof.parts}
    assert sdof.restitution == pytest.approx(0.72)
    assert names["contact law"].mean > 0.15 > abs(names["reduction"].mean) > 0
    assert names["effects left out"].worst == 0


def test_the_contact_laws_part_is_that_of_the_same_restitution_seen(beam: CostStudy) -> None:
    """By hand: the single degree of freedom with the R₁ of the eight-mode beam, flown."""
    case = parse(HELD_AT_CONTACT.split("[reference")[0], set=BEAM)
    systems = {name: case.system(name) for name in ("sdof", "beam")}
    other = with_first_mode_restitution(systems["sdof"], first_mode_restitution_of(systems["beam"]))
    assert other.restitution == pytest.approx(first_mode_restitution_of(systems["beam"]))  # of one mode, R₁ is R
    amplitudes = [
        sweep(each, omega=2 * np.pi * np.array([15, 15.5]), amplitude=case.base_amplitude, settle=200, output="sensor")
        for each in (systems["sdof"], other, systems["beam"])
    ]
    *steps, _ = shares(amplitudes)  # type: ignore[arg-type]
    told = {part.name: part for each in beam.splits if each.fidelity == "sdof" for part in each.parts}
    for name, link in zip(("contact law", "reduction"), steps, strict=False):
        part, step = told[name], link.values
        assert part.mean == pytest.approx(np.mean(step), rel=1e-6)
        assert part.rms == pytest.approx(np.sqrt(np.mean(step**2)), rel=1e-6)
        assert (part.lowest, part.highest) == pytest.approx((min(step), max(step)), rel=1e-6)
        assert part.peak == pytest.approx(link.at_peak, rel=1e-6)


def test_a_chain_telescopes_over_the_points_that_all_have() -> None:
    chain = [curve([1, 2, 3], a, p) for a, p in (([3, 9, 2], [1, 1, 0]), ([4, 8, 2], 1), ([2, 4, 1], 1))]
    found = shares(chain)
    assert [list(each.values) for each in found] == [[-0.5, 0.25], [1.0, 1.0], [0.5, 1.25]]
    assert [each.at_peak for each in found] == [0.25, 1.0, 1.25]  # the last one's peak is the second point
    loose = [chain[0], chain[1], replace(chain[2], period=np.array([1, 0, 1]))]
    assert np.isnan([each.at_peak for each in shares(loose)]).all()  # there it does not repeat: no error of a link


def test_a_part_has_its_extremes_and_its_value_at_the_peak_with_their_signs() -> None:
    found = part("reduction", LinkShare(np.array([-0.3, 0.1, 0.2]), 0.1))
    assert (found.lowest, found.highest, found.worst, found.peak) == (-0.3, 0.2, 0.3, 0.1)
    assert found.mean == pytest.approx(0.0, abs=1e-15)
    assert found.rms == pytest.approx(np.sqrt(0.14 / 3))
    assert np.isnan(part("reduction", LinkShare(np.array([]), np.nan)).peak)


def test_where_no_contact_gives_that_restitution_the_part_is_left_out_with_its_reason() -> None:
    case = parse(HELD_AT_CONTACT.split("[reference")[0], set=BEAM | {"stop.restitution": 0.05})
    told = cost(parse(case.text, set={"cost.solvers": ["flight"]})).splits[0]
    assert (told.fidelity, told.points) == ("sdof", 2)
    assert "outside [0, 1]" in told.parts[0].note
    assert np.isnan(told.parts[0].mean)
    assert told.parts[1].mean == told.total.mean  # the next link holds both


def test_models_of_one_system_are_one_and_modes_are_cut_below_the_finest() -> None:
    found, same = models(parse(SDOF + "[fidelity.again]\nsolver = 'mapping'\n"))
    assert [model.name for model in found] == ["sdof"]
    assert same == {"again": "sdof"}
    case = parse(HELD_AT_CONTACT.split("[reference")[0])
    found, _ = models(case)
    assert [(model.name, model.system.size, model.cut) for model in found] == [
        ("sdof", 1, False), ("two_modes", 2, False), ("beam", 8, False), ("modes_1", 1, True), ("modes_4", 4, True),
    ]  # fmt: skip
    assert [model.system.size for model in models(case, (16,))[0]] == [1, 2, 8, 16]


def test_a_file_is_the_truth_where_the_case_says_so(tmp_path: Path) -> None:
    """The curve is the single degree of freedom's own, five percent too large: that is what is found, at its points."""
    case = parse(TINY, set={"cost.settle": 150})
    plan = _plan(case)
    exact = measure(case.system("sdof"), Setting("flight"), plan).response  # type: ignore[arg-type]
    rows = [f"{f!r},up,{1.05 * a!r}" for f, a in zip(exact.frequency.tolist(), exact.amplitude.tolist(), strict=True)]
    (tmp_path / "curve.csv").write_text("\n".join(["frequency_hz,direction,amplitude", *rows]), encoding="utf-8")
    table = '[reference.own]\nfile = "curve.csv"\nfidelity = "sdof"\nquantity = "amplitude"\ntolerance = "1 %"\n'
    options = {"cost.settle": 150, "cost.solvers": ["flight"], "cost.reference": "own", "cost.frequency": None}
    study = cost(parse(TINY + table, tmp_path / "a.toml", set=options))
    assert study.truth == "reference own"
    assert len(study.frequency) == 3
    assert abs(study.rows[0].total.amplitude.worst) == pytest.approx(1 - 1 / 1.05, rel=1e-6)
    assert abs(study.rows[0].numerical.amplitude.worst) < 1e-8
    assert study.splits[0].parts[-1].mean == pytest.approx(1 / 1.05 - 1, rel=1e-6)
    assert sum(part.mean for part in study.splits[0].parts) == pytest.approx(study.splits[0].total.mean, rel=1e-12)
    assert parts(study).row_count == 2  # in all, and the finest fidelity itself
    with pytest.raises(ValueError, match=r"0\.3 Hz is no point of reference 'own'"):
        cost(parse(TINY + table, tmp_path / "a.toml", set=options | {"cost.frequency": [0.3]}))
    with pytest.raises(ValueError, match=r"cost\.reference: no reference 'owm'; did you mean 'own'"):
        parse(TINY + table, tmp_path / "a.toml", set={"cost.reference": "owm"})


def test_modes_are_asked_of_a_beam_alone() -> None:
    with pytest.raises(ValueError, match=r"cost\.modes: a single degree of freedom has one mode"):
        parse(TINY, set={"cost.modes": [1, 2]})


def test_too_little_time_leaves_all_runs_out_and_says_so() -> None:
    case = parse(TINY, set={"cost.budget": 1e-9, "cost.solvers": ["flight", "orbit"]})
    study = cost(case)
    assert study.rows == ()
    assert {each.run for each in study.left_out} == {"flight", "orbit"}
    assert study.splits[0].cpu > 0
    note = next(uncertain(study, case))
    assert "2 of 2 runs, by flight and orbit, did not fit into 1e-09 s: vibeam verdict " in note
    assert study.cpu < float(note.partition(" --only solvers --budget '")[2].partition(" s'")[0])
    assert answer(study, case).endswith(" a frequency; no run had time.")
    assert work_precision(study, case).axes


def test_the_bound_sees_a_reference_that_is_off() -> None:
    """The check of the reference can fail: an amplitude wrong by 1e-6 shows as that."""
    case = parse(TINY, set={"cost.settle": 150})
    plan = _plan(case)
    exact = measure(case.system("sdof"), Setting("flight"), plan)  # type: ignore[arg-type]
    fine = bound(case.system("sdof"), exact, plan)  # type: ignore[arg-type]
    assert fine.amplitude < 1e-8
    exact.response.amplitude[1] *= 1 + 1e-6
    assert bound(case.system("sdof"), exact, plan).amplitude == pytest.approx(1e-6, rel=0.02)  # type: ignore[arg-type]


def test_what_finds_no_motion_somewhere_is_not_on_the_front(beam: CostStudy) -> None:
    without = replace(beam, rows=tuple(replace(row, found=1) for row in beam.rows if row.solver == "orbit"))
    assert beam.front
    assert without.rows
    assert without.front == []


def test_the_sheet_answers_first(beam: CostStudy) -> None:
    """By times of our own, a millisecond a mode by flight and ten by all else."""
    case = parse(HELD_AT_CONTACT.split("[reference")[0], set=BEAM)
    times = [1e-3 * row.modes * (1 if row.solver == "flight" else 10) for row in beam.rows]
    study = replace(beam, rows=tuple(
        replace(row, work=replace(row.work, cpu_min=time)) for row, time in zip(beam.rows, times, strict=True)
    ))  # fmt: skip
    found = sheet(study, case, within=0.1)
    assert found.answer == (
        "With R = 0.72 at the contact held, exact flight of beam takes 4 ms a frequency; the cheapest within 10 % is "
        "beam cut off after mode 4 by flight, 2 times faster and 7 % off; orbit takes 10 times as long and is exact."
    )
    assert "nothing cheaper is within 0 %: the nearest is beam cut off after mode 4 " in answer(study, case, 0.0)
    few = tuple(replace(row, total=replace(row.total, amplitude=replace(row.total.amplitude, points=0)))
                for row in study.rows)  # fmt: skip
    assert "; of cheaper runs the error is known at less than half of the 2 frequencies" in answer(
        replace(study, rows=few), case
    )
    moved = (replace(row, numerical=replace(row.numerical, kind=1)) for row in study.rows)
    notes = list(uncertain(replace(study, rows=tuple(moved)), case))
    assert any(
        each.startswith("Exact flight is in another motion at 1 of 2 frequencies after 40 periods") for each in notes
    )
    asked = vibeam.Verdict(case, VerdictPlan(accuracy=0.1), (vibeam.studies.Stage("solvers", study, 0.0),))
    assert verdict.sheet(asked).answer == found.answer != answer(study, case)
    table = found.tables[0].brief()
    assert {str(cell).split()[0] for cell in table.columns[1].cells} == {"flight", "orbit", "averaging"}
    assert (
        [str(cell) for cell in table.columns[-1].cells].count("*") == len(study.front) <= table.row_count <= MOST_ROWS
    )
    shown = [each for split in beam.splits for each in split.parts if each.worst > 1e-12]
    assert [each.row_count for each in found.more] == [len(beam.rows), len(beam.splits) + len(shown)]
    assert found.details[0].startswith("Reference: beam. Solver error: flight and closed-form orbits agree to ")
    assert any("beam is off its own limit by +6" in line for line in found.notes)


def test_a_budget_for_all_of_it_is_kept_or_refused_beforehand() -> None:
    """By a clock of its own: the exact motions are within it, and what they alone exceed is not begun."""
    case, done = parse(TINY, set={"cost.solvers": ["flight", "moreau"]}), []
    study = cost(case, progress=lambda *counts: done.append(counts), clock=Clock(), budget=1000.0)
    assert study.budget == 1000
    assert study.cpu <= 1000 + study.rows[-1].work.cpu_min * 3
    assert (done[0], done[-1]) == ((0, 7), (7, 7))
    with pytest.raises(ValueError, match=r"the exact motions of 1 model alone take about \d+ s .* and 1 s are allowed"):
        cost(case, clock=Clock(), budget=1.0)


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tiny.toml").write_text(TINY, encoding="utf-8")
    words = ["verdict", "tiny.toml", "--only", "solvers", "--set", 'cost.solvers=["flight", "averaging"]']
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    assert {path.name for path in tmp_path.iterdir()} == {
        "tiny.toml", "tiny_cost.png", "tiny_cost.svg", "tiny_cost.csv",
    }  # fmt: skip
    assert "Error against time" in result.stdout
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
    settings = {"stop.restitution": None, "stop.law": "hertz", "stop.hertz_stiffness": 1e3, "cost.repeats": 1}
    study = cost(parse(TINY, set=settings | {"cost.solvers": ["flight", "orbit", "averaging"]}))
    assert [row.solver for row in study.rows] == ["flight", "orbit"]
    assert {each.run for each in study.refused} == {"averaging"}
    assert np.isnan(study.splits[0].restitution)
    told = "\n".join(details(study))
    assert 'averaging cannot take sdof: the contact law "hertz"' in told
    assert "HuntCrossley" not in told
    assert (parts(study).row_count, runs(study).row_count) == (1 + 3, 2)  # rows that say why there is no part


def test_a_frequency_without_averaged_motion_has_no_path_of_averaging() -> None:
    """Above its resonance the beam stays clear of a stop at 0.3 mm: averaging over impacts finds nothing there."""
    frequency = {"from": "4 Hz", "to": "8 Hz", "points": 9}
    plan = {"cost.solvers": ["flight", "averaging"], "cost.budget": "1 s", "cost.modes": [1]}
    changed = {"stop.restitution_of": "contact", "stop.gap": "0.3 mm", "sweep.frequency": frequency}
    study = vibeam.cost(vibeam.load(Path(__file__).parents[3] / "cases" / "dtu_neutral.toml", set=changed | plan))
    assert {row.solver for row in study.rows} >= {"flight", "averaging"}
