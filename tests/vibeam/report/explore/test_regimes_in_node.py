"""Any law, two stops, damping that couples the modes: the page's engine in node against Python's, at random places."""

from __future__ import annotations

from dataclasses import replace
from math import inf, pi
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.flight.engine.browser import browser_libraries, slots_table
from vibeam.flight.equilibrium import equilibrium
from vibeam.flight.solver import RegimeSolver
from vibeam.report.explore.models import ended_words, packed
from vibeam.report.explore.regime_models import beyond_plain
from vibeam.system.rows import TimeDerivative
from vibeam_models.arrays import Array
from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop
from vibeam_models.laws.restitution import PlasticRestitution, TableRestitution, ViscousRestitution

PLACES, PERIODS, SETTLE, INSTANTS = 3, 24, 100, 40
SAME = 1e-12  # share of the motion's size: regular motions part by no more, whatever order their sums are made in
#: the same of an integrated contact: its steps are chosen by an error estimate that is round-off itself, so that they
#: are others, and each is right to 1e-12
INTEGRATED = 1e-11
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
const { open } = await load("explore/engine/engine.js");
const engine = await open(given.payload);
return given.places.map(({ fidelity, periods, at, settle, ...place }) => {
  const flight = engine.ready(fidelity, engine.settings(fidelity, place));
  const { displacement, resting } = flight.packed.equilibrium();
  const { impacts, rests, contacts, counts, ended, ...motion } = engine.motion(fidelity, place, { periods });
  const { x, v, modes } = engine.motion(fidelity, place, { periods }).at(at);
  const steady = engine.steady(fidelity, place, { settle, hold: periods });
  return { displacement, resting, impacts, rests, contacts, counts, ended, x, v, modes, steady };
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
        omega, system = 2 * pi * place["frequency"], moved(SYSTEMS[name], place)
        near, twin = INTEGRATED if system.contact_law.integrated else SAME, replace(system, gap=system.gap + 4e-20)
        path, other = (vibeam.simulate(each, vibeam.Drive(omega, place["drive"]), PERIODS / place["frequency"])
                       for each in (system, twin))  # fmt: skip
        if parted(path.impact_velocities, other.impact_velocities) <= near / 10:
            regular += 1
            same_motion(path, place, answer, near)
        else:
            same_impacts(path, other, answer, near)
        sides |= set(path.impact_contacts.tolist())
        steady, beside = (steady_point(each, omega, place["drive"], "sensor") for each in (system, twin))
        if parted(steady.impact_velocities[0], beside.impact_velocities[0]) <= near / 10:
            same_point(steady, answer["steady"], near)
    assert regular > 0
    assert sides == ({0, 1} if SYSTEMS[name].second_gap is not None else {0})


def steady_point(system: vibeam.ImpactSystem, omega: float, drive: float, output: str) -> Any:
    return RegimeSolver(system, omega).steady([omega], drive, None, SETTLE, PERIODS, output)[0]


def parted(values: Array, others: Array) -> float:
    """How far two motions have parted, as a share of their largest velocity; infinite where they are not alike."""
    if np.shape(values) != np.shape(others):
        return inf
    return float(np.nanmax(np.abs(values - others), initial=0.0) / np.nanmax(values, initial=0.0))


def same_motion(path: vibeam.Trajectory, place: Place, answer: dict[str, Any], near: float) -> None:
    """All that the page says of a motion."""
    impacts, law, span = np.array(answer["impacts"]).reshape(-1, 2), path.system.contact_law, path.t_end
    assert answer["ended"] == path.ended.value
    assert answer["counts"]["impacts"] == path.stats["impacts"]
    assert law.integrated or answer["counts"]["evaluations"] == path.stats["evaluations"]
    assert apart(impacts[:, 0], path.impact_times, span) <= near
    assert apart(impacts[:, 1], path.impact_velocities) <= near
    assert apart(np.array(answer["rests"]).reshape(-1, 2), path.rests, span) <= near
    contacts, found = path.contacts.copy(), np.array(answer["contacts"]).reshape(-1, 3)
    contacts[:, 1] += contacts[:, 0]
    assert apart(found[:, :2], contacts[:, :2], span) <= near
    assert apart(found[:, 2], contacts[:, 2]) <= near
    assert (len(contacts) > 0) == law.yields
    assert apart(answer["x"], path.at(place["at"], "sensor")) <= near
    assert apart(answer["v"], path.velocity_at(place["at"], "sensor")) <= near
    assert apart(answer["modes"], path.modes_at(place["at"])[:, 0].ravel()) <= near


def same_impacts(path: vibeam.Trajectory, twin: vibeam.Trajectory, answer: dict[str, Any], near: float) -> None:
    """Impacts up to where round-off has grown as large as they are: no more than ten times as far as the twin's."""
    found, own, others = np.array(answer["impacts"])[:, 1], path.impact_velocities, twin.impact_velocities
    count, size = min(len(found), len(own), len(others)), own.max()
    grown = np.maximum.accumulate(np.abs(own[:count] - others[:count])) / size
    away = np.abs(found[:count] - own[:count]) / size
    assert np.all(away <= np.maximum(10 * grown, near))
    assert np.sum(grown < 1e-6) > 5


def same_point(steady: Any, found: dict[str, Any], near: float) -> None:
    """All that the page says of a steady point."""
    for name in ("maximum", "minimum", "amplitude", "reach"):
        size = float(max(abs(steady.maximum[0]), abs(steady.minimum[0]), steady.reach[0]))
        assert found[name] == pytest.approx(float(getattr(steady, name)[0]), abs=near * size)
    assert found["period"] == steady.period[0]
    assert found["impactsPerPeriod"] == steady.impacts_per_period[0]
    assert found["impactVelocity"] == pytest.approx(steady.impact_velocity[0], rel=near)
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
        assert apart(answer["displacement"], wanted.displacement) <= 1e-13
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
        steady = steady_point(system, 18 * pi, place["drive"], output)
        assert len(path.rests) + len(path.contacts) > 0
        assert answer["steady"]["maximum"] == pytest.approx(steady.maximum[0], rel=10 * SAME)
        assert answer["steady"]["minimum"] == pytest.approx(steady.minimum[0], rel=10 * SAME)
        assert apart(answer["x"], path.at(place["at"], output)) <= 10 * SAME
        assert apart(answer["v"], path.velocity_at(place["at"], output)) <= 10 * SAME


def test_what_cannot_be_is_refused(node: Any) -> None:
    script = """
    const { open } = await load("explore/engine/engine.js"), engine = await open(given.payload);
    const said = (place) => { try { engine.motion("two stops", place); } catch (fault) { return fault.message; } };
    return given.places.map(said);
    """
    asked = [{"damping": 2.0}, {"gap": -3e-4}, {"drive": 1e-4}]
    damping, gap, nothing = node(script, {"payload": payload([model("two stops", BETWEEN)]), "places": asked})
    assert "eigenvalues" in damping
    assert "leave nothing between" in gap
    assert nothing is None
