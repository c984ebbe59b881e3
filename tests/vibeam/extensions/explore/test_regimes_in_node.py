"""Any law, two stops, damping that couples the modes: the page's engine in node against Python's, at random places."""

from __future__ import annotations

from base64 import b64decode
from collections.abc import Mapping
from dataclasses import replace
from math import inf, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.extensions.explore.models import ended_words, packed
from vibeam.extensions.explore.own_numbers import says
from vibeam.extensions.explore.payload import payload as payload_of
from vibeam.extensions.explore.regime_models import beyond_plain
from vibeam.extensions.explore.sliders import Slider, case_sliders
from vibeam.flight.engine.browser import browser_libraries, slots_table
from vibeam.flight.equilibrium import equilibrium
from vibeam.flight.solver import RegimeSolver
from vibeam.system.rows import TimeDerivative
from vibeam_models.arrays import Array
from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop
from vibeam_models.laws.restitution import PlasticRestitution, TableRestitution, ViscousRestitution

PLACES, PERIODS, SETTLE, INSTANTS = 3, 24, 60, 40
SAME = 1e-12  # share of the motion's size: regular motions part by no more, whatever order their sums are made in
#: the same of an integrated contact: its steps are chosen by an error estimate that is round-off itself, so that they
#: are others, and each is right to 1e-12
INTEGRATED = 1e-11
#: the same, in all cases, of extremes and peaks: they are sought to 1e-11 of a signal's parts, which may be larger
SOUGHT = 1e-10
TIES = 3  # panels that a motion of any case may take more or less, where round-off decides whether one is split
LOST = 1e-9  # growth of round-off from which on impacts of an irregular motion are not compared
ULPS = 2e-15  # by which, as a share, the gap and the drive of a motion's twins differ from its own
COUPLED = np.array([[1.9, 0.5, 0.0], [0.5, 9.0, 2.0], [0.0, 2.0, 30.0]])
BASE = vibeam.ImpactSystem.from_modes(
    [48.0, 310.0, 905.0], 0.02, [2.1, 0.7, -0.5], [0.45, 0.12, 0.05], gap=3e-5, restitution=0.7,
    static=[-0.02, 0.01, 0.0], outputs={"sensor": [1.4, -0.6, 0.3]},
)  # fmt: skip
BETWEEN = replace(BASE, second_gap=2e-4, zeta=np.full(3, 0.2))  # two stops, damped so much that motions repeat
TABLE = TableRestitution((0.0, 0.005, 0.02, 0.2), (0.9, 0.8, 0.7, 0.5))
SYSTEMS = {
    "coupled": replace(BASE, coupling=COUPLED),
    "two stops": BETWEEN,
    "two stops, coupled": replace(BETWEEN, coupling=10 * COUPLED),
    "linear": replace(BASE, law=LinearStop(2e4)),
    "linear, damped, two stops": replace(BETWEEN, law=LinearStop(5e3, 4.0)),
    "linear, damped, coupled": replace(BASE, law=LinearStop(5e3, 4.0), coupling=COUPLED),
    "table": replace(BASE, law=TABLE),
    "plastic": replace(BASE, law=PlasticRestitution(0.6, 0.02)),
    "viscous, two stops": replace(BETWEEN, law=ViscousRestitution.matched(0.7, 0.02)),
    "hertz": replace(BASE, law=Hertz(1e7)),
    "hunt-crossley, two stops": replace(BETWEEN, law=HuntCrossley.matched(1e7, 0.5, 0.02), coupling=10 * COUPLED),
}
SCRIPT = """
const { open } = await load("extensions/explore/engine/engine.js");
const engine = await open(given.payload);
return given.places.map(({ fidelity, periods, at, settle, ...place }) => {
  const flight = engine.ready(fidelity, engine.settings(fidelity, place));
  const { displacement, resting } = flight.packed.equilibrium();
  const { impacts, counts, ended, ...motion } = engine.motion(fidelity, place, { periods });
  const { x, v, modes } = engine.motion(fidelity, place, { periods }).at(at);
  const steady = engine.steady(fidelity, place, { settle, hold: periods });
  return { displacement, resting, impacts, counts, ended, x, v, modes, steady };
});
"""
Place = dict[str, Any]


