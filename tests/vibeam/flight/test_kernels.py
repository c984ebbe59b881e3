"""Kernels that can be read (few parameters, few results), and compiled ones that are good until a source changes."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import vibeam.flight.kernels as kernels
from vibeam.flight.kernels import entry
from vibeam.flight.kernels.regimes import entry as regimes
from vibeam.flight.kernels.sources import EVERY, FLIGHT, GROUPS, POINTS, digest, files_of
from vibeam.flight.points.kernels import disturbances
from vibeam.flight.points.kernels import entry as points

FOLDER = Path(kernels.__file__).parent
MOST_PARAMETERS, MOST_RESULTS = 8, 4
DECORATORS = {"kernel", "joined", "summing", "entry"}

ENTRY_POINTS = {  # called from Python, which passes all that one call needs
    "entry.move",
    "entry.poses_at",
    "regimes.entry.move",
    "regimes.entry.poses_at",
    "contacts.entry.move",
    "contacts.entry.poses_at",
}


def functions(source: str) -> Iterator[ast.FunctionDef]:
    """Every compiled function of a module."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef):
            names = {name.id for name in node.decorator_list if isinstance(name, ast.Name)}
            if names & DECORATORS:
                yield node


def parameters(function: ast.FunctionDef) -> int:
    """How many a call must give."""
    arguments = function.args
    return len(arguments.posonlyargs) + len(arguments.args) + len(arguments.kwonlyargs)


def results(function: ast.FunctionDef) -> int:
    """The longest tuple without a name that is returned: as annotated, or as written."""
    given = [len(node.value.elts) for node in ast.walk(function)
             if isinstance(node, ast.Return) and isinstance(node.value, ast.Tuple)]  # fmt: skip
    told = function.returns
    if isinstance(told, ast.Subscript) and isinstance(told.slice, ast.Tuple):
        given.append(len(told.slice.elts))
    return max(given, default=1)


def signatures() -> dict[str, tuple[int, int]]:
    """Parameters and results of every kernel, by the place where it stands."""
    found = {}
    for file in sorted(FOLDER.rglob("*.py")):
        place = ".".join(file.relative_to(FOLDER).with_suffix("").parts)
        for function in functions(file.read_text(encoding="utf-8")):
            found[f"{place}.{function.name}"] = parameters(function), results(function)
    return found


def crowded(found: dict[str, tuple[int, int]]) -> set[str]:
    """Those with too many of either."""
    return {name for name, (taken, given) in found.items() if taken > MOST_PARAMETERS or given > MOST_RESULTS}


def test_no_kernel_takes_more_than_eight_or_gives_more_than_four() -> None:
    found = signatures()
    known = {"lanes.plain_flights.flight", "roots.first_root.first_root", "readout.extremes_to", "entry.cover"}
    assert known <= set(found)
    assert {name: found[name] for name in crowded(found) - ENTRY_POINTS} == {}


def test_only_what_is_crowded_is_excused() -> None:
    assert ENTRY_POINTS - crowded(signatures()) == set()


@pytest.mark.parametrize(
    ("source", "counts"),
    [
        ("@kernel\ndef f(a, b, /, c, *, d): return a", (4, 1)),
        ("@joined\ndef f(a) -> tuple[float, float, int]: return a", (1, 3)),
        ("@summing\ndef f():\n    if x:\n        return 1, 2\n    return 1, 2, 3, 4, 5", (0, 5)),
        ("@entry\ndef f(a) -> Ends: return Ends(a, a, a, a)", (1, 1)),
    ],
)
def test_parameters_and_results_are_counted(source: str, counts: tuple[int, int]) -> None:
    (function,) = functions(source)
    assert (parameters(function), results(function)) == counts


def test_plain_functions_are_no_kernels() -> None:
    assert list(functions("def f(a, b, c, d, e, f, g, h, i): return a")) == []


def test_a_change_in_any_kernel_is_noticed_wherever_it_lies(tmp_path: Path) -> None:
    assert {file.parent.name for file in FLIGHT} == {"kernels", "lanes", "roots"}
    assert set(EVERY) - set(FLIGHT) == set((FOLDER / "regimes").glob("*.py"))
    assert set(FLIGHT) | set().union(*map(files_of, GROUPS)) == set(FOLDER.rglob("*.py"))
    assert set(POINTS) == set(Path(points.__file__).parent.rglob("*.py"))
    one, other = tmp_path / "a.py", tmp_path / "b.py"
    one.write_text("x = 1")
    other.write_text("x = 2")
    assert digest((one,)) != digest((other,))


def test_plain_flight_stays_compiled_when_another_regime_or_points_change() -> None:
    assert entry.move._cache._sources == digest(FLIGHT)
    assert regimes.move._cache._sources == digest(EVERY)
    assert points.run._cache._sources == disturbances.carry._cache._sources == digest(FLIGHT + POINTS)
