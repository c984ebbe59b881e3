"""Fidelity map: against sweeps of each model on their own, constructed motions, and the variance it promises."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import chain, repeat
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stand_in import RIG, one_mode
from typer.testing import CliRunner

import vibeam
from vibeam.case.case import Case
from vibeam.casefile.read import parse
from vibeam.cli.main import app
from vibeam.exchange.faults import CaseError
from vibeam.maps.axes import axes_over
from vibeam.maps.boundaries import boundaries_of, joined
from vibeam.maps.irregular import IRREGULAR, NO_CONTACT
from vibeam.report.maps.verdict import sheet
from vibeam.runs.comparison.errors import Asked
from vibeam.studies.fidelity_map import judgement, study
from vibeam.studies.fidelity_map.judgement import MappedMotions
from vibeam.system.number_text import percent

pytestmark = pytest.mark.usefixtures("undrawn")

CASES = Path(__file__).parents[3] / "cases"
QUICK = {"sweep.settle": 120, "sweep.hold": 40, "beam.elements": 8, "fidelity.beam.modes": 3}
GAPS = {"low": "-0.02 mm", "high": "0.1 mm"}


@pytest.fixture(scope="module")
def case() -> vibeam.Case:
    return vibeam.load(CASES / "dtu_neutral.toml", QUICK)


@pytest.fixture(scope="module")
def found(case: vibeam.Case) -> vibeam.FidelityMap:
    return vibeam.fidelity_map(case, "gap", points=5, frequencies=13, accuracy="2 %", **GAPS)


def swept(case: vibeam.Case, name: str, gap: float) -> vibeam.Branches:
    """The sweep of ``vibeam run`` at one gap, by another way than the map's."""
    own = vibeam.load(CASES / "dtu_neutral.toml", QUICK | {"stop.gap": f"{gap!r} m"})
    frequencies = np.linspace(own.sweep.frequency.min(), own.sweep.frequency.max(), 13)
    both = vibeam.sweep(
        own.system(name), omega=2 * np.pi * frequencies, amplitude=own.base_amplitude, direction="both", settle=120,
        hold=40, output="sensor",
    )  # fmt: skip
    assert isinstance(both, vibeam.Branches)
    return both


def test_the_label_is_the_cheapest_within_the_accuracy(case: vibeam.Case, found: vibeam.FidelityMap) -> None:
    """In rows where all is periodic kinds and amplitudes of plain sweeps give the same regions."""
    judged = 0
    for row, gap in enumerate(found.values):
        curves = {model.name: swept(case, model.name, float(gap)) for model in found.models}
        if any((way.period == 0).any() for each in curves.values() for _, way in each.items()):
            continue  # which motion a sweep comes to after a chaotic one is chance
        for column in range(13):
            want = len(found.models) - 1
            for index in (1, 0):
                fits = True
                for way in ("up", "down"):
                    mine, best = (getattr(curves[name], way) for name in (found.models[index].name, "beam"))
                    at = column if way == "up" else 12 - column
                    near = abs(mine.amplitude[at] - best.amplitude[at]) <= 0.02 * best.amplitude[at]
                    fits &= bool(near) and mine.period[at] == best.period[at]
                want = index if fits else want
            assert found.label[row, column] == want
            judged += 1
    assert judged >= 50
    assert len(np.unique(found.label)) >= 2


def test_shares_add_up_and_rows_say_where(found: vibeam.FidelityMap) -> None:
    assert [model.name for model in found.models] == ["sdof", "two_modes", "beam"]
    assert sum(found.shares.values()) == pytest.approx(1.0)
    touched = np.any([model.kind != NO_CONTACT for model in found.models], axis=(0, 1))
    assert 0 < touched.sum() < touched.size
    sdof, _, beam = found.rows
    assert beam.within == 1.0
    wrong = ~judgement.within(found.models[0], found.finest, found.asked, found.frequency)
    assert sdof.within == pytest.approx(1 - wrong[touched].mean())
    assert found.shares["beam"] == pytest.approx((found.label == 2)[touched].mean())
    assert f"suffices on {percent(found.shares['two_modes'])} of the places with impacts (" in sheet(found).answer
    alike = (found.models[0].kind == found.finest.kind) & touched
    shares = (found.models[0].value / found.finest.value)[alike] - 1
    assert sdof.bias == pytest.approx(shares.mean())