def model(name: str, system: vibeam.ImpactSystem, output: str = "sensor") -> dict[str, Any]:
    """A system as a page's model, its drive a base amplitude in m."""
    return {
        "name": name, "label": name, "engine": "regimes", "refusal": "", "modes": system.size, "gap": system.gap,
        "output": output, **packed(beyond_plain(system, output)),
        "amplitude": {"level": 1.0, "power": 0, "factor": 1.0},
    }  # fmt: skip


def payload(models: list[dict[str, Any]]) -> dict[str, Any]:
    """A page's payload of these models, where each slider is their own number."""
    numbers, libraries = ("drive", "gap", "restitution", "damping"), ("tables", "regimes")
    own = {each["name"]: [0.0, 1.0] for each in models}
    return {
        "version": "", "level": "wasm", "digest": "", "ended": ended_words(), "models": models, "case": {},
        "libraries": browser_libraries(libraries), "slots": slots_table(libraries),
        "sliders": [{"name": "frequency", "value": 15.0}, *({"name": each, "of": own} for each in numbers)],
        "sweep": {"settle": SETTLE, "hold": PERIODS},
    }  # fmt: skip


def places(name: str, system: vibeam.ImpactSystem, seed: int) -> list[Place]:
    """Random places of gap, drive, frequency and, where the law has one, its coefficient."""
    random, found = np.random.default_rng(seed), []
    for _ in range(PLACES):
        frequency = float(random.uniform(8.0, 13.0))
        place = {
            "fidelity": name, "frequency": frequency, "drive": float(random.uniform(2e-4, 8e-4)),
            "gap": float(random.uniform(-2e-5, 1.2e-4)), "periods": PERIODS, "settle": SETTLE,
            "at": np.sort(random.uniform(0.0, PERIODS / frequency * (1 - 1e-9), INSTANTS)),
        }  # fmt: skip
        if system.law is None:
            place["restitution"] = float(random.uniform(0.4, 0.8))
        elif isinstance(system.law, PlasticRestitution | ViscousRestitution):
            place["restitution"] = float(random.uniform(0.3, 0.6))
        found.append(place)
    return found


def moved(system: vibeam.ImpactSystem, place: Place) -> vibeam.ImpactSystem:
    """The system at a place."""
    made, number = replace(system, gap=place["gap"]), place.get("restitution")
    if number is None:
        return made
    if system.law is None:
        return replace(made, restitution=number)
    name = "coefficient" if isinstance(system.law, PlasticRestitution) else "factor"
    return replace(made, law=replace(system.law, **{name: number}))


def answers(node: Any, systems: dict[str, vibeam.ImpactSystem], asked: list[Place], output: str) -> list[Any]:
    """The page's motions at places."""
    models = [model(name, each, output) for name, each in systems.items()]
    return node(SCRIPT, {"payload": payload(models), "places": asked})


@pytest.fixture(scope="module")
def flown(node: Any) -> dict[str, list[tuple[Place, dict[str, Any]]]]:
    """Places and the page's motions there, by name of the system."""
    asked = [place for i, (name, each) in enumerate(SYSTEMS.items()) for place in places(name, each, i)]
    found: dict[str, list[Any]] = {name: [] for name in SYSTEMS}
    for place, answer in zip(asked, answers(node, SYSTEMS, asked, "sensor"), strict=True):
        found[place["fidelity"]].append((place, answer))
    return found


def apart(first: Any, second: Any, size: float | None = None) -> float:
    """Largest difference of two arrays, as a share of ``size``, None: of the second's largest value."""
    one, two = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    assert one.shape == two.shape
    return float(np.max(np.abs(one - two), initial=0.0)) / (size or float(np.max(np.abs(two), initial=0.0)) or 1.0)


@pytest.mark.parametrize("name", SYSTEMS)
def test_motions_are_those_of_python(flown: Any, name: str) -> None:
    """As near as their kind allows, and as far as round-off grows: a twin, the gap a rounding away, says how fast."""
    regular, sides = 0, set[int]()
    for place, answer in flown[name]:
        system, drive = moved(SYSTEMS[name], place), vibeam.Drive(2 * pi * place["frequency"], place["drive"])
        regular += agrees(system, drive, place, answer, "sensor", SAME)
        sides |= set(vibeam.simulate(system, drive, PERIODS / place["frequency"]).impact_contacts.tolist())
    assert regular > 0
    assert sides == ({0, 1} if SYSTEMS[name].second_gap is not None else {0})


