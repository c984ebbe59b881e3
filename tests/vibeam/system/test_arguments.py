"""What the public constructors and calls refuse, and in which form they keep what they take."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from refusals import answers

import vibeam
from vibeam.flight.engine.entries import EntryPoint
from vibeam.solvers import solver
from vibeam_models.laws.compliant import HuntCrossley, LinearStop
from vibeam_models.laws.restitution import PlasticRestitution, Restitution, TableRestitution, ViscousRestitution

GOOD: dict[str, Any] = {
    "omega": [47.7, 635.0], "zeta": [0.017, 0.017], "contact": [2.12, 0.31], "load": [0.46, 0.09],
    "static": [0.0, 0.0], "gap": 0.0, "restitution": 0.72, "outputs": {"sensor": [1.0, 1.0]},
}  # fmt: skip
SYSTEM = vibeam.ImpactSystem(**GOOD)
DRIVE = vibeam.Drive(95.0, 1e-4)
RUN: dict[str, Any] = {"omega": [95.0], "amplitude": 1e-4, "settle": 3, "hold": 2}
TABLE = TableRestitution((0.1, 1.0), (0.9, 0.5))

WRONG: list[tuple[str, Any]] = [
    *[(name, value) for name in ("omega", "zeta", "contact", "load", "static") for value in (
        [1.0], [1.0, 2.0, 3.0], np.ones((2, 2)), [np.nan, 1.0], [1.0, np.inf], "two", ["1", "2"], None, [1j, 1.0],
        [True, False], [[1.0], [2.0, 3.0]], 1.0,
    ) if not (name == "omega" and isinstance(value, list) and len(value) != 2)],
    ("omega", []), ("omega", [-1.0, 2.0]), ("zeta", [-1e-9, 0.1]), ("contact", [0.0, 0.0]), ("contact", [1e-200, 0.0]),
    ("contact", [1e200, 1.0]), ("outputs", {"sensor": np.ones(50)}), ("outputs", {"sensor": [1.0]}), ("outputs", [1.0]),
    ("outputs", {"sensor": np.ones((2, 2))}), ("outputs", {"sensor": [1.0, np.nan]}), ("outputs", {3: [1.0, 1.0]}),
    ("gap", np.nan), ("gap", np.inf), ("gap", "0.1 mm"), ("gap", None), ("gap", True), ("gap", 10**400),
    ("restitution", 5.0), ("restitution", -1.0), ("restitution", np.nan), ("restitution", "0.7"), ("restitution", 1j),
    ("law", 0.7), ("law", "hertz"), ("coupling", np.eye(3)), ("coupling", np.full((2, 2), np.nan)), ("coupling", 1.0),
    ("coupling", [[1.0, 0.5], [0.0, 1.0]]), ("coupling", [[1.0, 2.0], [2.0, 1.0]]), ("coupling", "none"),
    ("second_gap", -1.0), ("second_gap", 0.0), ("second_gap", np.inf), ("second_gap", "wide"),
]  # fmt: skip


def test_only_what_is_refused_with_its_words_has_no_other_answer() -> None:
    assert answers(float, ["1", "a", "b"], "float: 'a'") == [
        ("1", "1.0"),
        ("b", "could not convert string to float: 'b'"),
    ]
    with pytest.raises(TypeError):
        answers(float, [None], "")


@pytest.mark.parametrize("name", dict.fromkeys(name for name, _ in WRONG))
def test_a_system_refuses_what_is_wrong_and_names_it_alone(name: str) -> None:
    wrong, alone = [value for each, value in WRONG if each == name], f"^{name}[^;]*$"
    assert answers(lambda value: vibeam.ImpactSystem(**GOOD | {name: value}), wrong, alone) == []
    assert answers(lambda value: replace(SYSTEM, **{name: value}), wrong, alone) == []


def test_a_system_names_all_that_is_wrong_at_once() -> None:
    wrong = {"zeta": [0.1, -0.1], "contact": [0, 0], "load": [1], "gap": np.nan, "restitution": 2, "second_gap": np.inf}
    with pytest.raises(ValueError, match="zeta") as raised:
        vibeam.ImpactSystem(**GOOD | wrong | {"law": 1, "outputs": {"a": [1.0]}, "coupling": np.eye(3)})
    assert all(f"{name}" in str(raised.value) for name in (*wrong, "law", "outputs['a']", "coupling"))
    assert str(raised.value).count(";") == 8


def test_what_was_given_is_kept_as_floats_that_nobody_changes() -> None:
    mine = np.array([47, 635])
    made = vibeam.ImpactSystem(**GOOD | {"omega": mine, "gap": Fraction(1, 8), "restitution": np.float32(0.5)})
    mine[0] = 1
    assert made.omega.tolist() == [47.0, 635.0]
    assert (type(made.gap), made.gap, type(made.restitution)) == (float, 0.125, float)
    for row in (made.omega, made.zeta, made.contact, made.load, made.static, made.output("sensor")):
        assert row.dtype == float
        with pytest.raises(ValueError, match="read-only"):
            row[0] = 1.0
    again = replace(made, gap=0.0)
    assert again.omega is made.omega
    assert mine.flags.writeable


def test_a_law_with_one_coefficient_is_that_coefficient() -> None:
    assert vibeam.ImpactSystem(**GOOD | {"law": Restitution(0.3)}).moves_as(replace(SYSTEM, restitution=0.3))


def test_a_state_that_is_none_is_refused() -> None:
    wrong = [
        ([0.0], [0.0, 0.0], False), ([], [], False), ([np.nan], [0.0], False), ([0.0], [np.inf], True),
        (0.0, 0.0, False), ([[0.0]], [[0.0]], False), (["0"], ["1"], False), (None, None, False),
        ([0.0], [0.0], "no"), ([0.0], [0.0], 2),
    ]  # fmt: skip
    assert answers(lambda parts: vibeam.State(*parts), wrong, "^state") == []


def test_a_drive_of_no_number_is_refused() -> None:
    wrong = ["95", None, True, 1j, [95.0], np.nan, np.inf, 10**400]
    assert answers(lambda value: vibeam.Drive(value, 1.0), [*wrong, -1.0], "^drive") == []
    assert answers(lambda value: vibeam.Drive(1.0, value), wrong, "^drive") == []


@pytest.mark.parametrize("made", [
    lambda bad: LinearStop(bad), lambda bad: LinearStop(1.0, bad), lambda bad: LinearStop.matched(bad, 0.5, 1.0),
    lambda bad: LinearStop.matched(1.0, bad, 1.0), lambda bad: LinearStop.matched(1.0, 0.5, bad),
    lambda bad: HuntCrossley(bad), lambda bad: HuntCrossley(1.0, bad), lambda bad: HuntCrossley(1.0, 0.0, bad),
    lambda bad: HuntCrossley.matched(1.0, bad, 1.0), lambda bad: HuntCrossley.matched(1.0, 0.5, bad),
    lambda bad: Restitution(bad), lambda bad: PlasticRestitution(bad, 1.0), lambda bad: PlasticRestitution(0.5, bad),
    lambda bad: PlasticRestitution(0.5, 1.0, bad), lambda bad: ViscousRestitution(bad),
    lambda bad: ViscousRestitution(0.1, bad), lambda bad: TableRestitution((bad, bad), (0.9, 0.5)),
    lambda bad: TableRestitution((0.1, 1.0), (bad, bad)), lambda bad: TableRestitution(bad, (0.9, 0.5)),
])  # fmt: skip
def test_a_law_of_no_number_is_refused(made: Callable[[Any], object]) -> None:
    assert answers(made, ["1", None, True, 1j, np.nan, np.inf, -1.0], "^(stop|restitution)") == []


@pytest.mark.parametrize("wrong", [
    {"settle": 10.5}, {"settle": "10"}, {"settle": 10**18}, {"settle": True}, {"hold": 10**10}, {"hold": 0.5},
    {"hold": None}, {"omega": "95"}, {"omega": [None]}, {"omega": {}}, {"amplitude": "1 mm"}, {"amplitude": None},
    {"wear": "much"}, {"wear": -1.0}, {"state": "rest"}, {"output": 3}, {"output": ["sensor"]},
    {"options": {"limit": 10.5}}, {"options": {"limit": "all"}}, {"options": {"limit": 10**20}},
])  # fmt: skip
def test_a_sweep_refuses_other_types(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="limit" if "options" in wrong else next(iter(wrong))):
        vibeam.sweep(SYSTEM, **RUN | wrong)


@pytest.mark.parametrize("wrong", [
    {"t_end": "1"}, {"t_end": None}, {"t_start": 2.0}, {"max_impacts": -5}, {"max_impacts": 10.5}, {"drive": 95.0},
    {"max_impacts": 10**19}, {"state": np.zeros((2, 2))}, {"system": None}, {"max_impacts": "many"},
    {"t_end": -1.0}, {"t_end": np.nan}, {"t_end": np.inf}, {"t_start": -1.0}, {"solver": "fligth"},
    {"state": vibeam.State([0.0], [0.0])}, {"state": vibeam.State.reached(np.full(2, np.nan), np.zeros(2))},
])  # fmt: skip
def test_a_simulation_refuses_other_types(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="t_end|t_start" if "t_start" in wrong else next(iter(wrong))):
        vibeam.simulate(**{"system": SYSTEM, "drive": DRIVE, "t_end": 1.0} | wrong)


@pytest.mark.parametrize(("name", "options"), [
    ("moreau", {"steps": 10.5}), ("moreau", {"steps": "fine"}), ("moreau", {"theta": None}),
    ("direct", {"rtol": "low"}), ("direct", {"limit": 0.5}), ("orbit", {"periods": 1.5}), ("mapping", {"periods": "1"}),
    ("averaging", {"resonance": 1.5}),
])  # fmt: skip
def test_an_option_of_another_type_is_refused(name: str, options: dict[str, Any]) -> None:
    one = vibeam.ImpactSystem.from_modes(50.0, 0.017, 2.0, 0.5, restitution=0.72)
    with pytest.raises(ValueError, match=next(iter(options))):
        solver(name, one, 80.0, **options)


def test_times_and_periods_of_other_types_are_refused() -> None:
    path = vibeam.simulate(SYSTEM, DRIVE, 0.5)
    for wrong in ("0.1", None, {}, ["0.1"]):
        with pytest.raises(ValueError, match=r"^t:"):
            path.at(wrong)
    for periods in (1.5, "2", None):
        with pytest.raises(ValueError, match=r"^periods"):
            vibeam.observe.phase_portrait(path, periods=periods)
        with pytest.raises(ValueError, match=r"^periods"):
            vibeam.orbits(SYSTEM, DRIVE, periods)


def signatures(kernel: EntryPoint) -> list[Any]:
    """What numba has compiled it for; a library has one signature."""
    return list(getattr(kernel.function, "signatures", [None]))


@pytest.mark.parametrize("law", [None, TABLE, LinearStop(1e6, 1.0)])
def test_whole_numbers_are_taken_as_floats_too_and_no_kernel_is_compiled_again(law: Any) -> None:
    """Every type of argument that is taken reaches the kernels as the same types: a library refuses any others."""
    from vibeam.flight.engine.entries import move, poses_at, regimes_move, regimes_poses_at

    system = replace(SYSTEM, law=law)
    kernels = [move, poses_at] if law is None else [regimes_move, regimes_poses_at]
    usual = vibeam.sweep(system, **RUN, options={"limit": 1000}), vibeam.simulate(system, DRIVE, 0.5)
    usual[1].at(0.1)
    before = [signatures(kernel) for kernel in kernels]
    lists = vibeam.ImpactSystem(**GOOD | {"law": law, "omega": (47.7, 635.0), "zeta": np.full((4,), 0.017)[::2]})
    other = {"omega": (95,), "amplitude": np.float64(1e-4), "settle": 3.0, "hold": np.int32(2)}
    swept = vibeam.sweep(lists, **other, options={"limit": 1e3}, state=vibeam.State([0, 0], (0.0, 0.0)))
    path = vibeam.simulate(lists, vibeam.Drive(95, np.float32(1e-4)), 1, max_impacts=1e5, t_start=np.int64(0))
    path.at(1), path.at([0, 1]), path.at(np.linspace(0, 1, 10, dtype=np.float32)[::2])
    vibeam.sweep(lists, omega=[90, 95], amplitude=[0, 1], settle=True + 0, hold=2, drift=lambda omega: [0, 0])
    solver("flight", lists, 95).steady([95, 96], 0, None, 1, 1, "sensor")
    assert [signatures(kernel) for kernel in kernels] == before
    start = vibeam.sweep(system, **RUN, state=vibeam.State(np.zeros(2), np.zeros(2)))
    np.testing.assert_array_equal(swept.amplitude, start.amplitude)


def test_a_static_force_beyond_all_bounds_is_said() -> None:
    with pytest.raises(ValueError, match=r"^static"):
        vibeam.simulate(replace(SYSTEM, omega=[1e-200, 1.0], static=[1.0, 0.0]), DRIVE, 1.0)