def test_boundaries_have_other_motions_on_either_side(case: vibeam.Case, found: vibeam.FidelityMap) -> None:
    """A thousandth of a row or column off each point the closed-form motions are not what they are on the other."""
    system = case.system("beam")
    factor = case.model("beam").at({"stop.gap": float(found.values[-1])}).system().gap / found.values[-1]
    curves = [curve for curve in found.boundaries if curve.fidelity == "beam"]
    steps = 2 * np.pi * 1e-3 * np.ptp(found.frequency) / 12, 1e-3 * factor * np.ptp(found.values) / 4
    for curve in curves:
        at = len(curve.frequency) // 2
        omega, gap = 2 * np.pi * curve.frequency[at], factor * curve.value[at]
        around = [
            tuple((orbit.admissible, orbit.stable) for orbit in vibeam.orbits(
                replace(system, gap=gap + up * steps[1]), vibeam.Drive(omega + across * steps[0], case.base_amplitude)
            ))
            for across, up in ((1, 0), (-1, 0), (0, 1), (0, -1))
        ]  # fmt: skip
        assert len(set(around)) > 1, curve
    assert len(curves) >= 2


def test_over_a_key_that_changes_the_structure(case: vibeam.Case) -> None:
    """Rows of their own systems: the boundaries of each row are those of its case."""
    found = vibeam.fidelity_map(case, "mass.mass", "0.19 kg", "0.21 kg", 3, 7)
    assert found.plan.axes[0].unit == "kg"
    assert found.label.shape == (3, 7)
    heavy = vibeam.load(CASES / "dtu_neutral.toml", QUICK | {"mass.mass": "0.21 kg"})
    frequencies = 2 * np.pi * np.linspace(14, 17, 7)
    curve = vibeam.sweep(
        heavy.system("sdof"), omega=frequencies, amplitude=heavy.base_amplitude, settle=120, hold=40, output="sensor"
    )
    assert isinstance(curve, vibeam.FrequencyResponse)
    np.testing.assert_allclose(found.models[0].value[0, 2], curve.amplitude, rtol=1e-9)


def test_a_label_that_hangs_on_scatter_is_doubtful() -> None:
    finest = motions([[1, IRREGULAR, IRREGULAR, 8]] * 2, [[1.0] * 4] * 2, [1] * 4, error=0.01)
    other = motions([[1, IRREGULAR, IRREGULAR, IRREGULAR]] * 2, [[1.0, 1.05, 1.2, 1.0]] * 2, [1] * 4)
    other, finest = (replace(each, error=np.where(each.kind == 1, 0.0, each.error)) for each in (other, finest))
    assert judgement.doubtful([other, finest], Asked.of(0.01))[0].tolist() == [False, True, False, True]


def motions(kind: Any, value: Any, count: Any, error: float = 0.0) -> MappedMotions:
    kinds, values = np.array(kind)[:, None, :], np.array(value, dtype=float)[:, None, :]
    return MappedMotions(
        "one", 1, values, np.full(values.shape, error), kinds, np.array(count)[None, :], 1e-3,
    )  # fmt: skip


def test_differences_in_kind_the_gravest_first() -> None:
    finest = motions([[1, 1, 1, IRREGULAR, IRREGULAR, 2]] * 2, [[1.0] * 6] * 2, [1, 1, 1, 1, 1, 1])
    other = motions([[1, 2, 1, 1, IRREGULAR, NO_CONTACT]] * 2, [[1.0] * 6] * 2, [1, 1, 2, 1, 1, 2])
    want = [judgement.SAME, judgement.IN_PERIOD, judgement.IN_NUMBER, judgement.IN_PERIOD, judgement.SAME]
    assert judgement.difference(other, finest)[0].tolist() == [*want, judgement.IN_NUMBER]