def agrees(
    system: vibeam.ImpactSystem, drive: vibeam.Drive, place: Place, answer: dict[str, Any], output: str, read: float
) -> bool:  # fmt: skip
    """Compare one motion and its steady point: whether all of it could be, for it is regular."""
    near, span = INTEGRATED if system.contact_law.integrated else SAME, PERIODS / place["frequency"]
    read = max(near, read)
    beside = [(replace(system, gap=system.gap * (1 + each) + each * 1e-4), drive) for each in (ULPS, -ULPS)]
    beside.append((system, replace(drive, amplitude=drive.amplitude * (1 + ULPS))))
    path, *twins = (vibeam.simulate(*each, span) for each in ((system, drive), *beside))
    regular = max(parted(path, each) for each in twins) <= near / 10
    if regular:
        same_motion(path, place, answer, output, near, read)
    else:
        same_impacts(path, twins, answer, near)
    steady, *others = (steady_point(*each, output) for each in ((system, drive), *beside))
    spreads = (
        max(differ(steady.impact_velocities[0], each.impact_velocities[0]), differ(steady.maximum, each.maximum))
        for each in others
    )
    if max(spreads) <= near / 10:
        same_point(steady, answer["steady"], near, read)
    return regular


def steady_point(system: vibeam.ImpactSystem, drive: vibeam.Drive, output: str) -> Any:
    return RegimeSolver(system, drive.omega).steady([drive.omega], drive.amplitude, None, SETTLE, PERIODS, output)[0]


def parted(path: vibeam.Trajectory, twin: vibeam.Trajectory) -> float:
    """How far two motions have parted, as a share of their time and velocity; infinite where they are not alike."""
    late = differ(path.impact_times, twin.impact_times)
    return max(late, differ(path.impact_velocities, twin.impact_velocities))


def differ(values: Array, others: Array) -> float:
    """Largest difference, as a share of the largest value; infinite where there are more of the ones."""
    if np.shape(values) != np.shape(others):
        return inf
    return float(np.nanmax(np.abs(values - others), initial=0.0) / np.nanmax(np.abs(values), initial=1e-300))


def same_motion(
    path: vibeam.Trajectory, place: Place, answer: dict[str, Any], output: str, near: float, read: float
) -> None:  # fmt: skip
    """All that the page says of a motion."""
    impacts, law, span = np.array(answer["impacts"]).reshape(-1, 2), path.system.contact_law, path.t_end
    assert answer["ended"] == path.ended.value
    assert answer["counts"]["impacts"] == path.stats["impacts"]
    if path.system.beyond_plain and not law.integrated:  # else Python's panels are others, of its plain engine
        assert abs(answer["counts"]["evaluations"] - path.stats["evaluations"]) <= (read > near) * TIES
    assert apart(impacts[:, 0], path.impact_times, span) <= near
    assert apart(impacts[:, 1], path.impact_velocities) <= near
    close = max(near, read / 10)
    assert apart(answer["x"], path.at(place["at"], output)) <= close
    modes = path.modes_at(place["at"])
    fast = float(np.max(np.abs(path.system.row(output)) @ (path.system.omega[:, None] * np.abs(modes[:, 0].T))))
    speeds = path.velocity_at(place["at"], output)
    assert apart(answer["v"], speeds, max(fast, float(np.max(np.abs(speeds))))) <= close
    assert apart(answer["modes"], modes[:, 0].ravel()) <= close


def same_impacts(path: vibeam.Trajectory, twins: list[vibeam.Trajectory], answer: dict[str, Any], near: float) -> None:
    """Impacts up to where round-off has grown as large as they are: no more than a hundred times as far as a twin's."""
    found, own = np.array(answer["impacts"]).reshape(-1, 2)[:, 1], path.impact_velocities
    count, size = min(len(found), len(own), *(len(each.impact_times) for each in twins)), own.max(initial=1e-300)
    apart_from = [np.abs(own[:count] - each.impact_velocities[:count]) / size for each in twins]
    grown = np.maximum.accumulate(np.max(apart_from, axis=0))
    away, known = np.abs(found[:count] - own[:count]) / size, grown < LOST
    assert np.all(away[known] <= np.maximum(100 * grown[known], near))


