"""A drive of several harmonics: the page's engine in node against Python's, at random places of a case's sliders."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.case.case import Case
from vibeam.extensions.explore.payload import payload
from vibeam.solvers.harmonic_point import several_of, started, steady_point

PERIODS, SETTLE, HOLD = 20, 60, 12
RIG = {
    "beam": {"length": "180 mm", "width": "20 mm", "thickness": "1 mm", "youngs_modulus": "210 GPa",
             "density": "7850 kg/m^3", "damping_ratio": 0.02},
    "mass": {"mass": "0.2 kg", "position": "132 mm"},
    "stop": {"gap": "0.01 mm", "restitution": 0.6}, "sensor": {"position": "100 mm"},
    "drive": {"acceleration": "0.8 m/s^2", "harmonic": [2, 5], "harmonic_share": ["30 %", "10 %"],
              "harmonic_phase": ["40 deg", "-100 deg"]},
    "sweep": {"frequency": ["10 Hz", "16 Hz"], "settle": SETTLE, "hold": HOLD},
    "fidelity": {"one": {"reduction": "static_mode"}, "two": {"reduction": "modal", "modes": 2},
                 "eight": {"reduction": "modal", "modes": 8}},
}  # fmt: skip
SCRIPT = """
const { open } = await load("extensions/explore/engine/engine.js");
const engine = await open(given.payload);
return given.places.map(({ fidelity, at, ...place }) => {
  const motion = engine.motion(fidelity, place, { periods: given.periods }), { x, v, modes } = motion.at(at);
  const { state, ...steady } = engine.steady(fidelity, place, { settle: given.settle, hold: given.hold });
  const settings = engine.settings(fidelity, place), { impacts, counts, ended } = motion;
  return { settings, impacts, counts, ended, x, v, modes, steady, displacement: state.displacement };
});
"""


def places(case: Case, count: int) -> list[dict[str, Any]]:
    random, found = np.random.default_rng(5), []
    for name in case.fidelities:
        for _ in range(count):
            frequency = float(random.uniform(10.0, 16.0))
            place = {"frequency": frequency, "drive": float(random.uniform(0.4, 1.5))}
            place |= {"gap": float(random.uniform(-2e-4, 2e-4)), "restitution": float(random.uniform(0.1, 0.8))}
            place["damping"] = float(random.choice([1.0, 2.0]))
            at = np.sort(random.uniform(0.0, PERIODS / frequency * (1 - 1e-9), 30))
            found.append({"fidelity": name, "at": at, **place})
    return found


def flown(case: Case, place: dict[str, Any], own: dict[str, float]) -> tuple[Any, ...]:
    """Motion and steady point by Python at a model's own numbers."""
    system = case.system(place["fidelity"])
    system = replace(system, gap=own["gap"], restitution=own["restitution"], zeta=system.zeta * own["damping"])
    drive, shares = vibeam.Drive(own["omega"], own["amplitude"]), case.scene_of(place["fidelity"]).harmonics
    wide, start = started(system, drive, shares, "flight")
    path = vibeam.simulate(wide, drive, PERIODS * 2 * pi / drive.omega, start)
    several = several_of(system, drive, shares, "flight")
    point, after = steady_point(
        several, None, SETTLE, HOLD, solver_name="flight", output="sensor", slowest=drive.omega, options={}
    )
    return several, path, point, after


@pytest.fixture(scope="module")
def answered(node: Any) -> tuple[Case, list[tuple[dict[str, Any], dict[str, Any]]]]:
    case = vibeam.load(RIG)
    asked = places(case, 4)
    given = {"payload": payload(case), "places": asked, "periods": PERIODS, "settle": SETTLE, "hold": HOLD}
    return case, list(zip(asked, node(SCRIPT, given), strict=True))


def apart(first: Any, second: Any) -> float:
    """Largest difference of two arrays, as a share of the second's largest value."""
    one, two = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    assert one.shape == two.shape
    return float(np.max(np.abs(one - two), initial=0.0) / (np.max(np.abs(two), initial=0.0) or 1.0))


