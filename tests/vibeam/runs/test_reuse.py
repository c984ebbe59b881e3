"""A results file of a changed case: what is kept, what is swept anew, and that the numbers are those of a new run."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from stand_in import SDOF, Solver, case, same, system

from vibeam.casefile.read import parse
from vibeam.runs import fidelity_sweep
from vibeam.runs.result import Result
from vibeam.runs.run import run
from vibeam.runs.store.file import read
from vibeam.store.errors import StoreError

GRID = np.linspace(14.0, 17.0, 8)
LONGER = np.append(GRID, [17.5, 18.0])
ASIDE = "its results are kept aside as a.1.h5"


class Run:
    """Runs of changing cases into one file: the ``calls`` of the last one, and the line it told."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, path: Path) -> None:
        self.patch, self.path = monkeypatch, path
        monkeypatch.setattr(fidelity_sweep, "WRITE_EVERY", 0.0)
        self.calls: list[tuple[int, float]] = []
        self.told: list[str] = []

    def __call__(self, wanted: Any, fresh: bool = False, **solver: Any) -> Result:
        used = Solver(**solver)
        self.patch.setattr(fidelity_sweep, "march_blocks", used)
        self.told = []
        try:
            return run(wanted, self.path, fresh=fresh, tell=self.told.append)
        finally:
            self.calls = used.calls

    def line(self) -> str:
        assert len(self.told) == 1
        assert self.told[0].startswith(f"{self.path}: ")
        return self.told[0].removeprefix(f"{self.path}: ").removesuffix(f"; {ASIDE}")

    def aside(self, before: bytes, names: tuple[str, ...] = ("a.1.h5",)) -> bool:
        """Whether the file as it was is kept beside, and nothing else is there."""
        there = {each.name: each.read_bytes() for each in self.path.parent.iterdir() if each != self.path}
        return sorted(there) == sorted(names) and there[names[-1]] == before and ASIDE in self.told[0]