def same_point(steady: Any, found: dict[str, Any], near: float, read: float) -> None:
    """All that the page says of a steady point."""
    for name in ("maximum", "minimum", "amplitude", "reach"):
        size = float(max(abs(steady.maximum[0]), abs(steady.minimum[0]), steady.reach[0]))
        assert found[name] == pytest.approx(float(getattr(steady, name)[0]), abs=read * size)
    assert found["period"] == steady.period[0]
    assert found["impactsPerPeriod"] == steady.impacts_per_period[0]
    assert found["impactVelocity"] == pytest.approx(steady.impact_velocity[0], rel=near, nan_ok=True)
    assert found["rest"] == pytest.approx(steady.rest[0], abs=near)


def test_starts_are_at_static_equilibrium(node: Any) -> None:
    """Off the stops, on the first one, on the second one: where forces or the least energy have it."""
    pushed = {
        f"{name}, {push}": replace(system, static=np.array([push, 0.1, 0.0]))
        for name, system in SYSTEMS.items()
        for push in (-30.0, -0.3, 0.3, 30.0)
    }
    usual = {"frequency": 10.0, "drive": 0.0, "restitution": 0.7, "periods": 1, "settle": 1, "at": [0.0]}
    asked = [{"fidelity": name, "gap": gap, **usual} for name in pushed for gap in (-3e-5, 4e-5, 2e-3)]
    held: dict[str, set[bool]] = {name: set() for name in SYSTEMS}
    for place, answer in zip(asked, answers(node, pushed, asked, "sensor"), strict=True):
        wanted = equilibrium(replace(pushed[place["fidelity"]], gap=place["gap"]))
        assert apart(answer["displacement"], wanted.displacement) <= 1e-12  # round-off of the systems solved
        assert answer["resting"] == wanted.resting
        held[place["fidelity"].rpartition(",")[0]].add(answer["resting"])
    assert all(held[name] == ({False} if SYSTEMS[name].contact_law.yields else {False, True}) for name in SYSTEMS)


RATES = {
    "velocity": TimeDerivative(np.array([1.4, -0.6, 0.3]), 1, 0.0),
    "acceleration": TimeDerivative(np.array([1.4, -0.6, 0.3]), 2, 1.0),
}
READ = {"plain": replace(BASE, zeta=np.full(3, 0.05))} | {
    name: SYSTEMS[name] for name in ("coupled", "two stops", "linear, damped, two stops")
}


@pytest.mark.parametrize("output", RATES)
def test_velocities_and_accelerations_are_read(node: Any, output: str) -> None:
    """In flight, in contact and at rest, also of plain modes: their extremes, and they and their rates at any time."""
    seen = {name: replace(each, derivatives=RATES, restitution=0.5) for name, each in READ.items()}
    usual = {"gap": -1e-5, "frequency": 9.0, "drive": 4e-4, "periods": PERIODS, "settle": SETTLE}
    usual["at"] = np.linspace(0.0, PERIODS / 9.0 * (1 - 1e-9), 3 * INSTANTS)
    asked = [{"fidelity": name, **usual} for name in seen]
    for place, answer in zip(asked, answers(node, seen, asked, output), strict=True):
        system = replace(seen[place["fidelity"]], gap=place["gap"])
        path = vibeam.simulate(system, vibeam.Drive(18 * pi, place["drive"]), PERIODS / 9.0)
        steady = steady_point(system, vibeam.Drive(18 * pi, place["drive"]), output)
        assert len(path.rests) + len(path.contacts) > 0
        assert answer["steady"]["maximum"] == pytest.approx(steady.maximum[0], rel=10 * SAME)
        assert answer["steady"]["minimum"] == pytest.approx(steady.minimum[0], rel=10 * SAME)
        assert apart(answer["x"], path.at(place["at"], output)) <= 10 * SAME
        assert apart(answer["v"], path.velocity_at(place["at"], output)) <= 10 * SAME