def test_both_ways_must_be_within_the_accuracy() -> None:
    finest = motions([[1, 1, 1, IRREGULAR]] * 2, [[1.0, 1.0, 1.0, 1.0], [2.0, 2.0, 2.0, 2.0]], [2] * 4, error=0.01)
    other = motions([[1, 1, 1, IRREGULAR]] * 2, [[1.009, 1.05, 1.0, 1.029], [2.0, 2.0, 2.5, 2.0]], [2] * 4)
    exact = replace(finest, error=np.zeros(finest.error.shape))
    assert judgement.within(other, exact, Asked.of(0.01))[0].tolist() == [True, False, False, False]
    assert judgement.within(other, finest, Asked.of(0.01))[0].tolist() == [
        True,
        False,
        False,
        True,
    ]  # 0.029 < 0.01 + 2 · 0.01


def test_an_end_of_a_branch_may_lie_as_far_off_as_is_asked() -> None:
    """The finest jumps between 10.05 and 10.1 Hz, the others one and three places later."""
    frequency = 10 + 0.05 * np.arange(8)
    kinds = [[1] * n + [NO_CONTACT] * (8 - n) for n in (2, 3, 5)]
    values = np.array([[5.0] * n + [1.0] * (8 - n) for n in (2, 3, 5)])
    finest, early, late = (motions([each] * 2, [row] * 2, [1] * 8) for each, row in zip(kinds, values, strict=True))
    asked = Asked.of(0.05, 0.006)
    assert judgement.within(early, finest, asked, frequency).all()
    assert judgement.within(late, finest, asked, frequency)[0].tolist() == [*[True] * 2, *[False] * 3, *[True] * 3]
    assert judgement.within(early, finest, asked)[0].tolist() == [*[True] * 2, False, *[True] * 5]
    other = replace(early, kind=np.where(early.kind == NO_CONTACT, 2, early.kind))  # never without contact
    assert not judgement.within(other, finest, asked, frequency)[0, 2:].any()


def test_models_that_both_rest_on_the_stop_do_not_differ() -> None:
    """With a gap below zero a weak drive moves neither."""
    finest, other = motions([[1, 1]] * 2, [[0.0, 1.0]] * 2, [1, 1]), motions([[1, 1]] * 2, [[0.0, 1.1]] * 2, [1, 1])
    assert judgement.relative(other, finest)[0] == pytest.approx([0.0, 0.1])
    assert judgement.within(other, finest, Asked.of(0.01))[0].tolist() == [True, False]


def test_a_place_of_rest_is_none_with_impacts() -> None:
    """Pressed against its stop by a gap of −1 mm the relay rests under a drive this weak, whatever its modes."""
    relay = CASES / "rigs" / "relay.toml"
    changes = {"sweep.settle": 30, "sweep.hold": 5}
    found = vibeam.fidelity_map(vibeam.load(relay, changes), "gap", "-1 mm", "0.1 mm", 2, 3)
    assert found.touched.any(axis=1).tolist() == [False, True]


def test_motions_that_do_not_repeat_are_of_one_kind() -> None:
    finest = motions([[8, IRREGULAR, 16, 4]] * 2, [[1.0] * 4] * 2, [1] * 4)
    other = motions([[IRREGULAR, 8, IRREGULAR, IRREGULAR]] * 2, [[1.0] * 4] * 2, [1] * 4)
    assert judgement.within(other, finest, Asked.of(0.05))[0].tolist() == [True, True, True, False]