@pytest.fixture
def again(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Run:
    return Run(monkeypatch, tmp_path / "a.h5")


def of(sizes: dict[str, int], grid: Any = GRID, direction: str = "both", key: str = "k" * 64) -> Any:
    """A case of fidelities with so many modes each."""
    changed = case(direction=direction, key=key)
    systems = {name: system(modes) for name, modes in sizes.items()}
    changed.sweep.frequency = np.asarray(grid)
    changed.system, changed.fidelities = systems.__getitem__, {name: changed.fidelities[name] for name in sizes}
    changed.own = {name: f"{changed.shared}modes = {modes}\n" for name, modes in sizes.items()}
    changed.numbers = f"{changed.shared}{sizes} {np.asarray(grid).tolist()} {direction}\n"
    return changed


def as_anew(result: Result) -> bool:
    """Whether all bits, of the result and of its file, are those of a run from nothing."""
    new, kept = run(result.case), read(result.path or Path())
    pairs = [(one, other, kept[name, way]) for name in new for (way, one), (_, other) in _pairs(new, result, name)]
    return set(new) == set(result) and all(same(one, other) and same(one, there) for one, other, there in pairs)


def _pairs(new: Result, result: Result, name: str) -> Any:
    return zip(new[name].items(), result[name].items(), strict=True)


def test_an_added_fidelity_is_all_that_is_computed(again: Run) -> None:
    again(of({"one": 1, "three": 3}))
    result = again(of({"one": 1, "two": 2, "three": 3}))
    assert {size for size, _ in again.calls} == {2}
    assert (result.found, len(again.calls)) == (32, 16)
    assert again.line() == "kept: one/up, one/down, three/up, three/down; added: two/up, two/down"
    assert as_anew(result)
    assert again(of({"one": 1, "two": 2, "three": 3})).found == 48
    assert again.told == []


def test_a_changed_fidelity_is_all_that_is_computed_anew(again: Run) -> None:
    again(of({"one": 1, "three": 3}))
    result = again(of({"one": 1, "three": 4}))
    assert {size for size, _ in again.calls} == {4}
    assert again.line() == "kept: one/up, one/down; swept anew: three/up, three/down"
    assert as_anew(result)


def test_a_fidelity_that_is_no_longer_named_stays(again: Run) -> None:
    first = again(of({"one": 1, "three": 3}))
    second = again(of({"three": 3}))
    assert again.calls == []
    assert again.line() == "kept: three/up, three/down; left as they are, the case does not name them: one/up, one/down"
    assert list(second) == ["three"]
    assert again(of({"one": 1, "three": 3})).found == first.total
    assert again.calls == []


@pytest.mark.parametrize("direction", ["up", "both"])
def test_a_grid_that_goes_on_keeps_the_points_before(again: Run, direction: str) -> None:
    again(of({"one": 1, "three": 3}, direction=direction))
    result = again(of({"one": 1, "three": 3}, LONGER, direction))
    extended = "extended: one/up (8 of 10 points), three/up (8 of 10 points)"
    assert again.line() == (extended if direction == "up" else f"{extended}; swept anew: one/down, three/down")
    assert (result.found, len(again.calls)) == (16, 4 if direction == "up" else 24)
    assert as_anew(result)


def test_a_run_that_was_stopped_is_extended_too(again: Run) -> None:
    with pytest.raises(ZeroDivisionError):
        again(of({"one": 1}, direction="up"), fail_at=5, failure=ZeroDivisionError())
    result = again(of({"one": 1}, LONGER, "up"))
    assert again.line() == "extended: one/up (5 of 10 points)"
    assert (result.found, as_anew(result)) == (5, True)


OTHER_GRIDS = {
    "finer": (np.linspace(14.0, 17.0, 15), "swept anew: one/up (after 1 points), one/down", 1),
    "from lower": (np.insert(GRID, 0, 13.5), "swept anew: one/up, one/down", 0),
    "another end": (np.append(GRID[:5], [20.0, 21.0, 22.0]), "swept anew: one/up (after 5 points), one/down", 5),
    "off by a bit": (np.append(GRID[:-1], np.nextafter(17.0, 18)), "swept anew: one/up (after 7 points), one/down", 7),
}


@pytest.mark.parametrize("grid", OTHER_GRIDS)
def test_another_grid_keeps_the_points_before_the_first_other_one(again: Run, grid: str) -> None:
    frequency, line, found = OTHER_GRIDS[grid]
    again(of({"one": 1}))
    result = again(of({"one": 1}, frequency))
    assert (again.line(), result.found) == (line, found)
    assert as_anew(result)


@pytest.mark.parametrize(("grid", "kept"), [(GRID[:5], 5), (np.linspace(14.0, 17.0, 4), 1), (GRID[:1], 1)])
def test_a_sweep_of_fewer_points_leaves_one_of_more_beside(again: Run, grid: Any, kept: int) -> None:
    """As a quick try with a coarser grid would, where the long sweep took hours."""
    again(of({"one": 1, "three": 3}, direction="up"))
    before = again.path.read_bytes()
    result = again(of({"one": 1, "three": 3}, grid, "up"))
    assert (result.found, as_anew(result), again.aside(before)) == (2 * kept, True, True)


def test_down_by_itself_is_not_down_after_up(again: Run) -> None:
    again(of({"one": 1}))
    result = again(of({"one": 1}, direction="down"))
    assert again.line() == "swept anew: one/down; left as they are, the case does not name them: one/up"
    assert as_anew(result)
    result = again(of({"one": 1}, np.append(12.0, GRID), direction="down"))
    assert result.found == 0, "a solver may know the lowest frequency of the sweep"
    assert as_anew(result)


def test_another_physics_is_swept_beside_the_one_before(again: Run) -> None:
    first, other, third = (of({"one": 1, "three": 3}, key=key) for key in ("k" * 64, "other", "third"))
    before = again(first) and again.path.read_bytes()
    result = again(other)
    assert (result.found, as_anew(result), again.aside(before)) == (0, True, True)
    assert again.line() == f"holds the case as it was (key = '{'k' * 64}' there, 'other' here)"
    second = again.path.read_bytes()
    again(third)
    assert again.told[0].endswith("a.2.h5")
    assert [(again.path.parent / f"a.{n}.h5").read_bytes() for n in (1, 2)] == [before, second]
    assert run(first, again.path.parent / "a.1.h5").found == result.total
    result = again(other, fresh=True)
    assert (result.found, again.told, as_anew(result)) == (0, [], True)


def test_points_that_an_edit_would_lose_are_kept_beside_with_their_blocks(again: Run) -> None:
    with pytest.raises(ZeroDivisionError):
        again(of({"one": 1}), fail_at=13, failure=ZeroDivisionError())
    kept = read(again.path)
    again(of({"one": 2}))
    assert all(same(kept[at], each) for at, each in read(again.path.parent / "a.1.h5").items())
    assert not again.path.with_name("a.h5.parts").exists()


def test_a_case_of_another_name_is_refused_and_nothing_is_lost(again: Run) -> None:
    again(of({"one": 1, "three": 3}))
    before = again.path.read_bytes()
    for changed in (of({"one": 1, "three": 3}, key="other"), of({"one": 1, "three": 4})):
        changed.path = Path("other.toml")
        with pytest.raises(StoreError, match=r"holds another case \(.*\): .* or start over with --fresh"):
            again(changed)
        assert (again.path.read_bytes(), again.calls, again.told) == (before, [], [])


def test_another_physics_that_all_fidelities_set_for_themselves_is_none(again: Run) -> None:
    first = of({"one": 1})
    again(first)
    other = of({"one": 1}, key="other")
    other.own = first.own
    assert again(other).found == 16


def test_a_failure_before_the_first_new_point_loses_nothing(again: Run) -> None:
    again(of({"one": 1, "three": 3}))
    before = again.path.read_bytes()
    for fresh in (False, True):
        with pytest.raises(ZeroDivisionError):
            again(of({"one": 2, "three": 4}), fresh=fresh, fail_at=0, failure=ZeroDivisionError())
        assert again.path.read_bytes() == before
        assert list(again.path.parent.iterdir()) == [again.path]


def test_a_stop_while_a_fidelity_is_swept_anew_keeps_the_others(again: Run) -> None:
    again(of({"one": 1, "three": 3}))
    with pytest.raises(ZeroDivisionError):
        again(of({"one": 1, "three": 4}), fail_at=5, failure=ZeroDivisionError())
    result = again(of({"one": 1, "three": 4}))
    assert (result.found, again.told) == (21, [])
    assert as_anew(result)


def test_without_a_listener_the_line_is_a_warning(again: Run) -> None:
    again(of({"one": 1}))
    with pytest.warns(UserWarning, match="swept anew: one/up, one/down"):
        run(of({"one": 2}), again.path)


def test_the_file_says_the_case_it_is_of_now(again: Run) -> None:
    again(of({"one": 1}))
    now = of({"one": 1, "two": 2})
    again(now)
    with h5py.File(again.path) as file:
        assert file["case/text"][()].decode() == now.numbers
        assert file["case/shared"][()].decode() == now.shared
        assert file["provenance/continued"][0].startswith(b"vibeam ")


KILLED = """
import os, signal, sys
sys.path[:0] = {path!r}
from pathlib import Path
from stand_in import Solver
from test_reuse import GRID, as_anew, of
from vibeam.runs import fidelity_sweep
from vibeam.runs.run import run as running

CALLS = ("write", "fsync", "link", "replace", "unlink")
path, before = Path({file!r}), Path({file!r} + ".before")
fidelity_sweep.march_blocks, fidelity_sweep.WRITE_EVERY = Solver(), 0.0
sys.modules["vibeam.runs.run"].warm_up = lambda *given, **options: None
new, edited = of({{"one": 1}}, GRID[:2]), of({{"one": 1, "two": 2}}, GRID[:3], "up")
wanted = {{"": new, "fidelity": edited, "physics": of({{"one": 1}}, GRID[:2], key="other")}}["{changed}"]
if "{changed}":
    running(of({{"one": 1, "two": 1}}, GRID[:2], "up"), before)

def killed_at(left):
    def counted(call):
        def called(*given, **options):
            left[0] -= 1
            if left[0] < 0:
                os.kill(os.getpid(), signal.SIGKILL)
            return call(*given, **options)
        return called
    for name in CALLS:
        setattr(os, name, counted(getattr(os, name)))
    running(wanted, path, tell=print)
    os._exit(0)

for calls in range({first}, {most}, {step}):
    for place in [*path.parent.glob(".*"), path, path.with_name("a.1.h5")]:
        place.unlink(missing_ok=True)
    if "{changed}":
        path.write_bytes(before.read_bytes())
    child = os.fork()
    if not child:
        killed_at([calls])
    _, status = os.waitpid(child, 0)
    assert as_anew(running(wanted, path, tell=print)), calls
    there = {{each.name: each.read_bytes() for each in path.parent.iterdir()}}
    assert len(there) == 1 + 2 * bool("{changed}") and there.get("a.1.h5") == there.get(before.name), calls
    if status == 0:
        sys.exit(0 if calls > 10 else 1)
sys.exit(2)
"""


@pytest.mark.parametrize(
    ("changed", "step"),
    [("", 11), *(pytest.param(edit, 5, marks=pytest.mark.slow) for edit in ("", "fidelity", "physics"))],
)
def test_a_kill_between_calls_to_the_system_loses_nothing(tmp_path: Path, changed: str, step: int) -> None:
    """Of a new file and of one that is adapted: the run after it ends in the bits of a run from nothing."""
    places = [str(Path(__file__).parent), *sys.path]
    script = KILLED.format(path=places, file=str(tmp_path / "a.h5"), changed=changed, first=0, most=500, step=step)
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


KEYS = {
    "[fidelity.sdof]\n": {"sdof", "other"},
    '[fidelity.sdof]\nset = { "stop.restitution" = 0.8 }\n': {"other"},
    '[fidelity.sdof]\nsolver = "mapping"\n': {"other"},
}


@pytest.mark.parametrize("table", KEYS)
def test_a_fidelity_s_key_hangs_on_its_own_table_alone(table: str) -> None:
    whole = parse(SDOF + "[fidelity.other]\n")
    changed = parse(SDOF.replace("[fidelity.sdof]\n", table) + "[fidelity.other]\n")
    assert {name for name in whole.own if whole.own[name] == changed.own[name]} == KEYS[table]
    assert whole.shared == changed.shared


@pytest.mark.parametrize("key", ["sdof.damping_ratio=0.02", "stop.gap=0.1", "sweep.settle=21", "sweep.hold=6"])
def test_what_all_share_is_in_every_key(key: str) -> None:
    name, _, value = key.partition("=")
    one, other = parse(SDOF), parse(SDOF, set={name: float(value) if "." in value else int(value)})
    assert one.shared != other.shared
    assert one.own["sdof"] != other.own["sdof"]


@pytest.mark.parametrize("key", ["title", "sweep.frequency.points", "sweep.direction", "fidelity.sdof.label"])
def test_grid_and_names_are_in_no_key(key: str) -> None:
    values = {"title": "b", "sweep.frequency.points": 7, "sweep.direction": "up", "fidelity.sdof.label": "c"}
    one, other = parse(SDOF), parse(SDOF, set={key: values[key]})
    assert (one.shared, one.own) == (other.shared, other.own)


def test_a_value_of_its_own_that_is_the_case_s_is_the_same_key() -> None:
    own = parse(SDOF.replace("[fidelity.sdof]", '[fidelity.sdof]\nset = { "stop.restitution" = 0.9 }'))
    assert own.own == parse(SDOF).own


def test_a_figure_s_key_hangs_on_its_own_fidelities_alone() -> None:
    shown = SDOF + '[fidelity.other]\n[show.a]\nkind = "portrait"\nfidelities = ["sdof"]\nfrequency = ["2 rad/s"]\n'
    key = parse(shown).shows["a"].key
    assert parse(shown, set={"fidelity.other.solver": "mapping"}).shows["a"].key == key
    assert parse(shown, set={"fidelity.sdof.solver": "mapping"}).shows["a"].key != key
    assert parse(shown, set={"show.a.periods": 7}).shows["a"].key != key


@pytest.mark.parametrize("grid", ["longer", "finer"])
def test_the_real_flight_goes_on_with_more_points_to_the_same_bits(tmp_path: Path, grid: str) -> None:
    """On a pressed stop, where motions are chaotic."""
    hertz = [each / (2 * np.pi) for each in (0.6, 0.9, 1.2, 1.5, 1.8, 2.1)]
    wanted = [*hertz, 0.4] if grid == "longer" else sorted([*hertz, 0.3])
    settings = {"stop.gap": -0.5e-3, "sweep.direction": "up"}
    first, then = (parse(SDOF, set=settings | {"sweep.frequency": points}) for points in (hertz, wanted))
    run(first, tmp_path / "a.h5")
    told: list[str] = []
    result = run(then, tmp_path / "a.h5", tell=told.append)
    assert result.found == (6 if grid == "longer" else 5)
    one, other = result["sdof"].up, run(then)["sdof"].up
    assert one is not None
    assert other is not None
    assert same(one, other, but=("cpu_seconds",))