def test_motions_are_those_of_python(answered: Any) -> None:
    """Impacts, counts, the output and the system's own modes: these motions are regular."""
    case, pairs = answered
    rested = 0
    for place, found in pairs:
        several, path, _, _ = flown(case, place, found["settings"])
        times, speeds = np.array(found["impacts"]).reshape(-1, 2).T
        assert found["ended"] == path.ended.value
        assert found["counts"] == {"impacts": path.stats["impacts"], "evaluations": path.stats["evaluations"]}
        assert apart(times, path.impact_times) <= 1e-12
        assert apart(speeds, path.impact_velocities) <= 1e-12
        assert apart(found["x"], path.at(place["at"], "sensor")) <= 1e-12
        assert apart(found["v"], path.velocity_at(place["at"], "sensor")) <= 1e-12
        own, _ = several.in_own_modes(path.modes_at(place["at"]), place["at"])
        assert apart(found["modes"], own.ravel()) <= 1e-12
        rested += len(path.rests)
    assert rested > 2


EXTREMES = ("maximum", "minimum", "amplitude", "reach")


def off(first: dict[str, Any], second: dict[str, Any], size: float) -> float:
    """Largest difference of two steady points' extremes, as a share of the motion's size."""
    return max(abs(first[name] - second[name]) for name in EXTREMES) / size


def extremes(point: Any) -> dict[str, float]:
    return {name: float(getattr(point, name)[0]) for name in EXTREMES}


def sensitivity(case: Case, place: dict[str, Any], own: dict[str, float]) -> tuple[float, float]:
    """What last digits of a model's numbers change in Python's steady point: extremes, and the state after it."""
    _, _, point, after = flown(case, place, own)
    moved = [
        flown(case, place, own | {name: own[name] * (1 + change)})[2:]
        for name in ("amplitude", "gap", "omega") for change in (1e-15, -1e-15)
    ]  # fmt: skip
    size = float(point.reach[0])
    return (
        max(off(extremes(each), extremes(point), size) for each, _ in moved),
        max(apart(end.displacement, after.displacement) for _, end in moved),
    )


def test_steady_points_are_those_of_python(answered: Any) -> None:
    """Those that repeat, as near as last digits of the same numbers bring Python's own to itself."""
    case, pairs = answered
    firm = 0
    for place, found in pairs:
        _, _, point, after = flown(case, place, found["settings"])
        steady, size = found["steady"], float(point.reach[0])
        assert (steady["period"] > 0) == (point.period[0] > 0)
        if point.period[0] == 0:
            continue
        of_extremes, of_state = sensitivity(case, place, found["settings"])
        firm += max(of_extremes, of_state) < 1e-12
        assert off(steady, extremes(point), size) <= 1e-13 + 3 * of_extremes
        assert steady["period"] == point.period[0]
        assert steady["impactsPerPeriod"] == pytest.approx(float(point.impacts_per_period[0]), rel=1e-14)
        assert steady["impactVelocity"] == pytest.approx(float(point.impact_velocity[0]), rel=1e-11, nan_ok=True)
        assert steady["rest"] == pytest.approx(float(point.rest[0]), abs=1e-12)
        assert apart(found["displacement"], after.displacement) <= 1e-13 + 3 * of_state
    assert firm > 8


def test_a_case_in_the_page(node: Any) -> None:
    """The further harmonic moves the peak as the case says; without drive nothing moves."""
    case = vibeam.load(Path(__file__).parents[4] / "cases/dtu_harmonic.toml")
    made = payload(case)
    assert {each["engine"] for each in made["models"]} == {"plain", "harmonics"}
    script = """
    const { open } = await load("extensions/explore/engine/engine.js"), engine = await open(given);
    const still = engine.motion("together", { drive: 0 }, { periods: 2 });
    const peaks = ["pure", "together"].map((name) => engine.steady(name, { frequency: 15.3 }).amplitude);
    return [...peaks, still.impacts.length];
    """
    pure, together, impacts = node(script, made)
    assert together / pure == pytest.approx(0.981, abs=0.01)
    assert impacts == 0