def test_places_are_joined_from_row_to_row() -> None:
    rows = [[1.0, 5.0], [1.1, 5.2], [1.2], [1.3, 9.0]]
    assert joined(rows, 0.5) == [[(0, 5.0), (1, 5.2)], [(0, 1.0), (1, 1.1), (2, 1.2), (3, 1.3)], [(3, 9.0)]]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"over": "frequency"}, "--over: write one key beside the frequency"),
        ({"over": "frequency,colour"}, "no key of the case"),
        ({"over": "frequency,mass.mass"}, "--from: missing"),
        ({"low": "1 kg"}, "--from: '1 kg' is a mass"),
        ({"low": "1 mm", "high": "0 mm"}, "must ascend"),
        ({"accuracy": "2 m"}, "--accuracy"),
        ({"accuracy": 1.5}, "--accuracy: must lie between"),
        ({"quantity": "colour"}, "--quantity"),
    ],
)
def test_faults_say_which_argument(case: vibeam.Case, given: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        vibeam.fidelity_map(case, **given)


def test_one_model_alone_has_no_verdict() -> None:
    alone = vibeam.load(CASES / "sdof_nominal.toml")
    with pytest.raises(ValueError, match="compares two models"):
        vibeam.fidelity_map(alone)


@pytest.mark.parametrize("as_json", [False, True], ids=["tables", "json"])
def test_the_command_prints_the_map_and_writes_its_files(tmp_path: Path, as_json: bool) -> None:
    asked = ["map", str(CASES / "dtu_neutral.toml"), "--picture", "verdict", "--points", "2,3", "--out", f"{tmp_path}/"]
    asked += [word for key, value in QUICK.items() for word in ("--set", f"{key}={value}")]
    asked += ["--from", "0 mm", "--to", "0.1 mm", "--accuracy", "2 %", *(["--json"] * as_json)]
    printed = CliRunner().invoke(app, asked)
    assert printed.exit_code == 0, printed.output
    assert "To 2 % of the amplitude at the sensor" in printed.stdout
    assert {path.name for path in tmp_path.iterdir()} >= {"dtu_neutral_verdict.csv", "dtu_neutral_verdict.png"}
    lines = (tmp_path / "dtu_neutral_verdict.csv").read_text().splitlines()
    assert len(lines) == 1 + 2 * 3 * 3 * 2
    if as_json:
        (told,) = json.loads(printed.stdout)["maps"]
        assert [row["fidelity"] for row in told["fidelities"]] == ["sdof", "two_modes", "beam"]
        assert sum(told["shares"].values()) == pytest.approx(1)


def test_a_mistake_leaves_no_file(tmp_path: Path) -> None:
    words = ["--picture", "verdict", "--over", "gap,drive", "--out", f"{tmp_path}/"]
    asked = ["map", str(CASES / "dtu_neutral.toml"), *words]
    printed = CliRunner().invoke(app, asked)
    assert printed.exit_code == 2
    assert "--over" in printed.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("over", "counts"), [("gap", (4, 3)), ("frequency,gap", (3, 4)), ("gap, sweep.frequency", (4, 3))]
)
def test_a_plane_is_asked_for_in_either_way(case: vibeam.Case, over: str, counts: tuple[int, int]) -> None:
    """Numbers of places are in the order of the words, the frequency is across."""
    gap, frequency = axes_over(case, over, None, None, counts, "sdof")
    assert (gap.key, len(gap.values), frequency.key, len(frequency.values)) == ("stop.gap", 4, "sweep.frequency", 3)


GRID = '{ from = "1.9 rad/s", to = "2.9 rad/s", points = 5 }'
RANGES = {"stop.restitution": (0.85, 0.95), "stop.gap": (0.1e-3, 0.3e-3)}
TEXT = one_mode(GRID, 20, 5, "[fidelity.one]", "[fidelity.other]", gap=0.2e-3)


def driven(**drive: Any) -> Case:
    return parse(TEXT, "mine.toml", set={"drive": drive})