def test_what_cannot_be_is_refused(node: Any) -> None:
    script = """
    const { open } = await load("extensions/explore/engine/engine.js"), engine = await open(given.payload);
    const said = (place) => { try { engine.motion("two stops", place); } catch (fault) { return fault.message; } };
    return given.places.map(said);
    """
    asked = [{"damping": 2.0}, {"gap": -3e-4}, {"drive": 1e-4}]
    damping, gap, nothing = node(script, {"payload": payload([model("two stops", BETWEEN)]), "places": asked})
    assert "eigenvalues" in damping
    assert "leave nothing between" in gap
    assert nothing is None


CASES = Path(__file__).parents[4] / "cases"
BY_REGIMES = (
    "experiment/fig17", "experiment/fig18a", "experiment/fig19", "experiment/fig22", "experiment/fig27",
    "experiment/fig28", "experiment/fig30", "experiment/restitution", "experiment/table1", "reductions/at_mass",
    "reductions/near_clamp", "rigs/absorber", "rigs/afm_tip", "rigs/elastic_stop", "rigs/mems_switch",
    "rigs/pinned_bar", "rigs/tube", "stuttgart/two_beams",
)  # fmt: skip


def asked_of(made: dict[str, Any], sliders: Mapping[str, Slider], count: int, seed: int) -> list[Place]:
    """Random places of the sliders, of one fidelity by regimes after the other."""
    random, flying = np.random.default_rng(seed), [each for each in made["models"] if each["engine"] == "regimes"][:4]
    found = []
    for i in range(count):
        place: Place = {}
        for name, each in sliders.items():
            value = float(random.uniform(each.low, each.high))
            place[name] = value if each.places is None else float(random.choice(each.places))
        if "dampings" not in flying[i % len(flying)]:
            place.pop("damping", None)  # which it does not follow, and refuses
        span = PERIODS / place["frequency"] * (1 - 1e-9)
        usual = {"fidelity": flying[i % len(flying)]["name"], "periods": PERIODS, "settle": SETTLE}
        found.append(place | usual | {"at": np.sort(random.uniform(0.0, span, INSTANTS))})
    return found


def case_agrees(node: Any, name: str, count: int) -> tuple[int, list[Place]]:
    """The page at places of its sliders, each against the case with its keys there: how many motions are regular."""
    case = vibeam.load(CASES / f"{name}.toml")
    sliders, made = dict(case_sliders(case).sliders), payload_of(case)
    kept = {each["name"]: each for each in made["sliders"]}
    for each in list(sliders):
        if each not in kept:
            del sliders[each]
        elif "places" in kept[each]:
            sliders[each] = replace(sliders[each], places=np.frombuffer(b64decode(kept[each]["places"]["f8"])))
    asked, regular = asked_of(made, sliders, count, len(name)), 0
    for place, answer in zip(asked, node(SCRIPT, {"payload": made, "places": asked}), strict=True):
        model, fidelity = case.model(place["fidelity"]), case.fidelities[place["fidelity"]]
        keys = [each.settings(place[name]) for name, each in sliders.items() if name != "frequency" and name in place]
        own = {key: value for each in keys for key, value in each.items() if not says(fidelity, key)}
        there, omega = model.at(own), 2 * pi * place["frequency"]
        drive = vibeam.Drive(omega, float(np.ravel(there.amplitude(np.array([omega])))[0]))
        regular += agrees(there.system(), drive, place, answer, case.sweep.output, SOUGHT)
    return regular, asked


@pytest.mark.parametrize("name", ["experiment/fig28", "rigs/tube"])
def test_other_damping_is_that_of_the_case(node: Any, name: str) -> None:
    """At the factors that the page carries; damping couples the modes of the first case."""
    regular, asked = case_agrees(node, name, 8)
    assert regular >= 3
    assert len({place["damping"] for place in asked}) > 2


@pytest.mark.slow
@pytest.mark.parametrize("name", BY_REGIMES)
def test_cases_at_random_places_of_their_sliders(node: Any, name: str) -> None:
    regular, _ = case_agrees(node, name, 20)
    assert regular >= 5
