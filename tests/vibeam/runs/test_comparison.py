"""The comparison of two responses: both errors and differences in kind, of models whose branches are known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_responses import MadeBranch, MadeSimulator, amplitudes, made
from stand_in import RIG, curve

import vibeam
from vibeam.figures.units import DisplayUnits
from vibeam.periodic.motion_kind import FREE, IRREGULAR, UNKNOWN, SteadyKind, kinds_of
from vibeam.report.comparison_words import open_points
from vibeam.runs.comparison.beyond import WEARS, fuller_models, is_whole
from vibeam.runs.comparison.errors import GIVEN, Asked, ResponseComparison, asked_of
from vibeam.runs.comparison.places import simulated
from vibeam.runs.comparison.responses import Response, compared
from vibeam.system.response import Branches

FIVE = Asked.of(0.05)
GRIDS = [np.linspace(100.0, 200.0, count) for count in (41, 60, 101)]


def branch(end: float, period: int = 1, impacts: int = 1, size: float = 1.0, slope: float = 0.002) -> MadeBranch:
    return MadeBranch(end, period, impacts, amplitudes(size, slope))


def hardening(jump: float, size: float = 1.0, begin: float = 120.0, doubled: float = 0.0) -> tuple[MadeBranch, ...]:
    """No contact, period 1, period 2 over the last ``doubled`` Hz, the jump down to no contact."""
    risen = amplitudes(size, 0.002)
    two = (MadeBranch(jump, 2, 2, risen),) * (doubled > 0)
    return branch(begin, FREE, 0, 0.4), MadeBranch(jump - doubled, 1, 1, risen), *two, branch(500.0, FREE, 0, 0.3)


def test_a_fifth_of_the_accuracy_is_asked_of_frequencies() -> None:
    assert (Asked.of(0.05).frequency, Asked.of(0.05, 0.03).frequency) == (pytest.approx(0.01), 0.03)
    assert asked_of(vibeam.load(RIG)) == FIVE
    given = {"verdict": {"accuracy": "2 %", "frequency_accuracy": "3 %"}}
    assert asked_of(vibeam.load(RIG, given)) == Asked(0.02, 0.03)


def test_kinds_are_told_apart_by_periods_and_impacts() -> None:
    found = curve(np.arange(1.0, 8.0), 1.0, [1, 2, 5, 0, -1, 1, 1], impacts_per_period=[2, 1.5, 1, 3, 0, 40, 1])
    found.ended[6] = 2
    assert kinds_of(found) == [
        SteadyKind(1, 2), SteadyKind(2, 3), SteadyKind(IRREGULAR), SteadyKind(IRREGULAR), SteadyKind(FREE),
        SteadyKind(1, -1), SteadyKind(UNKNOWN),
    ]  # fmt: skip
    assert [str(each) for each in kinds_of(found)[:2]] == ["period 1 with 2 impacts", "period 2 with 3 impacts"]


@pytest.mark.parametrize("grid", GRIDS, ids=len)
@pytest.mark.parametrize(("late", "size", "suffices"), [(0.004, 1.03, True), (0.02, 1.0, False), (0.0, 1.08, False)])
def test_both_errors_are_those_of_the_models_on_any_grid(
    grid: np.ndarray, late: float, size: float, suffices: bool
) -> None:
    ours, theirs = made(hardening(180.0 * (1 + late), size), grid), made(hardening(180.0), grid)
    found = compared(ours, theirs)
    assert found.suffices(FIVE) is suffices
    assert found.amplitude_error == pytest.approx(size - 1, abs=1e-9)
    lost = next(each for each in found.ends if each.ours.event == "contact is lost")
    assert lost.error == pytest.approx(late, abs=2e-3)
    assert lost.open <= 2e-3
    assert abs(lost.error - late) <= lost.open
    assert lost.ours.jumps
    assert not found.kinds


def test_what_only_one_of_them_does_is_a_difference_in_kind() -> None:
    for grid in GRIDS:
        ours, theirs = made(hardening(180.0, doubled=10.0), grid), made(hardening(180.0), grid)
        found = compared(ours, theirs)
        assert found.frequency_error <= 2e-3  # the jump is the same
        [other] = found.kinds
        assert (other.ours, other.reference) == (SteadyKind(2, 2), SteadyKind(1, 1))
        assert (other.low, other.high) == (pytest.approx(170, abs=0.2), pytest.approx(180, abs=0.2))
        assert found.suffices(FIVE) is False
        narrow = compared(made(hardening(180.0, doubled=1.0), grid), theirs)
        assert narrow.suffices(FIVE) is True  # 0.6 % wide
        assert not narrow.kinds


def test_a_branch_that_the_step_of_the_grid_left_too_early_is_followed_to_its_end() -> None:
    """With steps of 2.5 Hz the motion leaves up to 2 Hz before its branch ends, with half a hertz it does not."""
    coarse, fine = np.linspace(100.0, 200.0, 41), np.linspace(100.0, 200.0, 401)
    theirs = made(hardening(180.3), fine, careful=2.0)
    found = compared(made(hardening(180.3), coarse, careful=2.0), theirs)
    lost = next(each for each in found.ends if each.ours.event == "contact is lost")
    assert abs(lost.error) <= lost.open + 1e-3
    assert lost.ours.frequency == pytest.approx(180.3, rel=1e-3)


def test_a_branch_left_several_steps_of_the_grid_too_early_is_followed_to_its_end() -> None:
    """Steps of 2.5 Hz leave it within its last 9 Hz; steps of 1.3 Hz, to which halving comes, do not."""
    thrown = made(hardening(180.3), np.linspace(100.0, 200.0, 41), careful=1.3, early=9.0)
    before = max(each.frequency for each in thrown.places["up"] if each.kind.repeats)
    assert before < 173.0
    found = compared(thrown, made(hardening(180.3), np.linspace(100.0, 200.0, 401)))
    lost = next(each for each in found.ends if each.ours.event == "contact is lost")
    assert lost.ours.frequency == pytest.approx(180.3, rel=1e-3)
    assert found.suffices(FIVE) is True


@pytest.mark.parametrize("grid", GRIDS, ids=len)
def test_a_model_without_contact_where_the_other_has_a_narrow_range_does_not_suffice(grid: np.ndarray) -> None:
    touching = branch(150.0, FREE, 0), branch(150.6, 1, 1), branch(500.0, FREE, 0)
    never, narrow = (made(each, grid) for each in ((branch(500.0, FREE, 0),), touching))
    narrow.places["up"] = [*narrow.places["up"], simulated(MadeSimulator(touching), 150.3, None)]
    narrow.places["up"].sort(key=lambda each: each.frequency)
    for ours, theirs in ((never, narrow), (narrow, never)):
        found = compared(ours, theirs)
        assert found.suffices(FIVE) is False
        assert found.kinds[0].alone
        assert found.worst(FIVE) == np.inf
    assert compared(narrow, narrow).suffices(FIVE) is True


def test_a_jump_within_a_kind_is_an_end() -> None:
    def response(jump: float) -> Response:
        return made((branch(jump, size=1.0), branch(500.0, size=2.0)), GRIDS[1])

    found = compared(response(153.0), response(150.0))
    [end] = found.ends
    assert (end.ours.event, end.late) == ("jump", True)
    assert end.error == pytest.approx(0.02, abs=2e-3)


def test_small_amplitudes_are_compared_with_a_tenth_of_the_largest() -> None:
    ours = made((branch(150.0, size=0.02, slope=0.0), branch(500.0, 2, 2, slope=0.0)), GRIDS[0])
    theirs = made((branch(150.0, size=0.01, slope=0.0), branch(500.0, 2, 2, slope=0.0)), GRIDS[0])
    assert compared(ours, theirs).amplitude_error == pytest.approx(0.1)


def test_motions_that_do_not_repeat_are_compared_by_their_means() -> None:
    rng = np.random.default_rng(4)

    def irregular(size: float) -> Response:
        return made((MadeBranch(500.0, 0, 0, lambda _: size * (1 + 0.05 * rng.standard_normal())),), GRIDS[2])

    near, far = compared(irregular(1.0), irregular(1.0)), compared(irregular(1.2), irregular(1.0))
    assert near.amplitude is not None
    assert near.scattered is not None
    assert near.suffices(FIVE) is not False
    assert near.amplitude.least < 0.03
    assert far.suffices(FIVE) is False
    assert far.amplitude_error == pytest.approx(0.2, abs=0.05)


def test_points_that_failed_leave_the_answer_open() -> None:
    up = curve(GRIDS[0], 1.0, 1)
    failed = replace(up, ended=np.where(np.arange(41) > 35, 2, 0))
    found = compared(Response.of(Branches(failed)), Response.of(Branches(up)))
    assert found.suffices(FIVE) is None
    assert found.unknown[0][1] == pytest.approx(188.75)


def test_without_states_an_end_is_known_to_the_step_of_the_grid() -> None:
    """A step of 2.5 Hz leaves 1.25 Hz to either side, of both: too much to say 1 %."""
    up = [curve(GRIDS[0], 1.0, np.where(GRIDS[0] < at, 1, -1)) for at in (151.0, 151.0)]
    found = compared(Response.of(Branches(up[0])), Response.of(Branches(up[1])))
    assert found.ends[0].open == pytest.approx(2 * 1.25 / 151.25)
    assert found.suffices(FIVE) is None


def test_work_that_is_done_leaves_ends_open() -> None:
    ours, theirs = made(hardening(181.0), GRIDS[0]), made(hardening(180.0), GRIDS[0])
    for each in (ours, theirs):
        each.simulator.done = True  # type: ignore[union-attr,misc]
    assert compared(ours, theirs).suffices(FIVE) is None


def test_one_reading_of_what_does_not_repeat_is_not_known() -> None:
    """A single place, and no work left to read it again: its amplitude by chance is no error, nor agreement."""
    branches = MadeBranch(500.0, 0, 3, lambda frequency: 1.0), MadeBranch(500.0, 0, 3, lambda frequency: 1.5)
    ours, theirs = (made((each,), np.array([150.0])) for each in branches)
    read = compared(ours, theirs)
    assert read.amplitude is not None
    ours, theirs = (made((each,), np.array([150.0])) for each in branches)
    for each in (ours, theirs):
        each.simulator.done = True  # type: ignore[union-attr,misc]
    once = compared(ours, theirs)
    assert once.suffices(FIVE) is None
    assert np.isnan(once.amplitude_error)
    assert (
        open_points(once, FIVE, DisplayUnits("mm", 1e3, "Hz", 1.0))
        == "motions that do not repeat were read but once at 150 Hz"
    )


def random_model(rng: np.random.Generator, moved: float) -> tuple[tuple[MadeBranch, ...], tuple[MadeBranch, ...]]:
    """Two models with the same kinds of branches, each at least 8 Hz wide, whose ends differ by ``moved`` at most."""
    kinds = [(FREE, 0), (1, 1), (2, 2), (1, 2), (1, 1)][: int(rng.integers(3, 6))]
    ends = np.cumsum(rng.uniform(10, 24, len(kinds))) + 100
    shift, last = rng.uniform(-moved, moved, len(kinds)) * ends, 500.0
    ours, theirs = (
        tuple(
            MadeBranch(last if i == len(kinds) - 1 else ends[i] + own * shift[i], *kind, amplitudes(1 + i, 0.001))
            for i, kind in enumerate(kinds)
        )
        for own in (1.0, 0.0)
    )  # fmt: skip
    return ours, theirs


@pytest.mark.parametrize("seed", range(30))
def test_another_grid_turns_no_answer(seed: int) -> None:
    """Ends 0.7 % apart at most suffice for 1 %, one that is 1.3 % off does not, on each of three grids."""
    rng = np.random.default_rng(seed)
    ours, theirs = random_model(rng, 0.007)
    far = (replace(theirs[0], end=theirs[0].end * 1.013), *theirs[1:])
    for grid in GRIDS:
        assert compared(made(ours, grid), made(theirs, grid)).suffices(FIVE) is True
        assert compared(made(far, grid), made(theirs, grid)).suffices(FIVE) is False


RELAY = Path(__file__).parents[3] / "cases" / "rigs" / "relay.toml"
HARVESTER = RELAY.with_name("harvester.toml")


def rows(case: vibeam.Case, *names: str) -> dict[str, ResponseComparison]:
    found = vibeam.run(case, show=False, fidelities=names).compare()
    return {each.fidelity: each.comparison for each in found if each.reference and each.comparison is not None}


def test_the_harvester_of_one_mode_jumps_late() -> None:
    """An event-driven simulator of its own: swept up one mode jumps at 67.0, eight at 64.75 Hz; else 1.3 % at most."""
    case = vibeam.load(HARVESTER, {"fidelity.free": None, "sweep.direction": "up"})
    found = rows(case)["sdof"]
    assert found.ends[0].ours.event == "contact is lost"
    assert found.frequency_error == pytest.approx(67.1 / 64.85 - 1, abs=4e-3)
    assert found.amplitude_error <= 0.0135
    assert found.suffices(FIVE) is False


def test_a_further_fidelity_changes_no_other_comparison() -> None:
    """Relay: one degree of freedom jumps at 201 Hz, others at 183; two modes double their period early."""
    case = vibeam.load(RELAY, {"sweep.direction": "up"})
    alone, beside = rows(case, "two_modes", "spring"), rows(case, "sdof", "two_modes", "spring")
    assert alone["two_modes"].suffices(FIVE) is beside["two_modes"].suffices(FIVE) is False
    lost = next(each for each in beside["sdof"].ends if each.ours.event == "contact is lost")
    assert (lost.ours.frequency, lost.reference.frequency) == (pytest.approx(201, abs=1), pytest.approx(183, abs=1))
    doubled = next(each for each in alone["two_modes"].ends if each.ours.event == "period doubles")
    assert doubled.error == pytest.approx(-0.018, abs=2e-3)
    assert alone["two_modes"].amplitude_error <= 0.032


def reed(**changes: Any) -> dict[str, Any]:
    return {
        "beam": {"length": "18 mm", "width": "2.5 mm", "thickness": "0.2 mm", "youngs_modulus": "110 GPa",
                 "density": "8800 kg/m^3", "damping_ratio": "1 %"},
        "mass": {"mass": "20 mg", "position": "17 mm"}, "stop": {"gap": "0.3 mm", "restitution": 0.6},
        "sensor": {"position": "17 mm"}, "drive": {"acceleration": "10 g"},
        "sweep": {"frequency": {"from": "250 Hz", "to": "330 Hz", "points": 17}, "settle": 300, "hold": 50,
                  "direction": "up"},
        "fidelity": {"eight": {"reduction": "modal", "modes": 8}, "sixteen": {"reduction": "modal", "modes": 16}},
    } | changes  # fmt: skip


def test_modes_that_follow_a_branch_too_far_do_not_suffice() -> None:
    """A simulator of its own: the upper branch ends between 310 and 315 Hz of eight modes, 300 and 305 of sixteen."""
    found = rows(vibeam.Case.of(reed()))["eight"]
    lost = next(each for each in found.ends if each.ours.event == "contact is lost")
    assert 309 < lost.ours.frequency < 315
    assert 299 < lost.reference.frequency < 305
    assert found.suffices(FIVE) is False


def test_fuller_models_are_larger_finer_or_refused() -> None:
    case = vibeam.Case.of(reed())
    found = list(fuller_models(case, "eight", 8))
    assert [(each.modes, each.elements) for each in found] == [(32, 96), (16, 48)]
    assert [each.modes for each in fuller_models(case, "sixteen", 16)] == [32, 16]
    given = vibeam.load(RIG.parent / "matrices" / "dtu_modes.toml")
    with pytest.raises(ValueError, match=GIVEN):
        next(fuller_models(given, next(iter(given.fidelities)), 2))
    frame = vibeam.load(RIG.parent / "matrices" / "frame.toml")
    assert is_whole(frame, next(iter(frame.fidelities)), 2)
    worn = vibeam.Case.of(reed(stop={"gap": "0.3 mm", "restitution": 0.6, "wear": "1e-12 m"}))
    with pytest.raises(ValueError, match=WEARS):
        next(fuller_models(worn, "eight", 8))


def test_the_finest_is_compared_with_a_fuller_model_and_kept_in_the_file(tmp_path: Path) -> None:
    case = vibeam.load(RIG, {"sweep.frequency.points": 9})
    result = vibeam.run(case, tmp_path / "a.h5", compare=True)
    found = {each.fidelity: each for each in result.compared}
    assert (found["sdof"].reference, found["beam"].reference) == ("beam", "")
    assert found["beam"].suffices(FIVE)
    assert found["beam"].modes > found["sdof"].modes == 8
    again = vibeam.run(case, tmp_path / "a.h5", compare=True)
    assert again.compared == result.compared
    assert vibeam.read(tmp_path / "a.h5").compare() == result.compared


@pytest.mark.parametrize(("name", "value", "passed"), [("two_modes", "1.6 %", True), ("sdof", "5 %", False)])
def test_a_case_can_expect_its_errors(name: str, value: str, passed: bool) -> None:
    own = {"fidelity": name, "quantity": "amplitude_error", "value": value, "tolerance": "10 %", "source": "a run"}
    [row] = vibeam.check(vibeam.load(RIG, {"expect.error": own, "reference": None}))
    assert row.passed is passed