@pytest.mark.parametrize("key", ["stop.restitution", "drive.acceleration", "stop.gap"])
def test_boundaries_under_an_acceleration_are_those_of_its_amplitude_at_each_frequency(key: str) -> None:
    """B = A/Ω²: at each place of a curve one over the amplitude, the frequency held, has that amplitude."""
    case, ends = driven(acceleration=2e-3), RANGES.get(key, (None, None))
    axes = axes_over(case, key, *ends, (3, 31), "one")
    curves = [each for each in boundaries_of(case, "one", axes)[0] if each.boundary == "period doubling"]
    places = [
        place
        for each in curves
        for part in each.parts()
        for place in zip(each.frequency[part], each.value[part], strict=True)
    ]
    assert len(places) >= 3
    for frequency, value in places[:: -(-len(places) // 12)]:
        omega, own = 2 * np.pi * frequency, parse(TEXT, set={"drive": {"acceleration": 2e-3}} | {key: float(value)})
        level = value if key == "drive.acceleration" else 2e-3
        held = vibeam.boundaries(own.system("one"), (2e-5, 3e-3), omega, kinds=(vibeam.Kind.DOUBLING,))
        assert min(abs(each.amplitude * omega**2 / level - 1) for each in held) < 1e-7


def test_a_drive_s_range_is_written_in_its_unit() -> None:
    beam = vibeam.load(RIG, set={"drive": {"acceleration": "0.05 g"}})
    axis, _ = axes_over(beam, "drive.acceleration", "0.01 g", "1 m/s^2", (3,), "sdof")
    assert (axis.key, axis.unit) == ("drive.acceleration", "m/s^2")
    np.testing.assert_allclose([axis.values[0], axis.values[-1]], [0.0980665, 1.0])


def test_a_drive_of_several_harmonics_is_refused_at_its_key() -> None:
    drive = {"amplitude": 1e-3, "harmonic": [2], "harmonic_share": [0.1]}
    case = parse(TEXT, set={"drive": drive, "fidelity.other.set": {"stop.restitution": 0.8}})
    with pytest.raises(CaseError) as caught:
        vibeam.fidelity_map(case, "drive", fidelities=("one", "other"), points=2, frequencies=2)
    assert str(caught.value) == (
        "--set drive.harmonic: a fidelity map knows a drive of one harmonic: take drive.harmonic away"
    )


def test_a_budget_holds_leaves_places_out_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock that goes on by so many seconds a place, at first and from the second map on; nothing is struck."""
    case = parse(TEXT, set={"fidelity.other.set": {"stop.restitution": 0.8}})
    asked: Any = {"fidelities": ["one", "other"], "points": 40, "frequencies": 20, "low": 1, "high": 2}
    whole, now, each = study.run_map, [0.0], iter([])

    def flown(case: Case, plan: Any, *given: Any, **more: Any) -> vibeam.MapResult:
        now[0] += next(each) * len(plan.axes[0].values) * len(plan.axes[1].values)
        return whole(case, plan, *given, **more)

    monkeypatch.setattr(study, "run_map", flown)
    monkeypatch.setattr(study, "process_time", lambda: now[0])
    monkeypatch.setattr(study, "boundaries_of", lambda *_: ([], ""))

    def made(budget: float, *seconds: float) -> tuple[tuple[int, ...], list[str]]:
        nonlocal each
        now[0], each = 0.0, chain(seconds, repeat(seconds[-1]))
        found = vibeam.fidelity_map(case, **asked, budget=budget)
        rows, columns = found.label.shape
        assert (f"the {rows} x {columns} places of the plane" in sheet(found).answer) is bool(found.thinned)
        assert sheet(found).answer.startswith("No model touches the stop on the ")
        return found.label.shape, [note for note in sheet(found).notes if "budget" in note]

    assert made(100.0, 0.01) == ((40, 20), [])
    left = "places in place of 40 x 20, for the budget: a larger --budget refines the map."
    assert made(1.5, 0.01) == ((9, 8), [f"9 x 8 {left}"])
    assert made(1.5, 0.01, 1.0) == ((3, 3), [f"3 x 3 {left}"])
    with pytest.raises(ValueError, match="3 x 3 places of a fidelity map take longer than"):
        made(0.05, 0.01)


def test_a_kind_s_share_is_written_as_others_are() -> None:
    finest = motions([[IRREGULAR, IRREGULAR, 1, 1]] * 2, [[1.0] * 4] * 2, [1] * 4)
    assert judgement._kinds(finest, np.array([[True, True, True, False]])) == "no repeat (67 %), period 1 (33 %)"
